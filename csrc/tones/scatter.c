/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes: each has a place on the picture or on the thing, on a lattice as dots have it (dots.c), from which it is
 * shifted, and is drawn from there over other pixels (strokes.c). It follows the surface: the way in which that bends
 * most or, where it bends in none, planes that cut it. Which are drawn, and how wide, tells the darkness along them: in
 * the light few, then all, then a second and a third layer across. Here every pixel finds the strokes whose places it
 * holds, in its own row; spots are stipple.c's. */
#include "tones/strokes.h"

#include <string.h>

/* 255ths: so much brighter than its layer wants a stroke's middle may lie, for it goes to where it is darker. */
enum { DARKER_BESIDE = 32 };
static const float jitter = 0.6f;       /* pitches */
static const float beside_rows = 0.08f; /* sine of the angle up to which a stroke goes along a row of its lattice */

/* ---- tables ------------------------------------------------------------------------------------------------ */

/* The area of marks that cover c. Thrown at random it were -ln(1 - c); from a lattice, though shifted, they cover each
 * other less: by how much was measured. */
static float area_for(float c)
{
	float left = max(1 - c, 1.0f / 1024), y = 0;
	for (int k = 0; k < 12; k++) {
		float e = pixel_exp(-y);
		y += 2 * (e - left) / (e + left);
	}
	return y / (1 + y * 0.21f);
}

/* Share of a layer that is drawn where it alone is: each is full at a half of what those before it have left. */
static float cover_of(float dark, int layer)
{
	float left = 1 - dark;
	for (int k = 0; k < layer; k++)
		left = min(2 * left, 1);
	if (dark <= 0.875f)
		return clamp01(1 - max(left, 0.5f));
	return 1 - pixel_cbrt(1 - dark);
}

void ISA(tone_marks_tables)(tone_marks *m)
{
	for (int layer = 0; layer < TONE_LAYERS; layer++)
		for (int i = 0; i < 256; i++) {
			float dark = (float)i / 255, x = area_for(cover_of(dark, layer)) / full_cover;
			float low = min(x, 1), shown = 1.25f * sqrtf(low * sqrtf(low)), over = max(shown - 1, 0);
			float mean = shown < 0.25f ? 2 * shown * shown : shown - 0.125f - 2 * over * over;
			m->widths[layer][i] = (tone_width){shown, mean > 0 ? x / mean : 0};
		}
	for (int i = 0; i < 256; i++) {
		int layers = 0;
		for (int layer = 0; layer < TONE_LAYERS; layer++)
			layers |= m->widths[layer][i].shown > 0 ? TONE_FOUND << layer : 0;
		m->layers[i] = (uint8_t)layers;
		float x = 1 - (float)i / 128, y = 1 - fabsf(x), length = sqrtf(x * x + y * y);
		m->way[i][0] = x / length;
		m->way[i][1] = y / length;
	}
}

/* ---- darkness ---------------------------------------------------------------------------------------------- */

bool ISA(tone_marks_wanted)(const encre_params *p)
{
#define IN(n) || p->tone_##n == tone_##n##_HATCH || p->tone_##n == tone_##n##_STIPPLE
	return p->use_tones && (false TONE_EACH(IN));
#undef IN
}

/* Letters and eyes, which strokes would only tell by chance, are ink where it is dark, and so is what light letters lie
 * on: on a board in any tone, else where three layers of strokes cross or begin to, and letters would be but more gaps.
 * What is print but in part has more strokes: so much ink would be grey. */
static void close_print(const frame *f, int y, int x, int n, uint8_t *restrict dark)
{
	static const uint8_t half = 127, crossed = 170, all = 250; /* 255ths */
	const tone_detail *d = &((const tone_frame *)f->tones)->detail;
	size_t at = (size_t)y * (size_t)f->width + (size_t)x;
	for (int i = 0; d->keep && i < n; i++) {
		size_t own = at + (size_t)i;
		uint8_t print = dark[i] > half ? d->print[own] : 0;
		uint8_t around = dark[i] > crossed ? d->around[own] : dark[i] > 0 ? d->board[own] : 0;
		d->inked[own] = print >= all ? 255 : around;
		dark[i] = (uint8_t)(dark[i] + ((255 - dark[i]) * print + 127) / 255);
	}
}

/* The darkness of n pixels that marks fill, 1..255, 0 of others, the slot that fills them, and marks' share; of which
 * slots any are.
 */
static unsigned darken(const frame *f, const encre_params *p, const tone_slot *slots, int y, int x, int n,
		       uint8_t *restrict dark, uint8_t *restrict whose, uint8_t *restrict shares)
{
	tone_wanted w;
	float share[TONE_CHUNK] = {0}, sum[TONE_CHUNK] = {0}, best[TONE_CHUNK] = {0};
	int32_t slot[TONE_CHUNK] = {0};
	unsigned found[TONE_SLOTS] = {0}, any = 0;
	ISA(tone_want)(f, p, slots, y, x, n, &w);
	for (int k = 0; k < TONE_SLOTS; k++) {
		if (!w.any[k] || !tone_marked(slots + k))
			continue;
		for (int i = 0; i < n; i++) {
			float here = w.share[k][i];
			slot[i] = here > best[i] ? k : slot[i];
			best[i] = max(best[i], here);
			share[i] += here;
			sum[i] += here * w.dark[k][i];
		}
	}
	for (int i = 0; i < n; i++) {
		float mean = clamp01(sum[i] / max(share[i], 1e-30f));
		dark[i] = (uint8_t)(int)(share[i] > 0 ? 255 * mean + 0.5f : 0);
		whose[i] = (uint8_t)slot[i];
		shares[i] = (uint8_t)(int)(255 * min(share[i], 1) + 0.5f);
	}
	close_print(f, y, x, n, dark);
	for (int i = 0; i < n; i++)
		found[whose[i]] |= dark[i];
	for (int k = 0; k < TONE_SLOTS; k++)
		any |= found[k] ? 1u << k : 0;
	return any;
}

/* ---- places ------------------------------------------------------------------------------------------------ */

static uint32_t stir(uint32_t h, uint32_t k)
{
	h = (h ^ k) * 2654435761u;
	h ^= h >> 15;
	h *= 2246822519u;
	return h ^ h >> 13;
}

static float share_of(uint32_t h)
{
	return (float)(h >> 8) * 0x1p-24f;
}

/* A number along an axis whatever the octave: odd * 2^exponent. */
typedef struct dyadic {
	int32_t odd, exponent;
} dyadic;

static dyadic dyadic_of(float whole, float scale)
{
	int32_t n = (int32_t)whole, exponent = -(float_bits(scale) >> 23);
	if (n == 0)
		return (dyadic){0, 0};
	int twos = __builtin_ctz((unsigned)n);
	return (dyadic){n / (1 << twos), exponent + twos};
}

/* The layers' lattices lie beside each other. */
static const float beside[TONE_LAYERS] = {0, 0.381966f, 0.763932f};

/* The way in pixels from the middle of pixel i to the point of a layer's lattice that is nearest to it. */
static inline void nearest_point(const tone_lattice *l, int layer, int i, float whole[2], float way[2])
{
	way[0] = way[1] = 0;
	for (int k = 0; k < 2; k++) {
		float at = 2 * (l->at[k][i] + beside[layer] * l->scale[k][i]);
		whole[k] = floorf(at + 0.5f);
		float off = 0.5f * (whole[k] - at);
		way[0] += off * l->across[k][i];
		way[1] += off * l->up[k][i];
	}
}

/* Whether a point of a layer's lattice is in pixel i. */
static inline int holds(const tone_lattice *l, int layer, int i, float way[2])
{
	float whole[2];
	nearest_point(l, layer, i, whole, way);
	int near = max(fabsf(way[0]), fabsf(way[1])) <= held_within, known = l->flat[i] <= 0,
	    counts = max(fabsf(whole[0]), fabsf(whole[1])) < 1e9f;
	return near & known & counts;
}

/* Sets a layer's bit of pixels in which a point of its lattice is. */
static void hold(const tone_lattice *l, int layer, int n, uint8_t *restrict bits)
{
	for (int i = 0; i < n; i++) {
		float way[2];
		bits[i] = (uint8_t)(bits[i] | (holds(l, layer, i, way) ? TONE_FOUND << layer : 0));
	}
}

/* How far marks are shifted along an axis, in pitches. Strokes along the rows of the other axis would cover each other
 * and leave gaps between the rows, so that there was too little ink; theirs fill the whole of what is between rows. */
static float shift_of(const float way[2], float row_x, float row_y)
{
	float length = sqrtf(row_x * row_x + row_y * row_y);
	float sine = fabsf(way[0] * row_y - way[1] * row_x) / max(length, 1e-6f);
	return mix(jitter, 1, clamp01(2 - sine / beside_rows));
}

/* Of some pixels of a row what tells the marks whose places are in them. */
typedef struct places {
	const tone_slot *s;
	const tone_rest *rest; /* NULL: they are the screen's */
	tone_rest own;
	tone_lattice lattice;
} places;

/* columns: of n pixels from x to x + TONE_CHUNK - 1, ascending. */
static void places_fill(const frame *f, const tone_slot *s, int y, int x, const int *columns, int n, places *p)
{
	tone_field chart[2];
	p->s = s;
	p->rest = NULL;
	for (int i = 0; tone_sticks(s) && i < n; i++) {
		float room[ANCHOR_COUNT];
		const float *anchor = ISA(tone_anchor)(f, s, y, columns[i], 1, room);
		for (int c = 0; anchor && c < ANCHOR_COUNT; c++)
			p->own.at[c][i] = anchor[c];
		p->rest = anchor ? &p->own : NULL;
	}
	ISA(tone_chart)(f, s, p->rest, y, x, p->rest ? n : columns[n - 1] - x + 1, chart);
	for (int k = 0; k < 2 && !p->rest; k++)
		for (int i = 0; i < n; i++) {
			chart[k].at[i] = chart[k].at[columns[i] - x];
			chart[k].right[i] = chart[k].right[columns[i] - x];
			chart[k].down[i] = chart[k].down[columns[i] - x];
		}
	ISA(tone_lattice_fill)(s->least, s->most, n, chart, &p->lattice);
}

/* The mark whose place is in the i-th of these, pixel x. */
static tone_mark mark_at(const frame *f, const tone_marks *m, const places *p, int i, int layer, int x, int y)
{
	const tone_slot *s = p->s;
	const tone_rest *rest = p->rest;
	const tone_lattice *l = &p->lattice;
	float whole[2], way[2], weight = 1;
	nearest_point(l, layer, i, whole, way);
	uint32_t h = stir(0x9e3779b9u, (uint32_t)(TONE_LAYERS * (rest ? tone_axis(rest, i) : 0) + layer));
	dyadic place[2];
	for (int k = 0; k < 2; k++) {
		weight *= (int32_t)whole[k] & 1 ? l->grown[k][i] : 1;
		place[k] = dyadic_of(whole[k], l->scale[k][i]);
		h = stir(h, (uint32_t)place[k].exponent);
	}
	/* A rank of low discrepancy among those of an octave, so that few are spread as evenly as many. */
	uint32_t rank = h + (uint32_t)place[0].odd * 3242174889u + (uint32_t)place[1].odd * 2447445413u;
	h = stir(stir(h, (uint32_t)place[0].odd), (uint32_t)place[1].odd);
	uint32_t name = h;
	int32_t off = (int32_t)(256 * (way[0] * way[0] + way[1] * way[1]) + 0.5f);
	const float *along = m->way[tone_bytes(m, TONE_WAY + layer, y)[x]];
	for (int k = 0; k < 2; k++) {
		float length = sqrtf(l->across[k][i] * l->across[k][i] + l->up[k][i] * l->up[k][i]);
		float shift = shift_of(along, l->across[1 - k][i], l->up[1 - k][i]);
		h = stir(h, 1);
		float aside = (share_of(h) - 0.5f) * shift * l->pitch[k][i] / max(length, 1e-6f);
		way[0] += aside * l->across[k][i];
		way[1] += aside * l->up[k][i];
	}
	weight *= rest ? ISA(tone_grown_beside_seam)(f, s, rest, i, x, y) : 1;
	float size = sqrtf(weight), turn, pitch = sqrtf(l->pitch[0][i] * l->pitch[1][i]);
	h = stir(h, 2);
	turn = (share_of(h) - 0.5f) * 0.1f;
	h = stir(h, 3);
	float length = stroke_length * pitch * min(size * (0.7f + 0.6f * share_of(h)), 1.3f);
	return (tone_mark){
		.x = (float)(f->place.x + x) + 0.5f + way[0],
		.y = (float)(f->place.y + y) + 0.5f + way[1],
		.size = size,
		.rank = share_of(rank),
		.pitch = pitch,
		.reach = 0.5f * length,
		.turn = turn,
		.slot = s,
		.column = x,
		.name = name,
		.off = off,
		.layer = (uint8_t)layer,
	};
}

/* ---- passes ------------------------------------------------------------------------------------------------ */

static void look_at(const frame *f, const tone_marks *m, const tone_slot *slots, unsigned any, int y, int x, int n,
		    int thread)
{
	uint8_t *dark = tone_bytes(m, TONE_DARK, y) + x, *bits = tone_bytes(m, TONE_BITS, y) + x;
	const uint8_t *whose = tone_bytes(m, TONE_WHOSE, y) + x;
	for (int k = 0; k < TONE_SLOTS; k++) {
		const tone_slot *s = slots + k;
		if (!(any >> k & 1))
			continue;
		tone_field chart[2];
		tone_lattice l;
		tone_rest own;
		uint8_t found[TONE_CHUNK] = {0};
		const tone_rest *rest = tone_sticks(s) ? ISA(tone_rest_fill)(f, s, y, x, n, &own) : NULL;
		fetch_ahead(f, thread);
		if (s->kind == tone_1_HATCH) {
			ISA(tone_chart)(f, s, rest, y, x, n, chart);
			fetch_ahead(f, thread);
			ISA(tone_lattice_fill)(s->least, s->most, n, chart, &l);
			for (int layer = 0; layer < TONE_LAYERS; layer++)
				hold(&l, layer, n, found);
			ISA(tone_ways)(f, m, slots, k, rest, y, x, n);
		}
		fetch_ahead(f, thread);
		for (int i = 0; rest && i < n; i++)
			found[i] = rest->at[ANCHOR_PIXEL][i] > 0 ? found[i] : TONE_LOST;
		for (int i = 0; i < n; i++) {
			int most = dark[i] == 0 ? 0 : dark[i] + DARKER_BESIDE < 255 ? dark[i] + DARKER_BESIDE : 255;
			unsigned wanted = TONE_LOST | m->layers[most];
			bits[i] = (uint8_t)(bits[i] | (whose[i] == k ? found[i] & wanted : 0));
		}
	}
}

int ISA(tone_marks_look)(const frame *f, const tone_marks *m, int y, int thread)
{
	uint8_t *dark = tone_bytes(m, TONE_DARK, y), *bits = tone_bytes(m, TONE_BITS, y);
	int n = 0;
	memset(dark, 0, (size_t)TONE_BYTES * (size_t)f->width);
	memset(tone_ink(m, y), 0, (size_t)f->width * sizeof *m->ink);
	for (int x = 0, end; x < f->width; x = end) {
		int most = f->width - x > TONE_TOGETHER ? x + TONE_TOGETHER : f->width;
		const encre_params *p = style_run(f, y, x, most, &end);
		const tone_slot *slots = m->styles[p - f->params].slot;
		unsigned any = ISA(tone_marks_wanted)(p)
				       ? darken(f, p, slots, y, x, end - x, dark + x, tone_bytes(m, TONE_WHOSE, y) + x,
						tone_bytes(m, TONE_SHARE, y) + x)
				       : 0;
		fetch_ahead(f, thread);
		if (any)
			look_at(f, m, slots, any, y, x, end - x, thread);
	}
	for (int x = 0; x < f->width; x++)
		n += (bits[x] >> 4 & 1) + (bits[x] >> 5 & 1) + (bits[x] >> 6 & 1);
	return n;
}

static const tone_slot *slot_at(const frame *f, const tone_marks *m, const uint8_t *whose, int x, int y)
{
	return m->styles[style_at(f, x, y)].slot + whose[x];
}

void ISA(tone_marks_find)(const frame *f, const tone_marks *m, int y, tone_mark *marks)
{
	const uint8_t *bits = tone_bytes(m, TONE_BITS, y), *whose = tone_bytes(m, TONE_WHOSE, y);
	places p;
	for (int x0 = 0; x0 < f->width; x0 += TONE_CHUNK) {
		int end = f->width - x0 > TONE_CHUNK ? x0 + TONE_CHUNK : f->width, n = 0, columns[TONE_CHUNK];
		for (int x = x0; x < end; x++)
			if (bits[x] & TONE_PLACES)
				columns[n++] = x;
		/* they lie far apart, and across two lines of the cache */
		for (int i = 0; i < n && anchor_at(f, 0, y); i++) {
			__builtin_prefetch(anchor_at(f, columns[i], y));
			__builtin_prefetch(anchor_at(f, columns[i], y) + ANCHOR_COUNT - 1);
		}
		for (int i = 0, same; i < n; i += same) {
			const tone_slot *s = slot_at(f, m, whose, columns[i], y);
			for (same = 0; i + same < n && s == slot_at(f, m, whose, columns[i + same], y);)
				same++;
			int last = columns[i + same - 1] + 1;
			if (s->kind == tone_1_STIPPLE) {
				bool lacks;
				marks += ISA(tone_spots_find)(f, m, y, columns[i], last - columns[i], marks, &lacks);
				continue;
			}
			places_fill(f, s, y, x0, columns + i, same, &p);
			for (int k = 0; k < same; k++)
				for (int layer = 0, x = columns[i + k]; layer < TONE_LAYERS; layer++)
					if (bits[x] / TONE_FOUND >> layer & 1)
						*marks++ = mark_at(f, m, &p, k, layer, x, y);
		}
	}
}

void ISA(tone_marks_sift)(const frame *f, const tone_marks *m, int y)
{
	for (int row = tone_within(y - 1, f->height); row <= tone_within(y + 1, f->height); row++) {
		int64_t from = m->first[row], end = m->first[row + 1];
		for (int64_t i = m->first[y]; i < m->first[y + 1]; i++) {
			tone_mark *mark = m->marks + i;
			while (from < end && m->marks[from].column < mark->column - 1)
				from++;
			for (int64_t k = from; k < end && m->marks[k].column <= mark->column + 1; k++) {
				const tone_mark *beside = m->marks + k;
				bool nearer = beside->off < mark->off || (beside->off == mark->off && k < i);
				mark->other |= nearer && beside->name == mark->name && beside->layer == mark->layer;
			}
		}
	}
}
