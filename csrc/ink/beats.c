/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far along its line a site is, by the place on its thing: dashes and pictures along lines stick to it. */
#include "ink/turns.h"

#include "base/stage.h"
#include "fine/near.h"

/* Sites each way from which a line's place on its thing is told: at a rim that looks far to the side it jumps. */
enum { CHUNK = 1024, STEPS = 8, MOST = 2 * STEPS + 1, PADDED = MOST + 7 /* to a multiple of eight */ };
/* What moves more than so many times a pixel's size for each pixel runs over to another thing. */
static const float most_slant = 12;

/* In beats.step: the link leads to another thing, or it does not and the line ends with it. */
static const uint32_t other = UINT32_MAX, last = UINT32_MAX - 1;

/* Whether the site `at` lies on the same thing as the one before it. */
static bool goes_on(const fine *n, const spots *p, uint32_t before, uint32_t at)
{
	const site *a = n->site + before, *b = n->site + at;
	float x = p->x[at] - p->x[before], y = p->y[at] - p->y[before], z = p->z[at] - p->z[before];
	float most = most_slant * p->unit[before] / n->f->scale * max(1, sqrtf(apart2(a, b)));
	return !b->linked.dropped && x * x + y * y + z * z <= most * most && a->found.family == b->found.family;
}

static void step_rows(void *data, int first, int end, int thread)
{
	(void)thread;
	const beats *b = data;
	const fine *n = b->n;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(n, (int)i); i++)
		for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
			uint32_t at = n->to[k], next = n->at[at];
			uint32_t onward = links_at(n, at) != 2 ? last : n->to[next] == i ? next + 1 : next;
			b->step[k] = goes_on(n, &b->at, i, at) ? onward : other;
		}
}

int32_t ISA(beats_find)(frame *f, const spots *at, beats *b)
{
	const fine *n = f->fine;
	*b = (beats){n, *at, late_take(&f->late, (size_t)n->at[n->count] + 1, sizeof *b->step)};
	return b->step ? bands_run(f->bands, (int)n->count, CHUNK, step_rows, b) : ENCRE_ERROR_MEMORY;
}

/* The sites over a link of i that lie on the same thing, in `on`; returns how many. */
static int steps_on(const beats *b, uint32_t i, uint32_t link, uint32_t on[STEPS])
{
	int count = 0;
	while (count < STEPS && link < last && b->step[link] != other && b->n->to[link] != i) {
		on[count++] = b->n->to[link];
		link = b->step[link];
	}
	return count;
}

/* The thirteen ways between a cube's opposite corners, edges and faces; as many more as fill a vector are no others. */
enum { WAYS = 13, LANES_OF_WAYS = 16 };
static const float ways[3][LANES_OF_WAYS] = {
	{1, -1, 0, 1, -1, 0, 1, -1, 0, 1, -1, 0, 1},
	{0, 1, 1, 1, -1, -1, -1, 0, 0, 0, 1, 1, 1},
	{0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1},
};
#define R2 0.70710677f
#define R3 0.57735026f
static const float per_length[LANES_OF_WAYS] = {1, R2, 1, R2, R3, R2, R3, R2, 1, R2, R3, R2, R3};
#undef R2
#undef R3

/* Sites that follow each other along a line, `each` of them to both sides of the one in the middle. */
typedef struct stretch {
	int count, middle, each;
	float x[PADDED], y[PADDED], z[PADDED];
} stretch;

/* From the first to the last along each way. */
static void net_along(const stretch *s, float *restrict net)
{
	int end = s->count - 1;
	float x0 = s->x[0], y0 = s->y[0], z0 = s->z[0], x1 = s->x[end], y1 = s->y[end], z1 = s->z[end];
	for (int k = 0; k < LANES_OF_WAYS; k++) {
		float first = (x0 * ways[0][k] + y0 * ways[1][k] + z0 * ways[2][k]) * per_length[k];
		net[k] = fabsf((x1 * ways[0][k] + y1 * ways[1][k] + z1 * ways[2][k]) * per_length[k] - first);
	}
}

/* Up and down from site to site along a way; where those in the middle lie on the mean. */
static float all_along(const stretch *s, int way, float *place)
{
	float x = ways[0][way], y = ways[1][way], z = ways[2][way], per = per_length[way];
	float at[PADDED + 1], step[PADDED], all = 0, sum = 0;
	for (int j = 0; j < PADDED; j++)
		at[j] = (s->x[j] * x + s->y[j] * y + s->z[j] * z) * per;
	at[PADDED] = 0;
	for (int j = 0; j < PADDED; j++)
		step[j] = fabsf(at[j + 1] - at[j]);
	for (int j = 0; j < s->count - 1; j++)
		all += step[j];
	for (int j = s->middle - s->each; j <= s->middle + s->each; j++)
		sum += at[j];
	*place = sum / (float)(2 * s->each + 1);
	return all;
}

/* How far it is from the first to the last along the way that is nearest, and least unsteady: a straight line has one
 * all along, a small ring none. None is better than its net, so few are looked at. */
static float best_along(const stretch *s, float *place)
{
	float net[LANES_OF_WAYS], left[WAYS], score[WAYS], there[WAYS], most = -INFINITY, best = -INFINITY, far = 0;
	net_along(s, net);
	for (int k = 0; k < WAYS; k++) {
		left[k] = net[k];
		score[k] = -INFINITY;
		there[k] = 0;
	}
	for (;;) {
		int k = 0;
		for (int j = 1; j < WAYS; j++)
			k = left[j] > left[k] ? j : k;
		if (left[k] < 0 || left[k] * (1 + 1e-5f) < most) /* as sums are rounded */
			break;
		score[k] = net[k] - 2 * (all_along(s, k, there + k) - net[k]);
		most = max(most, score[k]);
		left[k] = -1;
	}
	for (int k = 0; k < WAYS; k++)
		if (score[k] > best) {
			best = score[k];
			far = net[k];
			*place = there[k];
		}
	return far;
}

static int put(stretch *s, const spots *p, uint32_t i)
{
	s->x[s->count] = p->x[i];
	s->y[s->count] = p->y[i];
	s->z[s->count] = p->z[i];
	return s->count++;
}

beat ISA(beat_of)(const beats *b, uint32_t i, float length)
{
	const fine *n = b->n;
	uint32_t before[STEPS], after[STEPS], links = links_at(n, i);
	if (links < 1 || links > 2)
		return (beat){0};
	int left = steps_on(b, i, n->at[i], before), right = links == 2 ? steps_on(b, i, n->at[i] + 1, after) : 0;
	/* as many on both sides, or the mean lies elsewhere */
	stretch s = {.each = left < right ? left : right};
	for (int k = left; k > 0; k--)
		put(&s, &b->at, before[k - 1]);
	s.middle = put(&s, &b->at, i);
	for (int k = 0; k < right; k++)
		put(&s, &b->at, after[k]);
	float place = 0, far = best_along(&s, &place);
	const site *from = n->site + (left ? before[left - 1] : i), *to = n->site + (right ? after[right - 1] : i);
	float rate = sqrtf(apart2(from, to)) / (length * far);
	if (!(rate > 1e-30f && rate < 1e30f))
		return (beat){0};
	/* whole powers of two of places part dashes; between them half that part, as far as the next is near */
	int32_t bits = float_bits(rate);
	float scale = bits_float(bits & 0x7f800000), times = rate / scale, at = place * scale;
	at = fabsf(at) < 1e9f ? at : 0;
	float number = floorf(at);
	at -= number;
	return (beat){.whole = min(at, 1 - at) * times * length,
		      .half = fabsf(at - 0.5f) * times * length,
		      .born = times - 1,
		      .length = length,
		      .at = at,
		      .octave = bits >> 23,
		      .number = (int32_t)number};
}
