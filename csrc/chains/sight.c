/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which parts of lines the eye sees. Samples lie about a pixel apart at places that are fixed to the whole edge, so
 * that every border asks the same. Where what can be seen changes between two of them is narrowed down. Where another
 * surface touches the line, what lies to both sides tells whether there is one. */
#include "chains/chains.h"

#include <string.h>

enum {
	CHUNK = 256, /* lines that a thread takes at once */
	HALVINGS = 12
};
static const double exact = 0.02;     /* pixels to which ends are found, and by which what hides lies before */
static const double close_to = 2e-6;  /* of the depth: as far as doubles of a mesh in floats tell */
static const double mark_before = 1;  /* pixels by which a line by hand may lie within what it is drawn on */
static const double beside = 0.12;    /* pixels to both sides where it is asked what a line parts */
static const double step = 0.2;       /* pixels of depth between the two: a line */
static const double cell = 4;         /* pixels in which a contour has one surface behind it */
static const double beyond = 0.3;     /* pixels from a contour, to what is behind it */
static const double color_step = 1.5; /* pixels from sample to sample where colors part: nothing but surfaces before it
					 ends such a line */
static const float nothing_behind = 1e9f, far_behind = 64;
static const float gap_step = 0.05f, gap_share = 1.15f, gap_even = 2; /* what is behind a piece lies so far off: pixels
									 up to gap_even, then shares */

static const int contours = ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER;

/* What is known of a place on a line. */
typedef struct look {
	bool seen, flush;
	float bend;
	int before; /* of what is not seen, where that is asked: things that lie
		       before it */
} look;

/* Aims at a place, that many units deep. */
static void sight_aim(sight *s, const double place[3], double depth)
{
	const chains *c = s->c;
	memcpy(s->to, place, sizeof s->to);
	s->least = c->job->clip_start / depth;
	s->most = c->job->clip_end > c->job->clip_start ? c->job->clip_end / depth : 1e6;
	for (int k = 0; k < 3; k++)
		s->from[k] = c->perspective ? c->eye[k] : place[k] + c->back[k] * depth;
}

static double pixel_at_depth(const chains *c, double depth)
{
	return c->perspective ? c->pixel * depth : c->pixel;
}

/* A direction of length 1 in space that on the screen is square to the line, at a place; false: there is none. */
static bool side_of(const chains *c, const line *l, const double p[3], double side[3])
{
	double to_eye[3], way[3];
	if (c->perspective)
		minus3(c->eye, p, to_eye);
	else
		memcpy(to_eye, c->back, sizeof to_eye);
	minus3(l->p[1], l->p[0], way);
	cross3(way, to_eye, side);
	double length = sqrt(dot3(side, side));
	for (int k = 0; k < 3; k++)
		side[k] /= length;
	return length > 0;
}

/* Share of the way to a place at which the plane of what was found lies, and its normal. */
static double plane_at(const chains *c, const sight *s, const double p[3], double depth, double across[3])
{
	double corners[3][3], from[3], way[3], to[3];
	world_face(c->bodies[s->body].mesh, s->face, corners);
	across3(corners, across);
	for (int k = 0; k < 3; k++)
		from[k] = c->perspective ? c->eye[k] : p[k] + c->back[k] * depth;
	minus3(p, from, way);
	minus3(corners[0], from, to);
	double d = dot3(across, way), size = sqrt(dot3(across, across) * dot3(way, way));
	return fabs(d) > 1e-9 * size ? dot3(across, to) / d : s->at;
}

/* What the two sides of a line are, where a surface touches it or ends there. */
static look parts(const chains *c, const line *l, double t)
{
	const look whole = {true, false, 180, 0}, none = {false, false, 0, 0};
	double p[3], side[3], at[2], across[2][3];
	screen here = screen_at(l, t);
	double pixel = pixel_at_depth(c, here.depth);
	sight s[2];
	space_at(l, t, p);
	if (!side_of(c, l, p, side))
		return none;
	for (int k = 0; k < 2; k++) {
		double place[3];
		for (int i = 0; i < 3; i++)
			place[i] = p[i] + (k ? -beside : beside) * pixel * side[i];
		s[k] = (sight){.c = c, .tolerance = 2 * close_to};
		sight_aim(s + k, place, here.depth);
		ISA(sight_nearest)(s + k);
	}
	if (s[0].body < 0 || s[1].body < 0)
		return s[0].body >= 0 || s[1].body >= 0 ? whole : none;
	if (s[0].body == s[1].body && s[0].face == s[1].face)
		return none;
	for (int k = 0; k < 2; k++)
		at[k] = plane_at(c, s + k, p, here.depth, across[k]);
	if (fabs(at[0] - at[1]) * here.depth > step * pixel)
		return whole;
	const encre_mesh *a = c->bodies[s[0].body].mesh, *b = c->bodies[s[1].body].mesh;
	if (dot3(across[0], across[1]) < 0)
		for (int k = 0; k < 3; k++)
			across[1][k] = -across[1][k]; /* of both the side that the eye sees */
	float bend = angle3(across[0], across[1]);
	bool one_object = object_of(a, s[0].face) == object_of(b, s[1].face);
	bool one_material = material_of(a, s[0].face) == material_of(b, s[1].face);
	if (!one_object && (!one_material || bend >= 1))
		return whole;
	return (look){true, true, bend, 0};
}

static look look_at(const chains *c, const line *l, double t, sight *s)
{
	double p[3];
	screen here = screen_at(l, t);
	double pixel = pixel_at_depth(c, here.depth);
	space_at(l, t, p);
	s->tolerance = fmax(close_to, (l->kind & ENCRE_CHAIN_MARK ? mark_before : exact) * pixel / here.depth);
	s->slack = exact * pixel;
	sight_aim(s, p, here.depth);
	if (ISA(sight_hidden)(s))
		return (look){.before = c->hidden && !(l->kind & ENCRE_CHAIN_COLOR)
						? ISA(sight_before)(s, c->job->most_before + 1)
						: 0};
	if (!(l->kind & (ENCRE_CHAIN_MARK | ENCRE_CHAIN_COLOR)) &&
	    (s->touched || l->kind & (ENCRE_CHAIN_BORDER | ENCRE_CHAIN_MEET)))
		return parts(c, l, t);
	return (look){true, false, l->bend, 0};
}

static bool alike(look a, look b)
{
	/* what something touches at one place only is no step along all of it */
	return a.seen == b.seen && a.flush == b.flush && a.before == b.before && (a.bend < 180) == (b.bend < 180);
}

/* Between two places that look different: where. */
static double narrow(const chains *c, const line *l, double from, double to, look first, const sight *hint)
{
	sight s = *hint;
	double long_ = l->whole_long / (l->whole[1] - l->whole[0]);
	for (int k = 0; k < HALVINGS && (to - from) * long_ > exact; k++) {
		double middle = 0.5 * (from + to);
		look at = look_at(c, l, middle, &s);
		if (alike(at, first))
			from = middle;
		else
			to = middle;
	}
	return first.seen ? from : to;
}

/* ---- what is behind -------------------------------------------------------------------------------------------- */

typedef struct depth_behind {
	int32_t object;
	float gap;
} depth_behind;

/* By itself, and not by where a piece begins: a part of a frame has the pieces of the whole. */
static float on_steps(float gap)
{
	if (!(gap >= 0 && gap < far_behind)) /* what lies before the contour begins there: the two are apart */
		return far_behind;
	if (gap < gap_even)
		return gap_step * floorf(gap / gap_step + 0.5f);
	float v = gap_even;
	while (v * gap_share <= gap)
		v *= gap_share;
	return v;
}

static depth_behind behind_at(const chains *c, const line *l, double t)
{
	double p[3], side[3];
	screen here = screen_at(l, t);
	double pixel = pixel_at_depth(c, here.depth);
	sight s = {.c = c, .tolerance = 2 * close_to};
	space_at(l, t, p);
	if (!l->side || !side_of(c, l, p, side))
		return (depth_behind){0, nothing_behind};
	/* away from the surface; on the screen y goes down */
	screen a = screen_at(l, l->part[0]), b = screen_at(l, l->part[1]);
	double right[2] = {-(b.y - a.y) * l->side, (b.x - a.x) * l->side}, probe[3], q[3];
	for (int k = 0; k < 3; k++)
		probe[k] = p[k] + pixel * side[k];
	const double *v = c->job->view, *m = c->job->projection;
	move3(v, probe, q);
	double x[4];
	for (int i = 0; i < 4; i++)
		x[i] = m[4 * i] * q[0] + m[4 * i + 1] * q[1] + m[4 * i + 2] * q[2] + m[4 * i + 3];
	double dx = 0.5 * c->job->frame.width * (1 + x[0] / x[3]) - here.x;
	double dy = 0.5 * c->job->frame.height * (1 - x[1] / x[3]) - here.y;
	double away = dx * right[0] + dy * right[1] > 0 ? -beyond : beyond, place[3];
	for (int k = 0; k < 3; k++)
		place[k] = p[k] + away * pixel * side[k];
	sight_aim(&s, place, here.depth);
	if (!ISA(sight_nearest)(&s))
		return (depth_behind){0, nothing_behind};
	return (depth_behind){object_of(c->bodies[s.body].mesh, s.face),
			      on_steps((float)((s.at - 1) * here.depth / pixel))};
}

/* ---- pieces ---------------------------------------------------------------------------------------------------- */

/* Which samples of the whole line lie in the frame, from..end-1 of n. */
typedef struct samples {
	int n, from, end;
} samples;

static samples samples_of(const line *l)
{
	bool color = l->kind & ENCRE_CHAIN_COLOR;
	double count = ceil(color ? l->whole_long / color_step : l->whole_long);
	int n = count < 1 ? 1 : count < 1e8 ? (int)count : 100000000;
	if (!color)
		n = n < 3 && l->whole_long > 0.7 ? 3 : n < 2 && l->whole_long > 0.3 ? 2 : n;
	double a = share_of(l, l->part[0]) * n, b = share_of(l, l->part[1]) * n;
	int from = (int)ceil(a - 0.5), last = (int)floor(b - 0.5);
	if (from > last)
		from = last = (int)floor(0.5 * (a + b));
	from = from < 0 ? 0 : from > n - 1 ? n - 1 : from;
	last = last > n - 1 ? n - 1 : last < from ? from : last;
	return (samples){n, from, last + 1};
}

static int cells_of(const line *l)
{
	if (!(l->kind & contours))
		return 1;
	double n = ceil(l->whole_long / cell);
	return n < 1 ? 1 : n < 1e7 ? (int)n : 10000000;
}

/* Pieces that a line can have at most: one for every second sample, or for each if what they show differs, and one more
 * for each cell. */
static int room_of(const line *l)
{
	samples s = samples_of(l);
	if (l->kind & ENCRE_CHAIN_COLOR)
		return (s.end - s.from + 1) / 2;
	double cells = cells_of(l) * (share_of(l, l->part[1]) - share_of(l, l->part[0]));
	return s.end - s.from + 2 + (int)cells + 2;
}

static void add_piece(line *l, seen_piece *all, seen_piece piece)
{
	if (l->n_pieces < l->room && piece.to > piece.from)
		all[l->n_pieces++] = piece;
}

/* A part that can be seen, cut where what is behind it changes. */
static void add_seen(const chains *c, line *l, seen_piece *all, double from, double to, look at)
{
	seen_piece piece = {.from = from, .to = to, .bend = at.bend, .flush = at.flush, .gap = nothing_behind};
	int n = cells_of(l);
	if (!(l->kind & contours)) {
		add_piece(l, all, piece);
		return;
	}
	int first = (int)(share_of(l, from) * n), last = (int)(share_of(l, to) * n);
	first = first < 0 ? 0 : first < n ? first : n - 1;
	last = last < first ? first : last < n ? last : n - 1;
	depth_behind now = {0, nothing_behind};
	for (int k = first; k <= last; k++) {
		double middle = place_of(l, (k + 0.5) / n), begins = place_of(l, (double)k / n);
		depth_behind next = behind_at(c, l, middle);
		if (k == first) {
			now = next;
		} else if (now.object != next.object || now.gap != next.gap) {
			piece.to = begins;
			piece.gap = now.gap;
			piece.behind = now.object;
			add_piece(l, all, piece);
			piece.from = begins;
			now = next;
		}
	}
	piece.to = to;
	piece.gap = now.gap;
	piece.behind = now.object;
	add_piece(l, all, piece);
}

static void add(const chains *c, line *l, seen_piece *all, double from, double to, look at)
{
	if (at.seen) {
		add_seen(c, l, all, from, to, at);
		return;
	}
	/* what nothing hides is no line there */
	if (c->hidden && at.before > 0 && at.before <= c->job->most_before && l->n_hidden < l->room && to > from)
		c->hidden[l->first_hidden + l->n_hidden++] = (seen_piece){
			.from = from, .to = to, .bend = l->bend, .gap = nothing_behind, .before = at.before};
}

/* s: what hid the line before hides this one, too, or not. */
static void see(const chains *c, line *l, seen_piece *all, sight *s)
{
	samples k = samples_of(l);
	s->own = l;
	look last = {0};
	double begins = 0, before = l->part[0];
	for (int i = k.from; i < k.end; i++) {
		double t = place_of(l, (i + 0.5) / k.n);
		look now = look_at(c, l, t, s);
		if (i == k.from) {
			begins = l->part[0];
		} else if (!alike(now, last)) {
			double at = narrow(c, l, before, t, last, s);
			add(c, l, all, begins, at, last);
			begins = at;
		}
		last = now;
		before = t;
	}
	add(c, l, all, begins, l->part[1], last);
}

static void see_lines(void *data, int from, int end, int thread)
{
	(void)thread;
	chains *c = data;
	sight s = {.c = c, .body = -1};
	for (int i = from; i < end && !bands_stopped(c->pool); i++)
		see(c, c->lines + i, c->pieces + c->lines[i].first, &s);
}

int32_t ISA(sight_find)(chains *c)
{
	int64_t sum = 0;
	for (int64_t i = 0; i < c->n_lines; i++) {
		line *l = c->lines + i;
		l->first = sum;
		l->first_hidden = sum;
		l->n_pieces = l->n_hidden = 0;
		sum += l->room = room_of(l);
	}
	c->pieces = late_take(&c->late, (size_t)sum + 1, sizeof *c->pieces);
	if (c->job->most_before > 0)
		c->hidden = late_take(&c->late, (size_t)sum + 1, sizeof *c->hidden);
	if (c->job->most_before > 0 && !c->hidden)
		return ENCRE_ERROR_MEMORY;
	return c->pieces ? bands_run(c->pool, (int)c->n_lines, CHUNK, see_lines, c) : ENCRE_ERROR_MEMORY;
}
