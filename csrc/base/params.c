/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stages' rows as tables that other languages read: encre_stage_info() and the functions on parameter blocks. */
#include "base/stage.h"

#include <float.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define LEVEL(i, t, w) {i, t, w, {1, 1, 1}}
/* Vainumäe 2020, 4.1: shade, half light, light. */
static const encre_levels shade_levels_default = {
	3, {LEVEL(0.5f, 0, 0), LEVEL(0.7f, 0.5f, 0.025f), LEVEL(1.1f, 0.9f, 0.025f)}};
#undef LEVEL

#define ITEM(pid, name, num, lab, hlp) {.id = #name, .label = lab, .help = hlp, .number = num},
#define ENUM(pid, scp, val, enb, lab, hlp, its) static const encre_enum_item pid##_items[] = {its};
#include "base/all.rows.h"

#define HEAD(pid, scp, typ, unt, enb, lab, hlp)                                                                        \
	.id = #pid, .label = lab, .help = hlp, .unit = unt, .enabled_if = enb, .type = typ, .scope = ENCRE_##scp,      \
	.offset = offsetof(encre_params, pid)
#define NUMBER(dft, hmin, hmax, smin, smax)                                                                            \
	.value = {dft}, .hard_min = hmin, .hard_max = hmax, .soft_min = smin, .soft_max = smax
#define SWITCH(pid, scp, dft, enb, lab, hlp)                                                                           \
	{HEAD(pid, scp, ENCRE_BOOL, "", enb, lab, hlp), .value = {dft}, .is_switch = 1},
#define BOOL(pid, scp, dft, enb, lab, hlp) {HEAD(pid, scp, ENCRE_BOOL, "", enb, lab, hlp), .value = {dft}},
#define INT(pid, scp, dft, hmin, hmax, smin, smax, unt, enb, lab, hlp)                                                 \
	{HEAD(pid, scp, ENCRE_INT, unt, enb, lab, hlp), NUMBER(dft, hmin, hmax, smin, smax)},
#define FLOAT(pid, scp, dft, hmin, hmax, smin, smax, unt, enb, lab, hlp)                                               \
	{HEAD(pid, scp, ENCRE_FLOAT, unt, enb, lab, hlp), NUMBER(dft, hmin, hmax, smin, smax)},
#define ENUM(pid, scp, dft, enb, lab, hlp, its)                                                                        \
	{HEAD(pid, scp, ENCRE_ENUM, "", enb, lab, hlp), .value = {dft}, .items = pid##_items,                          \
	 .n_items = sizeof pid##_items / sizeof *pid##_items},
#define COLOR(pid, scp, r, g, b, enb, lab, hlp) {HEAD(pid, scp, ENCRE_COLOR, "", enb, lab, hlp), .value = {r, g, b}},
#define IMAGE(pid, scp, unt, enb, lab, hlp) {HEAD(pid, scp, ENCRE_IMAGE, unt, enb, lab, hlp)},
#define LEVELS(pid, scp, enb, lab, hlp, dft) {HEAD(pid, scp, ENCRE_LEVELS, "", enb, lab, hlp), .levels = &(dft)},
static const encre_param_info table[] = {
#include "base/all.rows.h"
};

/* A stage's share of the table: from its first row to the next stage's. An enum that counts rows gives the places. */
#define STAGE(sid, lab, hlp) sid##_first, sid##_fence = sid##_first - 1,
#define ROW(pid) pid##_row,
#define BOOL(pid, ...) ROW(pid)
#define INT(pid, ...) ROW(pid)
#define FLOAT(pid, ...) ROW(pid)
#define ENUM(pid, ...) ROW(pid)
#define COLOR(pid, ...) ROW(pid)
#define IMAGE(pid, ...) ROW(pid)
#define LEVELS(pid, ...) ROW(pid)
enum row {
#include "base/all.rows.h"
	n_rows
};
#undef ROW
#undef HEAD
#undef NUMBER

#define BOOL(...) +1
#define INT(...) +1
#define FLOAT(...) +1
#define ENUM(...) +1
#define COLOR(...) +1
#define IMAGE(...) +1
#define LEVELS(...) +1
#define STAGE(sid, lab, hlp)                                                                                           \
	}                                                                                                              \
	,                                                                                                              \
	{                                                                                                              \
		.id = #sid, .label = lab, .help = hlp, .params = table + sid##_first, .n_params = 0
static const encre_stage_description stages[] = {{.id = NULL
#include "base/all.rows.h"
}};

const encre_stage_description *encre_stage_info(int32_t stage)
{
	int n = sizeof stages / sizeof *stages - 1;
	return stage >= 0 && stage < n ? stages + 1 + stage : NULL;
}

int64_t encre_params_size(void)
{
	return sizeof(encre_params);
}

void encre_params_init(void *params)
{
	memset(params, 0, sizeof(encre_params));
	for (int i = 0; i < n_rows; i++) {
		const encre_param_info *p = table + i;
		char *field = (char *)params + p->offset;
		float f[3] = {(float)p->value[0], (float)p->value[1], (float)p->value[2]};
		int32_t n = (int32_t)p->value[0];
		switch (p->type) {
		case ENCRE_FLOAT: memcpy(field, f, sizeof *f); break;
		case ENCRE_COLOR: memcpy(field, f, sizeof f); break;
		case ENCRE_LEVELS: memcpy(field, p->levels, sizeof *p->levels); break;
		case ENCRE_IMAGE: break;
		default: memcpy(field, &n, sizeof n);
		}
	}
}

static const char *check_number(const encre_param_info *p, double value, char *text, size_t size)
{
	/* The limits are decimals: the float nearest to one counts as the limit itself. */
	if (value >= (double)(float)p->hard_min && value <= (double)(float)p->hard_max)
		return NULL;
	if (p->hard_max >= FLT_MAX)
		snprintf(text, size, "%s: %g is out of range; give %g or more", p->id, value, p->hard_min);
	else
		snprintf(text, size, "%s: %g is out of range; give a value from %g to %g", p->id, value, p->hard_min,
			 p->hard_max);
	return text;
}

static const char *check_size(const encre_param_info *p, const encre_image *i, char *text, size_t size)
{
	if (!i->data || (i->width > 0 && i->height > 0 && i->width <= 65536 && i->height <= 65536 && i->channels > 0 &&
			 i->channels <= 4))
		return NULL;
	snprintf(text, size,
		 "%s: is %d x %d pixels of %d channels; give 1 to 65536 pixels each way and 1, 3 or 4 channels", p->id,
		 (int)i->width, (int)i->height, (int)i->channels);
	return text;
}

static const char *check_row(const encre_param_info *p, const char *field, char *text, size_t size)
{
	int32_t n;
	float f[3];
	encre_image image;
	switch (p->type) {
	case ENCRE_BOOL:
	case ENCRE_INT:
	case ENCRE_ENUM:
		memcpy(&n, field, sizeof n);
		if (p->type == ENCRE_INT)
			return check_number(p, n, text, size);
		for (int32_t i = 0; i < p->n_items; i++)
			if (p->items[i].number == n)
				return NULL;
		if (p->type == ENCRE_BOOL && (n == 0 || n == 1))
			return NULL;
		snprintf(text, size, "%s: %d is none of its values; see encre_stage_info()", p->id, (int)n);
		return text;
	case ENCRE_FLOAT: memcpy(f, field, sizeof *f); return check_number(p, (double)f[0], text, size);
	case ENCRE_COLOR:
		memcpy(f, field, sizeof f);
		for (int c = 0; c < 3; c++)
			if (!(f[c] >= 0 && f[c] <= FLT_MAX)) {
				snprintf(text, size, "%s: %g is no colour component; give 0 or more", p->id,
					 (double)f[c]);
				return text;
			}
		return NULL;
	case ENCRE_IMAGE: memcpy(&image, field, sizeof image); return check_size(p, &image, text, size);
	default: return NULL;
	}
}

const char *encre_params_check(const void *params, char *text, int64_t size)
{
	if (!params || !text || size < 1)
		return "params: the block or the room for a sentence is NULL; give both";
	for (int s = 0; encre_stage_info(s); s++) {
		const encre_stage_description *d = encre_stage_info(s);
		for (int i = 0; i < d->n_params; i++) {
			const char *e = check_row(d->params + i, (const char *)params + d->params[i].offset, text,
						  (size_t)size);
			if (e)
				return e;
		}
	}
#define POINTER(name) &JOIN(stage, JOIN_(name, base)),
	static const stage *const checked[] = {STAGES(POINTER)};
#undef POINTER
	for (size_t s = 0; s < sizeof checked / sizeof *checked; s++) {
		const char *e = checked[s]->check ? checked[s]->check(params, text, (size_t)size) : NULL;
		if (e)
			return e;
	}
	return NULL;
}
