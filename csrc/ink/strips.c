/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture along lines, small ones of it for lines that are thin or far, and where links lie in it. */
#include "ink/strips.h"

#include "fine/near.h"

enum { MOST = 4096 }; /* texels each way that are read: as many as a line may be pixels wide */

typedef struct making {
	const encre_image *image;
	strip *strip;
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
			m->strip->ink[0][(ptrdiff_t)y * wide + x] =
				(1 - grey) * (image.channels > 3 ? clean(in[3]) : 1);
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
		const float *above = s->ink[before] + (ptrdiff_t)2 * y * wide,
			    *below = 2 * y + 1 < s->height[before] ? above + wide : above;
		float *out = s->ink[m->level] + (ptrdiff_t)y * s->width[m->level];
		for (int x = 0; x < s->width[m->level]; x++) {
			int left = 2 * x, right = left + 1 < wide ? left + 1 : left;
			out[x] = 0.25f * (above[left] + above[right] + below[left] + below[right]);
		}
	}
}

static int32_t make(frame *f, const encre_image *image, strip *s)
{
	int wide = image->width < MOST ? image->width : MOST, high = image->height < MOST ? image->height : MOST;
	making m = {image, s, 0};
	*s = (strip){.data = image->data};
	int32_t code = ENCRE_OK;
	for (bool last = false; !code && !last; m.level++) {
		s->width[m.level] = wide;
		s->height[m.level] = high;
		s->levels = m.level + 1;
		s->ink[m.level] = late_take(&f->late, (size_t)wide * (size_t)high, sizeof **s->ink);
		if (!s->ink[m.level])
			return ENCRE_ERROR_MEMORY;
		code = bands_run(f->bands, high, 0, m.level ? halve_rows : read_rows, &m);
		last = wide == 1 && high == 1;
		wide = wide > 1 ? wide / 2 : 1;
		high = high > 1 ? high / 2 : 1;
	}
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
