/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* The rows of all stages, in the order of the stage list in stage.h. No guard: included once per use. */
#include "base/layers.rows.h"
#include "edges/edges.rows.h"
#include "surface/shade.rows.h"
#include "surface/smudge.rows.h"
#include "surface/paper.rows.h"
#include "surface/hatch.rows.h"
#include "ink/lines.rows.h"
