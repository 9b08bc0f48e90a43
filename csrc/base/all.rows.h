/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of all stages, in the order of the stage list in stage.h. No guard: included once per use. */
#include "layers.rows.h"
#include "edges/edges.rows.h"
#include "shade.rows.h"
#include "smudge.rows.h"
#include "paper.rows.h"
#include "hatch.rows.h"
#include "ink/lines.rows.h"
