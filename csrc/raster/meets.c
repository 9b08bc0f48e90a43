/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines where pieces pass through each other. Between two pixels that show different pieces one of two things happens:
 * the one in front ends, and there is a contour, or it goes on behind the other, and so does the other behind it. That
 * is looked up: each of the two pieces is drawn alone at the pixel that the other one hides it at. Where both are
 * found, and their depths follow from those that can be seen, the line passes where the four depths cross. Where a
 * piece ends before the next pixel, the planes of what can be seen tell, and between two objects, of which no edge
 * tells where one ends, all their faces there (fronts.c). */
#include "raster/meets.h"

#include "raster/contours.h"

#include <math.h>

static const float through = 180; /* degrees: a line whatever angle is asked for */

typedef struct place {
	double x, y; /* pixels of the full frame */
} place;

static place centre_of(int x, int y)
{
	return (place){x - OUTLINE_GUARD + 0.5, y - OUTLINE_GUARD + 0.5};
}

static void corners_of(const raster *r, uint32_t number, corner c[3])
{
	const part *part = geometry_part(&r->geometry, NULL, number);
	geometry_corners(part, number - part->first, c);
}

/* ---- each piece alone -------------------------------------------------------------------------------------- */

static void draw_alone(const raster *r, int i, const band *b, alone *look, uint32_t n)
{
	const part *part = NULL;
	asks_sort(look, n, sizeof *look);
	for (size_t k = r->list[i]; k < r->list[i + 1]; k++) {
		uint32_t number = r->entry[k], piece = r->piece[number], twin;
		uint32_t at = asks_first(look, n, sizeof *look, piece, 0);
		if (at == n || look[at].of.piece != piece)
			continue;
		outline o;
		part = geometry_part(&r->geometry, part, number);
		if (part->mesh->kind != ENCRE_TRIANGLES || !geometry_outline(part, number - part->first, &r->room, &o))
			continue;
		for (at = asks_first(look, n, sizeof *look, piece, o.y0);
		     at < n && look[at].of.piece == piece && look[at].of.y < o.y1; at++) {
			alone *l = look + at;
			if (l->x < o.x0 || l->x >= o.x1)
				continue;
			band pixel = *b;
			pixel.x0 = l->x;
			pixel.x1 = l->x + 1;
			pixel.y0 = l->of.y;
			pixel.y1 = l->of.y + 1;
			pixel.depth = &l->depth;
			pixel.front = &l->number;
			pixel.twin = &twin;
			outline_draw(&o, number, &pixel);
		}
	}
}

/* ---- what is found ----------------------------------------------------------------------------------------- */

/* Depths of a surface at two pixels, by the triangles there, and how much more of a step its planes explain. */
typedef struct run {
	double from, to, explained;
} run;

static run follow(const raster *r, uint32_t first, uint32_t last, place p, place q)
{
	corner a[3], b[3];
	corners_of(r, first, a);
	corners_of(r, last, b);
	double at_p = outline_plane(a, p.x, p.y), at_q = outline_plane(b, q.x, q.y);
	double ahead = fabs(outline_plane(a, q.x, q.y) - at_p), back = fabs(outline_plane(b, p.x, p.y) - at_q);
	return (run){at_p, at_q, ahead > back ? ahead : back};
}

/* Where on the way from the first pixel to the second surfaces of these depths cross; 0: they coincide. */
static double share_of(const raster *r, const band *b, const double one[2], const double other[2])
{
	if (!(other[0] - one[0] + one[1] - other[1] > 4 * ((double)b->close + fabs(one[0]) * 0x1p-20)))
		return 0;
	double share = outline_cross(one, other, r->job->projection[14] != 0);
	return share > LEAST_SHARE ? share : LEAST_SHARE;
}

/* Where on the way from the first pixel to the second the two surfaces cross; 0: nowhere. */
static double crossing_of(const raster *r, const band *b, const meeting *m, const alone *at_other, const alone *at_one)
{
	if (at_other->number == NOTHING || at_one->number == NOTHING)
		return 0;
	place p = centre_of(m->x, m->y), q = centre_of(m->x + !m->down, m->y + m->down);
	run one = follow(r, m->one, at_other->number, p, q), other = follow(r, at_one->number, m->other, p, q);
	bool perspective = r->job->projection[14] != 0;
	double pixel = 2 / (fabs(r->job->projection[5]) * r->job->frame.height) * (perspective ? one.from : 1);
	if (!(fabs(one.to - one.from) <= one.explained + pixel &&
	      fabs(other.to - other.from) <= other.explained + pixel))
		return 0; /* of what is another part of the piece */
	return share_of(r, b, (double[]){one.from, one.to}, (double[]){other.from, other.to});
}

/* Where on the way the planes of what can be seen cross; 0: nowhere. */
static double planes_cross(const raster *r, const band *b, const meeting *m)
{
	place p = centre_of(m->x, m->y), q = centre_of(m->x + !m->down, m->y + m->down);
	corner a[3], c[3];
	corners_of(r, m->one, a);
	corners_of(r, m->other, c);
	double one[2] = {outline_plane(a, p.x, p.y), outline_plane(a, q.x, q.y)};
	double other[2] = {outline_plane(c, p.x, p.y), outline_plane(c, q.x, q.y)};
	return other[0] >= one[0] && one[1] >= other[1] ? share_of(r, b, one, other) : 0;
}

static float object_of(const raster *r, uint32_t number)
{
	return geometry_object(geometry_part(&r->geometry, NULL, number), number);
}

static bool is_one_object(const raster *r, const meeting *m)
{
	return object_of(r, m->one) == object_of(r, m->other);
}

/* Where one of both pieces turns away or ends soon after it has gone on behind the other, its planes tell: between two
 * objects an outline, within one a crease. Of an edge that tells, too, it has the place: that may lie below the other.
 */
static void end_there(const raster *r, const band *b, const meeting *m, float *mark, float *crease)
{
	float share = (float)planes_cross(r, b, m);
	if (!(share > 0))
		return;
	if (!is_one_object(r, m)) {
		*mark = -share;
		return;
	}
	if (crease[1] == 0)
		crease[1] = bend_degrees(contours_bend_seen(&r->geometry, m->one, m->other));
	crease[0] = crease[1] != 0 ? share : 0;
}

static float *mark_of(const raster *r, const meeting *m)
{
	return r->job->marks.data ? pixel_at(&r->job->marks, m->x - r->room.x0, m->y - r->room.y0) + m->down : NULL;
}

static float *crease_of(const raster *r, const meeting *m)
{
	return pixel_at(&r->job->creases, m->x - r->room.x0, m->y - r->room.y0) + 2 * m->down;
}

/* Places of outlines between two objects by all faces that pass there. */
static void refine(const raster *r, int i, meets *room, uint32_t n)
{
	if (n == 0)
		return;
	fronts_find(r, i, &room->fronts, n);
	for (uint32_t k = 0; k < n; k++) {
		const meeting *m = room->way + room->refined[k];
		float share = (float)room->fronts.way[k].share, *crease = crease_of(r, m);
		if (!(share > 0))
			continue;
		*mark_of(r, m) = -share;
		crease[0] = crease[1] == through ? share : crease[0];
	}
}

static void settle(const raster *r, int i, const band *b, meets *room, uint32_t n)
{
	alone *look = room->look;
	uint32_t n_refined = 0;
	if (n == 0)
		return;
	draw_alone(r, i, b, look, 2 * n);
	for (uint32_t k = 0; k < 2 * n; k++)
		*(look[k].of.way % 2 ? &room->way[look[k].of.way / 2].at_one
				     : &room->way[look[k].of.way / 2].at_other) = k;
	for (uint32_t k = 0; k < n; k++) {
		const meeting *m = room->way + k;
		float *crease = crease_of(r, m), *mark = mark_of(r, m);
		float share = m->may ? (float)crossing_of(r, b, m, look + m->at_other, look + m->at_one) : 0;
		bool told = !mark || contour_mark(*mark) != 0; /* or it is not known */
		if (share > 0) {
			crease[0] = share;
			crease[1] = through;
		}
		if (told)
			continue;
		if (share > 0)
			*mark = -share;
		else if (m->may)
			end_there(r, b, m, mark, crease);
		if (is_one_object(r, m))
			continue;
		room->fronts.way[n_refined] = (front_way){
			.piece = {r->piece[m->one], r->piece[m->other]}, .x = m->x, .y = m->y, .down = m->down};
		room->refined[n_refined] = k;
		if (++n_refined < FRONTS_WAYS)
			continue;
		refine(r, i, room, n_refined);
		n_refined = 0;
	}
	refine(r, i, room, n_refined);
}

/* ---- where to look ----------------------------------------------------------------------------------------- */

/* Whether of two planes, each in front at its own pixel, each may go on behind the other. */
static bool may_meet(const raster *r, uint32_t one, uint32_t other, place p, place q)
{
	corner a[3], b[3];
	corners_of(r, one, a);
	corners_of(r, other, b);
	double a_p = outline_plane(a, p.x, p.y), a_q = outline_plane(a, q.x, q.y);
	double b_p = outline_plane(b, p.x, p.y), b_q = outline_plane(b, q.x, q.y);
	double slack = 0.25 * (fabs(a_q - a_p) + fabs(b_q - b_p));
	return b_p >= a_p - slack && a_q >= b_q - slack;
}

void meets_draw(const raster *r, int i, const band *b, int end, meets *room)
{
	uint32_t n = 0;
	for (int y = b->y0; y < end && !bands_stopped(r->pool); y++)
		for (int x = b->x0; x < b->x1; x++)
			for (int down = 0; down < 2; down++) {
				int qx = x + !down, qy = y + down;
				if (qx >= b->x1 || qy >= b->y1)
					continue;
				size_t p = (size_t)(y - b->y0) * (size_t)r->width + (size_t)(x - b->x0);
				size_t q = p + (down ? (size_t)r->width : 1);
				uint32_t one = b->front[p], other = b->front[q];
				if (one == other || one == NOTHING || other == NOTHING ||
				    r->piece[one] == r->piece[other] || b->twin[p] != NOTHING || b->twin[q] != NOTHING)
					continue;
				meeting m = {.x = x, .y = y, .down = down, .one = one, .other = other};
				m.may = may_meet(r, one, other, centre_of(x, y), centre_of(qx, qy));
				if (!m.may && (!mark_of(r, &m) || contour_mark(*mark_of(r, &m)) != 0))
					continue;
				room->way[n] = m;
				room->look[2 * n] = (alone){{r->piece[one], 2 * n, qy}, NOTHING, qx, INFINITY};
				room->look[2 * n + 1] = (alone){{r->piece[other], 2 * n + 1, y}, NOTHING, x, INFINITY};
				if (++n < MEETS_WAYS)
					continue;
				settle(r, i, b, room, n);
				n = 0;
			}
	settle(r, i, b, room, n);
}
