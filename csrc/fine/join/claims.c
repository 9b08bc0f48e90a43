/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a family may keep, one after the other: nothing that lies close to an earlier one, nothing weak that hangs
 * together with weak sites alone, nothing that is too short to be a line. */
#include "fine/near.h"

enum { CHUNK = 512 };

/* Pixels that a step keeps from the stripes in its own layer, and within which one holds it; test_fine_passes */
static const float clear_of_band = 2, held_by_band = 3;

typedef struct turn {
	fine *n;
	const family_info *is;
	uint32_t first, count; /* its sites */
} turn;

/* ---- keeping clear --------------------------------------------------------------------------------------- */

/* Whether light passes a level there on one side of its stripe. */
static bool is_side(const site *s, const site *stripe)
{
	if (s->found.family != FAMILY_LIGHT || stripe->found.family != FAMILY_LIGHT_BAND ||
	    s->found.axis != stripe->found.axis)
		return false;
	bool down = s->found.axis == AXIS_COLUMN;
	float x = fabsf(s->placed.x - stripe->placed.x), y = fabsf(s->placed.y - stripe->placed.y);
	return (down ? x : y) < 1 && (down ? y : x) < clear_of_band;
}

static bool owned(const fine *n, const site *s)
{
	const family_info *is = families + s->found.family;
	int band = is->kind == KIND_STEP && samples[is->sample].band ? samples[is->sample].band : FAMILY_COUNT;
	near_sites of = near_site(n, s, clear_of_band);
	for (uint32_t i; near_next(n, &of, &i);) {
		const site *other = n->site + i;
		if (other->found.family >= s->found.family ||
		    other->linked.dropped || /* its own are being dropped now */
		    rank_of(other) > rank_of(s))
			continue;
		float clear = other->found.family == band ? clear_of_band : clear_from(s, other);
		if (apart2(s, other) < clear * clear || is_side(s, other))
			return true;
	}
	return false;
}

static void clear_sites(void *data, int first, int end, int thread)
{
	(void)thread;
	const turn *t = data;
	for (int i = first; i < end && !stopped_at(t->n, i); i++) {
		site *s = t->n->site + t->first + i;
		s->linked.dropped = owned(t->n, s);
	}
}

/* ---- weak sites ------------------------------------------------------------------------------------------ */

static bool is_weak(const site *s)
{
	return s->placed.weak && !s->linked.dropped;
}

/* Whether a stripe of the same layer ends or turns there: of joints between bricks those that look narrow are stripes,
 * those that look wide have two sides. */
static bool meets_band(const fine *n, const site *s)
{
	const family_info *is = families + s->found.family;
	int band = is->kind == KIND_STEP ? samples[is->sample].band : 0;
	near_sites of = near_site(n, s, held_by_band);
	for (uint32_t i; band && near_next(n, &of, &i);) {
		const site *other = n->site + i;
		if (other->found.family == band && !other->linked.dropped &&
		    apart2(s, other) <= held_by_band * held_by_band)
			return true;
	}
	return false;
}

/* Holds all weak ones that those at open[0] to open[count - 1] hang together with, and adds them; how many there are
 * then. */
static int32_t hold_on(fine *n, uint32_t *open, uint32_t *count)
{
	uint32_t to[ROOM];
	int32_t code = ENCRE_OK;
	for (uint32_t at = 0; !code && at < *count; code = at_step(n, ++at))
		for (int k = ISA(close_sites)(n, open[at], to); k-- > 0;) {
			site *s = n->site + to[k];
			if (s->placed.weak && !s->linked.held) {
				s->linked.held = true;
				open[(*count)++] = to[k];
			}
		}
	return code;
}

/* Holds those that hang together with one that is not weak or a stripe, and drops the others. */
static int32_t drop_weak(const turn *t)
{
	fine *n = t->n;
	uint32_t end = t->first + t->count, weak = 0, open_count = 0, to[ROOM];
	int32_t code = ENCRE_OK;
	for (uint32_t i = t->first; !code && i < end; i++) {
		code = at_step(n, i);
		weak += is_weak(n->site + i);
	}
	if (code || weak == 0)
		return code;
	uint32_t *open = late_take(&n->f->late, weak, sizeof *open);
	if (!open)
		return ENCRE_ERROR_MEMORY;
	for (uint32_t i = t->first; !code && i < end; i++) {
		code = at_step(n, i);
		linked *s = &n->site[i].linked;
		if (!is_weak(n->site + i))
			continue;
		s->held = meets_band(n, n->site + i);
		for (int k = s->held ? 0 : ISA(close_sites)(n, i, to); k-- > 0 && !s->held;)
			s->held = !n->site[to[k]].placed.weak;
		if (s->held)
			open[open_count++] = i;
	}
	code = code ? code : hold_on(n, open, &open_count);
	for (uint32_t i = t->first; !code && i < end; i++) {
		code = at_step(n, i);
		n->site[i].linked.dropped |= n->site[i].placed.weak && !n->site[i].linked.held;
	}
	late_drop(&n->f->late, open);
	return code;
}

/* ---- crumbs ---------------------------------------------------------------------------------------------- */

/* How many sites hang together with one and itself, at most so many. */
static int hanging(const fine *n, uint32_t i, int wanted)
{
	uint32_t found[ROOM] = {i}, to[ROOM];
	int count = 1;
	for (int k = 0; k < count && count < wanted; k++) {
		int near = ISA(close_sites)(n, found[k], to);
		for (int j = 0; j < near && count < wanted; j++) {
			bool known = false;
			for (int l = 0; l < count; l++)
				known |= found[l] == to[j];
			if (!known)
				found[count++] = to[j];
		}
	}
	return count;
}

static void find_crumbs(void *data, int first, int end, int thread)
{
	(void)thread;
	const turn *t = data;
	for (int k = first; k < end && !stopped_at(t->n, k); k++) {
		uint32_t i = t->first + (uint32_t)k;
		site *s = t->n->site + i;
		if (!s->linked.dropped)
			s->linked.crumb = hanging(t->n, i, t->is->crumb) < t->is->crumb;
	}
}

static void drop_crumbs(void *data, int first, int end, int thread)
{
	(void)thread;
	const turn *t = data;
	for (int k = first; k < end && !stopped_at(t->n, k); k++) {
		linked *s = &t->n->site[t->first + (uint32_t)k].linked;
		s->dropped |= s->crumb;
	}
}

/* ---- in turn --------------------------------------------------------------------------------------------- */

int32_t ISA(fine_claim)(fine *n)
{
	int32_t code = ENCRE_OK;
	for (int k = 0; !code && k < FAMILY_COUNT; k++) {
		turn t = {.n = n, .is = families + k, .first = n->first[k * n->f->height]};
		t.count = n->first[(k + 1) * n->f->height] - t.first;
		if (t.is->rank > RANK_SHAPE && t.is->kind != KIND_CHAIN)
			code = bands_run(n->f->bands, (int)t.count, CHUNK, clear_sites, &t);
		if (!code && t.is->faint)
			code = drop_weak(&t);
		if (!code && t.is->crumb > LONE)
			code = bands_run(n->f->bands, (int)t.count, CHUNK, find_crumbs, &t);
		if (!code && t.is->crumb > LONE)
			code = bands_run(n->f->bands, (int)t.count, CHUNK, drop_crumbs, &t);
	}
	return code;
}
