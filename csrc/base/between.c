/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each edge of a chain is straight on the screen, and crosses rows and columns of pixel centres. */
#include "base/between.h"

#include <math.h>
#include <string.h>

/* Where it passes a centre itself: 0 is nowhere. */
static const double least_share = 1.0 / 1024;
/* Of the depth, by which an edge may lie before its surface; a share of the way to what is behind, from which on it is
 * of that. */
static const float before = 0.03f, share_behind = 0.5f;

/* Depths are even along an edge inverted, or as they are. */
float depth_between(const frame *f, const encre_chain_point *a, const encre_chain_point *b, double t)
{
	double one = (double)a->depth, two = (double)b->depth;
	if (f->camera.orthographic)
		return (float)(one + t * (two - one));
	return (float)(one * two / (two + t * (one - two)));
}

/* What it crosses of lines through centres: columns, or `down` rows, of the images. */
static void cross(const frame *f, const encre_chain_point *a, const encre_chain_point *b, int down, passage_found found,
		  void *user)
{
	double from = (double)(down ? a->y : a->x), to = (double)(down ? b->y : b->x);
	double side = (double)(down ? a->x : a->y), way = (double)(down ? b->x : b->y) - side;
	int start = down ? f->place.y : f->place.x, count = down ? f->height : f->width;
	int other = down ? f->place.x : f->place.y, room = down ? f->width : f->height;
	double low = from < to ? from : to, high = from < to ? to : from;
	int first = low <= start ? 0 : low - start < count ? -(int)floor(start - low) : count;
	for (int k = first; k < count && k + start < high; k++) {
		double t = (k + start - from) / (to - from), at = side + t * way - other, pixel = floor(at),
		       share = at - pixel;
		if (!(pixel >= 0 && pixel < room - 1))
			continue;
		passage p = {.of = b,
			     .x = down ? (int)pixel : k,
			     .y = down ? k : (int)pixel,
			     .down = !down,
			     .share = (float)(share > least_share ? share : least_share),
			     .depth = depth_between(f, a, b, t)};
		found(user, &p);
	}
}

void between_each(const frame *f, passage_found found, void *user)
{
	for (int64_t i = 1; i < f->n_chains; i++) {
		const encre_chain_point *a = f->chains + i - 1, *b = f->chains + i;
		for (int down = 0; a->run == b->run && down < 2; down++)
			cross(f, a, b, down, found, user);
	}
}

typedef struct contours {
	const frame *f;
	float *place;
} contours;

static void find_contour(void *user, const passage *p)
{
	enum {
		BOUNDS = ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER | ENCRE_CHAIN_NUMBER | ENCRE_CHAIN_MATERIAL |
		ENCRE_CHAIN_MEET
	};
	const contours *c = user;
	float *place = c->place + 2 * ((ptrdiff_t)p->y * c->f->width + p->x) + p->down;
	float one = depth_at(c->f, p->x, p->y), two = depth_at(c->f, p->x + !p->down, p->y + p->down);
	float near = one < two ? one : two, far = one < two ? two : one, slack = before * fabsf(near);
	if (!(p->of->kind & BOUNDS) || *place > 0 || p->depth < near - slack)
		return;
	if (p->depth <= near + slack || p->depth < near + share_behind * (far - near))
		*place = p->share;
}

void between_contours(const frame *f, float *place)
{
	contours c = {f, place};
	memset(place, 0, 2 * (size_t)f->width * (size_t)f->height * sizeof *place);
	between_each(f, find_contour, &c);
}
