/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Single pixels that are a little brighter, or darker, than all about them: cut into tones they would be specks. They
 * come down, or up, to the nearest of those.
 *
 * One cause is grain of soft light. The other is what a thing shows where it turns away: there light changes most just
 * at the rim, and pixels whose centres it barely covers see a sliver far narrower than a pixel, of which one centre in
 * five hits a part. */
#include "light/light.h"

enum { ABOUT = 5 };                   /* of eight neighbours: how many must be known to call a pixel grain */
static const float most_grain = 0.1f; /* by so much a share may stand out from all about it by chance */

/* The least and the largest of what lies about a pixel. */
typedef struct about {
	float low, high;
	int known;
} about;
#define ABOUT_NONE ((about){FLT_MAX, -FLT_MAX, 0})

static void take(about *a, float value)
{
	a->low = min(a->low, value);
	a->high = max(a->high, value);
	a->known++;
}

float ISA(lone_grain)(const light *l, const float *share, int x, int y)
{
	const float own = share[(ptrdiff_t)y * l->width + x];
	about a = ABOUT_NONE;
	for (int v = y - 1; v <= y + 1; v++)
		for (int u = x - 1; u <= x + 1; u++)
			if ((u != x || v != y) && goes_on(l, x, y, u, v))
				take(&a, share[(ptrdiff_t)v * l->width + u]);
	const float off = a.known < ABOUT ? 0 : min(max(own, a.low), a.high) - own;
	return fabsf(off) < most_grain ? off : 0;
}

static float brightest(const light *l, ptrdiff_t i)
{
	return max3(l->sum[3 * i], l->sum[3 * i + 1], l->sum[3 * i + 2]);
}

float ISA(lone_rim)(const light *l, int x, int y)
{
	const ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	const surface *s = l->surfaces + i;
	const int32_t thing = s->instance;
	if (s[-1].instance == thing && s[1].instance == thing && s[-l->width].instance == thing &&
	    s[l->width].instance == thing)
		return 1;
	about a = ABOUT_NONE;
	for (int v = -1; v <= 1; v++)
		for (int u = -1; u <= 1; u++) {
			const ptrdiff_t far = (ptrdiff_t)v * l->width + u;
			if (far && s[far].instance == thing)
				take(&a, brightest(l, i + far));
		}
	const float own = brightest(l, i);
	return a.known && own > 0 ? min(max(own, a.low), a.high) / own : 1;
}
