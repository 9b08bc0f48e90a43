/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* What FINE reads and what it finds. A use defines SAMPLE, FAMILY or both; the end takes them back.
 *
 * SAMPLE(id, layer, planes, form): layers that are averaged over their pixels, by the names of edges.h. `form` is how
 * their values are compared: a VECTOR bounded, a COLOR in the space of the metric, LIGHT exposed, a DISTANCE inverted.
 *
 * FAMILY(id, kind, sample, source, rank, floor, unit, times, clear, weak, crumb, word, bit), in the order in which they
 * claim the picture, each keeping clear of the earlier ones:
 *   kind    a CRACK runs between two pixels; a THIN thing between pixel centres has its middle; a BAND is a thin stripe
 *           of a sample, a STEP a boundary in it
 *   source  whose weight it has; CRACK and THIN weigh object, material and depth and take the strongest
 *   rank    what it is made of; of two lines the older rank owns the place
 *   floor   of what is a step or a band at all, in units of the sample (ONE) or of the difference of two normals at
 *           crease_angle (CREASE), so many times: a band's is its step's and more
 *   clear   pixels to the sites of earlier families, nearer to which it is theirs; 0: it joins them
 *   weak    share of an edge's strength with which it may go on beside what is an edge by itself; 0: none is
 *   crumb   so many sites that hang together are a line; 0: one is
 *   word    of the marks of a pixel, and which bit of it is that of AXIS_ROW; AXIS_COLUMN's is the next */
#ifndef SAMPLE
#define SAMPLE(...)
#endif
#ifndef FAMILY
#define FAMILY(...)
#endif

SAMPLE(SOURCE_NORMAL,     NORMAL,      3, VECTOR)
SAMPLE(SOURCE_COLOR,      ALBEDO,      3, COLOR)
SAMPLE(SOURCE_LIGHT,      DIFFUSE,     1, LIGHT)
SAMPLE(SOURCE_SEEN,       SEEN_NORMAL, 3, VECTOR)
SAMPLE(SAMPLE_SEEN_COLOR, SEEN_COLOR,  3, COLOR)
SAMPLE(SAMPLE_SEEN_DEPTH, SEEN_DEPTH,  1, DISTANCE)

FAMILY(CRACK,            CRACK, NO_SAMPLE,         SOURCE_DEPTH,  SHAPE,  0,     ONE,    0,    0,    1,    0, CRACK, 0)
FAMILY(THIN,             THIN,  NO_SAMPLE,         SOURCE_DEPTH,  SHAPE,  0,     ONE,    0,    0,    0,    0, RIDGE, 0)
FAMILY(MARK,             CRACK, NO_SAMPLE,         SOURCE_MARK,   CREASE, 0,     ONE,    0,    1.5f, 0,    0, CRACK, 4)
FAMILY(CREASE,           CRACK, NO_SAMPLE,         SOURCE_NORMAL, CREASE, 0,     ONE,    0,    1.5f, 0,    3, CRACK, 6)
FAMILY(NORMAL_BAND,      BAND,  SOURCE_NORMAL,     SOURCE_NORMAL, CREASE, 0.35f, CREASE, 1.2f, 1.5f, 0,    4, RIDGE, 2)
FAMILY(NORMAL,           STEP,  SOURCE_NORMAL,     SOURCE_NORMAL, CREASE, 0.35f, CREASE, 1,    1.5f, 0,    3, RIDGE, 4)
FAMILY(COLOR_BAND,       BAND,  SOURCE_COLOR,      SOURCE_COLOR,  COLOR,  0.01f, ONE,    1.2f, 1.5f, 0.5f, 4, RIDGE, 6)
FAMILY(COLOR,            STEP,  SOURCE_COLOR,      SOURCE_COLOR,  COLOR,  0.01f, ONE,    1,    1.5f, 0,    3, RIDGE, 8)
FAMILY(LIGHT_BAND,       BAND,  SOURCE_LIGHT,      SOURCE_LIGHT,  LIGHT,  0.1f,  ONE,    1,    1.5f, 0,    4, RIDGE, 10)
FAMILY(LIGHT_STEP,       STEP,  SOURCE_LIGHT,      SOURCE_LIGHT,  LIGHT,  0.02f, ONE,    1,    1.5f, 0,    3, RIDGE, 12)
FAMILY(LIGHT,            CRACK, NO_SAMPLE,         SOURCE_LIGHT,  LIGHT,  0,     ONE,    0,    1.5f, 0,    3, CRACK, 2)
FAMILY(SEEN_NORMAL_BAND, BAND,  SOURCE_SEEN,       SOURCE_SEEN,   SEEN,   0.6f,  CREASE, 1.2f, 1.5f, 0,    4, SEEN,  0)
FAMILY(SEEN_NORMAL,      STEP,  SOURCE_SEEN,       SOURCE_SEEN,   SEEN,   0.6f,  CREASE, 1,    1.5f, 0,    4, SEEN,  2)
FAMILY(SEEN_COLOR_BAND,  BAND,  SAMPLE_SEEN_COLOR, SOURCE_SEEN,   SEEN,   0.01f, ONE,    1.2f, 1.5f, 0,    4, SEEN,  4)
FAMILY(SEEN_COLOR,       STEP,  SAMPLE_SEEN_COLOR, SOURCE_SEEN,   SEEN,   0.01f, ONE,    1,    1.5f, 0,    4, SEEN,  6)
FAMILY(SEEN_DEPTH,       STEP,  SAMPLE_SEEN_DEPTH, SOURCE_SEEN,   SEEN,   0,     ONE,    1,    1.5f, 0,    9, SEEN,  8)

#undef SAMPLE
#undef FAMILY
