/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the layers show something else than the meshes: a surface that was displaced, smoke before it. There its lines
 * are found in the layers. It is decided along whole stretches, so that it does not change from frame to frame; but
 * what has no chains itself, as leaves that alpha cuts out, covers those behind it where it is. */
#include "fine/chains/stations.h"

/* Of the depth, by which that of the layers may differ; pixels along the run each way that decide, and of those that
 * can tell the share that must agree. */
static const float depth_differs = 0.03f, decides = 24, least_agreeing = 0.3f;
static const float nearer = 0.01f; /* of the depth: what lies so much nearer covers it */
/* Px: what is thinner may lie between the centres of pixels, and the layers can't tell. */
static const float too_thin = 2;

/* Depths, inverted where that is even on planes. */
static float even_depth(const frame *f, float z)
{
	return f->camera.orthographic ? z : 1 / z;
}

/* Whether what it is of lies as deep at pixels about its own, or would, going on from there: of ground at a grazing
 * angle one pixel is much deeper than the next. */
static bool shows(const frame *f, int x, int y, const station *t)
{
	float low = INFINITY, high = -INFINITY, own = even_depth(f, t->depth), differs = depth_differs * fabsf(own);
	for (int k = 0; k < 9; k++) {
		int qx = x + k % 3 - 1, qy = y + k / 3 - 1;
		if (qx < 0 || qy < 0 || qx >= f->width || qy >= f->height ||
		    (f->layer[ENCRE_LAYER_OBJECT].data && object_at(f, qx, qy) != (float)t->object) ||
		    !(depth_at(f, qx, qy) < INFINITY))
			continue;
		float its = even_depth(f, depth_at(f, qx, qy));
		low = min(low, its);
		high = max(high, its);
	}
	return low <= high && own >= 2 * low - high - differs && own <= 2 * high - low + differs;
}

/* Whether something lies before it whose lines are not told by chains, and which no mesh hides it by as it is drawn. */
static bool is_covered(const frame *f, int x, int y, const station *t)
{
	float number = object_at(f, x, y);
	bool told = number >= 0 && number < (float)f->n_chained && (f->chained[(int64_t)number] & 1);
	return f->layer[ENCRE_LAYER_OBJECT].data && !told && depth_at(f, x, y) < (1 - nearer) * t->depth;
}

static void compare(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	const frame *f = s->n->f;
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		station *t = s->at + i;
		double x = t->x - f->place.x, y = t->y - f->place.y;
		bool inside = x >= 0 && y >= 0 && x <= f->width - 1 && y <= f->height - 1;
		bool thin = t->importance == IMPORTANCE_CONTOUR && t->apart < max(too_thin * f->scale, 2);
		t->tells = inside && !thin && !(t->flags & STATION_NONE) && !(t->kind & ENCRE_CHAIN_MARK);
		int px = pixel_of((float)x, f->width), py = pixel_of((float)y, f->height);
		if (inside && is_covered(f, px, py, t))
			t->flags |= STATION_HIDDEN;
		t->agrees = t->tells && shows(f, px, py, t);
	}
}

static void hide(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		uint32_t from = s->first[i], last = s->first[i + 1], low = from, high = from;
		int tell = 0, agree = 0;
		for (uint32_t a = from; a < last; a++) {
			for (; high < last && s->at[high].s - s->at[a].s <= decides; high++) {
				tell += s->at[high].tells;
				agree += s->at[high].agrees;
			}
			for (; s->at[a].s - s->at[low].s > decides; low++) {
				tell -= s->at[low].tells;
				agree -= s->at[low].agrees;
			}
			if ((float)agree < least_agreeing * (float)tell)
				s->at[a].flags |= STATION_HIDDEN;
		}
	}
}

int32_t ISA(stations_compare)(stations *s)
{
	int32_t code = bands_run(s->n->f->bands, (int)s->count, STATION_CHUNK, compare, s);
	return code ? code : bands_run(s->n->f->bands, s->runs, RUN_CHUNK, hide, s);
}
