/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* The rows of all stages, in the order in which panels show them. No guard: each use defines the macros whose rows it
 * wants (params.h tells them). The others are nothing, a SWITCH is then a BOOL, and all are taken back at the end. */
#ifndef STAGE
#define STAGE(...)
#endif
#ifndef BOOL
#define BOOL(...)
#endif
#ifndef SWITCH
#define SWITCH(...) BOOL(__VA_ARGS__)
#endif
#ifndef INT
#define INT(...)
#endif
#ifndef FLOAT
#define FLOAT(...)
#endif
#ifndef ENUM
#define ENUM(...)
#endif
#ifndef COLOR
#define COLOR(...)
#endif
#ifndef IMAGE
#define IMAGE(...)
#endif
#ifndef LEVELS
#define LEVELS(...)
#endif

#include "base/layers.rows.h"
#include "edges/edges.rows.h"
#include "surface/shade.rows.h"
#include "surface/example.rows.h"
#include "paint/gouache.rows.h"
#include "surface/smudge.rows.h"
#include "surface/paper.rows.h"
#include "surface/wash.rows.h"
#include "surface/hatch.rows.h"
#include "tones/tones.rows.h"
#include "surface/rim.rows.h"
#include "surface/specks.rows.h"
#include "surface/print.rows.h"
#include "surface/relief.rows.h"
#include "ink/lines.rows.h"
#include "ink/pen.rows.h"

#undef STAGE
#undef BOOL
#undef SWITCH
#undef INT
#undef FLOAT
#undef ENUM
#undef COLOR
#undef IMAGE
#undef LEVELS
#undef ITEM
