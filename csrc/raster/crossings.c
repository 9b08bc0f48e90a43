/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks and creases: where lines by hand, contours and edges that bend pass between the pixels of a band, and can be
 * seen. */
#include "raster/crossings.h"

#include "raster/contours.h"
#include "raster/flush.h"
#include "raster/segment.h"

#include "base/pixel.h"

#include <math.h>
#include <string.h>

static const double least_cover = 0.25; /* pixels by which a surface lies over an edge that is not seen; test_creases */

/* A line, or the edge of a triangle from corner k to the next. */
static bool segment_of(const raster *r, const part *part, uint32_t primitive, int k, segment *s, int *y0, int *y1)
{
	corner c[3];
	geometry_corners(part, primitive, c);
	bool line = part->mesh->kind != ENCRE_TRIANGLES;
	return segment_make(&r->room, (const corner[2]){c[line ? 0 : k], c[line ? 1 : (k + 1) % 3]}, s, y0, y1);
}

static double turn_of(const part *part, uint32_t number)
{
	corner c[3];
	geometry_corners(part, number - part->first, c);
	return outline_turn(c, c + 1, c + 2);
}

/* Whether an edge of a triangle can be a contour or a crease. */
static bool is_drawn(const raster *r, const part *part, uint32_t primitive, int k)
{
	return (r->job->marks.data && contour_side(r->edges[part->first + primitive], k) != CONTOUR_NONE) ||
	       (part->bends && part->bends[(size_t)3 * primitive + (size_t)k]);
}

static void widen(int from, int to, int *y0, int *y1)
{
	*y0 = from < *y0 ? from : *y0;
	*y1 = to > *y1 ? to : *y1;
}

void crossings_rows(const raster *r, const part *part, uint32_t primitive, int *y0, int *y1)
{
	bool line = part->mesh->kind != ENCRE_TRIANGLES;
	segment s;
	int from, to;
	for (int k = 0; k < 3; k++)
		if (line ? k == 0 && r->job->marks.data : is_drawn(r, part, primitive, k))
			if (segment_of(r, part, primitive, k, &s, &from, &to))
				widen(from - r->job->frame.y, to - r->job->frame.y, y0, y1);
}

typedef struct marking {
	const raster *r;
	int i; /* the band's number */
	const band *b;
	flush *f;               /* ways at which another piece may go on; NULL: none is looked for */
	uint32_t number;        /* of the primitive */
	int k;                  /* and its edge */
	const part *part;       /* of the primitive that was looked at last */
	const part *own;        /* whose contour it is; NULL: a line */
	bool fold;              /* its surface goes on there, behind */
	bool cut;               /* its triangle may be one by itself, of a surface that is cut up */
	enum contour_side side; /* of a contour */
	bool left, down;        /* where it goes on the screen */
	float bend;             /* of a crease: degrees, negative for one that is shaded smoothly */
	uint32_t piece;         /* of its mesh: raster.piece */
	double turn;            /* outline_turn() of its triangle, if the surface goes on in that of the other side */
} marking;

/* What is in front at a pixel, how far a line that passes close by lies behind it, how far it may and be on it. */
typedef struct surface_at {
	const part *part; /* NULL: nothing */
	uint32_t number;
	double behind, allowed, step, pixel, turn;
} surface_at;

static surface_at look(marking *m, const crossing *c, int x, int y)
{
	const raster *r = m->r;
	uint32_t number = m->b->front[(size_t)(y - m->b->y0) * (size_t)r->width + (size_t)(x - m->b->x0)];
	if (number == NOTHING)
		return (surface_at){.behind = -INFINITY, .pixel = 1};
	corner corner[3];
	double step, pixel = 2 / (fabs(r->job->projection[5]) * r->job->frame.height);
	m->part = geometry_part(&r->geometry, m->part, number);
	geometry_corners(m->part, number - m->part->first, corner);
	double z = outline_depth(corner, c->x + 0.5, c->y + 0.5, &step);
	pixel *= r->job->projection[14] != 0 ? c->z : 1; /* in scene units, where the line is */
	return (surface_at){m->part,
			    number,
			    c->z - z,
			    0.5 * (step + pixel),
			    step,
			    pixel,
			    outline_turn(corner, corner + 1, corner + 2)};
}

static bool hides(const surface_at *s)
{
	return s->behind > s->allowed;
}

/* Whether the piece of a mesh that an edge is of is at a pixel; where triangles hang together with none, the mesh. */
static bool shows(const marking *m, const surface_at *s)
{
	return s->part == m->own && (m->cut || m->r->piece[s->number] == m->piece);
}

/* Whether what is at a pixel covers an edge, by however little it may and be taken for what is beside the edge: another
 * piece, or of a thin thing the side that is turned the other way. */
static bool covers(const marking *m, const surface_at *s)
{
	return s->part && (m->r->piece[s->number] != m->piece || s->turn * m->turn < 0) &&
	       s->behind > least_cover * s->pixel;
}

/* Whether what a contour bounds is at the first of both pixels. */
static bool bounds_first(const marking *m, bool down)
{
	return (m->side == CONTOUR_RIGHT) == (down ? m->left : m->down);
}

/* Whether a contour bounds what is in front at one of both pixels, before what is there at the other: of contours of
 * the same surface farther in than `there` it does not. */
static bool bounds(const marking *m, bool down, float share, float there, const surface_at *p, const surface_at *q)
{
	if (m->side == CONTOUR_BOTH)
		return there == 0 && p->part == m->own && q->part == m->own && !hides(p) && !hides(q);
	bool first = bounds_first(m, down);
	const surface_at *own = first ? p : q, *other = first ? q : p;
	return shows(m, own) && own->behind >= -own->allowed && !hides(other) &&
	       (there == 0 || (first ? share > -there : share < -there));
}

/* The place where what a contour bounds ends. Sunk into the other surface by so little that the contour still is on it,
 * it ends where the two meet. */
static double ends_at(const marking *m, const crossing *c, double share, const surface_at *p, const surface_at *q)
{
	bool first = bounds_first(m, c->down);
	const surface_at *own = first ? p : q, *other = first ? q : p;
	if (m->side == CONTOUR_BOTH || own->part != m->own || !other->part || !(other->behind > 0) || hides(other))
		return share;
	corner mine[3], its[3];
	geometry_corners(own->part, own->number - own->part->first, mine);
	geometry_corners(other->part, other->number - other->part->first, its);
	double x = c->column + (first || c->down ? 0 : 1) + 0.5, y = c->row + (first || !c->down ? 0 : 1) + 0.5;
	double one[2] = {outline_plane(mine, x, y), c->z};
	double two[2] = {outline_plane(its, x, y), outline_plane(its, c->x + 0.5, c->y + 0.5)};
	double slack = 4 * ((double)m->r->close + fabs(c->z) * 0x1p-20); /* less, and they coincide */
	if (!(two[0] > one[0] && one[1] > two[1] && two[0] - one[0] + one[1] - two[1] > slack))
		return share;
	double part = outline_cross(one, two, m->r->job->projection[14] != 0);
	return first ? share * part : 1 - (1 - share) * part;
}

/* How a contour's place is told: with it, how far the surface that it bounds lies before the other. Where it folds it
 * does, however little. */
static float contour_told(const marking *m, bool down, float share, const surface_at *p, const surface_at *q)
{
	bool first = bounds_first(m, down);
	const surface_at *other = first ? q : p;
	double before = -other->behind - (m->cut ? 0.5 * other->step : 0);
	double next = (double)least_contour_step * other->pixel * m->r->job->frame.height / 1080;
	int steps = 0;
	if (m->fold) {
		steps = 1;
		next *= 2;
	}
	while (steps < MOST_CONTOUR_STEPS && before >= next) {
		steps++;
		next *= 2;
	}
	return m->side == CONTOUR_BOTH ? -share : contour_value(share, steps);
}

/* Whether a contour runs in front of what is at both pixels, of which none shows its surface. */
static bool passes_between(const marking *m, const surface_at *p, const surface_at *q)
{
	return m->side != CONTOUR_BOTH && p->part != m->own && q->part != m->own && !hides(p) && !hides(q);
}

/* Of the contours of a thing that is narrower than the way from a pixel to the next; of a second thing nothing. */
static void between_told(float *out, float share)
{
	if (*out == 0)
		*out = between_first - share;
	else if (*out <= between_first && *out > between_both)
		*out = between_both - 0.5f * (between_first - *out + share);
}

static void mark(const marking *m, const crossing *c, float *out, const surface_at *p, const surface_at *q)
{
	double share = m->own ? ends_at(m, c, c->share, p, q) : c->share;
	share = share > LEAST_SHARE ? share : LEAST_SHARE;
	share = share < 1 ? share : 1;
	if (!m->own && !(hides(p) && hides(q)))
		*out = (float)share;
	else if (m->own && bounds(m, c->down, (float)share, -contour_place(*out), p, q))
		*out = contour_told(m, c->down, (float)share, p, q);
	else if (m->own && passes_between(m, p, q))
		between_told(out, (float)share);
}

/* Whether one of both pixels shows two surfaces that coincide. */
static bool at_twins(const marking *m, const crossing *c)
{
	const band *b = m->b;
	size_t at = (size_t)(c->row + OUTLINE_GUARD - b->y0) * (size_t)m->r->width +
		    (size_t)(c->column + OUTLINE_GUARD - b->x0);
	return b->twin[at] != NOTHING || b->twin[at + (c->down ? (size_t)m->r->width : 1)] != NOTHING;
}

static void crease_told(float out[2], const crossing *c, float bend)
{
	double share = c->share > LEAST_SHARE ? c->share : LEAST_SHARE;
	out[0] = (float)(share < 1 ? share : 1);
	out[1] = bend;
}

static void crease(const marking *m, const crossing *c, float out[2], float *contour, const surface_at *p,
		   const surface_at *q)
{
	if (fabsf(m->bend) <= fabsf(out[1]) || (hides(p) && hides(q)) || (covers(m, p) && covers(m, q)))
		return;
	bool twins = at_twins(m, c);
	if (twins && p->part != m->own && q->part != m->own)
		return; /* of the later of two surfaces that coincide */
	crease_told(out, c, m->bend);
	if (!twins || p->part == q->part || !contour)
		return;
	/* the earlier surface ends there, though the mesh goes on behind the later one */
	*contour = contour_mark(*contour) == 0 ? -out[0] : *contour;
}

/* Whether another piece of an edge's mesh is at a pixel, at about the depth of the edge. */
static bool touches(const marking *m, const surface_at *s)
{
	return s->part == m->own && !shows(m, s) && fabs(s->behind) <= s->allowed;
}

/* Where on the way what is told goes; NULL: nowhere. */
typedef struct told {
	float *mark, *crease;
} told;

static told told_at(const raster *r, const crossing *c)
{
	int x = c->column + OUTLINE_GUARD - r->room.x0, y = c->row + OUTLINE_GUARD - r->room.y0;
	return (told){r->job->marks.data ? pixel_at(&r->job->marks, x, y) + c->down : NULL,
		      r->job->creases.data ? pixel_at(&r->job->creases, x, y) + 2 * c->down : NULL};
}

static void settle(const raster *r, int i, const band *b, flush *f);

static void pass(void *user, const crossing *c)
{
	marking *m = user;
	const raster *r = m->r;
	int x = c->column + OUTLINE_GUARD, y = c->row + OUTLINE_GUARD;
	if (x + !c->down >= r->room.x1 || y + c->down >= r->room.y1)
		return; /* to a pixel outside of the images */
	told out = told_at(r, c);
	bool marks = out.mark && m->side != CONTOUR_NONE && !(*out.mark > 0);
	bool creases = out.crease && fabsf(m->bend) > fabsf(out.crease[1]);
	if (!marks && !creases)
		return;
	surface_at p = look(m, c, x, y), q = look(m, c, x + !c->down, y + c->down);
	if (m->f && m->own && m->side != CONTOUR_BOTH && (touches(m, &p) || touches(m, &q))) {
		m->f->way[m->f->n++] = (flush_way){.at = *c, .number = m->number, .k = m->k};
		if (m->f->n == FLUSH_WAYS)
			settle(r, m->i, m->b, m->f);
		return;
	}
	if (marks)
		mark(m, c, out.mark, &p, &q);
	if (creases)
		crease(m, c, out.crease, out.mark, &p, &q);
}

/* Gets ready for edge k of a primitive; false: nothing of it can be told. */
static bool aim(marking *m, uint32_t number, int k, segment *s)
{
	const raster *r = m->r;
	const part *part = geometry_part(&r->geometry, m->own ? m->own : m->part, number);
	bool line = part->mesh->kind != ENCRE_TRIANGLES;
	int from, to;
	uint32_t i = number - part->first;
	if (line ? k > 0 : !is_drawn(r, part, i, k))
		return false;
	if (!segment_of(r, part, i, k, s, &from, &to))
		return false;
	uint16_t bend = part->bends ? part->bends[(size_t)3 * i + (size_t)k] : 0;
	m->own = line ? NULL : part;
	m->number = number;
	m->k = k;
	m->piece = r->piece[number];
	m->side = line ? CONTOUR_BOTH : contour_side(r->edges[number], k);
	m->fold = !line && contour_folds(r->edges[number], k);
	m->cut = !line && !m->fold && contour_ends(r->edges[number]) > 1;
	m->left = s->x[1] < s->x[0];
	m->down = s->y[1] > s->y[0];
	m->bend = bend_degrees(bend);
	m->turn = bend && m->side == CONTOUR_NONE ? turn_of(part, number) : 0;
	return true;
}

/* Where surfaces go on over an edge, they bend there, and not the edge; elsewhere the edge tells. */
static void settle(const raster *r, int i, const band *b, flush *f)
{
	marking m = {.r = r, .b = b};
	segment s;
	uint16_t bend;
	flush_look(r, i, f);
	for (uint32_t k = 0; k < f->n; k++) {
		const flush_way *way = f->way + k;
		enum flush_seen seen = flush_seen(r, way, &bend);
		if (seen == FLUSH_COVERED || !aim(&m, way->number, way->k, &s))
			continue;
		float *crease = told_at(r, &way->at).crease;
		if (seen == FLUSH_NOT)
			pass(&m, &way->at);
		else if (crease && bend_degrees(bend) > fabsf(crease[1])) /* which there is, where f is */
			crease_told(crease, &way->at, m.bend < 0 ? -bend_degrees(bend) : bend_degrees(bend));
	}
	f->n = 0;
}

/* With a constant number of channels: else a function is called for each pixel. */
KERNEL void clear_rows(const encre_image *image, const size_t channels, int y0, int rows)
{
	for (int y = y0; image->data && y < y0 + rows; y++) {
		char *row = (char *)pixel_at(image, 0, y);
		for (int x = 0; x < image->width; x++)
			memset(row + x * image->pixel_stride, 0, channels * sizeof(float));
	}
}

void crossings_draw(const raster *r, int i, const band *b, int end, flush *f)
{
	marking m = {.r = r, .i = i, .b = b, .f = f};
	int x0 = b->x0 - OUTLINE_GUARD, y0 = b->y0 - OUTLINE_GUARD, rows = end - b->y0;
	clear_rows(&r->job->marks, 2, b->y0 - r->room.y0, rows);
	clear_rows(&r->job->creases, 4, b->y0 - r->room.y0, rows);
	if (f)
		f->n = 0;
	for (size_t n = r->list[i]; n < r->list[i + 1] && !bands_stopped(r->pool); n++)
		for (int k = 0; k < 3; k++) {
			segment s;
			if (aim(&m, r->entry[n], k, &s))
				segment_cross(&s, x0, x0 + r->width, y0, y0 + rows, pass, &m);
		}
	if (f)
		settle(r, i, b, f);
}
