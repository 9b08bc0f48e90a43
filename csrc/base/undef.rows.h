/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* Takes back what a use of all.rows.h defined. No guard: included after each use. */
#undef STAGE
#undef BOOL
#undef INT
#undef FLOAT
#undef ENUM
#undef COLOR
#undef IMAGE
#undef LEVELS
#undef ITEM
