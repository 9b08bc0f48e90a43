/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From marks to sites. First of the marks of a tile that has too many the strongest are chosen: what is denser than
 * hair and leaves is noise, which would cost many times a picture and show nothing. Then sites are counted by row, so
 * that their numbers don't depend on threads, and placed. */
#include "fine/near.h"

#include <string.h>

/* ---- a walk over marks ----------------------------------------------------------------------------------- */

/* What is done with each mark that it meets, and with what. */
typedef struct walk walk;
struct walk {
	const fine *n;
	void (*visit)(walk *w, const found *at, int slot);
	uint32_t number[FAMILY_COUNT]; /* of the next site, by family */
	uint64_t *key, limit;          /* of the marks of a tile, in the order of the walk; more than which is kept */
	uint64_t *kept;
	uint32_t count;
	tile at;
};

/* The marks of a pixel have a bit each in fine.kept: those of cracks, their junctions beside them, ridges. */
enum { BLOCK = 2, SLOT_JUNCTION = 8, SLOT_RIDGE = 16, SLOT_MORE = 32 };
static const uint8_t slots[WORD_COUNT] = {[WORD_RIDGE] = SLOT_RIDGE, [WORD_MORE] = SLOT_MORE};

static void walk_marks(walk *w, int x, int y, enum word word, int marks)
{
	for (; marks; marks &= marks - 1) {
		int bit = __builtin_ctz((unsigned)marks);
		found at = {(uint16_t)x, (uint16_t)y, marked_family[word][bit], (uint8_t)(bit % 2)};
		w->visit(w, &at, slots[word] + bit);
	}
}

/* Of the four cracks between the pixels from x on: `crack`, `below` are rows of marks. */
static int sides(const uint8_t *crack, const uint8_t *below, int x, uint8_t right)
{
	int down = right << 1;
	return !!(crack[x] & right) + !!(below[x] & right) + !!(crack[x] & down) + !!(crack[x + 1] & down);
}

/* The first of pixels x..end - 1 of a row that has a mark, or end. */
static int next_pixel(const uint8_t *crack, const uint16_t *ridge, int x, int end)
{
	for (; x + 8 <= end; x += 8) {
		uint64_t cracks, ridges[2];
		memcpy(&cracks, crack + x, 8);
		memcpy(ridges, ridge + x, 16);
		if (!(cracks | ridges[0] | ridges[1]))
			continue;
		int crack_at = first_byte(cracks),
		    ridge_at = (ridges[0] ? first_byte(ridges[0]) : 8 + first_byte(ridges[1])) / 2;
		return x + (crack_at < ridge_at ? crack_at : ridge_at);
	}
	while (x < end && !(crack[x] | ridge[x]))
		x++;
	return x;
}

/* Pixels x..end - 1 of a row. */
static void walk_row(walk *w, int y, int x, int end)
{
	const fine *n = w->n;
	int width = n->f->width;
	const uint8_t *crack = n->crack + (ptrdiff_t)y * width, *below = crack + width;
	const uint16_t *ridge = n->ridge + (ptrdiff_t)y * width;
	for (x = next_pixel(crack, ridge, x, end); x < end; x = next_pixel(crack, ridge, x + 1, end)) {
		bool inside = x + 1 < width && y + 1 < n->f->height;
		walk_marks(w, x, y, WORD_CRACK, crack[x]);
		for (int bit = 0; crack[x] && inside && bit < 8; bit += 2) {
			int count = sides(crack, below, x, (uint8_t)(1 << bit));
			if (count == 3 || (count == 4 && !(bit == 0 && ISA(crack_passage)(n, x, y)))) {
				found at = {(uint16_t)x, (uint16_t)y, marked_family[WORD_CRACK][bit], AXIS_JUNCTION};
				w->visit(w, &at, SLOT_JUNCTION + bit / 2);
			}
		}
		walk_marks(w, x, y, WORD_RIDGE, ridge[x] & ~RIDGE_MORE);
		if (ridge[x] & RIDGE_MORE)
			walk_marks(w, x, y, WORD_MORE, n->more[(ptrdiff_t)y * width + x]);
	}
}

static void walk_tile(walk *w, int i)
{
	tile t = tile_of(w->n->f, i);
	for (; t.y < t.last; t.y++)
		walk_row(w, t.y, t.x, t.end);
}

/* ---- counted --------------------------------------------------------------------------------------------- */

static bool is_kept(const fine *n, const found *at, int slot)
{
	const frame *f = n->f;
	if (!n->dense)
		return true;
	int across = tiles_of(f->width), tall = tiles_of(f->height);
	int i = (int)(((int64_t)at->row * tall + tall - 1) / f->height) * across +
		(int)(((int64_t)at->column * across + across - 1) / f->width);
	const uint64_t *kept = n->kept[i];
	tile t = tile_of(f, i);
	return !kept || kept[(at->row - t.y) * TILE_SIDE + at->column - t.x] >> slot & 1;
}

static void count_site(walk *w, const found *at, int slot)
{
	bool kept = is_kept(w->n, at, slot);
	w->number[at->family] += kept;
	w->count += kept;
}

static void count_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	int width = n->f->width, across = tiles_of(width);
	for (int y = y0; y < y1; y++) {
		walk w = {.n = n, .visit = count_site};
		for (int i = 0; i < across; i++) {
			w.count = 0;
			walk_row(&w, y, tile_from(i, width), tile_from(i + 1, width));
			n->marks[(ptrdiff_t)y * across + i] = w.count;
		}
		for (int k = 0; k < FAMILY_COUNT; k++)
			n->first[k * n->f->height + y] = w.number[k];
	}
}

static uint32_t marks_of(const fine *n, int i)
{
	tile t = tile_of(n->f, i);
	int across = tiles_of(n->f->width);
	uint32_t count = 0;
	for (; t.y < t.last; t.y++)
		count += n->marks[(ptrdiff_t)t.y * across + i % across];
	return count;
}

/* ---- at most so many a tile ------------------------------------------------------------------------------ */

/* Marks order by strength. Those that are as strong as each other are thinned out evenly, wherever they lie, but a few
 * pixels each way together: lines that are cut anywhere would have more ends than there was to save. */
static void rank_mark(walk *w, const found *at, int slot)
{
	float own_strength = ISA(fine_strength)(w->n, at);
	uint32_t strength;
	memcpy(&strength, &own_strength, sizeof strength); /* from 0 on, floats order as their bits do */
	uint32_t block = mix_bits((uint32_t)(at->row / BLOCK) << 16 | (uint32_t)(at->column / BLOCK)),
		 own = mix_bits(mix_bits((uint32_t)at->row << 16 | at->column) + (uint32_t)slot);
	w->key[w->count++] = (uint64_t)strength << 32 | (block & 0xffff0000u) | own >> 16;
}

static void choose_mark(walk *w, const found *at, int slot)
{
	if (w->key[w->count++] > w->limit)
		w->kept[(at->row - w->at.y) * TILE_SIDE + at->column - w->at.x] |= (uint64_t)1 << slot;
}

/* The least number than which at most `most` keys are larger, digit by digit. */
static uint64_t limit_of(const uint64_t *key, uint32_t count, uint32_t most)
{
	enum { DIGIT = 8, DIGITS = 1 << DIGIT };
	uint64_t limit = 0;
	for (int shift = 64 - DIGIT; shift >= 0; shift -= DIGIT) {
		uint32_t have[DIGITS] = {0};
		for (uint32_t i = 0; i < count; i++)
			if (shift == 64 - DIGIT || key[i] >> (shift + DIGIT) == limit >> (shift + DIGIT))
				have[key[i] >> shift & (DIGITS - 1)]++;
		int digit = DIGITS - 1;
		for (; digit > 0 && have[digit] <= most; digit--)
			most -= have[digit];
		limit |= (uint64_t)digit << shift;
	}
	return limit;
}

typedef struct bound {
	fine *n;
	uint32_t *tile, most; /* the tiles that have too many, and the most that one of these has */
	uint64_t *key, *kept;
} bound;

static void bound_tiles(void *data, int first, int end, int thread)
{
	const bound *b = data;
	for (int i = first; i < end; i++) {
		walk w = {.n = b->n, .visit = rank_mark, .key = b->key + (size_t)thread * b->most};
		w.kept = b->kept + (size_t)i * TILE_SIDE * TILE_SIDE;
		walk_tile(&w, (int)b->tile[i]);
		w.limit = limit_of(w.key, w.count, most_of(b->n->f, (int)b->tile[i]));
		w.at = tile_of(b->n->f, (int)b->tile[i]);
		w.visit = choose_mark;
		w.count = 0;
		memset(w.kept, 0, TILE_SIDE * TILE_SIDE * sizeof *w.kept);
		walk_tile(&w, (int)b->tile[i]);
		b->n->kept[b->tile[i]] = w.kept;
	}
}

/* Leaves in `first` how many sites each row of a family has. */
int32_t ISA(fine_bound)(fine *n)
{
	frame *f = n->f;
	bound b = {.n = n};
	int tiles = tiles_of(f->width) * tiles_of(f->height), dense = 0;
	n->dense = NULL;
	int32_t code = bands_run(f->bands, f->height, 0, count_rows, n);
	for (int i = 0; !code && i < tiles; i++) {
		uint32_t marks = marks_of(n, i);
		n->kept[i] = NULL;
		dense += marks > most_of(f, i);
		b.most = marks > b.most ? marks : b.most;
	}
	if (code || !dense)
		return code;
	b.tile = late_take(&f->late, (size_t)dense, sizeof *b.tile);
	b.key = late_take(&f->late, (size_t)bands_threads(f->bands) * b.most, sizeof *b.key);
	b.kept = late_take(&f->late, (size_t)dense * TILE_SIDE * TILE_SIDE, sizeof *b.kept);
	if (!b.tile || !b.key || !b.kept)
		return ENCRE_ERROR_MEMORY;
	for (int i = 0, k = 0; i < tiles; i++)
		if (marks_of(n, i) > most_of(f, i))
			b.tile[k++] = (uint32_t)i;
	code = bands_run(f->bands, dense, 1, bound_tiles, &b);
	n->dense = b.kept;
	late_drop(&f->late, b.tile);
	late_drop(&f->late, b.key);
	return code ? code : bands_run(f->bands, f->height, 0, count_rows, n);
}

/* ---- all sites, in order --------------------------------------------------------------------------------- */

static void make_site(walk *w, const found *at, int slot)
{
	if (!is_kept(w->n, at, slot))
		return;
	site *s = w->n->site + w->number[at->family]++;
	*s = (site){.found = *at};
	ISA(fine_place)(w->n, at, &s->placed);
	ISA(fine_controls)(w->n, at, &s->placed);
}

enum {
	AROUND = 3,  /* rows about it that a site reads */
	DENSE = 128, /* pixels a site, from which on rows are read */
	FETCHED = 32 /* pixels that are asked for at once: more would wait */
};

/* Pixels x..end - 1 of a row of each layer. Sites read here and there, and would wait for the memory each time. */
static void fetch_layers(const fine *n, int y, int x, int end)
{
	static const int layers[] = {ENCRE_LAYER_DEPTH, ENCRE_LAYER_OBJECT, ENCRE_LAYER_NORMAL, ENCRE_LAYER_ALBEDO,
				     ENCRE_LAYER_DIFFUSE};
	int some = (int)(sizeof layers / sizeof *layers) - !n->e->on[SOURCE_LIGHT];
	for (int i = 0; i < some; i++)
		if (n->f->layer[layers[i]].data)
			fetch(n->f->layer[layers[i]], encre_layer_info(layers[i])->channels, y, x, end);
}

static void make_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	int width = n->f->width, height = n->f->height, fetched = y0 - AROUND;
	for (int y = y0; y < y1 && !bands_stopped(n->f->bands); y++) {
		walk w = {.n = n, .visit = make_site};
		uint32_t sites = 0;
		for (int k = 0; k < FAMILY_COUNT; k++) {
			w.number[k] = n->first[k * height + y];
			sites += n->first[k * height + y + 1] - w.number[k];
		}
		bool dense = sites * DENSE > (uint32_t)width, next = dense && y + AROUND + 1 < height;
		fetched = fetched > y - AROUND ? fetched : y - AROUND;
		for (; dense && fetched <= y + AROUND; fetched++)
			fetch_layers(n, clamp_index(fetched, height), 0, width);
		for (int x = 0; x < width; x += FETCHED) {
			int end = width - x < FETCHED ? width : x + FETCHED;
			if (next)
				fetch_layers(n, y + AROUND + 1, x, end);
			walk_row(&w, y, x, end);
		}
		fetched += next;
	}
}

int32_t ISA(fine_gather)(fine *n)
{
	frame *f = n->f;
	size_t count = 0;
	uint32_t chains = chain_sites(n);
	n->first[FAMILY_CHAIN_SHAPE * f->height] = n->chains[0]; /* they have no rows */
	n->first[FAMILY_CHAIN_CREASE * f->height] = n->chains[1];
	n->first[FAMILY_CHAIN_COLOR * f->height] = n->chains[2];
	for (int i = 0; i < FAMILY_COUNT * f->height; i++) {
		uint32_t own = n->first[i];
		n->first[i] = (uint32_t)count;
		count += own;
	}
	n->first[FAMILY_COUNT * f->height] = (uint32_t)count;
	n->site = count < INT32_MAX ? late_take(&f->late, count, sizeof *n->site) : NULL;
	if (!n->site)
		return ENCRE_ERROR_MEMORY;
	n->count = (uint32_t)count;
	if (chains)
		memcpy(n->site, n->chain_made, chains * sizeof *n->site);
	late_drop(&f->late, n->chain_made);
	int32_t code = bands_run(f->bands, f->height, 0, make_rows, n);
	late_drop(&f->late, n->dense);
	return code;
}
