/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* What FINE reads and what it finds. A use defines SAMPLE, FAMILY or both; the end takes them back.
 *
 * SAMPLE(id, layer, planes, form): layers that are averaged over their pixels, by the names of edges.h. `form` is how
 * their values are compared: a VECTOR bounded, a COLOR in the space of the metric, LIGHT exposed, a DISTANCE inverted.
 *
 * A family is one of these, in the order in which they claim the picture; all but shapes and chains keep clear of
 * earlier ones:
 *   CHAIN_FAMILY(id, rank, bit) runs along edges of meshes, as chains tell it (fine/chains/): no pixel has marks of it
 *   CRACK_FAMILY(id, rank, faint, crumb, bit) runs between two pixels
 *   THIN_FAMILY(id, rank, crumb, bit) between pixel centres has its middle
 *   BAND_FAMILY(id, sample, rank, floor, unit, faint, crumb, word, bit) is a thin stripe of a sample
 *   STEP_FAMILY(id, sample, rank, floor, unit, faint, crumb, word, bit) is a boundary in it
 *   VALLEY_FAMILY(id, rank, faint, crumb, bit) is where forms are dark that are lit from the eye
 * A use of all defines FAMILY(id, kind, sample, rank, floor, unit, faint, crumb, word, bit).
 *   rank    what it is made of; of two lines the older rank owns the place
 *   floor   of what is a step or a band at all, in units of the sample (ONE) or of the difference of two normals at
 *           crease_angle (CREASE)
 *   faint   FAINT: it may go on where it is no edge by itself, beside what is one
 *   crumb   so many sites that hang together are a line; LONE: one is
 *   word    of the marks of a pixel, and which bit of it is that of AXIS_ROW; AXIS_COLUMN's is the next */
#ifndef SAMPLE
#define SAMPLE(...)
#endif
#ifndef FAMILY
#define FAMILY(...)
#endif
#define CHAIN_FAMILY(id, rank, bit) FAMILY(id, CHAIN, NO_SAMPLE, rank, 0, ONE, SURE, LONE, NONE, bit)
#define CRACK_FAMILY(id, rank, faint, crumb, bit) FAMILY(id, CRACK, NO_SAMPLE, rank, 0, ONE, faint, crumb, CRACK, bit)
#define THIN_FAMILY(id, rank, crumb, bit) FAMILY(id, THIN, NO_SAMPLE, rank, 0, ONE, SURE, crumb, RIDGE, bit)
#define BAND_FAMILY(id, ...) FAMILY(id, BAND, __VA_ARGS__)
#define STEP_FAMILY(id, ...) FAMILY(id, STEP, __VA_ARGS__)
#define VALLEY_FAMILY(id, rank, faint, crumb, bit) FAMILY(id, VALLEY, NO_SAMPLE, rank, 0, ONE, faint, crumb, MORE, bit)

SAMPLE(SOURCE_NORMAL,     NORMAL,      3, VECTOR)
SAMPLE(SOURCE_COLOR,      ALBEDO,      3, COLOR)
SAMPLE(SOURCE_LIGHT,      DIFFUSE,     1, LIGHT)
SAMPLE(SOURCE_SEEN,       SEEN_NORMAL, 3, VECTOR)
SAMPLE(SAMPLE_SEEN_COLOR, SEEN_COLOR,  3, COLOR)
SAMPLE(SAMPLE_SEEN_DEPTH, SEEN_DEPTH,  1, DISTANCE)

CHAIN_FAMILY(CHAIN_SHAPE,                          SHAPE,                                       0)
CHAIN_FAMILY(CHAIN_CREASE,                         CREASE,                                      2)
CHAIN_FAMILY(CHAIN_COLOR,                          COLOR,                                       4)
CRACK_FAMILY(CRACK,                                SHAPE,                  SURE,  LONE,        0)
THIN_FAMILY(THIN,                                  SHAPE,                         LONE,        0)
BAND_FAMILY(NORMAL_BAND,      SOURCE_NORMAL,       CREASE, 0.42f,  CREASE, SURE,  4,    RIDGE, 2)
STEP_FAMILY(NORMAL,           SOURCE_NORMAL,       CREASE, 0.35f,  CREASE, FAINT, 3,    RIDGE, 4)
BAND_FAMILY(COLOR_BAND,       SOURCE_COLOR,        COLOR,  0.012f, ONE,    FAINT, 4,    RIDGE, 6)
STEP_FAMILY(COLOR,            SOURCE_COLOR,        COLOR,  0.01f,  ONE,    FAINT, 3,    RIDGE, 8)
VALLEY_FAMILY(VALLEY,                              FORM,                   FAINT, 4,           10)
BAND_FAMILY(LIGHT_BAND,       SOURCE_LIGHT,        LIGHT,  0.1f,   ONE,    FAINT, 4,    RIDGE, 10)
STEP_FAMILY(LIGHT_STEP,       SOURCE_LIGHT,        LIGHT,  0.02f,  ONE,    SURE,  3,    RIDGE, 12)
CRACK_FAMILY(LIGHT,                                LIGHT,                  SURE,  3,           2)
BAND_FAMILY(SEEN_NORMAL_BAND, SOURCE_SEEN,         SEEN,   0.72f,  CREASE, SURE,  4,    MORE,  0)
STEP_FAMILY(SEEN_NORMAL,      SOURCE_SEEN,         SEEN,   0.6f,   CREASE, FAINT, 4,    MORE,  2)
BAND_FAMILY(SEEN_COLOR_BAND,  SAMPLE_SEEN_COLOR,   SEEN,   0.012f, ONE,    SURE,  4,    MORE,  4)
STEP_FAMILY(SEEN_COLOR,       SAMPLE_SEEN_COLOR,   SEEN,   0.01f,  ONE,    FAINT, 4,    MORE,  6)
STEP_FAMILY(SEEN_DEPTH,       SAMPLE_SEEN_DEPTH,   SEEN,   0,      ONE,    FAINT, 9,    MORE,  8)

#undef SAMPLE
#undef FAMILY
#undef CHAIN_FAMILY
#undef CRACK_FAMILY
#undef THIN_FAMILY
#undef BAND_FAMILY
#undef STEP_FAMILY
#undef VALLEY_FAMILY
