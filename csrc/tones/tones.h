/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of tones have of each other. A darkness in 0..1 becomes ink whose mean is that, in dots, lines or
 * strokes of a fixed size on the screen. */
#ifndef ENCRE_TONES_H
#define ENCRE_TONES_H

#include "base/stage.h"

enum {
	TONE_CHUNK = 256,
	TONE_TOGETHER = 64 /* pixels: what is made of them stays in the nearest cache */,
	TONE_GREYS = 65536,
	TONE_SHEARS = 5,
	TONE_BIRTHS = 7,
	TONE_STEPS = 33,
	TONE_SLOTS = 6,
	TONE_LAYERS = 3 /* of strokes */,
	TONE_DETAIL_MOST = 32 /* pixels */,
	TONE_DETAIL_FAR = TONE_DETAIL_MOST + TONE_DETAIL_MOST / 2 + 1,
	TONE_ROOM_MOST = 60,
	TONE_SPOTTED = 255,
	TONE_SHADES = 5,   /* from as dark as black to light */
	TONE_THINGS = 4096 /* that are told apart in the dark */
};

#define TONE_EACH(X) X(1) X(2) X(3) X(4) X(5) X(6)

/* A coordinate in which a screen repeats itself, at the pixels of a chunk, and its growth per pixel. */
typedef struct tone_field {
	float at[TONE_CHUNK], right[TONE_CHUNK], down[TONE_CHUNK];
} tone_field;

/* The layer anchor at the pixels of a chunk, channel by channel; and at one more, where there is one. */
enum { TONE_REST = TONE_CHUNK + 8 };
typedef struct tone_rest {
	float at[ANCHOR_COUNT][TONE_REST];
} tone_rest;

/* One look of dots or lines. */
typedef struct tone_screen {
	float pitch;       /* pixels, at least 2; where there are many, that of `radius` */
	float least, most; /* pixels between which it is what it is on the thing; else octaves keep it there */
	float soft;        /* pixels over which edges fade, at least 1; next to nothing of crisp ones */
	/* radius of full-grown dots of this pitch in pixels, by how slanted rows lie, by halfway() of how grown dots
	   between are, along rows and across, and by even() of the darkness */
	float radius[TONE_SHEARS][TONE_BIRTHS][TONE_BIRTHS][TONE_STEPS];
} tone_screen;

/* A tile of a picture whose texels are inked one after the other. */
typedef struct tone_picture {
	const encre_image *image;  /* data NULL: there is none, and ink is grey */
	int shrink, width, height; /* so many pixels of the image are a texel, each way */
	float aspect;              /* width by height */
	float *threshold;          /* the darkness from which on a texel is inked */
	uint32_t *count;           /* scratch */
} tone_picture;

/* A style's tone of a level. */
typedef struct tone_slot {
	int kind, space;
	bool crisp;
	float pitch, gradient, across[2]; /* pixels; cosine and sine of the angle */
	float unit;                       /* of a field on the thing, in the thing's own */
	float least, most;                /* pixels between which strokes and spots lie a unit apart, else by octaves */
	const float *color;
	const encre_image *image;
	bool by_uv;    /* strokes go along U, where the layer tangent has it */
	bool to_light; /* or toward `light`, a direction of the camera's */
	float light[3];
	int like; /* the first slot that looks the same, perhaps this one: ink that is the same grows from one to the
		     next */
	const tone_screen *screen; /* of the first that looks the same */
	const tone_picture *picture;
} tone_slot;

typedef struct tone_style {
	tone_slot slot[TONE_SLOTS];
	int only; /* the slot of strokes or spots that looks as all others that draw, -1 where there is none */
	tone_screen screen[TONE_SLOTS];
	tone_picture picture[TONE_SLOTS];
	float room; /* pixels: half of how wide dots and lines are at least */
} tone_style;

/* What tones are kept clear of, by pixel. */
typedef struct tone_detail {
	int reach;     /* pixels to both sides of a pixel that a fine thing may have */
	int far;       /* the same of what is clear if what it hangs together with is */
	bool prints;   /* strokes, spots, dots or lines, which tell letters by chance, are drawn: print is looked for */
	uint8_t *keep; /* 255ths of the tones that are left; NULL: all */
	uint8_t *ease; /* 255ths of the darkness that is left of what is cleared as a whole */
	uint8_t *room; /* 255ths of its darkness that a screen has where it has little room; NULL: there is room */
	uint8_t *aim;  /* and how much is added to that */
	uint8_t *value, *light, *thin, *dark, *raw, *scratch; /* dark: fine dark things, for room.c, too */
	uint8_t *sure[2]; /* 255ths by which what is thin, and what is dark, is fine */
	uint8_t *print;   /* 255ths by which fine dark things are print, on light ground */
	uint8_t *around;  /* and by which dark ground has light print on it */
	uint8_t *flat;    /* not 0: light print that lies in one plane, as on a board */
	uint8_t *board;   /* and by which that is of so dark a colour that nothing else is seen on it */
	uint8_t *inked;   /* and by which for these there is ink, strokes or not; `raw` again */
} tone_detail;

/* What there is to draw in a chunk: of each slot its share of the pixel and its darkness there. */
typedef struct tone_wanted {
	float share[TONE_SLOTS][TONE_CHUNK], dark[TONE_SLOTS][TONE_CHUNK];
	bool any[TONE_SLOTS];
} tone_wanted;

/* How strokes along the form, and those across, go on the screen: two columns. */
typedef struct tone_ground {
	float along[2][TONE_CHUNK], across[2][TONE_CHUNK];
} tone_ground;

/* Points at the whole numbers of two fields, so many to the unit along each that they are a pitch or up to two apart on
 * the screen; where the unit itself is between the least pitch and the most, one. */
typedef struct tone_lattice {
	float at[2][TONE_CHUNK];                        /* in points that are full-grown */
	float across[2][TONE_CHUNK], up[2][TONE_CHUNK]; /* on the screen, from a point to the next along each axis */
	float grown[2][TONE_CHUNK];                     /* how far those half-way between are, 0..1 */
	float scale[2][TONE_CHUNK];                     /* full-grown ones to the unit, a power of 2 */
	float pitch[2][TONE_CHUNK];                     /* on the screen, between the least and the most */
	float flat[TONE_CHUNK];                         /* 1: seen on its edge, it shows none */
} tone_lattice;

/* Dots of one size, as even on the screen as may be: in rows, and those half-way to the next dot, to the next row, and
 * to both, which are young. */
typedef struct tone_spread {
	float at[2][TONE_CHUNK];    /* in dots that are full-grown: along rows, of a slanted lattice, and across */
	float apart[2][TONE_CHUNK]; /* pixels on the screen: from dot to dot in a row, and from row to row */
	float slant[TONE_CHUNK];    /* -1..1: by so many dots a row is shifted along the one before */
	float grown[2][TONE_CHUNK]; /* how far those between dots and between rows are, 0..1 */
	float share[3][TONE_CHUNK]; /* area of young dots, of a full-grown one's */
	float flat[TONE_CHUNK];     /* 1: seen on its edge, it shows none */
} tone_spread;

typedef struct tone_marks tone_marks; /* strokes.h */

/* Of a thing's pixels, by how light their color is: how many there are, and how many of them have light. */
typedef struct tone_thing {
	float object;
	bool taken;
	uint64_t all[TONE_SHADES], lit[TONE_SHADES];
} tone_thing;

/* What the stage has of a frame. */
typedef struct tone_frame {
	tone_style *styles;
	tone_marks *marks;
	tone_detail detail;
	bool caught;        /* shadows are seen where nothing is: they have light, and no color */
	bool night;         /* the sky is some light's color, and may be black as anything that is dark */
	uint8_t *spotted;   /* by pixel, TONE_SPOTTED where a black is one, else 0; NULL: all are */
	float *open;        /* by pixel, the least light that it has in the dark; NULL: nothing is left open, yet */
	float *opening;     /* room for that; NULL: nothing is ever */
	tone_thing *things; /* TONE_THINGS; NULL likewise */
	float *settled;     /* by pixel, its light without crumbs; NULL: these are not known, yet, or stay */
	float *settling;    /* room for that; NULL: they stay */
} tone_frame;

/* tones.c: the coordinates of a slot's dots, spots and strokes; on the screen without `rest`. */
void ISA(tone_chart)(const frame *f, const tone_slot *s, const tone_rest *rest, int y, int x, int n,
		     tone_field chart[2]);

/* slots.c: pixels from dot to dot; a style's tones. */
float ISA(tone_pitch)(const frame *f, float pitch);
void ISA(tone_style_fill)(const frame *f, const encre_params *p, tone_style *t);

/* detail.c, words.c, room.c: fill keep and room. */
void ISA(tone_detail_plan)(const frame *f, tone_detail *d, arena *a);
int32_t ISA(tone_detail_run)(frame *f, const tone_detail *d);
int32_t ISA(tone_words_run)(frame *f, const tone_detail *d);
int32_t ISA(tone_ground_run)(frame *f, const tone_detail *d);
int32_t ISA(tone_room_run)(frame *f, const tone_detail *d, const tone_style *styles);
float ISA(tone_room)(const encre_params *p, const tone_style *style);

/* blacks.c: fills it. */
int32_t ISA(tone_blacks_run)(frame *f, uint8_t *spotted);

/* open.c: fills it. */
int32_t ISA(tone_open_run)(frame *f, tone_frame *t);

/* crumbs.c: fills `settled`. */
int32_t ISA(tone_crumbs_run)(frame *f, tone_frame *t);

/* dark.c */
/* How much of the light a color that looks so bright has, by how far it is from black to dark. */
float ISA(tone_counts_as)(const encre_params *p, float bright, float r, float g, float b, float black, float dark);
/* The light of n pixels that levels are compared with. */
void ISA(tone_light)(const frame *f, const encre_params *p, int y, int x, int n, float *restrict light);
/* Tells which of n pixels show the shadow that a catcher has caught; false: none does. */
bool ISA(tone_caught)(const frame *f, int y, int x, int n, bool *caught);
void ISA(tone_want)(const frame *f, const encre_params *p, const tone_slot *slots, int y, int x, int n, tone_wanted *w);

/* fields.c: the layer anchor at n pixels, of a flat slot that of its sheet, written into `room`, which holds as many;
 * NULL where there is none. And channel by channel; s NULL: of the surfaces. */
const float *ISA(tone_anchor)(const frame *f, const tone_slot *s, int y, int x, int n, float *room);
const tone_rest *ISA(tone_rest_fill)(const frame *f, const tone_slot *s, int y, int x, int n, tone_rest *rest);
/* Of n pixels from x on in row y. A field of the picture along (right, down), in pixels of the full frame; of
 * the thing, its place along a direction in the space in which it rests; the two axes of the thing that its normal is
 * farthest from, turned; and how well planes across a direction cut the surface, 0..1: not where they graze it. */
void ISA(tone_screen_field)(const frame *f, int y, int x, int n, float right, float down, tone_field *field);
void ISA(tone_surface_field)(const tone_rest *rest, int n, const float along[3], float per, tone_field *field);
void ISA(tone_surface_chart)(const tone_rest *rest, int n, float cosine, float sine, tone_field field[2]);
void ISA(tone_cut)(const tone_rest *rest, int n, const float along[3], float *restrict cut);

/* ways.c: which way strokes go on n pixels of surfaces, by their forms. */
void ISA(tone_ground_fill)(const tone_rest *rest, int n, tone_ground *g);

/* pictures.c: a tile for a pitch, without memory yet; its thresholds; ink of n pixels. */
tone_picture ISA(tone_picture_of)(const encre_image *image, float pitch);
int32_t ISA(tone_picture_fill)(frame *f, tone_picture *p);
void ISA(tone_picture_row)(const tone_slot *s, int n, const tone_field chart[2], const float *restrict dark,
			   float *restrict ink);

/* spread.c, dots.c, ruled.c */
void ISA(tone_spread_fill)(float pitch, int n, const tone_field field[2], tone_spread *s);
/* The radius that is drawn for a disc of radius r, in pixels, so that small ones are not too dark. */
float ISA(tone_true_radius)(float r);
void ISA(tone_screen_fill)(tone_screen *screen, const tone_slot *s);
void ISA(tone_lattice_fill)(float least, float most, int n, const tone_field field[2], tone_lattice *l);
void ISA(tone_dots)(const tone_screen *screen, int n, const tone_field field[2], const float *restrict dark,
		    float *restrict ink);
void ISA(tone_lines)(const tone_screen *screen, int n, const tone_field *field, const float *restrict dark,
		     float *restrict ink);

/* The nearest of `size` pixels: where the frame ends its last pixel stands for what lies beyond, or strokes ended there
 * and left a pale edge. */
static inline int tone_within(int pixel, int size)
{
	pixel = pixel < size ? pixel : size - 1;
	return pixel > 0 ? pixel : 0;
}

static inline bool tone_sticks(const tone_slot *s)
{
	return s->space != tone_1_space_SCREEN;
}

/* Whether dots or lines fill it. */
static inline bool tone_is_screen(const tone_slot *s)
{
	return s->kind == tone_1_DOTS || s->kind == tone_1_LINES || s->kind == tone_1_CROSS;
}

/* Whether strokes or spots do. */
static inline bool tone_marked(const tone_slot *s)
{
	return s->kind == tone_1_HATCH || s->kind == tone_1_STIPPLE;
}

static inline bool tone_flat(const tone_slot *s)
{
	return s->space == tone_1_space_FLAT;
}

/* Whether blacks are spotted only where they are small. */
static inline bool tone_spots_small(const frame *f)
{
	return f->any.use_tones && f->params->tone_black_widest > 0;
}

/* Whether crumbs of ink and light join what is around them. */
static inline bool tone_joins(const frame *f)
{
	return f->any.use_tones && f->params->tone_crumbs > 0;
}

/* What is compared with tone_black. */
static inline float tone_lightness(const encre_params *p, float r, float g, float b)
{
	return p->tone_black_by == tone_black_by_LUMINANCE ? luminance(r, g, b) : max3(r, g, b);
}

/* How deep a red or a blue is, which looks darker than its luminance: no skin has more red than 2.6 times its green,
 * all but, and none is blue. */
static inline float tone_deep(float r, float g, float b)
{
	static const float skin = 2.6f, sky = 1.6f;
	float most = max(g, b), red = (r - skin * most) / max(most, FLT_MIN);
	float other = max(r, g), blue = (b - sky * other) / max(other, FLT_MIN);
	return clamp01(max(red, blue));
}

/* How light the color of a thing is beside tone_black. No colorist calls dark skin, wood and wine red black, as light
 * as they are: as the eye sees it, most of what red has more is added. Deep reds have nothing of it. */
static inline float tone_looks(const encre_params *p, float r, float g, float b)
{
	float own = tone_lightness(p, r, g, b);
	return own + 0.6f * (1 - tone_deep(r, g, b)) * positive(r - own);
}

/* As the eye has light. */
static inline float tone_cube_root(float x)
{
	return x > 1e-30f ? pixel_cbrt(most_one(x)) : 0;
}

/* A film that lets through less than this is opaque: what is seen of it is a sky. */
static const float tone_film = 0.999f;

static inline bool tone_fitted(const frame *f)
{
	return f->any.use_tones && (f->params->tone_detail > 0 || f->params->tone_least > 0);
}

/* Whether any of n values is above 0. */
static inline bool tone_any(const float *values, int n)
{
	int any = 0;
	for (int i = 0; i < n; i++)
		any |= values[i] > 0;
	return any;
}

/* 2^floor(log2 x) and, in *rest, x divided by it, of 2^-60 <= x <= 2^60; others are moved there. */
static inline float octave(float x, float *rest)
{
	x = x > 0x1p-60f ? x : 0x1p-60f;
	x = x < 0x1p60f ? x : 0x1p60f;
	int32_t bits = float_bits(x);
	*rest = bits_float((bits & 0x7fffff) | 0x3f800000);
	return bits_float(bits & 0x7f800000);
}

/* How large young dots are, by area: half-way to the next dot, to the next row, to both. grown: how far the cell of
 * full-grown ones has got to twice its size, along rows and across: so large are all together, but for a slower begin.
 * All three are the same where it has grown alike both ways, for then what is a row and what goes across may change
 * places. Were they born one after the other, the middle of the cell first, they would be spread more evenly yet, and
 * grow twice as fast: in a zoom 15 times as many pixels pop. */
static inline void tone_births(float grown0, float grown1, float share[3])
{
	float even = min(grown0, grown1) * (1 - max(grown0, grown1)) * (1.0f / 3);
	float dot = grown0 - even, row = grown1 - even, both = grown0 * grown1 + 2 * even;
	share[0] = dot * (0.8f + 0.2f * dot);
	share[1] = row * (0.8f + 0.2f * row);
	share[2] = both * (0.8f + 0.2f * both);
}

#endif
