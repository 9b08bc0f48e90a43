/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From stations to sites and links between them: finished lines, which later passes leave alone and all others yield
 * to. */
#include "base/between.h"
#include "fine/chains/stations.h"

#include <string.h>

static const float least_keep = 0.02f; /* of a width: less is not seen */
static const float beyond_frame = 12;  /* pixels beside the image where lines still reach into it */
/* Pixels from the end of a run to the line that it meets, two steps of stations; what is nearer lies at one place. */
static const float tie_reach = 1.6f, one_place = 0.03f;
static const float own_run = 4; /* pixels along a run that do not count as another line */
/* Pixels over which two ends that lie ahead of each other are one line: where a contour turns into another one, both
 * fade. Cosine of how far aside they may lie; pixels back along the run that tell its way. */
static const float ahead_reach = 8, straight_on = 0.85f, way_back = 3;

static const uint32_t no_site = UINT32_MAX;

/* ---- sites ----------------------------------------------------------------------------------------------- */

/* Which of the families of chains a site is of, from the first. */
static int family_of(const station *t)
{
	return t->source == SOURCE_COLOR ? 2 : t->source == SOURCE_NORMAL || t->source == SOURCE_MARK ? 1 : 0;
}

static bool has_site(const stations *s, const station *t)
{
	const frame *f = s->n->f;
	double x = t->x - f->place.x, y = t->y - f->place.y, far = (double)beyond_frame;
	return is_drawn(t) && t->keep > least_keep && x > -far && y > -far && x < f->width - 1 + far &&
	       y < f->height - 1 + far;
}

/* Pixels: what is thinner is drawn as one line where its two would meet, in full where it is thinner by as much. */
static const float thin_from = 3.9f, thin_ramp = 0.6f;

/* How thin the thing is that a contour bounds, and how far on along the axis that it crosses the middle of that lies.
 */
static void tell_thin(const station *t, bool row, site *made)
{
	float wide = min(t->across, 2 * t->apart), aside = row ? -t->dy * t->side : t->dx * t->side;
	if (t->importance != IMPORTANCE_CONTOUR || !t->side || !(t->apart < thin_from))
		return;
	made->placed.thin = clamp01((thin_from - t->apart) / thin_ramp);
	made->placed.half = 0.5f * wide;
	made->placed.inside = on_grid(0.5f * wide / aside);
	made->linked.tapers = t->tapers;
}

/* Why its run ends there. */
static uint8_t end_of(const stations *s, const station *t)
{
	const int64_t *run = s->run[t->run];
	int64_t at = t->flags & STATION_FIRST ? run[0] : run[1] - 1;
	return t->flags & (STATION_FIRST | STATION_LAST) ? (uint8_t)s->point[at].end : ENCRE_END_NONE;
}

static void make_site(const stations *s, uint32_t i, site *made, chain_site *of)
{
	const station *t = s->at + i;
	const frame *f = s->n->f;
	float x = (float)(t->x - f->place.x), y = (float)(t->y - f->place.y), radius = ISA(station_radius)(s, t);
	bool row = fabsf(t->dy) > fabsf(t->dx); /* the line crosses it */
	*made = (site){
		.found = {.column = (uint16_t)(row ? clamp_index((int)floorf(x), f->width - (f->width > 1))
						   : pixel_of(x, f->width)),
			  .row = (uint16_t)(row ? pixel_of(y, f->height)
						: clamp_index((int)floorf(y), f->height - (f->height > 1))),
			  .family = (uint8_t)(FAMILY_CHAIN_SHAPE + family_of(t)),
			  .axis = row ? AXIS_ROW : AXIS_COLUMN},
		.placed = {.x = x,
			   .y = y,
			   .strength = t->strength,
			   .near_x = t->near_x,
			   .near_y = t->near_y,
			   .source = t->source & 127,
			   .eased = (uint8_t)(255 * (1 - min(t->keep, 1)) + 0.5f)},
		.linked = {.crowd = radius < INFINITY ? 1 / radius : 0},
	};
	tell_thin(t, row, made);
	*of = (chain_site){.run = t->run,
			   .s = t->s,
			   .mesh = t->mesh,
			   .edge = t->edge,
			   .along = t->along,
			   .gap = t->gap,
			   .depth = t->depth,
			   .object = t->object,
			   .kind = t->kind,
			   .folded = t->importance == IMPORTANCE_CONTOUR && is_folded(t),
			   .tied = (t->flags & STATION_TIED) != 0,
			   .end = end_of(s, t)};
	ISA(gap_of)(s, t, of);
}

/* Of two sites, or of one and none. */
static void add_link(fine *n, uint32_t a, uint32_t b)
{
	if (a == no_site || b == no_site || a == b)
		return;
	n->chain_link[n->chain_links][0] = a;
	n->chain_link[n->chain_links++][1] = b;
}

static int32_t make_sites(stations *s)
{
	fine *n = s->n;
	uint32_t *number = late_take(&n->f->late, s->count, sizeof *number), count[CHAIN_FAMILIES] = {0};
	if (!number)
		return ENCRE_ERROR_MEMORY;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < s->count; i++) {
		code = at_step(n, i);
		number[i] = has_site(s, s->at + i) ? count[family_of(s->at + i)]++ : no_site;
	}
	if (code)
		return code;
	memcpy(n->chains, count, sizeof count);
	n->chain_made = late_take(&n->f->late, chain_sites(n), sizeof *n->chain_made);
	n->chain = late_take(&n->f->late, chain_sites(n), sizeof *n->chain);
	n->chain_link = late_take(&n->f->late, 2 * (size_t)chain_sites(n), sizeof *n->chain_link);
	if (!n->chain_made || !n->chain || !n->chain_link)
		return ENCRE_ERROR_MEMORY;
	for (uint32_t i = 0; !code && i < s->count; i++) {
		code = at_step(n, i);
		if (number[i] == no_site)
			continue;
		for (int k = 0; k < family_of(s->at + i); k++)
			number[i] += count[k];
		make_site(s, i, n->chain_made + number[i], n->chain + number[i]);
		/* where a run stops being a line, as others go on in its place, it may meet these */
		n->chain[number[i]].tied |=
			(i && !(s->at[i].flags & STATION_FIRST) && number[i - 1] == no_site) ||
			(i + 1 < s->count && !(s->at[i].flags & STATION_LAST) && !has_site(s, s->at + i + 1));
		if (i && !(s->at[i].flags & STATION_FIRST))
			add_link(n, number[i - 1], number[i]);
	}
	for (int32_t i = 0; !code && i < s->runs; i++) {
		uint32_t first = s->first[i], last = s->first[i + 1] - 1;
		if (s->first[i] == s->first[i + 1] || !(s->at[first].flags & STATION_CLOSED))
			continue;
		uint32_t one = number[first], other = number[last];
		if (last - first > 1)
			add_link(n, one, other);
		if (one == no_site && other != no_site)
			n->chain[other].tied = true;
		if (one != no_site && other == no_site)
			n->chain[one].tied = true;
	}
	late_drop(&n->f->late, number);
	return code;
}

/* Where colours may step: at joints that meshes tell. */
static int32_t find_joints(fine *n)
{
	if (!n->e->on[SOURCE_COLOR])
		return ENCRE_OK;
	n->joints = late_take(&n->f->late, 2 * (size_t)n->f->width * (size_t)n->f->height, sizeof *n->joints);
	if (!n->joints)
		return ENCRE_ERROR_MEMORY;
	between_contours(n->f, n->joints);
	return ENCRE_OK;
}

int32_t ISA(chains_find)(fine *n)
{
	stations s = {.n = n, .px = room_px(n, 1), .point = n->f->chains, .points = n->f->n_chains};
	int32_t code = ISA(stations_make)(&s);
	if (code)
		return code;
	s.mean = late_take(&n->f->late, s.count, sizeof *s.mean);
	if (!s.mean)
		return ENCRE_ERROR_MEMORY;
	code = ISA(stations_sort)(&s);
	code = code ? code : ISA(stations_thin_out)(&s);
	code = code ? code : ISA(stations_measure)(&s);
	code = code ? code : ISA(stations_compare)(&s);
	code = code ? code : ISA(stations_give_way)(&s);
	code = code ? code : ISA(stations_drop_fragments)(&s);
	code = code ? code : ISA(chains_replace)(&s);
	code = code ? code : find_joints(n);
	code = code ? code : ISA(stations_smooth)(&s);
	code = code ? code : make_sites(&s);
	late_drop(&n->f->late, s.mean);
	late_drop(&n->f->late, s.grid.px);
	late_drop(&n->f->late, s.grid.station);
	late_drop(&n->f->late, s.grid.first);
	late_drop(&n->f->late, s.at);
	late_drop(&n->f->late, s.first);
	late_drop(&n->f->late, s.run);
	return code;
}

/* ---- links ----------------------------------------------------------------------------------------------- */

/* What the end of a run meets: the nearest site of another; of those at its own place the first. */
static uint32_t met_by(const fine *n, uint32_t i)
{
	const site *s = n->site + i;
	const chain_site *own = n->chain + i;
	uint32_t best = no_site;
	float least = tie_reach * tie_reach;
	near_sites of = near_site(n, s, tie_reach);
	for (uint32_t j; near_next(n, &of, &j);) {
		float d2 = apart2(s, n->site + j);
		if (j == i || !is_chain(n->site + j) || !(d2 < least) ||
		    (n->chain[j].run == own->run && fabsf(n->chain[j].s - own->s) < own_run))
			continue;
		best = j;
		least = d2 < one_place * one_place ? 0 : d2;
	}
	return best;
}

/* Which way a run goes on at its end, of length 1; false: it has none. */
static bool way_on(const fine *n, uint32_t i, float way[2])
{
	uint32_t count = chain_sites(n), back = i;
	for (int step = -1; step <= 1; step += 2)
		for (uint32_t j = i; (step < 0 ? j > 0 : j + 1 < count);) {
			j = step < 0 ? j - 1 : j + 1;
			float s = fabsf(n->chain[j].s - n->chain[i].s), last = fabsf(n->chain[back].s - n->chain[i].s);
			if (n->chain[j].run != n->chain[i].run || s > way_back || s - last > tie_reach)
				break;
			back = j;
		}
	float x = n->site[i].placed.x - n->site[back].placed.x, y = n->site[i].placed.y - n->site[back].placed.y;
	float length = sqrtf(x * x + y * y);
	way[0] = length > 0 ? x / length : 0;
	way[1] = length > 0 ? y / length : 0;
	return length > 0;
}

static bool lies_ahead(const fine *n, uint32_t i, uint32_t of)
{
	const site *a = n->site + i, *b = n->site + of;
	float way[2], x = b->placed.x - a->placed.x, y = b->placed.y - a->placed.y, far = sqrtf(x * x + y * y);
	return far > 0 && way_on(n, i, way) && x * way[0] + y * way[1] > straight_on * far;
}

/* The nearest end that meets nothing either and goes on in this one. */
static uint32_t faces(const fine *n, uint32_t i, const uint32_t *met)
{
	const site *s = n->site + i;
	uint32_t best = no_site;
	float least = ahead_reach * ahead_reach;
	near_sites of = near_site(n, s, ahead_reach);
	for (uint32_t j; near_next(n, &of, &j);) {
		if (j == i || !is_chain(n->site + j) || !n->chain[j].tied || met[j] != no_site ||
		    (n->chain[j].run == n->chain[i].run && fabsf(n->chain[j].s - n->chain[i].s) <= tie_reach) ||
		    !(apart2(s, n->site + j) < least) || !lies_ahead(n, i, j) || !lies_ahead(n, j, i))
			continue;
		best = j;
		least = apart2(s, n->site + j);
	}
	return best;
}

int32_t ISA(chains_link)(fine *n)
{
	uint32_t count = chain_sites(n), links = n->chain_links;
	uint32_t *met = late_take(&n->f->late, count, sizeof *met);
	if (!met)
		return ENCRE_ERROR_MEMORY;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < count; i++) {
		code = at_step(n, i);
		met[i] = n->chain[i].tied ? met_by(n, i) : no_site;
	}
	for (uint32_t i = 0; !code && i < count; i++) {
		uint32_t other = n->chain[i].tied && met[i] == no_site ? faces(n, i, met) : no_site;
		code = at_step(n, i);
		if (other != no_site && i < other && faces(n, other, met) == i && n->chain_links < 2 * count)
			add_link(n, i, other);
	}
	/* what lies at one place is one site */
	for (uint32_t i = 0; !code && i < count; i++) {
		bool same = met[i] != no_site && apart2(n->site + i, n->site + met[i]) < one_place * one_place;
		n->site[i].linked.dropped = same && met[i] < i;
		if (met[i] != no_site && !same && n->chain_links < 2 * count)
			add_link(n, i, met[i]);
	}
	for (uint32_t k = 0; !code && k < n->chain_links; k++)
		for (int e = 0; e < 2; e++) {
			uint32_t *to = &n->chain_link[k][e];
			while (n->site[*to].linked.dropped)
				*to = met[*to];
		}
	uint32_t kept = 0;
	for (uint32_t k = 0; !code && k < n->chain_links; k++)
		if (n->chain_link[k][0] != n->chain_link[k][1]) {
			memmove(n->chain_link[kept], n->chain_link[k], sizeof *n->chain_link);
			kept++;
		}
	if (!code)
		code = ISA(fine_add_links)(n, n->chain_link, kept);
	n->chain_links = links;
	late_drop(&n->f->late, met);
	return code;
}
