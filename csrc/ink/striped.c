/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ink of links along which a picture lies. */
#include "ink/capsules.h"

/* Where picked pixels lie on their link, and in the canvas. */
typedef struct spread {
	float px[STRIP_PLACES], py[STRIP_PLACES], s[STRIP_PLACES], across[STRIP_PLACES];
	float dry[STRIP_PLACES]; /* what bristles leave */
	int32_t at[STRIP_PLACES];
} spread;

static void spread_out(const capsule *e, const canvas *c, int n, const uint32_t *restrict place, spread *restrict to)
{
	float x0 = e->a->x, top = e->a->y, out = e->a->out, other = e->b->out;
	int y0 = c->y0, stride = (int)c->stride;
	for (int i = 0; i < n; i++) {
		int x = (int)(place[i] & 0xffff), y = (int)(place[i] >> 16);
		float px = (float)x - x0, py = (float)y - top, s = clamp01((px * e->dx + py * e->dy) * e->inverse);
		to->at[i] = (y - y0) * stride + x;
		to->px[i] = px;
		to->py[i] = py;
		to->s[i] = s;
		to->across[i] = across_at(&e->across, px, py, mix(out, other, s));
		to->dry[i] = e->dry[0] ? left_by(&e->across, to->across[i], s) : 1;
	}
}

/* As ink_span() does, each pixel by itself. */
static void own(const capsule *e, const canvas *c, const spread *w, int i, float t)
{
	float ex = w->px[i] - w->s[i] * e->dx, ey = w->py[i] - w->s[i] * e->dy, d2 = ex * ex + ey * ey;
	float *dark = c->dark + w->at[i], *distance = c->distance + w->at[i];
	if (!(t > *dark || (t > 0 && t == *dark && d2 < *distance)))
		return;
	*dark = t;
	*distance = d2;
	c->owner[w->at[i]] = w->s[i] > 0.5f ? e->two : e->one;
}

void ISA(picked_ink)(const capsule *e, const canvas *c, picked *p)
{
	spread w;
	float left[STRIP_PLACES];
	int count = p->n, n = (count + LANES - 1) / LANES * LANES;
	if (count < 1)
		return;
	for (int i = count; i < n; i++)
		p->place[i] = p->place[0];
	spread_out(e, c, n, p->place, &w);
	ISA(strip_left)(&e->strip, n, w.px, w.py, w.s, w.across, left);
	for (int i = 0; i < count; i++) {
		float t = p->most[i] * (left[i] * w.dry[i]), *dark = c->dark + w.at[i];
		if (c->owner)
			own(e, c, &w, i, t);
		else
			*dark = t > *dark ? t : *dark;
	}
	p->n = 0;
}
