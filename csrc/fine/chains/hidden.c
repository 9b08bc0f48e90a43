/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines that lie behind things, as meshes tell them. They are added when all
 * others are lines: neither do they give way to any, nor any to them. */
#include "fine/near.h"

static const float far_apart = 1.5f;  /* pixels between sites, at most */
static const float beyond_frame = 12; /* pixels beside the image where lines still reach into it */

typedef struct hidden {
	fine *n;
	site *site;
	uint32_t (*link)[2];
	uint32_t sites, links; /* counted while there is no memory */
} hidden;

/* Whether a line is drawn along the way to a point. */
static bool is_line(const fine *n, const encre_chain_point *p, int style)
{
	enum {
		SHAPES = ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER | ENCRE_CHAIN_MEET | ENCRE_CHAIN_OTHER |
		ENCRE_CHAIN_NUMBER | ENCRE_CHAIN_MARK
	};
	const encre_params *s = n->f->params + style;
	float least = p->kind & ENCRE_CHAIN_SMOOTH ? s->crease_angle_smooth : s->crease_angle;
	return p->gap <= (float)n->f->params->hidden_most && ((p->kind & SHAPES) || p->bend >= least);
}

/* Adds a site; false: there is none. */
static bool add_site(hidden *h, const encre_chain_point *p, float x, float y, bool row)
{
	const frame *f = h->n->f;
	x -= (float)f->place.x;
	y -= (float)f->place.y;
	if (!(x > -beyond_frame && y > -beyond_frame && x < (float)f->width - 1 + beyond_frame &&
	      y < (float)f->height - 1 + beyond_frame))
		return false;
	site made = {.found = {.column = (uint16_t)pixel_of(x, f->width),
			       .row = (uint16_t)pixel_of(y, f->height),
			       .family = FAMILY_COUNT - 1,
			       .axis = row ? AXIS_ROW : AXIS_COLUMN},
		     .placed = {.x = x, .y = y}};
	int style = style_at(f, made.found.column, made.found.row);
	if (!is_line(h->n, p, style) || !(h->n->e->weight[SOURCE_HIDDEN][style] > 0))
		return false;
	made.placed.near_x = made.found.column;
	made.placed.near_y = made.found.row;
	made.placed.source = SOURCE_HIDDEN;
	made.placed.strength = min(h->n->e->weight[SOURCE_HIDDEN][style], 1);
	if (h->site)
		h->site[h->sites] = made;
	h->sites++;
	return true;
}

static void add_link(hidden *h)
{
	if (h->link) {
		h->link[h->links][0] = h->n->count + h->sites - 2;
		h->link[h->links][1] = h->n->count + h->sites - 1;
	}
	h->links++;
}

static int32_t add_all(hidden *h)
{
	const frame *f = h->n->f;
	const encre_chain_point *q = f->chains;
	int32_t code = ENCRE_OK;
	bool open = false;
	h->sites = h->links = 0;
	for (int64_t i = 1; !code && i < f->n_chains; i++) {
		code = at_step(h->n, (uint32_t)(i & 0xffffff));
		if (!(q[i].kind & ENCRE_CHAIN_HIDDEN) || q[i].run != q[i - 1].run) {
			open = false;
			continue;
		}
		float dx = q[i].x - q[i - 1].x, dy = q[i].y - q[i - 1].y, length = sqrtf(dx * dx + dy * dy);
		int steps = length < 1e5f ? 1 + (int)(length / far_apart) : 1;
		for (int k = open ? 1 : 0; k <= steps; k++) {
			float t = (float)k / (float)steps;
			bool there =
				add_site(h, q + i, q[i - 1].x + t * dx, q[i - 1].y + t * dy, fabsf(dy) > fabsf(dx));
			if (there && open)
				add_link(h);
			open = there;
		}
	}
	return code;
}

int32_t ISA(chains_add_hidden)(fine *n)
{
	hidden h = {.n = n};
	int32_t code = add_all(&h);
	if (code || !h.sites)
		return code;
	h.site = late_take(&n->f->late, h.sites, sizeof *h.site);
	h.link = late_take(&n->f->late, (size_t)h.links + 1, sizeof *h.link);
	if (!h.site || !h.link)
		return ENCRE_ERROR_MEMORY;
	uint32_t before = n->count;
	code = add_all(&h);
	if (!code)
		code = ISA(fine_add_sites)(n, h.site, h.sites);
	if (!code)
		code = ISA(fine_add_links)(n, h.link, h.links);
	for (uint32_t i = before; !code && i < n->count; i++) /* a dot is no line */
		n->site[i].linked.dropped |= n->at[i] == n->at[i + 1];
	late_drop(&n->f->late, h.link);
	late_drop(&n->f->late, h.site);
	return code;
}
