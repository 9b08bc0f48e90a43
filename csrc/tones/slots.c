/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a style's parameters say of its tones, once a frame. */
#include "tones/strokes.h"

#include <string.h>

float ISA(tone_pitch)(const frame *f, float pitch)
{
	const encre_params *scene = f->params;
	if (scene->tone_pitch_unit == tone_pitch_unit_LENGTH)
		return pitch * f->scale;
	return 25.4f * (float)f->place.height / (scene->page_height * pitch);
}

static bool alike(const tone_slot *a, const tone_slot *b)
{
	return a->kind == b->kind && a->space == b->space && a->pitch == b->pitch && a->across[0] == b->across[0] &&
	       a->across[1] == b->across[1] && (a->kind != tone_1_IMAGE || a->image->data == b->image->data) &&
	       memcmp(a->color, b->color, 3 * sizeof *a->color) == 0;
}

/* A screen of the picture whose steps are whole pixels repeats itself exactly: without grey its ink would else have
 * moire. */
static void snap(tone_slot *s)
{
	float a = nearest_int(s->pitch * s->across[0]), b = nearest_int(s->pitch * s->across[1]);
	float pitch = sqrtf(a * a + b * b);
	if (!s->crisp || s->kind == tone_1_IMAGE || tone_sticks(s) || tone_marked(s) || !(pitch >= 2 && pitch < 65536))
		return;
	s->pitch = pitch;
	s->across[0] = a / pitch;
	s->across[1] = b / pitch;
}

/* The style's light, seen by the camera. */
static void turn_to_light(const frame *f, const encre_params *p, tone_slot *s)
{
	const float degree = 0.0174532925f, *view = f->camera.view;
	float turn = p->tone_light_direction * degree, height = p->tone_light_height * degree,
	      level = pixel_cos(height);
	float light[3] = {pixel_cos(turn) * level, pixel_sin(turn) * level, pixel_sin(height)};
	s->by_uv = p->tone_strokes == tone_strokes_UV && !tone_flat(s);
	s->to_light = p->tone_strokes == tone_strokes_LIGHT;
	for (int c = 0; c < 3; c++)
		s->light[c] = view[3 * c] * light[0] + view[3 * c + 1] * light[1] + view[3 * c + 2] * light[2];
}

/* How far marks lie apart on things. */
static void space_out(const frame *f, tone_slot *s)
{
	bool own = s->space == tone_1_space_OBJECT;
	float pitch = tone_mark_pitch(s);
	s->unit = own ? s->unit * (s->kind == tone_1_STIPPLE ? 0.5f : 1) : 1;
	s->least = own ? 3 : pitch;
	s->most = own ? max(widest_apart * f->scale, 3) : pitch;
}

static int only_marks(const tone_style *t)
{
	int only = -1;
	for (int k = 0; k < TONE_SLOTS; k++) {
		const tone_slot *s = t->slot + k;
		if (s->kind == tone_1_NONE || s->like == only)
			continue;
		if (only >= 0 || !tone_marked(s))
			return -1;
		only = k;
	}
	return only;
}

void ISA(tone_style_fill)(const frame *f, const encre_params *p, tone_style *t)
{
#define SLOT(n)                                                                                                        \
	{.kind = p->tone_##n,                                                                                          \
	 .space = p->tone_##n##_space,                                                                                 \
	 .crisp = p->tone_crisp,                                                                                       \
	 .pitch = ISA(tone_pitch)(f, p->tone_##n##_pitch),                                                             \
	 .unit = 0.01f * p->tone_##n##_pitch,                                                                          \
	 .gradient = p->tone_##n##_gradient,                                                                           \
	 .across = {pixel_cos(p->tone_##n##_angle * 0.0174532925f), pixel_sin(p->tone_##n##_angle * 0.0174532925f)},   \
	 .color = p->tone_##n##_color,                                                                                 \
	 .image = &p->tone_##n##_image},
	const tone_slot given[TONE_SLOTS] = {TONE_EACH(SLOT)};
#undef SLOT
	memcpy(t->slot, given, sizeof given);
	for (int k = 1; k < TONE_SLOTS; k++)
		if (t->slot[k].kind == tone_5_SAME)
			t->slot[k] = t->slot[k - 1];
	for (int k = 0; k < TONE_SLOTS; k++) {
		tone_slot *s = t->slot + k;
		s->like = k;
		snap(s);
		space_out(f, s);
		turn_to_light(f, p, s);
		for (int j = k - 1; j >= 0; j--)
			if (alike(t->slot + j, s))
				s->like = j;
		s->screen = t->screen + s->like;
		s->picture = t->picture + s->like;
		if (s->like == k)
			ISA(tone_screen_fill)(t->screen + k, s);
	}
	t->only = only_marks(t);
	t->room = ISA(tone_room)(f->params, t);
}
