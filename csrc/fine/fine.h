/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the FINE detector share: edges as sites between pixels, linked to polylines.
 *
 * cracks.c, light.c and ridges.c mark, densely and row by row, where sites are, and place each; mirrors.c tells
 * ridges.c where the eye sees something else than the surface in front; sites.c runs them, gathers all sites and drops
 * those that an earlier family owns; links.c joins what is left. To add a family: name it below where its turn is, mark
 * its pixels, place its sites in fine_site() and say in links.c what joins them. */
#ifndef ENCRE_FINE_H
#define ENCRE_FINE_H

#include "edges/edges.h"
#include "base/pixel.h"

/* In the order in which they claim the picture: each keeps clear of the earlier ones. */
enum family {
	FAMILY_CRACK, /* depth, object, material: between two pixels */
	FAMILY_THIN,  /* the same, of a thing between pixel centres: its middle */
	FAMILY_MARK,  /* drawn by hand: between two pixels */
	FAMILY_NORMAL_BAND,
	FAMILY_NORMAL, /* averaged layers: a thin stripe; a step */
	FAMILY_COLOR_BAND,
	FAMILY_COLOR,
	FAMILY_LIGHT_BAND,
	FAMILY_LIGHT_STEP,
	FAMILY_LIGHT, /* where smooth light crosses a threshold: between two pixels */
	FAMILY_SEEN_NORMAL_BAND,
	FAMILY_SEEN_NORMAL, /* what mirrors and glass show: averaged layers again */
	FAMILY_SEEN_COLOR_BAND,
	FAMILY_SEEN_COLOR,
	FAMILY_SEEN_DEPTH,
	FAMILY_COUNT,
	FAMILY_SEEN = FAMILY_SEEN_NORMAL_BAND /* the first of them */
};

/* Which neighbour a crack lies before, or along which axis a ridge was found; a junction joins the cracks of the four
 * pixels from (column, row). */
enum axis { AXIS_ROW, AXIS_COLUMN, AXIS_JUNCTION };

/* A point of a line. Numbers of sites grow by family, row, column and axis. */
typedef struct site {
	float x, y;               /* pixels; centres are whole numbers */
	float strength;           /* weighted */
	float thin, half, inside; /* how much it is a side of a thin thing, half its width, and how far on along the
				     axis its middle lies */
	float crowd;              /* its radius is at most 1 / crowd */
	uint16_t column, row;     /* of the pixel that it was found at */
	uint16_t near_x, near_y;  /* of the least depth in the 5x5 about the pixel that held it, of the object that the
				     line bounds: there it takes its controls */
	uint8_t family, axis, source;
	uint8_t dropped;
	uint8_t crumb;
	uint8_t weak;   /* of a line only where that goes on beside what is none by itself */
	int8_t step[3]; /* a ridge's way along its axis through the values of its layer, at most 127 long; 0 for bands
			 */
} site;

/* Of a ridge, by what it is sampled from: a source or SAMPLE_SEEN_... */
static inline enum family step_of(int s)
{
	switch (s) {
	case SOURCE_NORMAL: return FAMILY_NORMAL;
	case SOURCE_COLOR: return FAMILY_COLOR;
	case SOURCE_LIGHT: return FAMILY_LIGHT_STEP;
	case SOURCE_SEEN: return FAMILY_SEEN_NORMAL;
	case SAMPLE_SEEN_COLOR: return FAMILY_SEEN_COLOR;
	default: return FAMILY_SEEN_DEPTH;
	}
}

/* There is none of SAMPLE_SEEN_DEPTH. */
static inline enum family band_of(int s)
{
	return (enum family)(step_of(s) - 1);
}

/* What a family of ridges is sampled from. */
static inline int sample_of(int family)
{
	return family <= FAMILY_NORMAL        ? SOURCE_NORMAL
	       : family <= FAMILY_COLOR       ? SOURCE_COLOR
	       : family <= FAMILY_LIGHT       ? SOURCE_LIGHT
	       : family <= FAMILY_SEEN_NORMAL ? SOURCE_SEEN
	       : family <= FAMILY_SEEN_COLOR  ? SAMPLE_SEEN_COLOR
					      : SAMPLE_SEEN_DEPTH;
}

static inline bool is_band(int family)
{
	return family == FAMILY_NORMAL_BAND || family == FAMILY_COLOR_BAND || family == FAMILY_LIGHT_BAND ||
	       family == FAMILY_SEEN_NORMAL_BAND || family == FAMILY_SEEN_COLOR_BAND;
}

/* Marks of a pixel in fine.crack. */
enum { CRACK_RIGHT = 1, CRACK_DOWN = 2, LIGHT_RIGHT = 4, LIGHT_DOWN = 8, MARK_RIGHT = 16, MARK_DOWN = 32 };

static inline bool is_crack(enum family family)
{
	return family == FAMILY_CRACK || family == FAMILY_MARK || family == FAMILY_LIGHT;
}

/* The mark of a family of cracks; along a column it is the next bit. */
static inline uint8_t right_of(enum family family)
{
	return family == FAMILY_CRACK ? CRACK_RIGHT : family == FAMILY_MARK ? MARK_RIGHT : LIGHT_RIGHT;
}

/* The bit in fine.ridge: those from FAMILY_THIN on have one. */
static inline int ridge_bit(enum family family, int axis)
{
	return 2 * ((int)family - FAMILY_THIN) + axis;
}

/* Marks in fine.hit: a thin thing, other in index or in depth only. */
enum { HIT_OBJECT = 1, HIT_DEPTH = 2, THIN_SPAN = 16 };

typedef struct fine {
	frame *f;
	const edges *e;
	float crease; /* length of the difference of two normals at crease_angle */
	float floor[SAMPLE_COUNT], band_floor[SAMPLE_COUNT]; /* of what is a step or a band in an averaged layer */
	float most_color;     /* the largest weight of colour, without the painted control */
	float least_contrast; /* between colours across a step */
	uint8_t *colored;     /* by row: colours may make edges */
	uint8_t *crack;       /* width * height */
	uint8_t *hit;         /* spans * height: of THIN_SPAN pixels of a row */
	int spans;
	uint16_t *ridge;  /* width * height: ridge_bit(), or MARK_SEEN */
	uint16_t *seen;   /* width * height: bit 2 * (family - FAMILY_SEEN) + axis; NULL: nothing is known of it */
	uint8_t *through; /* width * height: the eye passes through or off the surface here; NULL likewise */
	uint8_t *glimpse; /* by row: there are such pixels */
	float *light;     /* the light, without its noise where that may matter, until sites are placed; NULL where it
			     makes no edges */
	uint32_t *first;  /* [FAMILY_COUNT * height + 1]: number of the first site of a family's row */
	float *scratch;   /* for each thread */
	ptrdiff_t thread_scratch;

	uint32_t count;
	site *site;
	/* Sites by cells of CELL pixels each way, ascending within a cell: member[cell[i]] to member[cell[i + 1] - 1].
	 */
	int across, tall;
	uint32_t *cell, *member;
	/* The sites that site i is linked to: to[at[i]] to to[at[i + 1] - 1], ascending. */
	uint32_t *at, *to;
	uint32_t linked; /* sites that `at` knows */
} fine;

enum { CELL = 4 };
enum { MARK_SEEN = 1 << (2 * (FAMILY_MARK - FAMILY_THIN)) }; /* in fine.ridge, for FAMILY_MARK has none there */

/* The pixel that holds a site. */
static inline int pixel_of(float at, int n)
{
	return clamp_index((int)floorf(at + 0.5f), n);
}

/* Pixels beside a crack hold two surfaces. */
static inline bool mixed_at(const fine *n, int x, int y)
{
	const uint8_t *c = n->crack + (ptrdiff_t)y * n->f->width + x;
	return (c[0] & (CRACK_RIGHT | CRACK_DOWN)) || (x > 0 && (c[-1] & CRACK_RIGHT)) ||
	       (y > 0 && (c[-n->f->width] & CRACK_DOWN));
}

/* Whether no ridge that is sampled from `s` reads there. */
static inline bool closed_at(const fine *n, int s, int x, int y)
{
	return mixed_at(n, x, y) || (s >= SOURCE_SEEN && !n->through[(ptrdiff_t)y * n->f->width + x]);
}

/* ---- sites near a place ---------------------------------------------------------------------------------- */

typedef struct near_sites {
	int row, last, x0, x1;
	uint32_t i, end;
} near_sites;

/* All sites within `reach` of (x, y), and more. */
static inline near_sites near_place(const fine *n, float x, float y, float reach)
{
	return (near_sites){
		.row = pixel_of(y - reach, n->f->height) / CELL,
		.last = pixel_of(y + reach, n->f->height) / CELL,
		.x0 = pixel_of(x - reach, n->f->width) / CELL,
		.x1 = pixel_of(x + reach, n->f->width) / CELL,
	};
}

static inline bool near_next(const fine *n, near_sites *of, uint32_t *site)
{
	while (of->i == of->end) {
		if (of->row > of->last)
			return false;
		const uint32_t *cell = n->cell + (ptrdiff_t)of->row++ * n->across;
		of->i = cell[of->x0];
		of->end = cell[of->x1 + 1];
	}
	*site = n->member[of->i++];
	return true;
}

/* Shares that are added up give the place of a boundary exactly under a box filter. Under Blackman and Harris's of 1.5
 * pixels, which is steeper, that is up to 0.125 pixel too far from pixel centres, and the layers don't tell how they
 * were filtered: halfway between the two neither is off by much. */
static inline float unbiased(float place)
{
	return place - 0.06f * pixel_sin(6.28318531f * place);
}

/* Squared length of a difference. */
static inline float distance2(const float *a, const float *b, int planes)
{
	float sum = 0;
	for (int c = 0; c < planes; c++)
		sum += (a[c] - b[c]) * (a[c] - b[c]);
	return sum;
}

static inline float apart2(const site *a, const site *b)
{
	float dx = a->x - b->x, dy = a->y - b->y;
	return dx * dx + dy * dy;
}

/* ---- chains ---------------------------------------------------------------------------------------------- */

/* What a family is made of: shapes, creases, colours, light, what is seen in mirrors. Older ones come first. */
static inline int rank_of(const site *s)
{
	switch ((enum family)s->family) {
	case FAMILY_CRACK:
	case FAMILY_THIN: return 0;
	case FAMILY_MARK:
	case FAMILY_NORMAL_BAND:
	case FAMILY_NORMAL: return 1;
	case FAMILY_COLOR_BAND:
	case FAMILY_COLOR: return 2;
	case FAMILY_LIGHT_BAND:
	case FAMILY_LIGHT_STEP:
	case FAMILY_LIGHT: return 3;
	default: return 4;
	}
}

static inline bool is_end(const fine *n, uint32_t i)
{
	return !n->site[i].dropped && n->at[i + 1] - n->at[i] == 1;
}

/* The next site of a chain, coming from `from`; UINT32_MAX at its end. */
static inline uint32_t next_of(const fine *n, uint32_t from, uint32_t i)
{
	const uint32_t *to = n->to + n->at[i];
	return n->at[i + 1] - n->at[i] != 2 ? UINT32_MAX : to[0] == from ? to[1] : to[0];
}

/* ---- passes ---------------------------------------------------------------------------------------------- */

/* cracks.c */
void ISA(crack_rows)(void *data, int y0, int y1, int thread);
bool ISA(crack_site)(const fine *n, site *s);
ptrdiff_t ISA(crack_scratch)(const frame *f); /* floats a thread */
static inline void crack_place(site *s, float share)
{
	s->x = (float)s->column + (s->axis == AXIS_ROW ? share : 0);
	s->y = (float)s->row + (s->axis == AXIS_COLUMN ? share : 0);
}

/* light.c */
int32_t ISA(light_even)(fine *n);             /* takes and fills light */
ptrdiff_t ISA(light_scratch)(const frame *f); /* floats a thread */
/* Into how many levels the light of each pixel rises. */
void ISA(level_row)(const fine *n, int y, uint8_t *level);
bool ISA(light_site)(const fine *n, site *s);
/* Strength of the boundary between two values of light; the levels are those of p. */
float ISA(light_contrast)(const fine *n, const encre_params *p, float one, float two);

/* marks.c: marks in the cracks of a row where lines drawn by hand pass. */
void ISA(hand_row)(const fine *n, int y);
bool ISA(hand_site)(const fine *n, site *s);
/* Where a line passes between the pixels of a crack, 0 < place <= 1, or a contour, -place; 0 for nowhere. */
float ISA(hand_place)(const fine *n, const site *s);

/* thin.c: marks thin things; places their cracks again; marks and places sites between those. */
void ISA(thin_rows)(void *data, int y0, int y1, int thread);
void ISA(thin_place)(const fine *n, site *s);
void ISA(thin_mark)(const fine *n, int y, uint8_t *hits, uint16_t *ridge); /* hits: scratch, n->spans */
bool ISA(thin_site)(const fine *n, site *s);
int32_t ISA(thin_tie)(fine *n); /* links these to cracks, when each are linked */

/* density.c: bounds the radius of lines between colours by the room they have. */
int32_t ISA(fine_crowd)(fine *n);

/* ridges.c */
ptrdiff_t ISA(ridge_scratch)(const frame *f); /* floats a thread */
void ISA(ridge_rows)(void *data, int y0, int y1, int thread);
/* steps.c */
void ISA(fine_floors)(fine *n);
bool ISA(ridge_site)(const fine *n, site *s);
/* mirrors.c: finds where the eye passes through or off the front surface. */
int32_t ISA(seen_run)(fine *n);
/* How clearly a ridge of what is sampled from `s` stands out of its surroundings: 0..1. */
float ISA(seen_clarity)(const fine *n, const site *at, int s);

/* sites.c: finds where a placed site takes its controls; returns the style there. */
int ISA(fine_controls)(const fine *n, site *s);
static inline int fine_style(const fine *n, site *s)
{
	return n->f->style ? ISA(fine_controls)(n, s) : 0;
}
/* The site gets this strength, weighted, if it is larger than what it has; returns whether it is an edge now. */
bool ISA(fine_weigh)(const fine *n, site *s, int style, enum source source, float strength);

/* links.c: drops weak sites of a family that hang together with no other ones; drops sites of a family whose chains are
 * too short to be lines. */
int32_t ISA(fine_drop_weak)(fine *n, enum family family);
int32_t ISA(fine_drop_crumbs)(fine *n, enum family family);
/* Fills at and to. */
int32_t ISA(fine_link)(fine *n);
/* Adds links, of sites that may be new. */
int32_t ISA(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t count);
int32_t ISA(fine_smooth)(fine *n);
/* doubles.c: drops chains that run along others. */
int32_t ISA(fine_drop_beside)(fine *n);
/* ends.c */
int32_t ISA(fine_join_ends)(fine *n);
/* picture.c: whether an edge like a's runs from a to b; whether lines from a and b enclose something that ends at x, y.
 */
bool ISA(picture_agrees)(const fine *n, const site *a, const site *b);
bool ISA(picture_wedge)(const fine *n, const site *a, const site *b, int rank, float x, float y);
/* chains.c: whether a line ends at a site, tied to nothing and not cut off by the frame; drops what branches off a line
 * and ends at once. */
bool ISA(leads_nowhere)(const fine *n, uint32_t i);
void ISA(fine_cut_spurs)(const fine *n);
/* Lengths along its chain from each site to the nearest end that is tied to nothing, INFINITY beyond `reach`. */
void ISA(fine_free_lengths)(const fine *n, float reach, float *length);
/* sites.c: fills cell and member. */
int32_t ISA(fine_sort)(fine *n);

#endif
