/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What kind a line of FINE is, its ink, and the hand that draws it. */
#ifndef ENCRE_PEN_H
#define ENCRE_PEN_H

#include "fine/fine.h"
#include "ink/noise.h"

/* LINE(KIND, id, width, label): the parameters line_<id>_pen and line_<id>_ink, and which line_<width>_width it reads;
 * kinds.c has factors on that. OUTLINE       a jump in depth to another object, or to nothing CONTACT       another
 * object at continuous depth (times line_contact_width) INNER         a jump in depth within an object CREASE        a
 * bend INTERSECTION  where pieces of a mesh pass through each other (times line_intersection_width) SUGGESTIVE    where
 * a smooth form nearly turns away An outline that only its depth tells (line_outline_strength 0) reads
 * line_inner_width. */
#define LINES(LINE)                                                                                                    \
	LINE(OUTLINE, outline, outline, "Outlines")                                                                    \
	LINE(CONTACT, contact, outline, "Contacts")                                                                    \
	LINE(INNER, inner, inner, "Inner Lines")                                                                       \
	LINE(CREASE, crease, crease, "Creases")                                                                        \
	LINE(INTERSECTION, intersection, crease, "Intersections")                                                      \
	LINE(MATERIAL, material, material, "Materials")                                                                \
	LINE(COLOR, color, color, "Colors")                                                                            \
	LINE(LIGHT, shadow, shadow, "Shadow Edges")                                                                    \
	LINE(SEEN, mirror, mirror, "Mirror Lines")                                                                     \
	LINE(SUGGESTIVE, suggestive, suggestive, "Folds")                                                              \
	LINE(MARK, mark, mark, "Marks")                                                                                \
	LINE(HIDDEN, hidden, hidden, "Hidden Lines")

#define LINE(kind, ...) LINE_##kind,
enum line { LINES(LINE) LINE_COUNT };
#undef LINE

/* ---- pens ------------------------------------------------------------------------------------------------ */

enum { PENS = 3, BRISTLES = 8 /* that a byte each has room for */, STREAKS = 6 /* that are used */, STROKES = 4 };

/* One pen's rows, as parameters have them. */
#define FLOAT(id, ...) float id;
#define INT(id, ...) int32_t id;
typedef struct hand {
	TOOL_ROWS(pen, )
	PEN_ROWS(pen)
} hand;
#undef FLOAT
#undef INT

/* What a style draws with. */
typedef struct pens {
	hand hand[PENS];
	uint8_t of[LINE_COUNT]; /* which of them draws a kind */
	bool differ;            /* not all kinds have the first */
	uint8_t used;           /* a bit each */
	const encre_image *strip[PENS];
	uint32_t again[PENS]; /* the seed of what they draw anew now; 0: they draw once for all frames */
} pens;

/* hands.c */
pens ISA(pens_of)(const frame *f, const encre_params *p);
/* The most strokes that any of them draws. */
uint32_t ISA(pens_strokes)(const pens *s);

/* ---- kinds.c --------------------------------------------------------------------------------------------- */

enum line ISA(line_of)(const frame *f, const site *s);
/* The factor on the width of its source. */
float ISA(line_width)(const frame *f, const encre_params *p, const site *s, enum line kind);
/* How much a line is the outer contour of a thing, by how far what is behind lies: 0..1. */
float ISA(line_outer)(const frame *f, const site *s);
/* Does the ink depend on more than the style? */
bool ISA(inks_by_site)(const encre_params *p);
/* The first ink of a line's site. */
void ISA(line_ink)(const frame *f, const site *s, float ink[3]);

/* ---- second.c -------------------------------------------------------------------------------------------- */

struct pen_end;
bool ISA(takes_second)(const encre_params *p);
/* Mixes the second ink into those of all sites of a stroke, and narrows its ends. Reads the picture before any lines.
 */
int32_t ISA(second_ink)(frame *f, struct pen_end *end, float (*ink)[3]);

/* ---- pen.c ----------------------------------------------------------------------------------------------- */

/* SPAN sites are looked at at a time. */
enum { SPAN = 64 };

/* A stroke, one of the times that a line is drawn, along a few sites: where they are on their things, and whose hand
 * draws each. */
typedef struct strokes {
	spots at;
	const hand *hand[SPAN];
	uint32_t again[SPAN]; /* the seed of what is drawn anew now; 0 for none */
	int stroke;
} strokes;

typedef struct touch {
	float rough, fray;     /* how much the rim is frayed here, about 0; times so many pixels */
	float left;            /* share of it that gaps leave */
	float dx, dy;          /* pixels that the hand strays by */
	float farther;         /* times as far as others a stroke goes on beyond a corner */
	uint8_t ink[BRISTLES]; /* 255ths that each bristle gives */
} touch;

/* Whether a hand varies along its lines. */
bool ISA(pen_varies)(const hand *h);
/* The factor on the width by the hand's pressure; of n <= SPAN sites. */
void ISA(pen_pressures)(const strokes *s, int n, float *factor);
void ISA(pen_touches)(const frame *f, const strokes *s, int n, touch *t);

#endif
