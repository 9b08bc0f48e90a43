/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be seen of chains, as polylines. A chain is walked from one end to the other; hidden parts that are short
 * are bridged, and short pieces that are hidden at both ends dropped. */
#include "chains/chains.h"

static const double bridge = 1.5; /* pixels */
static const double least = 1.5;  /* pixels of what is hidden at both ends */
static const double none = 0.02;  /* pixels of any run */
static const double touch = 1e-3; /* pixels between what follows without a gap */
static const double span = 60;    /* pixels of an edge from point to point at most: what the frame cuts has, some way
				     from there, the points that it has uncut */

typedef struct walk {
	const chains *c;
	bool hidden; /* what is not seen is written */
	kept_shapes *out;
	bool failed;
	int32_t run;
	bool open;      /* a run has begun */
	int64_t first;  /* its first point */
	double gap;     /* pixels since the last that is seen; INFINITY: none was */
	int32_t begins; /* enum encre_chain_end */
	double length;
} walk;

/* The pieces of a line that are written. */
static const seen_piece *pieces_of(const chains *c, const line *l, bool hidden, int *count)
{
	*count = hidden ? l->n_hidden : l->n_pieces;
	return hidden ? c->hidden + l->first_hidden : c->pieces + l->first;
}

static encre_chain_point *add_point(walk *w)
{
	kept_shapes *k = w->out;
	encre_chain_point *points = with_room(k->points, sizeof *points, k->n_points, &k->room_points);
	if (!points) {
		w->failed = true;
		return NULL;
	}
	k->points = points;
	return k->points + k->n_points++;
}

static void finish(walk *w, int32_t end)
{
	kept_shapes *k = w->out;
	if (!w->open)
		return;
	w->open = false;
	bool loose = w->begins == ENCRE_END_HIDDEN && end == ENCRE_END_HIDDEN;
	if (k->n_points - w->first < 2 || w->length < none || (loose && w->length < least)) {
		k->n_points = w->first;
		return;
	}
	k->points[w->first].end = w->begins;
	k->points[k->n_points - 1].end = end;
	w->run++;
}

static double apart_from(const encre_chain_point *p, screen s)
{
	double x = s.x - 0.5 - (double)p->x, y = s.y - 0.5 - (double)p->y;
	return sqrt(x * x + y * y);
}

static void add_part(walk *w, const line *l, const seen_piece *piece, int way, double from, double to)
{
	kept_shapes *k = w->out;
	screen ends[2] = {screen_at(l, from), screen_at(l, to)};
	screen begins = screen_at(l, l->whole[0]);
	encre_chain_point p = {.bend = piece->flush ? piece->bend : max(piece->bend, l->bend),
			       .gap = w->hidden ? (float)piece->before : piece->gap,
			       .along = {(float)apart(begins, ends[0]), (float)apart(begins, ends[1])},
			       .over = l->kind & ENCRE_CHAIN_BEVEL ? l->over : 0,
			       .fade = l->kind & ENCRE_CHAIN_BEVEL ? l->fade : 0,
			       .mesh = l->body,
			       .edge = l->edge & 0xffffff,
			       .kind = l->kind | (piece->flush ? ENCRE_CHAIN_FLUSH : 0) |
				       (w->hidden ? ENCRE_CHAIN_HIDDEN : 0),
			       .side = l->side * way,
			       .object = l->object,
			       .behind = piece->behind,
			       .run = w->run,
			       .color = {l->color[way < 0], l->color[way > 0]}};
	bool any = k->n_points > w->first;
	for (int e = 0; e < 2; e++) {
		/* the first point of a run has what tells of the way from it; one after a bridge of the way to it */
		if (e == 0 && any && apart_from(k->points + k->n_points - 1, ends[0]) <= touch)
			continue;
		encre_chain_point *to = add_point(w);
		if (!to)
			return;
		*to = p;
		to->x = (float)(ends[e].x - 0.5);
		to->y = (float)(ends[e].y - 0.5);
		to->depth = (float)ends[e].depth;
		if (e == 0 && any) {
			to->along[1] = to->along[0];
			w->length += apart_from(to - 1, ends[0]);
		}
	}
	w->length += apart(ends[0], ends[1]);
}

/* With points of its own at places that are fixed to the whole line. */
static void add_piece(walk *w, const line *l, const seen_piece *piece, int way)
{
	double from = way > 0 ? piece->from : piece->to, to = way > 0 ? piece->to : piece->from;
	int count = l->whole_long > 2 * span ? (int)fmin(l->whole_long / span, 1e6) : 1;
	double begins = share_of(l, from) * count, ends = share_of(l, to) * count, little = 1e-3;
	int first = way > 0 ? (int)floor(begins + little) + 1 : (int)ceil(begins - little) - 1;
	for (int i = first; way > 0 ? i < ends - little : i > ends + little; i += way) {
		double at = place_of(l, (double)i / count);
		add_part(w, l, piece, way, from, at);
		from = at;
	}
	add_part(w, l, piece, way, from, to);
}

static void hide(walk *w, double pixels)
{
	if (pixels <= touch)
		return;
	w->gap += pixels;
	if (w->gap > bridge)
		finish(w, ENCRE_END_HIDDEN);
}

/* A line of a chain, from its end `from`. */
static void walk_line(walk *w, const line *l, int from, bool loop)
{
	int way = from ? -1 : 1;
	double at = l->part[from];
	int count;
	const seen_piece *all = pieces_of(w->c, l, w->hidden, &count);
	for (int i = 0; i < count && !w->failed; i++) {
		const seen_piece *piece = all + (way > 0 ? i : count - 1 - i);
		double begins = way > 0 ? piece->from : piece->to, ends = way > 0 ? piece->to : piece->from;
		double hidden = apart(screen_at(l, at), screen_at(l, begins));
		bool none_yet = w->gap == INFINITY;
		hide(w, hidden);
		if (!w->open) {
			w->open = true;
			w->first = w->out->n_points;
			w->length = 0;
			w->begins = !none_yet || hidden > touch ? ENCRE_END_HIDDEN
				    : loop                      ? ENCRE_END_LOOP
				    : l->clipped[from]          ? ENCRE_END_FRAME
								: ENCRE_END_NODE;
		}
		w->gap = 0;
		add_piece(w, l, piece, way);
		at = ends;
	}
	hide(w, apart(screen_at(l, at), screen_at(l, l->part[1 - from])));
}

static bool is_whole(const chains *c, const line *l, bool hidden)
{
	int count;
	const seen_piece *all = pieces_of(c, l, hidden, &count);
	if (!count || all[0].from > l->part[0] || all[count - 1].to < l->part[1])
		return false;
	for (int i = 1; i < count; i++)
		if (all[i].from > all[i - 1].to)
			return false;
	return true;
}

static bool begins_apart(const chains *c, int64_t end, bool hidden)
{
	const line *l = c->lines + end / 2;
	int count;
	const seen_piece *all = pieces_of(c, l, hidden, &count);
	if (!count)
		return true;
	return end & 1 ? all[count - 1].to < l->part[1] : all->from > l->part[0];
}

/* The end at which to enter a ring: where nothing of it is written, if anywhere. *whole: all is. */
static int64_t ring_start(const chains *c, int64_t start, bool hidden, bool *whole)
{
	int64_t end = start, part = -1;
	do {
		const line *l = c->lines + end / 2;
		if (begins_apart(c, end, hidden)) {
			*whole = false;
			return end;
		}
		part = part < 0 && !is_whole(c, l, hidden) ? end : part;
		end = l->link[1 - (end & 1)];
	} while (end != start);
	*whole = part < 0;
	return *whole ? start : part;
}

/* The end at which to enter a chain: the one given, or the other one, so that what it bounds lies to its right, however
 * much of it lies in the frame. */
static int64_t ahead_of(const chains *c, int64_t start)
{
	int64_t end = start, last = start;
	int side = 0;
	do {
		const line *l = c->lines + end / 2;
		side = side ? side : end & 1 ? -l->side : l->side;
		last = end ^ 1;
		end = l->link[1 - (end & 1)];
	} while (end >= 0 && end != start);
	return side >= 0 ? start : end < 0 ? last : c->lines[start / 2].link[start & 1];
}

/* A chain, entered at an end of its first line. */
static void walk_chain(walk *w, int64_t start, bool loop, uint8_t *done)
{
	int64_t end = start;
	w->gap = INFINITY;
	do {
		const line *l = w->c->lines + end / 2;
		int from = (int)(end & 1);
		done[end / 2] = 1;
		walk_line(w, l, from, loop && end == start);
		end = l->link[1 - from];
		if (end < 0) {
			finish(w, w->gap > touch         ? ENCRE_END_HIDDEN
				  : l->clipped[1 - from] ? ENCRE_END_FRAME
							 : ENCRE_END_NODE);
			return;
		}
	} while (end != start && !w->failed);
	finish(w, loop ? ENCRE_END_LOOP : w->gap > touch ? ENCRE_END_HIDDEN : ENCRE_END_NODE);
}

int32_t runs_write(chains *c)
{
	walk w = {.c = c, .out = c->kept};
	uint8_t *done = late_take(&c->late, (size_t)c->n_lines + 1, sizeof *done);
	if (!done)
		return ENCRE_ERROR_MEMORY;
	c->kept->n_points = 0;
	for (int hidden = 0; hidden < 1 + (c->hidden != NULL); hidden++) {
		w.hidden = hidden;
		for (int64_t i = 0; i < c->n_lines; i++)
			done[i] = 0;
		for (int rings = 0; rings < 2; rings++)
			for (int64_t i = 0; i < c->n_lines && !w.failed; i++) {
				const line *l = c->lines + i;
				bool whole = false;
				if (done[i] || (!rings && l->link[0] >= 0 && l->link[1] >= 0))
					continue;
				int64_t start =
					rings ? ring_start(c, 2 * i, hidden, &whole) : 2 * i + (l->link[0] >= 0);
				walk_chain(&w, ahead_of(c, start), whole, done);
			}
	}
	return w.failed ? ENCRE_ERROR_MEMORY : ENCRE_OK;
}
