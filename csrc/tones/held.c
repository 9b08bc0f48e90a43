/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How things are turned. Toward a light that stands still the way on a limb that swings is another from frame to frame,
 * and strokes would slip over it: they lie nearly as the light falls on the thing at rest, turned as the thing is as a
 * whole. That is the mean of how its pixels are turned from the layer `anchor`. */
#include "tones/strokes.h"

#include <string.h>

enum { APART = 4 /* pixels of the full frame between those that are asked */, TRIES = 32 };

static const float least_facing = 0.1f; /* a surface that is seen on its edge tells nothing */

/* The entry of an object, or the one that it may take; NULL: there are too many. */
static tone_turn *entry_of(tone_turn *turns, float object)
{
	uint32_t at = (uint32_t)float_bits(object) * 2654435761u >> 16;
	for (uint32_t k = 0; k < TRIES; k++) {
		tone_turn *t = turns + (at + k) % TONE_TURNS;
		if (!t->taken || t->object == object)
			return t;
	}
	return NULL;
}

const float *ISA(tone_turn_of)(const tone_marks *m, float object)
{
	const tone_turn *t = m->turns ? entry_of(m->turns, object) : NULL;
	return t && t->taken ? t->by : NULL;
}

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Makes it one long; false: it has no length. */
static bool unit(float v[3])
{
	float square = dot(v, v);
	if (!(square > 1e-30f && square < 1e30f))
		return false;
	for (int c = 0; c < 3; c++)
		v[c] /= sqrtf(square);
	return true;
}

/* Three directions at right angles, of which the last is the normal, from where pixels to the right and below lie;
 * false: there are none. */
static bool axes(float right[3], float down[3], const float normal[3])
{
	if (!unit(right))
		return false;
	float along = dot(right, down), out = dot(normal, down);
	for (int c = 0; c < 3; c++)
		down[c] -= along * right[c] + out * normal[c];
	return unit(down);
}

/* How a pixel's surface is turned from rest, seen by the camera, by how far it faces it. */
static void add_pixel(const frame *f, int x, int y, tone_turn *turn)
{
	const float *anchor = anchor_at(f, x, y), *n = layer_row(f, ENCRE_LAYER_NORMAL, y) + (ptrdiff_t)3 * x,
		    *v = f->camera.view;
	float rest[3][3], seen[3][3] = {{1, 0, 0}, {0, -1, 0}, {dot(v, n), dot(v + 3, n), dot(v + 6, n)}};
	memcpy(rest[0], anchor + ANCHOR_RIGHT, sizeof rest[0]);
	memcpy(rest[1], anchor + ANCHOR_DOWN, sizeof rest[1]);
	memcpy(rest[2], anchor + ANCHOR_NORMAL, sizeof rest[2]);
	if (!unit(rest[2]) || !unit(seen[2]) || seen[2][2] < least_facing)
		return;
	seen[0][2] = -seen[2][0] / seen[2][2];
	seen[1][2] = seen[2][1] / seen[2][2];
	/* the resting normal may be that of a smooth surface */
	float out = dot(rest[0], rest[2]);
	for (int c = 0; c < 3; c++)
		rest[0][c] -= out * rest[2][c];
	if (!axes(rest[0], rest[1], rest[2]) || !axes(seen[0], seen[1], seen[2]))
		return;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			for (int k = 0; k < 3; k++)
				turn->by[3 * i + j] += seen[2][2] * seen[k][i] * rest[k][j];
}

/* One after the other, in the order of rows, so that the sums are the same on any number of threads. */
void ISA(tone_turns_find)(const frame *f, tone_marks *m)
{
	const encre_frame *o = &f->place;
	if (!m->turns)
		return;
	memset(m->turns, 0, TONE_TURNS * sizeof *m->turns);
	if (!f->layer[ENCRE_LAYER_NORMAL].data || !anchor_at(f, 0, 0))
		return;
	for (int y = 0; y < f->height && !bands_stopped(f->bands); y++) {
		const float *objects = layer_row(f, ENCRE_LAYER_OBJECT, y);
		for (int x = 0; (o->y + y) % APART == 0 && x < f->width; x++) {
			if ((o->x + x) % APART || !(anchor_at(f, x, y)[ANCHOR_PIXEL] > 0))
				continue;
			float object = objects ? objects[x] : 0;
			tone_turn *t = entry_of(m->turns, object);
			if (!t)
				continue;
			t->object = object;
			t->taken = true;
			add_pixel(f, x, y, t);
		}
	}
}
