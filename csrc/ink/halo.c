/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A gutter of paper, or of a color, around outlines, on what lies behind them. */
#include "ink/discs.h"
#include "fine/near.h"

#include <string.h>

enum { ROWS = 16 };

typedef struct halos {
	const frame *f;
	float *cover;   /* width * height */
	uint8_t *style; /* likewise: whose it is */
} halos;

static void cover_around(const halos *h, uint32_t i, int y0, int y1)
{
	const frame *f = h->f;
	const fine *n = f->fine;
	const placed *s = &n->site[i].placed;
	const chain_site *of = n->chain + i;
	float reach = of->halo + 0.5f;
	int top = (int)(s->y - reach), bottom = (int)(s->y + reach) + 1, left = (int)(s->x - reach),
	    right = (int)(s->x + reach) + 1;
	for (int y = top > y0 ? top : y0; y <= bottom && y < y1; y++)
		for (int x = left > 0 ? left : 0; x <= right && x < f->width; x++) {
			float dx = (float)x - s->x, dy = (float)y - s->y, d2 = dx * dx + dy * dy;
			size_t at = (size_t)y * (size_t)f->width + (size_t)x;
			if (!(d2 < reach * reach) || !(depth_at(f, x, y) > of->beyond))
				continue;
			float cover = min(reach - sqrtf(d2), 1);
			if (!(cover > h->cover[at]))
				continue;
			h->cover[at] = cover;
			h->style[at] = (uint8_t)style_at(f, s->near_x, s->near_y);
		}
}

static void halo_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const halos *h = data;
	const frame *f = h->f;
	const fine *n = f->fine;
	size_t first = (size_t)y0 * (size_t)f->width, end = (size_t)y1 * (size_t)f->width;
	memset(h->cover + first, 0, (end - first) * sizeof *h->cover);
	for (uint32_t i = 0; i < n->chains[0]; i++) {
		const placed *s = &n->site[i].placed;
		float reach = n->chain[i].halo + 1;
		if (reach > 1 && s->y + reach > (float)y0 && s->y - reach < (float)y1)
			cover_around(h, i, y0, y1);
	}
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		float *rgba = output_row(f, ENCRE_OUTPUT_COMBINED, y);
		for (int x = 0; x < f->width; x++, first++) {
			float cover = h->cover[first], *p = rgba + (ptrdiff_t)4 * x;
			if (!(cover > 0))
				continue;
			const float *color = f->params[h->style[first]].line_halo_color;
			for (int c = 0; c < 3; c++)
				p[c] = blend(p[c], color[c], cover);
			p[3] = cover + p[3] - cover * p[3];
		}
	}
}

int32_t ISA(halos_draw)(frame *f)
{
	const fine *n = f->fine;
	bool any = false;
	for (uint32_t i = 0; i < n->chains[0] && !any; i++)
		any = n->chain[i].halo > 0;
	if (!any)
		return ENCRE_OK;
	size_t pixels = (size_t)f->width * (size_t)f->height;
	halos h = {f, late_take(&f->late, pixels, sizeof *h.cover), late_take(&f->late, pixels, 1)};
	if (!h.cover || !h.style)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, f->height, ROWS, halo_rows, &h);
	late_drop(&f->late, h.style);
	late_drop(&f->late, h.cover);
	return code;
}
