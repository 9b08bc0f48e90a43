/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What must hold after the passes of FINE, as plainly as it can be asked. Only debug builds have it. */
#include "fine/invariants.h"
#include "fine/near.h"

#ifdef ENCRE_DEBUG

#include <stdio.h>
#include <stdlib.h>

void demand(const char *pass, const char *broken)
{
	if (!broken)
		return;
	fprintf(stderr, "encre: FINE, after \"%s\": not true that %s\n", pass, broken);
	abort();
}

const char *broken_cracks(const fine *n)
{
	int width = n->f->width, height = n->f->height;
	for (int y = 0; y < height; y++)
		if (n->crack[(ptrdiff_t)y * width + width - 1] & (CRACK_RIGHT | LIGHT_RIGHT))
			return "nothing lies right of the last column";
	for (int x = 0; x < width; x++)
		if (n->crack[(ptrdiff_t)(height - 1) * width + x] & (CRACK_DOWN | LIGHT_DOWN))
			return "nothing lies below the last row";
	return NULL;
}

const char *broken_ridges(const fine *n)
{
	int all[WORD_COUNT] = {0};
	for (int k = 0; k < FAMILY_COUNT; k++)
		all[families[k].word] |= mark_of(k, AXIS_ROW) | mark_of(k, AXIS_COLUMN);
	for (ptrdiff_t i = 0; i < (ptrdiff_t)n->f->width * n->f->height; i++) {
		bool seen = n->ridge[i] & RIDGE_MORE;
		if (n->ridge[i] & ~(all[WORD_RIDGE] | RIDGE_MORE) || (seen && n->more[i] & ~all[WORD_MORE]))
			return "every mark of a ridge is a family's";
		if (n->more && seen != (n->more[i] != 0))
			return "a pixel has marks in both words or in none";
	}
	return NULL;
}

static const char *broken_bound(const fine *n)
{
	for (int k = 0; k < tiles_of(n->f->width) * tiles_of(n->f->height); k++) {
		tile t = tile_of(n->f, k);
		uint32_t count = 0;
		for (uint32_t i = 0; i < n->count; i++) {
			const found *at = &n->site[i].found;
			count += !is_chain(n->site + i) && at->column >= t.x && at->column < t.end && at->row >= t.y &&
				 at->row < t.last;
		}
		if (count > most_of(n->f, k))
			return "a tile has no more sites than it may";
	}
	return NULL;
}

const char *broken_sites(const fine *n)
{
	int width = n->f->width, height = n->f->height;
	for (uint32_t i = 0; i < n->count; i++) {
		const found *at = &n->site[i].found, *last = i ? &n->site[i - 1].found : NULL;
		const placed *s = &n->site[i].placed;
		uint64_t key = (((uint64_t)at->family << 16 | at->row) << 16 | at->column) << 8 | at->axis;
		if (last && !is_chain(n->site + i) &&
		    key <= ((((uint64_t)last->family << 16 | last->row) << 16 | last->column) << 8 | last->axis))
			return "sites grow by family, row, column and axis";
		int row = is_chain(n->site + i) ? 0 : at->row; /* chains have no rows */
		if (i < n->first[at->family * height + row] || i >= n->first[at->family * height + row + 1])
			return "sites are counted by family and row";
		if (at->column >= width || at->row >= height || s->near_x >= width || s->near_y >= height)
			return "sites lie in the frame and take their controls there";
		if (!is_chain(n->site + i) &&
		    !(fabsf(s->x - (float)at->column) <= 2 && fabsf(s->y - (float)at->row) <= 2))
			return "sites lie where they were found";
		if (!(s->strength >= 0 && s->strength <= FLT_MAX))
			return "a strength is a number";
		if (!(s->thin >= 0 && s->thin <= 1 && s->half >= 0 && fabsf(s->inside) < 99))
			return "a thing has a width, and its line is beside or on it";
	}
	return broken_bound(n);
}

const char *broken_cells(const fine *n)
{
	uint32_t count = 0;
	for (int row = 0; row < n->tall; row++)
		for (int x = 0; x < n->across; x++) {
			const uint32_t *cell = n->cell + (ptrdiff_t)row * n->across + x;
			for (uint32_t k = cell[0]; k < cell[1]; k++, count++) {
				const site *s = n->site + n->member[k];
				if (k > cell[0] && n->member[k] <= n->member[k - 1])
					return "sites of a cell ascend";
				if (pixel_of(s->placed.x, n->f->width) / CELL != x ||
				    pixel_of(s->placed.y, n->f->height) / CELL != row)
					return "a site is a member of the cell that it lies in";
			}
		}
	return count == n->count ? NULL : "cells hold all sites";
}

const char *broken_claims(const fine *n)
{
	for (uint32_t i = 0; i < n->count; i++) {
		const site *s = n->site + i;
		bool joins = rank_of(s) == RANK_SHAPE || is_chain(s);
		if (s->linked.crumb && !s->linked.dropped)
			return "crumbs are dropped";
		if (s->linked.dropped)
			continue;
		if (!joins && s->placed.strength <= 0)
			return "what is kept is an edge";
		if (s->placed.weak && !s->linked.held)
			return "weak sites that are kept are held";
		near_sites of = near_site(n, s, clear_of_older);
		for (uint32_t j; !joins && near_next(n, &of, &j);)
			if (!n->site[j].linked.dropped && n->site[j].found.family < s->found.family &&
			    rank_of(n->site + j) <= rank_of(s) &&
			    apart2(s, n->site + j) < clear_from(s, n->site + j) * clear_from(s, n->site + j))
				return "sites keep clear of those of earlier families";
	}
	return NULL;
}

static bool is_linked(const fine *n, uint32_t from, uint32_t to)
{
	for (uint32_t k = n->at[from]; k < n->at[from + 1]; k++)
		if (n->to[k] == to)
			return true;
	return false;
}

const char *broken_links(const fine *n)
{
	if (n->known != n->count || n->at[0] != 0)
		return "links are known of all sites";
	for (uint32_t i = 0; i < n->count; i++)
		for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
			if (n->to[k] >= n->count || n->to[k] == i)
				return "a link goes to another site";
			if (!is_linked(n, n->to[k], i))
				return "a link goes both ways";
			if (n->site[i].linked.dropped)
				return "what is dropped is not linked";
		}
	return NULL;
}

const char *broken_crowd(const fine *n)
{
	for (uint32_t i = 0; i < n->count; i++)
		if (!(n->site[i].linked.crowd >= -1e-3f && n->site[i].linked.crowd <= FLT_MAX)) /* 0, rounded */
			return "a crowd is a number";
	return NULL;
}

const char *broken_joined(const fine *n)
{
	const char *broken = broken_cells(n);
	return broken ? broken : broken_links(n);
}

#endif
