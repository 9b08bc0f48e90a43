/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture along lines, small ones of it for lines that are thin or far, and where links lie in it. */
#include "ink/strips.h"

#include "fine/near.h"

#include <string.h>

enum { MOST = 4096 }; /* texels each way that are read: as many as a line may be pixels wide */

typedef struct making {
	const encre_image *image;
	strip *strip;
	float *ink[STRIP_LEVELS];
	int level;
} making;

static inline float clean(float v)
{
	return v > 0 ? v < 1 ? v : 1 : 0;
}

/* As stored, for it is a mask and no light; what is not there has no ink. */
static void read_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const making *m = data;
	const encre_image image = with_strides(*m->image);
	int wide = m->strip->width[0], high = m->strip->height[0];
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < wide; x++) {
			const float *in = pixel_at(&image, (int)((int64_t)x * image.width / wide),
						   (int)((int64_t)y * image.height / high));
			float grey =
				image.channels < 3 ? clean(in[0]) : luminance(clean(in[0]), clean(in[1]), clean(in[2]));
			m->ink[0][(ptrdiff_t)y * wide + x] = (1 - grey) * (image.channels > 3 ? clean(in[3]) : 1);
		}
}

/* Each texel the mean of four of the level before; of an odd number the last is left out. */
static void halve_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const making *m = data;
	const strip *s = m->strip;
	int before = m->level - 1, wide = s->width[before];
	for (int y = y0; y < y1; y++) {
		const float *above = m->ink[before] + (ptrdiff_t)2 * y * wide,
			    *below = 2 * y + 1 < s->height[before] ? above + wide : above;
		float *out = m->ink[m->level] + (ptrdiff_t)y * s->width[m->level];
		for (int x = 0; x < s->width[m->level]; x++) {
			int left = 2 * x, right = left + 1 < wide ? left + 1 : left;
			out[x] = 0.25f * (above[left] + above[right] + below[left] + below[right]);
		}
	}
}

/* As strip.pair has them: one read brings what is mixed. */
static void pair_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const making *m = data;
	int wide = m->strip->width[m->level], last = m->strip->height[m->level] - 1;
	for (int y = y0; y < y1; y++) {
		const float *above = m->ink[m->level] + (ptrdiff_t)wide * (y > 0 ? y - 1 : 0),
			    *below = m->ink[m->level] + (ptrdiff_t)wide * (y < last ? y : last);
		float (*out)[2] = m->strip->pair[m->level] + (ptrdiff_t)y * (wide + 2);
		for (int x = 0; x < wide + 2; x++) {
			int from = x == 0 ? wide - 1 : x > wide ? 0 : x - 1;
			out[x][0] = above[from];
			out[x][1] = below[from];
		}
	}
}

static int32_t make(frame *f, const encre_image *image, strip *s)
{
	int wide = image->width < MOST ? image->width : MOST, high = image->height < MOST ? image->height : MOST;
	making m = {.image = image, .strip = s};
	*s = (strip){.data = image->data};
	int32_t code = ENCRE_OK;
	for (bool last = false; !code && !last; m.level++) {
		s->width[m.level] = wide;
		s->height[m.level] = high;
		s->levels = m.level + 1;
		m.ink[m.level] = late_take(&f->late, (size_t)wide * (size_t)high, sizeof **m.ink);
		s->pair[m.level] = late_take(&f->late, (size_t)(wide + 2) * (size_t)(high + 1), sizeof **s->pair);
		if (!m.ink[m.level] || !s->pair[m.level])
			return ENCRE_ERROR_MEMORY;
		code = bands_run(f->bands, high, 0, m.level ? halve_rows : read_rows, &m);
		if (!code)
			code = bands_run(f->bands, high + 1, 0, pair_rows, &m);
		last = wide == 1 && high == 1;
		wide = wide > 1 ? wide / 2 : 1;
		high = high > 1 ? high / 2 : 1;
	}
	for (int k = 0; k < s->levels; k++)
		late_drop(&f->late, m.ink[k]);
	return code;
}

/* Whether a pen that draws has one. */
static bool has_one(const frame *f, const pens *all, int style, int pen)
{
	const pens *p = all + style;
	return f->params[style].use_lines && p->used >> pen & 1 && p->hand[pen].pen_strip > 0 && p->strip[pen]->data;
}

int32_t ISA(strips_make)(frame *f, const pens *all, const strip *(**to)[PENS])
{
	strip *made = late_take(&f->late, (size_t)f->n_styles * PENS, sizeof *made);
	*to = late_take(&f->late, (size_t)f->n_styles, sizeof **to);
	if (!made || !*to)
		return ENCRE_ERROR_MEMORY;
	int count = 0;
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < f->n_styles * PENS; i++) {
		int style = i / PENS, pen = i % PENS, same = 0;
		(*to)[style][pen] = NULL;
		if (!has_one(f, all, style, pen))
			continue;
		const encre_image *image = all[style].strip[pen];
		while (same < count && made[same].data != image->data)
			same++;
		if (same == count)
			code = make(f, image, made + count++);
		(*to)[style][pen] = made + same;
	}
	return code;
}

/* Half the length is the whole of the next octave. */
static void go_finer(strip_end *e)
{
	e->at = 2 * e->at - floorf(2 * e->at);
	e->born = 0;
	e->length *= 0.5f;
	e->octave++;
}

static float nearest_turn(float way)
{
	return way - floorf(way + 0.5f);
}

float ISA(strip_rate)(const strip_end *from, const strip_end *to)
{
	strip_end a = *from, b = *to;
	if (!(a.length > 0 && b.length > 0))
		return 0;
	if (a.octave + 1 == b.octave)
		go_finer(&a);
	else if (b.octave + 1 == a.octave)
		go_finer(&b);
	float way = nearest_turn(b.at - a.at), rate = 1 / max(0.5f * (a.length + b.length), 1);
	return a.octave != b.octave || way == 0 ? 0 : way < 0 ? -rate : rate;
}

strip_link ISA(strip_between)(const strip_end *from, const strip_end *to, float far)
{
	static const float fastest = 3; /* times as fast as the line itself the strip may go by */
	strip_end a = *from, b = *to;
	bool known = a.length > 0 && b.length > 0;
	if (known && a.octave + 1 == b.octave)
		go_finer(&a);
	else if (known && b.octave + 1 == a.octave)
		go_finer(&b);
	float way = nearest_turn(b.at - a.at);
	strip_link l = {.of = a.of ? a.of : b.of,
			.left = {a.of ? a.left : 1, b.of ? b.left : 1},
			.at = {a.at, b.at},
			.born = {a.born, b.born},
			.length = max(a.length > 0 ? a.length : b.length, 1)};
	l.jumps = !known || a.octave != b.octave || fabsf(way) * l.length > fastest * far + 1;
	if (!l.jumps)
		l.at[1] = a.at + way;
	for (int k = 0; k < 2 && l.jumps && !known; k++) {
		const strip_end *other = a.length > 0 ? &a : &b;
		l.at[k] = other->at;
		l.born[k] = other->born;
	}
	return l;
}

/* Where it is `texels` of the first level to a pixel. */
static strip_level level_of(const strip *s, float texels)
{
	int level = 0;
	while (texels > 2 && level + 1 < s->levels) {
		texels *= 0.5f;
		level++;
	}
	return (strip_level){level, level + 1 < s->levels ? clamp01(texels - 1) : 0};
}

void ISA(strip_choose)(strip_link *l, float wide)
{
	float along = (float)l->of->width[0] / l->length, across = (float)l->of->height[0] / max(wide, 1);
	l->level[0] = level_of(l->of, max(along, across));
	l->level[1] = level_of(l->of, max(2 * along, across));
}

/* ---- what is left ---------------------------------------------------------------------------------------- */

/* Ink of one level at n places (u, v), 0 to 1 each way. */
static void texels(const strip *s, int level, int n, const float *restrict u, const float *restrict v,
		   float *restrict ink)
{
	int wide = s->width[level], high = s->height[level];
	const float *from = s->pair[level][0];
	int32_t at[STRIP_PLACES];
	float right_by[STRIP_PLACES], down_by[STRIP_PLACES], four[STRIP_PLACES][4];
	for (int i = 0; i < n; i++) {
		float x = (u[i] - floorf(u[i])) * (float)wide - 0.5f, y = v[i] * (float)high - 0.5f, fx = floorf(x),
		      fy = floorf(y);
		at[i] = 2 * (((int)fy + 1) * (wide + 2) + (int)fx + 1);
		right_by[i] = x - fx;
		down_by[i] = y - fy;
	}
	for (int i = 0; i < n; i++)
		memcpy(four[i], from + at[i], sizeof four[i]);
	for (int i = 0; i < n; i++)
		ink[i] = mix(mix(four[i][0], four[i][2], right_by[i]), mix(four[i][1], four[i][3], right_by[i]),
			     down_by[i]);
}

static void inks(const strip *s, strip_level at, int n, const float *restrict u, const float *restrict v,
		 float *restrict ink)
{
	float more[STRIP_PLACES];
	texels(s, at.level, n, u, v, ink);
	if (!(at.next > 0))
		return;
	texels(s, at.level + 1, n, u, v, more);
	for (int i = 0; i < n; i++)
		ink[i] = mix(ink[i], more[i], at.next);
}

void ISA(strip_left)(const strip_link *l, int n, const float *restrict px, const float *restrict py,
		     const float *restrict s, const float *restrict v, float *restrict left)
{
	float u[STRIP_PLACES], born[STRIP_PLACES], ink[STRIP_PLACES], half[STRIP_PLACES];
	float x = l->x, y = l->y, rate = l->rate, far = l->far, from = l->at[0], to = l->at[1];
	int wholes = 0, halves = 0;
	n &= ~(LANES - 1); /* it is such, and no loop has a rest */
	if (n <= 0)
		return;
	for (int i = 0; i < n; i++) {
		float along = x * px[i] + y * py[i], one = from + rate * along, two = to + rate * (along - far);
		float jump = s[i] > 0.5f ? 1.0f : 0.0f, share = l->jumps ? jump : s[i];
		u[i] = mix(one, two, share);
		born[i] = mix(l->born[0], l->born[1], share);
		wholes |= born[i] < 1;
		halves |= born[i] > 0;
	}
	if (wholes || !halves)
		inks(l->of, l->level[0], n, u, v, ink);
	if (halves) {
		for (int i = 0; i < n; i++)
			u[i] *= 2;
		inks(l->of, l->level[1], n, u, v, half);
	}
	if (wholes & halves)
		for (int i = 0; i < n; i++)
			ink[i] = born[i] < 1 ? mix(ink[i], half[i], born[i]) : half[i];
	const float *of = wholes || !halves ? ink : half;
	for (int i = 0; i < n; i++)
		left[i] = mix(mix(l->left[0], l->left[1], s[i]), 1, of[i]);
}
