/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise that sticks to things: gradient noise (Perlin 2002) in the rest position, on the lattice that a pixel's size
 * asks for, mixed with that of twice its cells by how far the size lies between them, so that it neither pops nor swims
 * as the camera comes nearer. Each corner has two gradients, and a look-up gives two noises that know nothing of each
 * other. */
#ifndef ENCRE_SOLID_H
#define ENCRE_SOLID_H

#include "base/stage.h"

/* Where a pixel is: on the thing at rest, or of what has no rest position in the full frame. */
typedef struct solid_place {
	float at[3], pixel; /* pixel: how much of `at` it spans */
	uint32_t key;       /* of the thing */
} solid_place;

static inline solid_place solid_place_of(const frame *f, int x, int y)
{
	const float *anchor = anchor_at(f, x, y), *object = layer_row(f, ENCRE_LAYER_OBJECT, y);
	if (!anchor || !(anchor[ANCHOR_PIXEL] > 0))
		return (solid_place){{(float)(f->place.x + x), (float)(f->place.y + y), 0}, 1, 0};
	float number = object ? object[x] : 0;
	uint32_t key = 1 + (uint32_t)(int32_t)max(min(number, 1e9f), -1e9f);
	return (solid_place){{anchor[0], anchor[1], anchor[2]}, anchor[ANCHOR_PIXEL], key};
}

static inline float solid_eased(float t)
{
	return t * t * t * (t * (t * 6 - 15) + 10);
}

enum { SOLID_CORNERS = 8, SOLID_OCTAVES = 2 };

/* A number of each corner: loops over eight are unrolled before anything makes one instruction of them. */
typedef float solid_corners __attribute__((vector_size(SOLID_CORNERS * sizeof(float))));

/* Gradients at the corners of the cell that was looked at last: pixels beside each other mostly lie in one. */
typedef struct solid_cell {
	int32_t cell[3];
	uint32_t key;
	bool known;
	solid_corners gradient[2][3];
} solid_cell;

/* Of one noise along a row; all zero to begin with. */
typedef struct solid_memory {
	solid_cell octave[SOLID_OCTAVES];
} solid_memory;

static inline void solid_fill(solid_cell *m, const int32_t cell[3], uint32_t key)
{
	/* the twelve edges of a cube, four of them twice */
	static const float edge[16][3] = {{1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
					  {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1},
					  {1, 1, 0},  {0, -1, 1},  {-1, 1, 0}, {0, -1, -1}};
	uint32_t column[2], row[4];
	m->known = true;
	m->key = key;
	for (int c = 0; c < 3; c++)
		m->cell[c] = cell[c];
	for (int k = 0; k < 2; k++)
		column[k] = mix_bits(key + (uint32_t)cell[0] + (uint32_t)k);
	for (int k = 0; k < 4; k++)
		row[k] = mix_bits(column[k & 1] + (uint32_t)cell[1] + (uint32_t)(k >> 1));
	for (int k = 0; k < SOLID_CORNERS; k++) {
		uint32_t h = mix_bits(row[k & 3] + (uint32_t)cell[2] + (uint32_t)(k >> 2));
		const float *one = edge[h & 15], *two = edge[h >> 16 & 15];
		for (int c = 0; c < 3; c++) {
			m->gradient[0][c][k] = one[c];
			m->gradient[1][c][k] = two[c];
		}
	}
}

/* Adds `share` of both noises at a place in cells. */
static inline void solid_add(const float place[3], uint32_t key, float share, solid_cell *m, float out[2])
{
	static const float far = 4e6f;
	static const solid_corners right = {0, 1, 0, 1, 0, 1, 0, 1}, down = {0, 0, 1, 1, 0, 0, 1, 1},
				   deep = {0, 0, 0, 0, 1, 1, 1, 1};
	float in[3], ease[3];
	int32_t cell[3];
	for (int c = 0; c < 3; c++) {
		float at = max(min(place[c], far), -far), whole = floorf(at);
		cell[c] = (int32_t)whole;
		in[c] = at - whole;
		ease[c] = solid_eased(in[c]);
	}
	if (!m->known || m->key != key || m->cell[0] != cell[0] || m->cell[1] != cell[1] || m->cell[2] != cell[2])
		solid_fill(m, cell, key);
	solid_corners part = (1 - ease[0] + right * (2 * ease[0] - 1)) * (1 - ease[1] + down * (2 * ease[1] - 1)) *
			     (1 - ease[2] + deep * (2 * ease[2] - 1));
	for (int j = 0; j < 2; j++) {
		const solid_corners *g = m->gradient[j];
		solid_corners s = part * (g[0] * (in[0] - right) + g[1] * (in[1] - down) + g[2] * (in[2] - deep));
		out[j] += share * (((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7])));
	}
}

/* Two noises about -1..1, whose hills are so many pixels apart. */
static inline void solid_noise(const solid_place *p, float size, uint32_t seed, solid_memory *m, float out[2])
{
	float target = p->pixel * size;
	out[0] = out[1] = 0;
	if (!(target > 1e-30f && target < 1e30f))
		return;
	int32_t bits = float_bits(target), octave = (bits >> 23) - 127;
	float rest = bits_float((bits & 0x7fffff) | 0x3f800000) - 1;
	float scale = 1.6f / sqrtf((1 - rest) * (1 - rest) + rest * rest);
	for (int k = 0; k < SOLID_OCTAVES; k++) {
		float cells = bits_float((127 - octave - k) << 23), x = p->at[0] * cells, y = p->at[1] * cells,
		      z = p->at[2] * cells;
		/* turned, so that its planes lie along no wall */
		float turned[3] = {0.36f * x + 0.48f * y - 0.8f * z, 0.6f * y - 0.8f * x,
				   0.48f * x + 0.64f * y + 0.6f * z};
		uint32_t key = mix_bits(seed * 7919u + mix_bits((uint32_t)(octave + k) + 77u) + p->key * 2654435761u);
		solid_add(turned, key, scale * (k ? rest : 1 - rest), m->octave + k, out);
	}
}

#endif
