/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens the detector FINE to tests: every pass that is named below is linked through here (ld --wrap), and what it
 * found and left is kept, so that each is compared with its twin alone. Only for a library that compiles one set of
 * kernels. */
#include "fine/fine.h"

#include <stdlib.h>

/* A site as tests/reference/ has it; all fields are four bytes wide. */
typedef struct probe_site {
	float x, y, strength, thin, half, inside, crowd;
	int32_t column, row, near_x, near_y, family, axis, source, dropped, crumb, weak, step[3];
} probe_site;

typedef struct snapshot {
	const char *pass;
	int32_t sites, links, width, height;
	probe_site *site;
	int32_t (*link)[2];
	float *light;     /* width * height, or NULL */
	uint8_t *through; /* likewise */
} snapshot;

static snapshot *kept;
static int32_t count;

static void *copy(const void *from, size_t size)
{
	return from ? memcpy(malloc(size + 1), from, size) : NULL;
}

static void keep(const char *pass, const fine *n)
{
	kept = realloc(kept, (size_t)(count + 1) * sizeof *kept);
	snapshot *k = kept + count++;
	size_t pixels = (size_t)n->f->width * (size_t)n->f->height;
	*k = (snapshot){.pass = pass, .sites = (int32_t)n->count, .width = n->f->width, .height = n->f->height};
	k->site = calloc((size_t)k->sites + 1, sizeof *k->site);
	for (int32_t i = 0; n->site && i < k->sites; i++) {
		const site *s = n->site + i;
		k->site[i] = (probe_site){.x = s->x,
					  .y = s->y,
					  .strength = s->strength,
					  .thin = s->thin,
					  .half = s->half,
					  .inside = s->inside,
					  .crowd = s->crowd,
					  .column = s->column,
					  .row = s->row,
					  .near_x = s->near_x,
					  .near_y = s->near_y,
					  .family = s->family,
					  .axis = s->axis,
					  .source = s->source,
					  .dropped = s->dropped,
					  .crumb = s->crumb,
					  .weak = s->weak,
					  .step = {s->step[0], s->step[1], s->step[2]}};
	}
	if (n->at && n->to) {
		k->link = calloc((size_t)n->at[n->linked] + 1, sizeof *k->link);
		for (uint32_t i = 0; i < n->linked; i++)
			for (uint32_t j = n->at[i]; j < n->at[i + 1]; j++) {
				k->link[k->links][0] = (int32_t)i;
				k->link[k->links++][1] = (int32_t)n->to[j];
			}
	}
	k->light = copy(n->light, pixels * sizeof *k->light);
	k->through = copy(n->through, pixels);
}

#define JOINED_(a, b) a##b
#define JOINED(a, b) JOINED_(a, b)
#define REAL(name) JOINED(__real_, ISA(name))
#define WRAP(name) JOINED(__wrap_, ISA(name))

/* `before`, `after`: the names under which what is there before and after the pass is kept. */
#define PASS(name, before, after)                                                                                      \
	int32_t REAL(name)(fine * n);                                                                                  \
	int32_t WRAP(name)(fine * n);                                                                                  \
	int32_t WRAP(name)(fine * n)                                                                                   \
	{                                                                                                              \
		keep(before, n);                                                                                       \
		int32_t code = REAL(name)(n);                                                                          \
		keep(after, n);                                                                                        \
		return code;                                                                                           \
	}
PASS(light_even, "", "even")
PASS(seen_run, "", "through")
PASS(fine_link, "cleared", "linked")
PASS(thin_tie, "linked", "tied")
PASS(fine_smooth, "tied", "smooth")
PASS(fine_crowd, "smooth", "crowded")
PASS(fine_drop_beside, "joined", "beside")
#undef PASS

/* The first of these comes when all sites are placed and those of its family that others own are dropped. */
int32_t REAL(fine_drop_weak)(fine *n, enum family family);
int32_t WRAP(fine_drop_weak)(fine *n, enum family family);
int32_t WRAP(fine_drop_weak)(fine *n, enum family family)
{
	keep("owned", n);
	int32_t code = REAL(fine_drop_weak)(n, family);
	keep("weak", n);
	return code;
}

int32_t REAL(fine_drop_crumbs)(fine *n, enum family family);
int32_t WRAP(fine_drop_crumbs)(fine *n, enum family family);
int32_t WRAP(fine_drop_crumbs)(fine *n, enum family family)
{
	int32_t code = REAL(fine_drop_crumbs)(n, family);
	keep("crumbs", n);
	return code;
}

/* By thin_tie() and by each round of joining ends, which has added the corners already. */
int32_t REAL(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t links);
int32_t WRAP(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t links);
int32_t WRAP(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t links)
{
	int32_t code = REAL(fine_add_links)(n, link, links);
	keep("added", n);
	return code;
}

void REAL(fine_cut_spurs)(const fine *n);
void WRAP(fine_cut_spurs)(const fine *n);
void WRAP(fine_cut_spurs)(const fine *n)
{
	keep("beside", n);
	REAL(fine_cut_spurs)(n);
	keep("spurs", n);
}

ENCRE_API int32_t probe_count(void);
int32_t probe_count(void)
{
	return count;
}

ENCRE_API const snapshot *probe_snapshot(int32_t i);
const snapshot *probe_snapshot(int32_t i)
{
	return kept + i;
}

ENCRE_API void probe_clear(void);
void probe_clear(void)
{
	for (int32_t i = 0; i < count; i++) {
		free(kept[i].site);
		free(kept[i].link);
		free(kept[i].light);
		free(kept[i].through);
	}
	free(kept);
	kept = NULL;
	count = 0;
}
