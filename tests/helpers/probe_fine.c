/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens the detector FINE to tests: runs the passes of its own table and keeps what each has found and left, so that
 * each is compared with its twin alone. Linked in place of fine.c, to a library of one set of kernels. */
#define fine_run run_unseen
#include "fine/fine.c"
#undef fine_run

#include <stdlib.h>

/* A site as tests/reference/ has it; all fields are four bytes wide. */
typedef struct probe_site {
	float x, y, strength, thin, half, inside, crowd, tapers;
	int32_t column, row, near_x, near_y, family, axis, source, dropped, crumb, held, weak, eased, step[3];
} probe_site;

typedef struct snapshot {
	const char *pass;
	int32_t sites, links, width, height;
	probe_site *site;
	int32_t (*link)[2];
	uint8_t *through; /* width * height, or NULL */
} snapshot;

static snapshot *kept;
static int32_t n_kept;

static void *copy(const void *from, size_t size)
{
	return from ? memcpy(malloc(size + 1), from, size) : NULL;
}

static probe_site opened(const site *s)
{
	return (probe_site){
		.x = s->placed.x,
		.y = s->placed.y,
		.strength = s->placed.strength,
		.thin = s->placed.thin,
		.half = s->placed.half,
		.inside = s->placed.inside,
		.crowd = s->linked.crowd,
		.tapers = s->linked.tapers,
		.column = s->found.column,
		.row = s->found.row,
		.near_x = s->placed.near_x,
		.near_y = s->placed.near_y,
		.family = s->found.family - FAMILY_CRACK, /* the twins know none of chains */
		.axis = s->found.axis,
		.source = s->placed.source,
		.dropped = s->linked.dropped,
		.crumb = s->linked.crumb,
		.held = s->linked.held,
		.weak = s->placed.weak,
		.eased = s->placed.eased,
		.step = {s->placed.step[0], s->placed.step[1], s->placed.step[2]},
	};
}

static void keep(const char *pass, const fine *n)
{
	kept = realloc(kept, (size_t)(n_kept + 1) * sizeof *kept);
	snapshot *k = kept + n_kept++;
	size_t pixels = (size_t)n->f->width * (size_t)n->f->height;
	*k = (snapshot){.pass = pass, .width = n->f->width, .height = n->f->height};
	k->sites = n->site ? (int32_t)n->count : 0;
	k->site = calloc((size_t)k->sites + 1, sizeof *k->site);
	for (int32_t i = 0; i < k->sites; i++)
		k->site[i] = opened(n->site + i);
	if (n->at && n->to) {
		k->link = calloc((size_t)n->at[n->known] + 1, sizeof *k->link);
		for (uint32_t i = 0; i < n->known; i++)
			for (uint32_t j = n->at[i]; j < n->at[i + 1]; j++) {
				k->link[k->links][0] = (int32_t)i;
				k->link[k->links++][1] = (int32_t)n->to[j];
			}
	}
	k->through = copy(n->through, pixels);
}

/* Both rounds of joining ends add their corners and then, here, their links (ld --wrap). */
#define JOINED_(a, b) a##b
#define JOINED(a, b) JOINED_(a, b)
#define REAL(name) JOINED(__real_, ISA(name))
#define WRAP(name) JOINED(__wrap_, ISA(name))
int32_t REAL(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t count);
int32_t WRAP(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t count);
/* Sites and links, each once, that are put in the place of what a pass has left; none if `after` is NULL. */
static struct {
	const char *after;
	const probe_site *site;
	const int32_t (*link)[2];
	int32_t sites, links;
} given;

static site closed(const probe_site *s)
{
	return (site){
		.found = {(uint16_t)s->column, (uint16_t)s->row, (uint8_t)(s->family + FAMILY_CRACK), (uint8_t)s->axis},
		.placed = {.x = s->x,
			   .y = s->y,
			   .strength = s->strength,
			   .near_x = (uint16_t)s->column,
			   .near_y = (uint16_t)s->row,
			   .step = {(int8_t)s->step[0], (int8_t)s->step[1], (int8_t)s->step[2]}},
		.linked = {.dropped = s->dropped, .crumb = s->crumb},
	};
}

static int32_t take(fine *n)
{
	late **late = &n->f->late;
	uint32_t count = (uint32_t)given.sites, links = (uint32_t)given.links;
	uint32_t (*link)[2] = late_take(late, links + 1, sizeof *link);
	late_drop(late, n->site);
	late_drop(late, n->at);
	n->site = late_take(late, count, sizeof *n->site);
	n->at = late_take(late, count + 1, sizeof *n->at);
	if (!link || !n->site || !n->at)
		return ENCRE_ERROR_MEMORY;
	for (uint32_t i = 0; i < count; i++)
		n->site[i] = closed(given.site + i);
	memset(n->at, 0, (count + 1) * sizeof *n->at);
	memcpy(link, given.link, links * sizeof *link);
	n->count = n->known = count;
	memset(n->crack, 0, (size_t)n->f->width * (size_t)n->f->height); /* of none of these sites */
	return REAL(fine_add_links)(n, link, links);
}

int32_t ISA(fine_run)(frame *f)
{
	fine *n = f->fine;
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < PASSES; i++) {
		if (passes[i].wanted && !passes[i].wanted(n))
			continue;
		code = passes[i].run(n);
		if (!code && given.after && !strcmp(given.after, passes[i].name))
			code = take(n);
		keep(passes[i].name, n);
	}
	return code;
}

int32_t WRAP(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t count)
{
	int32_t code = REAL(fine_add_links)(n, link, count);
	keep("add links", n);
	return code;
}

ENCRE_API int32_t probe_count(void);
int32_t probe_count(void)
{
	return n_kept;
}

ENCRE_API const snapshot *probe_snapshot(int32_t i);
const snapshot *probe_snapshot(int32_t i)
{
	return kept + i;
}

ENCRE_API void probe_give(const char *after, const probe_site *, int32_t sites, const int32_t (*link)[2],
			  int32_t links);
void probe_give(const char *after, const probe_site *site, int32_t sites, const int32_t (*link)[2], int32_t links)
{
	given.after = after;
	given.site = site;
	given.sites = sites;
	given.link = link;
	given.links = links;
}

ENCRE_API void probe_clear(void);
void probe_clear(void)
{
	for (int32_t i = 0; i < n_kept; i++) {
		free(kept[i].site);
		free(kept[i].link);
		free(kept[i].through);
	}
	free(kept);
	kept = NULL;
	n_kept = 0;
}
