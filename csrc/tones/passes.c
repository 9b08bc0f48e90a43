/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The passes of strokes and spots: pixels tell what strokes need of them, then marks are found, and then drawn. */
#include "tones/strokes.h"

#include <string.h>

typedef struct work {
	const frame *f;
	tone_marks *m;
	int reach; /* rows */
} work;

void ISA(tone_marks_rows)(const frame *f, const tone_marks *m, int y0, int y1, int thread)
{
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++)
		m->first[y] = ISA(tone_marks_look)(f, m, y, thread);
}

static void look_at_rows(void *data, int y0, int y1, int thread)
{
	const work *w = data;
	ISA(tone_marks_rows)(w->f, w->m, y0, y1, thread);
}

/* Whether surfaces end within the next few pixels: strokes ask it at each step. */
static void look_ahead(const tone_marks *m, int height, int y, int x, int n)
{
	uint8_t right[TONE_CHUNK + TONE_AHEAD] = {0}, ended[2][TONE_CHUNK] = {{0}};
	uint8_t *restrict near = tone_bytes(m, TONE_NEAR, y) + x;
	int known = n + TONE_AHEAD < m->width - x ? n + TONE_AHEAD : m->width - x;
	memcpy(right, tone_bytes(m, TONE_BITS, y) + x, (size_t)known);
	for (int k = 0; k < TONE_AHEAD; k++) {
		const uint8_t *restrict down = tone_bytes(m, TONE_BITS, tone_within(y + k, height)) + x;
		for (int i = 0; i < n; i++) {
			ended[0][i] |= (right[i + k] & TONE_ENDS_RIGHT) != 0;
			ended[1][i] |= (down[i] & TONE_ENDS_DOWN) != 0;
			near[i] = (uint8_t)(near[i] | ended[0][i] << k | ended[1][i] << (TONE_AHEAD + k));
		}
	}
}

/* Marks that nothing within their reach is dark enough for need not be traced, and those with one object about them not
 * ask whose pixels are: blocks tell both. */
static tone_block block_of(const frame *f, const tone_marks *m, int x, int n, int y0, int y1)
{
	uint8_t most[TONE_BLOCK] = {0};
	int other = 0;
	const float *objects = layer_row(f, ENCRE_LAYER_OBJECT, y0);
	tone_block b = {.object = objects ? objects[x] : 0};
	for (int y = y0; y < y1; y++) {
		const uint8_t *restrict dark = tone_bytes(m, TONE_DARK, y) + x;
		const float *restrict object = objects ? layer_row(f, ENCRE_LAYER_OBJECT, y) + x : NULL;
		for (int i = 0; i < n; i++)
			most[i] = dark[i] > most[i] ? dark[i] : most[i];
		for (int i = 0; object && i < n; i++)
			other |= object[i] != b.object;
	}
	for (int i = 0; i < n; i++)
		b.darkest = most[i] > b.darkest ? most[i] : b.darkest;
	b.parted = other != 0;
	return b;
}

/* Called with bands of a block's rows. */
static void block_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	int wide = tone_blocks(w->f->width), high = tone_blocks(w->f->height);
	tone_block *own = w->m->blocks + (ptrdiff_t)wide * (high + y0 / TONE_BLOCK);
	for (int k = 0; k < wide; k++) {
		int x = k * TONE_BLOCK, n = w->f->width - x < TONE_BLOCK ? w->f->width - x : TONE_BLOCK;
		own[k] = block_of(w->f, w->m, x, n, y0, y1);
	}
}

static void join_blocks(const frame *f, const tone_marks *m)
{
	int wide = tone_blocks(f->width), high = tone_blocks(f->height);
	const tone_block *own = m->blocks + (ptrdiff_t)wide * high;
	for (int k = 0; k < wide * high; k++) {
		tone_block all = own[k];
		for (int j = 0; j < 9; j++) {
			int y = tone_within(k / wide + j / 3 - 1, high), x = tone_within(k % wide + j % 3 - 1, wide);
			const tone_block *there = own + (ptrdiff_t)y * wide + x;
			all.darkest = there->darkest > all.darkest ? there->darkest : all.darkest;
			all.parted |= there->parted || there->object != all.object;
		}
		m->blocks[k] = all;
	}
}

static void look_ahead_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	int width = w->f->width;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int x = 0; x < width; x += TONE_CHUNK)
			look_ahead(w->m, w->f->height, y, x, width - x < TONE_CHUNK ? width - x : TONE_CHUNK);
}

static void count_spots(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		bool lacks = false;
		int n = w->m->lacks[y] ? ISA(tone_spots_find)(w->f, w->m, y, 0, w->f->width, NULL, &lacks) : 0;
		w->m->first[y] += lacks ? 0 : n;
		w->m->lacks[y] = lacks;
	}
}

/* Counts spots, and finds the points of those rows that lack some, until none does. */
static int32_t find_points(frame *f, work *w)
{
	tone_marks *m = w->m;
	int32_t code = ENCRE_OK;
	bool lacks = true;
	blue_trim(f->kept_spots);
	memset(m->lacks, 1, (size_t)f->height);
	while (!code && lacks) {
		blue_want_none(&m->wanted);
		code = bands_run(f->bands, f->height, 0, count_spots, w);
		lacks = false;
		for (int y = 0; y < f->height; y++)
			lacks |= m->lacks[y];
		if (!code && lacks)
			code = ISA(blue_make)(f, &m->wanted);
	}
	return code;
}

static void find_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		ISA(tone_marks_find)(w->f, w->m, y, w->m->marks + w->m->first[y]);
}

static void sift_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		ISA(tone_marks_sift)(w->f, w->m, y);
}

static void draw_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	ISA(tone_marks_draw)(w->f, w->m, w->reach, y0, y1);
}

int32_t ISA(tone_marks_run)(frame *f, tone_marks *m, bool looked)
{
	work w = {f, m, 0};
	float pitch = 0;
	for (int i = 0; i < f->n_styles; i++)
		for (int k = 0; k < TONE_SLOTS && f->params[i].use_tones; k++)
			if (tone_marked(m->styles[i].slot + k))
				pitch = max(pitch, m->styles[i].slot[k].most);
	float reach = 0.65f * stroke_length * pitch;
	ISA(tone_turns_find)(f, m);
	w.reach = (int)min(reach + tone_step(reach) + pitch, (float)f->height) + 3;
	int32_t code = looked ? ENCRE_OK : bands_run(f->bands, f->height, 0, look_at_rows, &w);
	code = !code && m->lacks ? find_points(f, &w) : code;
	if (code)
		return code;
	int64_t sum = 0;
	for (int y = 0; y <= f->height; y++) {
		int64_t own = y < f->height ? m->first[y] : 0;
		m->first[y] = sum;
		sum += own;
	}
	m->marks = late_take(&f->late, (size_t)sum + 1, sizeof *m->marks);
	if (!m->marks)
		return ENCRE_ERROR_MEMORY;
	code = bands_run(f->bands, f->height, TONE_BLOCK, block_rows, &w);
	if (code)
		return code;
	join_blocks(f, m);
	code = bands_run(f->bands, f->height, 0, look_ahead_rows, &w);
	code = code ? code : bands_run(f->bands, f->height, 0, find_rows, &w);
	code = code ? code : bands_run(f->bands, f->height, 0, sift_rows, &w);
	code = !code && m->lacks ? ISA(tone_spots_thin)(f, m) : code;
	/* strokes are traced in each band that they reach */
	int band = f->height / (2 * bands_threads(f->bands));
	band = band < 64 ? 64 : band;
	return code ? code : bands_run(f->bands, f->height, band, draw_rows, &w);
}
