/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines that pass behind a thing end before its outline, as inkers part figure and ground. Of chains and of pixels
 * alike: what counts is the depth of the surface that a line is on. */
#include "fine/chains/stations.h"

/* Px by which an outline lies before what is behind it, from which on it keeps that away, in full. */
static const float full_gap = 6;
/* Pixels off the outline where what is behind it is looked at; of its depth, how far behind lies what is nothing; a
 * share of the way to what is behind, from which on a line is of that. */
static const float outside = 1.5f, nothing = 0.04f, share_behind = 0.5f;
static const float blunt = 0.75f, least_left = 0.02f; /* pixels over which a line ends; what is not seen */

enum { CHUNK = 1024 };

/* ---- outlines ---------------------------------------------------------------------------------------------- */

void ISA(gap_of)(const stations *s, const station *t, chain_site *of)
{
	const frame *f = s->n->f;
	const encre_params *p = params_at(f, t->near_x, t->near_y);
	float full = clamp01(t->gap / (full_gap * s->px)), own = t->depth;
	of->keeps_away = of->halo = 0;
	if (t->importance != IMPORTANCE_CONTOUR || !t->side || !p->use_lines || !(max(p->line_gap, p->line_halo) > 0) ||
	    !(full > 0))
		return;
	double away = (double)(outside * (float)t->side);
	int x = pixel_of((float)(t->x - f->place.x + away * (double)t->dy), f->width),
	    y = pixel_of((float)(t->y - f->place.y - away * (double)t->dx), f->height);
	float far = f->camera.orthographic ? f->camera.height : own, behind = depth_at(f, x, y);
	behind = behind < INFINITY ? behind : own + nothing * far;
	if (!(behind > own))
		return;
	of->beyond = mix(own, behind, share_behind);
	of->halo = is_folded(t) ? 0 : full * p->line_halo * f->scale;
	of->keeps_away = max(full * p->line_gap * f->scale, of->halo);
}

/* ---- lines behind them ------------------------------------------------------------------------------------- */

typedef struct keeping {
	fine *n;
	float most;
	float *left; /* by site */
} keeping;

/* What a site is on. */
typedef struct spot {
	float depth, object;
	const chain_site *chain; /* NULL: pixels tell */
} spot;

static spot spot_of(const fine *n, const site *s)
{
	const frame *f = n->f;
	int x = pixel_of(s->placed.x, f->width), y = pixel_of(s->placed.y, f->height);
	if (!is_chain(s))
		return (spot){depth_at(f, x, y), object_at(f, x, y), NULL};
	const chain_site *of = chain_of(n, s);
	return (spot){of->depth, (float)of->object, of};
}

/* Whether it lies behind an outline. A thing's outline hides no line of its own, but a fold's does; neither what it
 * goes on in. */
static bool is_behind(const spot *p, const chain_site *o)
{
	bool same = p->object == (float)o->object;
	if (!(p->depth > o->beyond) || same != o->folded)
		return false;
	return !p->chain || p->chain->run != o->run || fabsf(p->chain->s - o->s) > 2 * o->keeps_away;
}

static void keep_away(void *data, int first, int end, int thread)
{
	(void)thread;
	const keeping *k = data;
	const fine *n = k->n;
	for (int i = first; i < end && !stopped_at(n, i); i++) {
		const site *s = n->site + i;
		spot p = spot_of(n, s);
		float left = 1;
		near_sites of = near_site(n, s, k->most + blunt);
		for (uint32_t j; !s->linked.dropped && left > 0 && near_next(n, &of, &j);) {
			const chain_site *o = n->chain + j;
			if (!is_chain(n->site + j) || !(o->keeps_away > 0) || !is_behind(&p, o))
				continue;
			float far = o->keeps_away + blunt, d2 = apart2(s, n->site + j);
			if (d2 < far * far)
				left = min(left, max(sqrtf(d2) - o->keeps_away, 0) / blunt);
		}
		k->left[i] = left;
	}
}

int32_t ISA(chains_keep_away)(fine *n)
{
	keeping k = {.n = n};
	uint32_t chains = chain_sites(n);
	for (uint32_t i = 0; i < chains; i++)
		k.most = max(k.most, n->chain[i].keeps_away);
	if (!(k.most > 0))
		return ENCRE_OK;
	k.left = late_take(&n->f->late, n->count, sizeof *k.left);
	if (!k.left)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, keep_away, &k);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		placed *p = &n->site[i].placed;
		code = at_step(n, i);
		if (!(k.left[i] < 1))
			continue;
		p->eased = (uint8_t)(255 - k.left[i] * (float)(255 - p->eased) + 0.5f);
		n->site[i].linked.dropped |= k.left[i] < least_left;
	}
	late_drop(&n->f->late, k.left);
	return code ? code : ISA(fine_unlink_dropped)(n);
}
