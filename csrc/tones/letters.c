/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far what hangs together is a word: how surely, how much of it is strokes, and whether it lies in a plane. */
#include "tones/words.h"

static const float whole = 6; /* of a word one in so many pixels, surely fine, is enough */
/* How many times its strokes, laid end to end, are as long as wide: two eyes 10 to 12.5, a letter 10 to 30. */
static const float two_eyes = 12, word = 15;
static const float outline = 0.45f;   /* of what is about a word: little wider than a line */
static const float slanted = 0.97f;   /* cosine of what is still of one plane */
static const float flat_share = 0.6f; /* so much of a flat thing is */

/* How surely what hangs together over what is open is a word: wholly from half of the sureness on that its pixels have,
 * each of which counts as much as it is sure, for where strokes meet they are long; less where hardly any are, as of
 * bars that folds cut to pieces. */
uint8_t ISA(word_sureness)(const work *w, const uint8_t *sure, size_t count)
{
	size_t all = 0;
	uint64_t sum = 0, squares = 0;
	for (size_t k = 0; k < count; k++) {
		bool counts = details(w)[w->open[k]] != 0;
		uint64_t own = counts ? sure[w->open[k]] : 0;
		all += counts;
		sum += own;
		squares += own * own;
	}
	if (sum == 0)
		return 0;
	float mean = (float)sum / (255 * (float)all), own = (float)squares / (float)sum;
	return (uint8_t)(int)(min(2 * own * most_one(whole * mean), 255) + 0.5f);
}

/* How much of what is about light things that hang together is: round ones are eyes, which have an outline. Beside a
 * pupil, which is darker than what the eye lies on, it has no edge; the hole of a letter shows that, and is one. */
uint8_t ISA(word_strokes)(const work *w, size_t count)
{
	size_t area = 0, edges[2] = {0}, sum[2] = {0};
	for (size_t k = 0; k < count; k++) {
		spot to[4];
		if (!details(w)[w->open[k]])
			continue;
		area++;
		for (int n = beside(w, spot_of(w, w->open[k]), to) - 1; n >= 0; n--) {
			bool inside = w->d->dark[to[n].i] != 0, is_edge = !details(w)[to[n].i];
			edges[inside] += is_edge;
			sum[inside] += is_edge ? w->d->value[to[n].i] : 0;
		}
	}
	float about = (float)sum[0] / max((float)edges[0], 1), within = (float)sum[1] / max((float)edges[1], 1);
	float pupil = edges[0] ? clamp01((about - within - 2) * 0.25f) : 0;
	float edge = (float)edges[0] + (1 - pupil) * (float)edges[1], length = edge * edge / (4 * (float)area);
	return (uint8_t)(int)(255 * mix(outline, 1, clamp01((length - two_eyes) / (word - two_eyes))) + 0.5f);
}

/* A normal in whole numbers, whose sums are the same in any order; 0 where there is none. */
static void normal_of(const work *w, uint32_t i, int way[3])
{
	spot s = spot_of(w, i);
	const float *n = layer_row(w->f, ENCRE_LAYER_NORMAL, s.y) + (ptrdiff_t)3 * s.x;
	float size2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
	bool there = size2 > 0 && size2 < INFINITY;
	for (int c = 0; c < 3; c++)
		way[c] = there ? (int)(1000 * (n[c] / sqrtf(size2))) : 0;
}

/* Whether light things that hang together lie in one plane, 255 or 0: letters do, though the sides of raised ones are
 * seen; eyes, brows and hair do not. */
uint8_t ISA(word_flatness)(const work *w, size_t count)
{
	int64_t sum[3] = {0}, all = 0, along = 0;
	int way[3];
	if (!w->f->layer[ENCRE_LAYER_NORMAL].data)
		return 255;
	for (size_t k = 0; k < count; k++) {
		normal_of(w, w->open[k], way);
		for (int c = 0; c < 3; c++)
			sum[c] += details(w)[w->open[k]] ? way[c] : 0;
	}
	float x = (float)sum[0], y = (float)sum[1], z = (float)sum[2],
	      least = 1000 * slanted * sqrtf(x * x + y * y + z * z);
	for (size_t k = 0; k < count; k++) {
		normal_of(w, w->open[k], way);
		bool own = details(w)[w->open[k]] != 0;
		all += own;
		along += own && (float)way[0] * x + (float)way[1] * y + (float)way[2] * z > least;
	}
	return (float)along > flat_share * (float)all ? 255 : 0;
}
