/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One parameter is one row in a stage's .rows.h. Here the rows become the fields of encre_params and the C names
 * of enum items; in params.c the same rows become the introspection table.
 *
 *   STAGE (id, label, help)                     once, first
 *   SWITCH(id, scope, default, enabled_if, label, help)    a BOOL, at most one: whether the stage draws
 *   BOOL  (likewise)
 *   INT   (id, scope, default, hard_min, hard_max, soft_min, soft_max, unit, enabled_if, label, help)
 *   FLOAT (likewise)
 *   ENUM  (id, scope, default, enabled_if, label, help, ITEM(id, NAME, number, label, help) ITEM(…)…)
 *   COLOR (id, scope, r, g, b, enabled_if, label, help)
 *   IMAGE (id, scope, unit, enabled_if, label, help)
 *   LEVELS(id, scope, enabled_if, label, help, table of the default)
 *
 * scope is FRAME or SURFACE. unit: "" plain, "factor" a 0..1 share, "px" a length that length_unit governs,
 * "length" scene units, "angle" degrees; of an image "" values as stored, "color" scene-linear colours. Item NAME of
 * parameter edge_detector is the C constant edge_detector_NAME. */
#ifndef ENCRE_PARAMS_H
#define ENCRE_PARAMS_H

#include "encre.h"

#define ITEM(id, name, number, label, help) id##_##name = number,
#define ENUM(id, scope, value, enabled_if, label, help, items) enum id##_item{items};
#include "base/all.rows.h"

#define BOOL(id, ...) int32_t id;
#define INT(id, ...) int32_t id;
#define FLOAT(id, ...) float id;
#define ENUM(id, ...) int32_t id;
#define COLOR(id, ...) float id[3];
#define IMAGE(id, ...) encre_image id;
#define LEVELS(id, ...) encre_levels id;
typedef struct encre_params {
#include "base/all.rows.h"
} encre_params;

/* Each stage's switch. */
#define SWITCH(id, ...) bool id;
typedef struct switches {
#include "base/all.rows.h"
} switches;

/* Whether any stage draws with these parameters. */
static inline bool draws(const encre_params *p)
{
	bool on = false;
#define SWITCH(id, ...) on |= p->id;
#include "base/all.rows.h"
	return on;
}

#endif
