/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where screens lie: coordinates of the picture, or of the thing at rest. */
#include "tones/tones.h"

#include <string.h>

void ISA(tone_screen_field)(const frame *f, int y, int x, int n, float right, float down, tone_field *field)
{
	float row = (float)(f->place.y + y) + 0.5f;
	for (int i = 0; i < n; i++) {
		field->at[i] = right * ((float)(f->place.x + x + i) + 0.5f) + down * row;
		field->right[i] = right;
		field->down[i] = down;
	}
}

void ISA(tone_surface_field)(const tone_rest *rest, int n, const float direction[3], float per, tone_field *field)
{
	static const int from[3] = {ANCHOR_POSITION, ANCHOR_RIGHT, ANCHOR_DOWN};
	float along[3] = {direction[0] * per, direction[1] * per, direction[2] * per};
	for (int k = 0; k < 3; k++) {
		const float (*v)[TONE_REST] = rest->at + from[k];
		float *restrict to = k == 0 ? field->at : k == 1 ? field->right : field->down;
		for (int i = 0; i < n; i++)
			to[i] = v[0][i] * along[0] + v[1][i] * along[1] + v[2][i] * along[2];
	}
}

/* A sheet stands upright in x and z, as a wall before the eye. */
const float *ISA(tone_anchor)(const frame *f, const tone_slot *s, int y, int x, int n, float *room)
{
	if (!s || !tone_flat(s))
		return anchor_at(f, x, y);
	const float *card = layer_row(f, ENCRE_LAYER_CARD, y);
	for (int i = 0; card && i < n; i++) {
		const float *c = card + (ptrdiff_t)CARD_COUNT * (x + i);
		float right = c[CARD_RIGHT], up = c[CARD_RIGHT + 1];
		const float sheet[ANCHOR_COUNT] = {[ANCHOR_POSITION] = c[CARD_POSITION],
						   [ANCHOR_POSITION + 2] = c[CARD_POSITION + 1],
						   [ANCHOR_NORMAL + 1] = -1,
						   [ANCHOR_PIXEL] = sqrtf(right * right + up * up),
						   [ANCHOR_RIGHT] = right,
						   [ANCHOR_RIGHT + 2] = up,
						   [ANCHOR_DOWN] = up,
						   [ANCHOR_DOWN + 2] = -right};
		memcpy(room + (ptrdiff_t)ANCHOR_COUNT * i, sheet, sizeof sheet);
	}
	return card ? room : NULL;
}

static float size_on_sheet(const float *card)
{
	return sqrtf(card[CARD_RIGHT] * card[CARD_RIGHT] + card[CARD_RIGHT + 1] * card[CARD_RIGHT + 1]);
}

/* As tone_anchor() tells a sheet. */
static const tone_rest *sheet_fill(const float *restrict card, int n, tone_rest *rest)
{
	memset(rest, 0, sizeof *rest);
	for (int i = 0; i < n; i++) {
		const float *c = card + (ptrdiff_t)CARD_COUNT * i;
		rest->at[ANCHOR_POSITION][i] = c[CARD_POSITION];
		rest->at[ANCHOR_POSITION + 2][i] = c[CARD_POSITION + 1];
		rest->at[ANCHOR_NORMAL + 1][i] = -1;
		rest->at[ANCHOR_PIXEL][i] = size_on_sheet(c);
		rest->at[ANCHOR_RIGHT][i] = c[CARD_RIGHT];
		rest->at[ANCHOR_RIGHT + 2][i] = rest->at[ANCHOR_DOWN][i] = c[CARD_RIGHT + 1];
		rest->at[ANCHOR_DOWN + 2][i] = -c[CARD_RIGHT];
	}
	return rest;
}

#if defined __has_builtin
#if __has_builtin(__builtin_shufflevector)
#define SHUFFLES
#endif
#endif

/* Pixels that are told together, and of which channels. */
enum { LANES = 8, GROUP = 4 };

#ifdef SHUFFLES
typedef float four __attribute__((vector_size(GROUP * sizeof(float))));
typedef float eight __attribute__((vector_size(LANES * sizeof(float))));

/* A pixel's channels beside those of the pixel four on, as instructions keep to halves. */
#define PIXELS(k)                                                                                                      \
	memcpy(&low, anchor + (ptrdiff_t)ANCHOR_COUNT * (k), sizeof low);                                              \
	memcpy(&high, anchor + (ptrdiff_t)ANCHOR_COUNT * ((k) + GROUP), sizeof high);                                  \
	const eight pixels##k = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#define CHANNEL(c, a, b, ...)                                                                                          \
	channel = __builtin_shufflevector(a, b, __VA_ARGS__);                                                          \
	memcpy(to[c], &channel, sizeof channel);
#endif

/* Some channels of some pixels: compilers make twice as many shuffles of the plain loop. */
KERNEL void group_fill(const float *restrict anchor, float (*restrict to)[TONE_REST])
{
#ifdef SHUFFLES
	four low, high;
	eight channel;
	PIXELS(0)
	PIXELS(1)
	PIXELS(2)
	PIXELS(3)
	const eight a = __builtin_shufflevector(pixels0, pixels1, 0, 8, 1, 9, 4, 12, 5, 13),
		    b = __builtin_shufflevector(pixels2, pixels3, 0, 8, 1, 9, 4, 12, 5, 13),
		    c = __builtin_shufflevector(pixels0, pixels1, 2, 10, 3, 11, 6, 14, 7, 15),
		    d = __builtin_shufflevector(pixels2, pixels3, 2, 10, 3, 11, 6, 14, 7, 15);
	CHANNEL(0, a, b, 0, 1, 8, 9, 4, 5, 12, 13)
	CHANNEL(1, a, b, 2, 3, 10, 11, 6, 7, 14, 15)
	CHANNEL(2, c, d, 0, 1, 8, 9, 4, 5, 12, 13)
	CHANNEL(3, c, d, 2, 3, 10, 11, 6, 7, 14, 15)
#else
	for (int c = 0; c < GROUP; c++)
		for (int k = 0; k < LANES; k++)
			to[c][k] = anchor[(ptrdiff_t)ANCHOR_COUNT * k + c];
#endif
}

#undef CHANNEL
#undef PIXELS

static const tone_rest *surface_fill(const float *restrict anchor, int n, tone_rest *restrict rest)
{
	int i = 0;
	for (; i + LANES <= n; i += LANES)
		for (int c = 0; c < ANCHOR_COUNT; c += GROUP)
			group_fill(anchor + (ptrdiff_t)ANCHOR_COUNT * i + c, (float (*)[TONE_REST])(rest->at[c] + i));
	for (; i < n; i++)
		for (int c = 0; c < ANCHOR_COUNT; c++)
			rest->at[c][i] = anchor[(ptrdiff_t)ANCHOR_COUNT * i + c];
	return rest;
}

const tone_rest *ISA(tone_rest_fill)(const frame *f, const tone_slot *s, int y, int x, int n, tone_rest *rest)
{
	n = x + n < f->width ? n + 1 : n;
	const float *anchor = anchor_at(f, x, y), *card = layer_row(f, ENCRE_LAYER_CARD, y);
	if (!s || !tone_flat(s))
		return anchor ? surface_fill(anchor, n, rest) : NULL;
	return card ? sheet_fill(card + (ptrdiff_t)CARD_COUNT * x, n, rest) : NULL;
}

void ISA(tone_surface_chart)(const tone_rest *rest, int n, float cosine, float sine, tone_field field[2])
{
	static const int from[3] = {ANCHOR_POSITION, ANCHOR_RIGHT, ANCHOR_DOWN};
	const float (*normal)[TONE_REST] = rest->at + ANCHOR_NORMAL;
	for (int k = 0; k < 3; k++) {
		const float (*v)[TONE_REST] = rest->at + from[k];
		float *restrict to = k == 0 ? field[0].at : k == 1 ? field[0].right : field[0].down;
		float *restrict too = k == 0 ? field[1].at : k == 1 ? field[1].right : field[1].down;
		for (int i = 0; i < n; i++) {
			float x = fabsf(normal[0][i]), y = fabsf(normal[1][i]), z = fabsf(normal[2][i]);
			int first = (x >= y) & (x >= z), second = (x < z) & (y < z);
			float one = first ? v[1][i] : v[0][i], two = second ? v[1][i] : v[2][i];
			to[i] = cosine * one + sine * two;
			too[i] = cosine * two - sine * one;
		}
	}
}

void ISA(tone_cut)(const tone_rest *rest, int n, const float along[3], float *restrict cut)
{
	const float (*normal)[TONE_REST] = rest->at + ANCHOR_NORMAL;
	for (int i = 0; i < n; i++) {
		float dot = normal[0][i] * along[0] + normal[1][i] * along[1] + normal[2][i] * along[2];
		cut[i] = clamp01((sqrtf(max(1 - dot * dot, 0)) - 0.3f) / 0.12f);
	}
}
