/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of their width contours within a thing lack, evened along them. Where a slit is narrower than a pixel some
 * pixels' centres lie in it and see how deep it is, and others see only its rims, which hardly part: its line would be
 * dashes. From one row of pixels to the next a line passes every place between them, so that what it lacks is the mean
 * of so much of it each way. */
#include "fine/join/fronts.h"

enum { CHUNK = 512, LONGEST = 20 /* sites each way, within what a part of a frame is drawn beyond it */ };

typedef struct evening {
	fine *n;
	uint8_t *eased; /* by site */
} evening;

/* Adds the line from site i on by its link k, until it has gone on by a pixel both across and down. */
static void add_period(const fine *n, uint32_t i, uint32_t k, int *sum, int *count)
{
	const placed *own = &n->site[i].placed;
	uint32_t from = i, at = n->to[k];
	for (int sites = 0; sites < LONGEST && at != UINT32_MAX && at != i; sites++) {
		const site *s = n->site + at;
		float x = fabsf(s->placed.x - own->x), y = fabsf(s->placed.y - own->y);
		if (!is_fold(n, s) || min(x, y) >= 1)
			break;
		*sum += s->placed.eased;
		++*count;
		uint32_t next = next_of(n, from, at);
		from = at;
		at = next;
	}
}

static void find_eased(void *data, int first, int end, int thread)
{
	(void)thread;
	const evening *e = data;
	const fine *n = e->n;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(n, (int)i); i++) {
		const site *s = n->site + i;
		int sum = s->placed.eased, count = 1;
		if (!s->linked.dropped && is_fold(n, s))
			for (uint32_t k = n->at[i]; k < n->at[i + 1] && links_at(n, i) <= 2; k++)
				add_period(n, i, k, &sum, &count);
		e->eased[i] = (uint8_t)((sum + count / 2) / count);
	}
}

int32_t ISA(fine_even_eased)(fine *n)
{
	evening e = {n, late_take(&n->f->late, n->count, sizeof *e.eased)};
	if (!e.eased)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, find_eased, &e);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		n->site[i].placed.eased = e.eased[i];
	}
	late_drop(&n->f->late, e.eased);
	return code;
}
