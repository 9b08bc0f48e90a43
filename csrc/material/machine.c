/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The machine: runs a material's program for a block of pixels, operation by operation, so that each is one loop over
 * adjacent numbers. */
#include "base/pixel.h"
#include "material/material.h"

#include <math.h>
#include <string.h>

/* x^y; of negative x for whole y, else 0. */
static inline float signed_power(float x, float y)
{
	float size = fabsf(x) > 0 && y < 0 ? 1 / max(fabsf(x), 1e-30f) : fabsf(x);
	float power = pixel_pow(min(size, 1e30f), fabsf(y));
	float odd = y - 2 * floorf(y * 0.5f);
	return x >= 0 ? power : odd == 0 ? power : odd == 1 ? -power : 0;
}

/* As pixel_atan2() wants its operands. */
static inline float far_from_nothing(float x)
{
	float size = fabsf(x);
	return size > 1e-30f ? min(max(x, -1e30f), 1e30f) : 0;
}

#define EACH(name, inputs, value, jumps, reach)                                                                        \
	void ISA(run_##name)(const block *k, const encre_operation *o, const float *const in[], float *const out[])    \
	{                                                                                                              \
		(void)k, (void)o;                                                                                      \
		const float *restrict first = in[0], *restrict second = in[1], *restrict third = in[2];                \
		float *restrict to = out[0];                                                                           \
		for (int i = 0; i < MATERIAL_BLOCK; i++) {                                                             \
			float a = first[i], b = second[i], c = third[i];                                               \
			(void)b, (void)c;                                                                              \
			to[i] = value;                                                                                 \
		}                                                                                                      \
	}                                                                                                              \
	static void reach_##name(const block *k, const encre_operation *o, const float *const in[],                    \
				 const float *const by[], float *const out[])                                          \
	{                                                                                                              \
		(void)k, (void)o;                                                                                      \
		const float *restrict first = in[0], *restrict second = in[1], *restrict third = in[2];                \
		const float *restrict one = by[0], *restrict two = by[1], *restrict three = by[2];                     \
		float *restrict to = out[0];                                                                           \
		for (int i = 0; i < MATERIAL_BLOCK; i++) {                                                             \
			float a = first[i], b = second[i], c = third[i], da = one[i], db = two[i], dc = three[i];      \
			(void)a, (void)b, (void)c, (void)da, (void)db, (void)dc;                                       \
			float most = reach;                                                                            \
			to[i] = most >= 0 ? most : INFINITY;                                                           \
		}                                                                                                      \
	}
#define OPERATION(name, inputs, outputs, jumps, reach)
#include "material/operations.rows.h"

static void fill(float *to, float value)
{
	for (int i = 0; i < MATERIAL_BLOCK; i++)
		to[i] = value;
}

#define RUN(name)                                                                                                      \
	void ISA(run_##name)(const block *b, const encre_operation *o, const float *const in[], float *const out[])
#define REACH(name)                                                                                                    \
	void ISA(reach_##name)(const block *b, const encre_operation *o, const float *const in[],                      \
			       const float *const by[], float *const out[])

REACH(same)
{
	(void)b, (void)in, (void)by;
	for (int k = 0; k < operation_info(o->code)->outputs; k++)
		fill(out[k], 0);
}

REACH(unknown)
{
	(void)b, (void)in;
	const encre_operation_description *what = operation_info(o->code);
	float most[MATERIAL_BLOCK] = {0};
	for (int k = 0; k < what->inputs; k++)
		for (int i = 0; i < MATERIAL_BLOCK; i++)
			most[i] = by[k][i] > 0 ? INFINITY : most[i];
	for (int k = 0; k < what->outputs; k++)
		memcpy(out[k], most, sizeof most);
}

RUN(constant)
{
	(void)in;
	fill(out[0], b->materials->constants[o->data[0]]);
}

/* What is `own` in the middle of the pixels, where they are looked at. */
static void look(const block *b, const float *restrict own, const float *restrict right, const float *restrict down,
		 float *restrict to)
{
	if (b->aside[0] == 0 && b->aside[1] == 0) { /* how it grows may be unknown */
		memcpy(to, own, MATERIAL_BLOCK * sizeof *to);
		return;
	}
	for (int i = 0; i < MATERIAL_BLOCK; i++)
		to[i] = own[i] + b->aside[0] * right[i] + b->aside[1] * down[i];
}

/* By how much that differs within the pixels. */
static void look_about(const float *restrict right, const float *restrict down, float *restrict to)
{
	for (int i = 0; i < MATERIAL_BLOCK; i++) {
		float most = 0.5f * (fabsf(right[i]) + fabsf(down[i]));
		to[i] = most >= 0 ? most : INFINITY;
	}
}

RUN(channel)
{
	(void)in;
	int c = o->data[0];
	look(b, b->channel[c], b->right[c], b->down[c], out[0]);
}

REACH(channel)
{
	(void)in, (void)by;
	look_about(b->right[o->data[0]], b->down[o->data[0]], out[0]);
}

RUN(place)
{
	(void)in, (void)o;
	for (int c = 0; c < 3; c++)
		look(b, b->place[c], b->beside[0][c], b->beside[1][c], out[c]);
}

REACH(place)
{
	(void)o, (void)in, (void)by;
	for (int c = 0; c < 3; c++)
		look_about(b->beside[0][c], b->beside[1][c], out[c]);
}

RUN(normal)
{
	(void)in, (void)o;
	for (int c = 0; c < 3; c++)
		memcpy(out[c], b->normal[c], sizeof b->normal[c]);
}

RUN(incoming)
{
	(void)in, (void)o;
	for (int c = 0; c < 3; c++)
		memcpy(out[c], b->incoming[c], sizeof b->incoming[c]);
}

RUN(camera)
{
	(void)in, (void)o;
	for (int c = 0; c < 5; c++)
		memcpy(out[c], b->camera[c], sizeof b->camera[c]);
}

RUN(beside)
{
	(void)in, (void)o;
	for (int c = 0; c < 6; c++)
		memcpy(out[c], b->beside[c / 3][c % 3], sizeof b->beside[0][0]);
}

RUN(thing)
{
	(void)in;
	const encre_materials *m = b->materials;
	for (int i = 0; i < MATERIAL_BLOCK; i++) {
		size_t number = (size_t)b->thing[i];
		out[0][i] = b->thing[i] >= 0 && b->thing[i] < m->n_things
				    ? m->things[number * (size_t)m->n_values + (size_t)o->data[0]]
				    : 0;
	}
}

RUN(footprint)
{
	(void)in;
	const float *by = b->materials->constants + o->data[1];
	for (int k = 0; k < 4; k++) {
		const float (*step)[MATERIAL_BLOCK] = (k < 2 ? b->right : b->down) + o->data[0];
		const float *row = by + 3 * (k & 1);
		for (int i = 0; i < MATERIAL_BLOCK; i++)
			out[k][i] = row[0] * step[0][i] + row[1] * step[1][i] + row[2] * step[2][i];
	}
}

/* Stop k of a ramp: its place, then its colour. */
static const float *stop_at(const float *stops, int k)
{
	return stops + (size_t)5 * (size_t)k;
}

/* The last of n stops that comes before x. */
static int stop_before(const float *stops, int n, float x)
{
	int k = 0;
	while (k + 1 < n && x >= stop_at(stops, k + 1)[0])
		k++;
	return k;
}

RUN(ramp)
{
	const float *stops = b->materials->constants + o->data[0];
	int n = o->data[1];
	for (int i = 0; i < b->n; i++) {
		int k = stop_before(stops, n, in[0][i]);
		const float *from = stop_at(stops, k), *to = stop_at(stops, k + 1 < n ? k + 1 : k);
		float wide = to[0] - from[0], t = wide > 0 ? clamp01((in[0][i] - from[0]) / wide) : 0;
		for (int c = 0; c < 4; c++)
			out[c][i] = mix(from[1 + c], to[1 + c], t);
	}
}

RUN(steps)
{
	const float *stops = b->materials->constants + o->data[0];
	for (int i = 0; i < b->n; i++) {
		int k = stop_before(stops, o->data[1], in[0][i]);
		for (int c = 0; c < 4; c++)
			out[c][i] = stop_at(stops, k)[1 + c];
	}
}

REACH(steps)
{
	const float *stops = b->materials->constants + o->data[0];
	int n = o->data[1];
	for (int i = 0; i < b->n; i++) {
		float x = in[0][i], d = by[0][i];
		bool same = stop_before(stops, n, x - d) == stop_before(stops, n, x + d);
		for (int c = 0; c < 4; c++)
			out[c][i] = same ? 0 : INFINITY;
	}
}

RUN(curve)
{
	const float *table = b->materials->constants + o->data[0];
	int last = o->data[1] - 1;
	for (int i = 0; i < b->n; i++) {
		float x = clamp01(in[0][i]) * (float)last;
		int k = (int)x < last ? (int)x : last - 1;
		out[0][i] = mix(table[k], table[k + 1], x - (float)k);
	}
}

RUN(to_hsv)
{
	(void)o;
	for (int i = 0; i < b->n; i++) {
		float red = in[0][i], green = in[1][i], blue = in[2][i];
		float most = max3(red, green, blue), span = most - min(min(red, green), blue), hue = 0;
		if (span > 0 && red == most)
			hue = (green - blue) / span;
		else if (span > 0)
			hue = green == most ? 2 + (blue - red) / span : 4 + (red - green) / span;
		out[0][i] = hue < 0 ? hue / 6 + 1 : hue / 6;
		out[1][i] = most > 0 ? span / most : 0;
		out[2][i] = most;
	}
}

RUN(from_hsv)
{
	(void)o;
	for (int i = 0; i < b->n; i++) {
		float turn = 6 * (in[0][i] - floorf(in[0][i]));
		for (int c = 0; c < 3; c++) { /* red leads at 0, green at 2, blue at 4 */
			float way = fabsf(turn - 2 * (float)c);
			float near = min(way, 6 - way);
			out[c][i] = in[2][i] * mix(1, clamp01(2 - near), in[1][i]);
		}
	}
}

typedef struct entry {
	encre_operation_description what;
	operation_run run;
	operation_reach reach;
} entry;

static const entry entries[] = {
#define EACH(name, inputs, value, jumps, reach) {{#name, inputs, 1}, ISA(run_##name), reach_##name},
#define OPERATION(name, inputs, outputs, jumps, reach) {{#name, inputs, outputs}, ISA(run_##name), ISA(reach_##reach)},
#include "material/operations.rows.h"
};

/* By how much what operation k gives differs within the pixels, before it is run: it may be put where its inputs are.
 */
static void reach(block *b, int k, const float *const in[])
{
	const encre_operation *o = b->program->operations + k;
	const entry *e = entries + o->code;
	const float *by[ENCRE_INPUTS];
	float *out[MATERIAL_OUTPUTS];
	for (int i = 0; i < ENCRE_INPUTS; i++)
		by[i] = b->reach + (in[i] - b->reg);
	for (int i = 0; i < e->what.outputs; i++)
		out[i] = b->reach + (size_t)(o->out + i) * MATERIAL_BLOCK;
	e->reach(b, o, in, by, out);
	for (int i = 0; b->wanted[k] & JUMPS && i < MATERIAL_BLOCK; i++)
		b->jump[i] |= out[0][i] > 0;
}

void ISA(material_run)(block *b)
{
	const encre_program *p = b->program;
	memset(b->reg, 0, (size_t)p->n_registers * MATERIAL_BLOCK * sizeof *b->reg);
	if (b->reach)
		memset(b->reach, 0, (size_t)p->n_registers * MATERIAL_BLOCK * sizeof *b->reach);
	for (int k = 0; k < p->n_operations; k++) {
		if (!(b->wanted[k] & b->wants))
			continue;
		const encre_operation *o = p->operations + k;
		const entry *e = entries + o->code;
		const float *in[ENCRE_INPUTS];
		float *out[MATERIAL_OUTPUTS];
		for (int i = 0; i < ENCRE_INPUTS; i++) /* those that it does not take are any */
			in[i] = b->reg + (size_t)(i < e->what.inputs ? o->in[i] : o->in[0]) * MATERIAL_BLOCK;
		for (int i = 0; i < e->what.outputs; i++)
			out[i] = b->reg + (size_t)(o->out + i) * MATERIAL_BLOCK;
		if (b->reach && b->wanted[k] & LEADS_ASIDE)
			reach(b, k, in);
		e->run(b, o, in, out);
	}
}
