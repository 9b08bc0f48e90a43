/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The FINE detector: thin, exactly placed edges. Dense passes mark the pixels at which sites lie; these are placed,
 * each family keeps clear of the earlier ones, and what is left is linked to lines. The table below is the whole way.
 */
#include "fine/invariants.h"
#include "fine/near.h"

#include <string.h>

/* ---- planned --------------------------------------------------------------------------------------------- */

/* The distance of two colours in the space of the metric below which none is an edge. */
static float least_contrast(const encre_params *p, float weight)
{
	float most = p->contrast_local ? min(p->contrast_full, least_full_contrast) : p->contrast_full,
	      least = p->contrast_threshold;
	if (weight > 0 && most > least)
		least += (most - least) * min(1, least_faint * p->edge_threshold / weight);
	/* a difference is at most 2/3 of the distance in RGB, and that distance itself in CIE76; the others bend the
	 * space */
	if (p->contrast_metric == contrast_metric_HSL) {
		float weight = max3(p->contrast_lightness, p->contrast_saturation, 0.5f * p->contrast_hue);
		return least / max(weight, 1e-6f);
	}
	return least * (p->contrast_metric == contrast_metric_RGB     ? 1.5f
			: p->contrast_metric == contrast_metric_CIE76 ? 1
								      : 0.33f);
}

void ISA(fine_plan)(frame *f, const edges *e, arena *a)
{
	size_t pixels = (size_t)f->width * (size_t)f->height;
	float half = f->params->crease_angle * 0.00872664626f; /* in radians */
	fine made = {.f = f, .e = f->edges, .crease = 2 * pixel_sin(half)};
	for (int i = 0; i < f->n_styles; i++)
		made.bumps |= e->bump[i] > 0;
	for (int i = 0; i < f->n_styles; i++)
		made.most_color = max(made.most_color, e->weight[SOURCE_COLOR][i]);
	made.least_contrast = least_contrast(f->params, made.most_color);
	for (int k = 0; k < FAMILY_COUNT; k++)
		made.floor[k] = families[k].floor * (families[k].unit == UNIT_CREASE ? made.crease : 1);
	made.across = pieces_of(f->width, CELL);
	made.tall = pieces_of(f->height, CELL);
	made.crack = arena_take(a, pixels, sizeof *made.crack);
	made.ridge = arena_take(a, pixels, sizeof *made.ridge);
	made.first = arena_take(a, (size_t)FAMILY_COUNT * (size_t)f->height + 1, sizeof *made.first);
	made.spans = pieces_of(f->width, THIN_SPAN);
	made.hit = arena_take(a, (size_t)made.spans * (size_t)f->height, sizeof *made.hit);
	size_t tiles = (size_t)tiles_of(f->width) * (size_t)tiles_of(f->height);
	made.marks = arena_take(a, (size_t)tiles_of(f->width) * (size_t)f->height, sizeof *made.marks);
	made.kept = arena_take(a, tiles, sizeof *made.kept);
	made.colored = arena_take(a, (size_t)f->height, sizeof *made.colored);
	made.cell = arena_take(a, (size_t)made.across * (size_t)made.tall + 1, sizeof *made.cell);
	if (e->on[SOURCE_SEEN] || e->on[SOURCE_SUGGESTIVE])
		made.more = arena_take(a, pixels, sizeof *made.more);
	if (e->on[SOURCE_SEEN]) {
		made.through = arena_take(a, pixels, sizeof *made.through);
		made.glimpse = arena_take(a, (size_t)f->height, sizeof *made.glimpse);
	}
	ISA(light_plan)(&made, e, a);
	ISA(valley_plan)(&made, e, a);
	ptrdiff_t scratch[] = {ISA(crack_scratch)(f), ISA(ridge_scratch)(f), ISA(valley_scratch)(&made)};
	for (int i = 0; i < 3; i++)
		made.thread_scratch = scratch[i] > made.thread_scratch ? scratch[i] : made.thread_scratch;
	made.scratch =
		arena_take(a, (size_t)bands_threads(f->bands) * (size_t)made.thread_scratch, sizeof *made.scratch);
	fine *n = arena_take(a, 1, sizeof *n);
	f->fine = n;
	made.mixed = made.crack;
	if (n && !f->edges_kept)
		*n = made;
	if (n)
		n->f = f;
}

/* ---- passes ---------------------------------------------------------------------------------------------- */

static int32_t mark_cracks(fine *n)
{
	return bands_run(n->f->bands, n->f->height, 0, ISA(crack_rows), n);
}

static int32_t mark_hits(fine *n)
{
	return bands_run(n->f->bands, n->f->height, 0, ISA(thin_rows), n);
}

static int32_t mark_ridges(fine *n)
{
	return bands_run(n->f->bands, n->f->height, 0, ISA(ridge_rows), n);
}

/* edge_strength where a site lies is the largest of its sites'. */
static int32_t show_strength(fine *n)
{
	plane out = n->f->output[ENCRE_OUTPUT_EDGES];
	for (int y = 0; out.data && y < n->f->height; y++)
		memset(out.data + y * out.row, 0, (size_t)n->f->width * sizeof *out.data);
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && out.data && i < n->count; i++) {
		const site *s = n->site + i;
		code = at_step(n, i);
		float *at =
			out.data + pixel_of(s->placed.y, n->f->height) * out.row + pixel_of(s->placed.x, n->f->width);
		*at = !s->linked.dropped && s->placed.strength > *at ? s->placed.strength : *at;
	}
	return code;
}

static bool has_chains(const fine *n)
{
	return n->f->n_chained > 0;
}

static bool has_seen(const fine *n)
{
	return n->through != NULL;
}

static bool has_forms(const fine *n)
{
	return n->lit != NULL;
}

static bool has_lengths(const fine *n)
{
	bool any = has_forms(n);
	for (int i = 0; i < n->f->n_styles; i++) {
		const encre_params *p = n->f->params + i;
		any |= n->e->on[SOURCE_LIGHT] && p->line_shadow_shortest > 0;
		any |= n->e->on[SOURCE_COLOR] && p->line_color_shortest > 0;
		any |= n->e->on[SOURCE_SEEN] && p->line_mirror_shortest > 0;
	}
	return any;
}

static bool has_light(const fine *n)
{
	return n->e->on[SOURCE_LIGHT];
}

static bool keeps_away(const fine *n)
{
	bool any = false;
	for (int i = 0; i < n->f->n_styles; i++)
		any |= n->f->params[i].line_gap > 0 || n->f->params[i].line_halo > 0;
	return any && has_chains(n);
}

static bool has_hidden(const fine *n)
{
	return n->e->on[SOURCE_HIDDEN] && n->f->n_chains > 0;
}

static bool may_crowd(const fine *n)
{
	return n->e->on[SOURCE_COLOR] || n->e->on[SOURCE_LIGHT];
}

/* ---- the way --------------------------------------------------------------------------------------------- */

/* What passes read and write. */
enum part {
	LAYERS = 1 << 0,
	CRACKS = 1 << 1,  /* crack, colored */
	HITS = 1 << 2,    /* hit */
	THROUGH = 1 << 3, /* through, glimpse */
	RIDGES = 1 << 4,  /* ridge, seen */
	BOUND = 1 << 5,   /* kept */
	FOUND = 1 << 6,   /* count, first, and of each site: found */
	PLACED = 1 << 7,
	CELLS = 1 << 8,   /* cell, member */
	KEPT = 1 << 9,    /* linked */
	LINKS = 1 << 10,  /* at, to, known */
	CHAINS = 1 << 11, /* chains, chain, chain_made, chain_link, replaced */
	MARKS = LAYERS | CRACKS | HITS | THROUGH | RIDGES
};

/* What is not wanted writes NULL, and nobody asks for it. */
typedef struct pass {
	const char *name;
	bool (*wanted)(const fine *n); /* NULL: always */
	int32_t (*run)(fine *n);
	int reads, writes;
	const char *(*broken)(const fine *n); /* what should hold after the pass and does not: debug builds ask */
} pass;

static const pass passes[] = {
	{"find chains", has_chains, ISA(chains_find), LAYERS, CHAINS, NULL},
	{"mark cracks", NULL, mark_cracks, LAYERS, CRACKS, BROKEN(cracks)},
	{"mark hits", NULL, mark_hits, LAYERS | CRACKS, HITS, NULL},
	{"see through", has_seen, ISA(seen_run), LAYERS, THROUGH, NULL},
	{"mark ridges", NULL, mark_ridges, LAYERS | CRACKS | HITS | THROUGH, RIDGES, BROKEN(ridges)},
	{"mark valleys", has_forms, ISA(valley_run), LAYERS | CRACKS | RIDGES, CRACKS | RIDGES, BROKEN(ridges)},
	{"leave to chains", has_chains, ISA(chains_leave), LAYERS | CHAINS | CRACKS | RIDGES, CRACKS | RIDGES,
	 BROKEN(cracks)},
	{"bound", NULL, ISA(fine_bound), MARKS, BOUND, NULL},
	{"gather", NULL, ISA(fine_gather), MARKS | BOUND, FOUND | PLACED, BROKEN(sites)},
	{"sort", NULL, ISA(fine_sort), PLACED, CELLS, BROKEN(cells)},
	{"claim", NULL, ISA(fine_claim), FOUND | PLACED | CELLS, KEPT | PLACED, BROKEN(claims)},
	{"link", NULL, ISA(fine_link), CRACKS | FOUND | PLACED | CELLS | KEPT, LINKS | KEPT, BROKEN(links)},
	{"link chains", has_chains, ISA(chains_link), CHAINS | FOUND | PLACED | CELLS | LINKS, LINKS | KEPT,
	 BROKEN(links)},
	{"tie", NULL, ISA(fine_tie), FOUND | PLACED | CELLS | KEPT | LINKS, LINKS | PLACED, BROKEN(links)},
	{"smooth", NULL, ISA(fine_smooth), LINKS | KEPT | PLACED, PLACED, NULL},
	{"sort again", NULL, ISA(fine_sort), PLACED, CELLS, BROKEN(cells)},
	{"crowd", may_crowd, ISA(fine_crowd), FOUND | PLACED | CELLS | KEPT, KEPT, BROKEN(crowd)},
	{"give way", has_light, ISA(fine_give_way), FOUND | PLACED | CELLS | KEPT | LINKS, KEPT, BROKEN(crowd)},
	{"join ends", NULL, ISA(fine_join_ends), LAYERS | FOUND | PLACED | CELLS | KEPT | LINKS,
	 FOUND | PLACED | CELLS | LINKS, BROKEN(joined)},
	{"slender", NULL, ISA(fine_slender), LAYERS | CRACKS | FOUND | PLACED | KEPT | LINKS, KEPT, BROKEN(crowd)},
	{"drop beside", NULL, ISA(fine_drop_beside), FOUND | PLACED | CELLS | KEPT | LINKS, KEPT | PLACED, NULL},
	{"keep away", keeps_away, ISA(chains_keep_away), LAYERS | CHAINS | FOUND | PLACED | CELLS | KEPT | LINKS,
	 PLACED | KEPT | LINKS, BROKEN(links)},
	{"cut spurs", NULL, ISA(fine_cut_spurs), FOUND | PLACED | KEPT | LINKS, KEPT | LINKS, BROKEN(links)},
	{"drop short", NULL, ISA(fine_drop_short), FOUND | PLACED | KEPT | LINKS, KEPT, NULL},
	{"ease forms", has_lengths, ISA(fine_ease_forms), FOUND | PLACED | CELLS | KEPT | LINKS, PLACED | KEPT | LINKS,
	 BROKEN(links)},
	{"add hidden", has_hidden, ISA(chains_add_hidden), LAYERS | CHAINS | FOUND | PLACED | CELLS | KEPT | LINKS,
	 FOUND | PLACED | CELLS | KEPT | LINKS, BROKEN(links)},
	{"show strength", NULL, show_strength, PLACED | KEPT, 0, NULL},
};

enum { PASSES = sizeof passes / sizeof *passes };

int32_t ISA(fine_run)(frame *f)
{
	fine *n = f->fine;
	int32_t code = ENCRE_OK;
	for (int i = 0, known = LAYERS; !code && i < PASSES; i++) {
		const pass *p = passes + i;
		demand(p->name, p->reads & ~known ? "it reads nothing but what is written" : NULL);
		known |= p->writes;
		if (p->wanted && !p->wanted(n))
			continue;
		code = p->run(n);
		if (!code && p->broken)
			demand(p->name, p->broken(n));
	}
	return code;
}
