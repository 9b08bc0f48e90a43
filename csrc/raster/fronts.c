/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What curves away soon after the last pixel that shows it, or dips below what it lies on, ends between two pixels on a
 * face that no pixel shows: the planes of the faces that are shown cross elsewhere, or nowhere, and its outline would
 * be stairs. So all triangles of both pieces are cut by the way from pixel to pixel, and that is halved until it is
 * known which piece is in front where. */
#include "raster/fronts.h"

#include <math.h>

enum { HALVINGS = 12 };

/* Which share of a way a triangle covers; false: none. */
static bool covers(const corner c[3], const double from[2], bool down, double share[2])
{
	double at[3], more[3], sum = 0; /* how far its first pixel is inside of the edges, and how that grows */
	for (int k = 0; k < 3; k++) {
		const corner *a = c + (k + 1) % 3, *b = c + (k + 2) % 3;
		double ax = a->x - from[0] * a->w, ay = a->y - from[1] * a->w;
		double bx = b->x - from[0] * b->w, by = b->y - from[1] * b->w;
		at[k] = ax * by - bx * ay;
		more[k] = down ? bx * a->w - ax * b->w : ay * b->w - by * a->w;
		sum += at[k];
	}
	double sign = sum < 0 ? -1 : 1;
	share[0] = 0;
	share[1] = 1;
	for (int k = 0; k < 3; k++) {
		double begin = sign * at[k], grows = sign * more[k];
		if (grows > 0)
			share[0] = fmax(share[0], -begin / grows);
		else if (grows < 0)
			share[1] = fmin(share[1], begin / -grows);
		else if (begin < 0)
			return false;
	}
	return share[0] < share[1];
}

static void add_side(front_way *w, const corner c[3], bool first)
{
	const double from[2] = {w->x - OUTLINE_GUARD + 0.5, w->y - OUTLINE_GUARD + 0.5};
	side_seen s = {.first = first};
	if (!(c[0].w > 0 && c[1].w > 0 && c[2].w > 0) || w->n == FRONTS_SIDES || !covers(c, from, w->down, s.share))
		return;
	for (int k = 0; k < 2; k++) {
		double step;
		s.depth[k] = outline_depth(c, from[0] + (w->down ? 0 : s.share[k]),
					   from[1] + (w->down ? s.share[k] : 0), &step);
	}
	w->side[w->n++] = s;
}

static void gather(const raster *r, int i, fronts *room, uint32_t n)
{
	const part *part = NULL;
	for (size_t k = r->list[i]; k < r->list[i + 1]; k++) {
		uint32_t number = r->entry[k], piece = r->piece[number];
		uint32_t at = asks_first(room->ask, n, sizeof(ask), piece, 0);
		if (at == n || room->ask[at].piece != piece)
			continue;
		outline o;
		part = geometry_part(&r->geometry, part, number);
		if (part->mesh->kind != ENCRE_TRIANGLES || !geometry_outline(part, number - part->first, &r->room, &o))
			continue;
		for (at = asks_first(room->ask, n, sizeof(ask), piece, o.y0 - 1);
		     at < n && room->ask[at].piece == piece && room->ask[at].y < o.y1; at++) {
			front_way *w = room->way + room->ask[at].way / 2;
			if (w->y + w->down >= o.y0 && w->x + !w->down >= o.x0 && w->x < o.x1)
				add_side(w, o.corner, room->ask[at].way % 2 == 0);
		}
	}
}

/* How deep a triangle lies at a share of the way. */
static double side_depth(const side_seen *s, double share, bool perspective)
{
	double t = (share - s->share[0]) / (s->share[1] - s->share[0]), a = s->depth[0], b = s->depth[1];
	return perspective ? 1 / ((1 - t) / a + t / b) : (1 - t) * a + t * b;
}

/* Whether the piece at the way's first pixel is in front; so it is where neither is. */
static bool is_first(const front_way *w, double share, bool perspective)
{
	double nearest[2] = {INFINITY, INFINITY};
	for (int k = 0; k < w->n; k++) {
		const side_seen *s = w->side + k;
		if (share >= s->share[0] && share <= s->share[1])
			nearest[!s->first] = fmin(nearest[!s->first], side_depth(s, share, perspective));
	}
	return nearest[0] <= nearest[1];
}

void fronts_find(const raster *r, int i, fronts *room, uint32_t n)
{
	bool perspective = r->job->projection[14] != 0;
	for (uint32_t k = 0; k < 2 * n; k++) {
		const front_way *w = room->way + k / 2;
		room->ask[k] = (ask){w->piece[k % 2], k, w->y};
	}
	asks_sort(room->ask, 2 * n, sizeof(ask));
	gather(r, i, room, 2 * n);
	for (uint32_t k = 0; k < n; k++) {
		front_way *w = room->way + k;
		double low = 0, high = 1;
		w->share = 0;
		if (w->n == FRONTS_SIDES || !is_first(w, low, perspective) || is_first(w, high, perspective))
			continue; /* what is seen between them is of neither */
		for (int h = 0; h < HALVINGS; h++) {
			double middle = 0.5 * (low + high);
			if (is_first(w, middle, perspective))
				low = middle;
			else
				high = middle;
		}
		w->share = fmax(0.5 * (low + high), LEAST_SHARE);
	}
}
