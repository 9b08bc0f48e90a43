/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The FINE detector: what its files share. Edges as sites between pixels, linked to polylines.
 *
 * Comes in: the layers, and the edge stage's weights and samples. Goes out: frame.fine, whose sites, cells and links
 * capsules.c inks and nearest.c measures to. fine.c runs the passes in the order of its table. find/ marks, densely and
 * row by row, where sites are, and places each; sites.c gathers them; join/ drops those that another line owns and
 * links what is left.
 *
 * To add a family: write its row in families.rows.h where its turn is. A band or a step needs nothing else, and if what
 * it reads is new, a SAMPLE row and the layer's rows of samples in edges/samples.c. A crack is marked in cracks.c and
 * placed in sites.c, crack_of(). */
#ifndef ENCRE_FINE_H
#define ENCRE_FINE_H

#include "edges/edges.h"
#include "base/pixel.h"

/* ---- families -------------------------------------------------------------------------------------------- */

#define FAMILY(id, ...) FAMILY_##id,
enum family {
#include "fine/families.rows.h"
	FAMILY_COUNT
};

enum kind { KIND_CHAIN, KIND_CRACK, KIND_THIN, KIND_BAND, KIND_STEP, KIND_VALLEY };

/* What a family is made of: shapes, creases, colours, forms, light, what is seen in mirrors. Older ones come
 * first. */
enum rank { RANK_SHAPE, RANK_CREASE, RANK_COLOR, RANK_FORM, RANK_LIGHT, RANK_SEEN, RANK_COUNT };

/* Of a floor; and the marks of a pixel: in fine.crack, fine.ridge, fine.more; of chains it has none. */
enum unit { UNIT_ONE, UNIT_CREASE };
enum word { WORD_CRACK, WORD_RIDGE, WORD_MORE, WORD_NONE, WORD_COUNT };

enum { CHAIN_FAMILIES = 3 };
enum { NO_SAMPLE = SAMPLE_COUNT, LONE = 1, FAINT_SURE = 0, FAINT_FAINT = 1 };

/* families.rows.h tells what the fields are. */
typedef struct family_info {
	const char *name;
	uint8_t kind, sample, rank;
	float floor;
	uint8_t unit;
	bool faint;
	uint8_t crumb, word, bit;
} family_info;
extern const family_info families[FAMILY_COUNT];
/* Pixels to sites of earlier families, of all but shapes, which join them. Where light crosses a threshold that goes
 * round a corner from a step in it, along the other axis, to clear_of_turn: they are one line. */
extern const float clear_of_older, clear_of_turn;
/* Of edge_threshold, of what is FAINT: so strong must be what is a line only beside one. */
extern const float least_faint;

enum form { FORM_VECTOR, FORM_COLOR, FORM_LIGHT, FORM_DISTANCE };

/* Of what is sampled: family 0, of chains, stands for none. */
typedef struct sample_info {
	uint8_t layer, planes, form;
	uint8_t band, step; /* the families that are found in it */
} sample_info;
extern const sample_info samples[SAMPLE_COUNT];

/* The family whose mark in a word a bit is; family 0, of chains, in fine.ridge and fine.more
 * for none. */
extern const uint8_t marked_family[WORD_COUNT][16];

/* Marks of a pixel in fine.crack: CRACK_RIGHT, CRACK_DOWN, LIGHT_... */
#define MARKS_CRACK(id, bit) id##_RIGHT = 1 << (bit), id##_DOWN = 2 << (bit),
#define MARKS_RIDGE(id, bit)
#define MARKS_MORE(id, bit)
#define MARKS_NONE(id, bit)
#define FAMILY(id, kind, sample, rank, floor, unit, faint, crumb, word, bit) MARKS_##word(id, bit)
enum {
#include "fine/families.rows.h"
	RIDGE_MORE = 1 << 14 /* in fine.ridge: the pixel has marks in fine.more */
};
#undef MARKS_CRACK
#undef MARKS_RIDGE
#undef MARKS_MORE
#undef MARKS_NONE

static inline uint16_t mark_of(int family, int axis)
{
	return (uint16_t)(1 << (families[family].bit + axis));
}

/* ---- sites ----------------------------------------------------------------------------------------------- */

/* Which neighbour a crack lies before, or along which axis a ridge was found; a junction joins the cracks of the four
 * pixels from (column, row), a corner two ends that met. */
enum axis { AXIS_ROW, AXIS_COLUMN, AXIS_JUNCTION, AXIS_CORNER };

/* What marking knows of a site, and nothing changes. Numbers of sites grow by family, row, column and axis. */
typedef struct found {
	uint16_t column, row; /* of the pixel */
	uint8_t family, axis;
} found;

/* What placing makes of it. Later passes only even out x and y. */
typedef struct placed {
	float x, y;               /* pixels; centres are whole numbers */
	float strength;           /* weighted */
	float thin, half, inside; /* how much it is a side of a thin thing, half its width, and how far on along the
				     axis its middle lies */
	uint16_t near_x, near_y;  /* of the least depth in the 5x5 about the pixel that held it, of the object that the
				     line bounds: there it takes its controls */
	uint8_t source : 7;       /* the strongest: whose width the line has */
	uint8_t eased;            /* 255ths of its width that it lacks */
	bool weak : 1;            /* of a line only where that goes on beside what is none by itself */
	int8_t step[3]; /* a step's way along its axis through the values of its layer, at most 127 long; else 0 */
} placed;

/* What joining decides. */
typedef struct linked {
	bool dropped;
	bool crumb;   /* dropped because what it hung together with was no line */
	bool held;    /* weak, but of a line */
	float crowd;  /* the line's radius is at most 1 / crowd there */
	float tapers; /* how much that is because what it is of comes to a tip */
} linked;

typedef struct site {
	found found;
	placed placed;
	linked linked;
} site;

/* Marks in fine.hit: a thin thing, other in index or in depth only. */
enum { HIT_OBJECT = 1, HIT_DEPTH = 2, THIN_SPAN = 16 };

enum { CELL = 4 };

/* Tiles that share the frame out evenly, each way at most TILE_SIDE pixels. None has more sites than pixels: beyond
 * that, the strongest. A small frame may have LEAST_BOUND in any case. */
enum { TILE_SIDE = 128, LEAST_BOUND = 4096 };

static inline int pieces_of(int size, int piece)
{
	return (size - 1) / piece + 1;
}

static inline int tiles_of(int size)
{
	return pieces_of(size, TILE_SIDE);
}

/* The first pixel of a tile along a side. */
static inline int tile_from(int tile, int size)
{
	return (int)((int64_t)tile * size / tiles_of(size));
}

/* What chains tell of a site of theirs, besides. */
typedef struct chain_site {
	int32_t run, kind; /* kind: bits of enum encre_chain_kind */
	float s;           /* pixels along the run */
	int32_t mesh, edge;
	float along, gap; /* as in encre_chain_point */
	bool folded;      /* a contour behind which the same thing goes on */
	bool tied;        /* an end that meets something */
	uint8_t end;      /* of the first and the last of a run: enum encre_chain_end */
	float depth;
	int32_t object;
	float keeps_away, halo, beyond; /* pixels about it free of lines, and of anything, that lie deeper than the
					   last */
} chain_site;

typedef struct fine {
	frame *f;
	const edges *e;
	float crease;              /* length of the difference of two normals at crease_angle */
	float floor[FAMILY_COUNT]; /* of what is a step or a band */
	float most_color;          /* the largest weight of colour, without the painted control */
	float least_contrast;      /* between colours across a step */
	float *level_contrast;     /* of each style, each level and each other: how much they differ */
	bool bumps;                /* normals may make edges where no face bends */
	uint8_t *colored;          /* by row: colours may make edges; 2: however little they differ */
	uint8_t *crack;            /* width * height */
	uint8_t *mixed;            /* likewise: all cracks; `crack` has those that make sites */
	uint8_t *hit;              /* spans * height: of THIN_SPAN pixels of a row */
	int spans;
	uint16_t *ridge;  /* width * height */
	uint16_t *more;   /* width * height; NULL: no family is sought that has marks there */
	uint8_t *through; /* width * height: the eye passes through or off the surface here; NULL: nothing is seen */
	uint8_t *glimpse; /* by row: there are such pixels */
	/* Of forms: where they are dark that are lit from the eye. width * height each, NULL: it is not asked. */
	float *lit_rows, *lit;
	float form_sigma; /* pixels */
	uint32_t *marks;  /* by row, and in it by tile: how many marks are kept */
	/* By tile, where it has too many marks, those that are kept, a bit each, by pixel of the tile; NULL: all. */
	uint64_t **kept, *dense; /* dense: the memory of these */
	uint32_t *first;         /* [FAMILY_COUNT * height + 1]: number of the first site of a family's row */
	float *scratch;          /* for each thread */
	ptrdiff_t thread_scratch;

	/* Of chains (fine/chains/): their sites are the first ones, those of shapes before those of creases, and of
	 * colors last. NULL and 0 without. */
	uint32_t chains[CHAIN_FAMILIES]; /* how many of each */
	site *chain_made;                /* until they are gathered */
	chain_site *chain;
	uint32_t (*chain_link)[2], chain_links;
	uint8_t *replaced, *uncut; /* width * height: 1 = chains tell the lines of what is there, 2 = those of its
				      colors; memory of `mixed` */
	float *joints;             /* as between_contours() fills it; NULL: no colours are looked at */
	uint8_t *bent; /* width * height: bit 0, 1: an edge of faces that are shaded flat passes to the right, down */

	uint32_t count;
	site *site;
	/* Sites by cells of CELL pixels each way, ascending within a cell: member[cell[i]] to member[cell[i + 1] - 1].
	 */
	int across, tall;
	uint32_t *cell, *member;
	/* The sites that site i is linked to: to[at[i]] to to[at[i + 1] - 1]. */
	uint32_t *at, *to;
	uint32_t known; /* sites that `at` knows */
} fine;

static inline uint32_t chain_sites(const fine *n)
{
	return n->chains[0] + n->chains[1] + n->chains[2];
}

static inline int rank_of(const site *s)
{
	return families[s->found.family].rank;
}

static inline bool is_chain(const site *s)
{
	return families[s->found.family].kind == KIND_CHAIN;
}

static inline bool is_crack(int family)
{
	return families[family].kind == KIND_CRACK;
}

/* ---- find ------------------------------------------------------------------------------------------------ */

/* cracks.c */
void ISA(crack_rows)(void *data, int y0, int y1, int thread);
bool ISA(crack_site)(const fine *n, const found *at, placed *s);
/* Only its strength; the place tells the style. */
bool ISA(crack_weigh)(const fine *n, const found *at, int style, placed *s);
ptrdiff_t ISA(crack_scratch)(const frame *f); /* floats a thread */
/* A place on the grid on which all sites lie: there float is exact in frames up to 4096 pixels, so that a part of a
 * frame, whose pixels have other numbers, has the bytes of the whole. `off`: pixels from a pixel, or from a site. */
static inline float on_grid(float off)
{
	return floorf(off * 4096 + 0.5f) / 4096;
}

static inline void crack_place(const found *at, float share, placed *s)
{
	share = on_grid(share);
	s->x = (float)at->column + (at->axis == AXIS_ROW ? share : 0);
	s->y = (float)at->row + (at->axis == AXIS_COLUMN ? share : 0);
}

/* contacts.c: the place of a crack where two surfaces touch, as their depths tell it; else `place`, which averages
 * tell, the better the more of each other's surface both pixels hold. */
float ISA(contact_place)(const fine *n, const found *at, float place, float mixed);

/* light.c */
void ISA(light_plan)(fine *n, const edges *e, arena *a);
/* Into how many levels the light of each pixel rises. */
void ISA(level_row)(const fine *n, int y, uint8_t *level);
bool ISA(light_site)(const fine *n, const found *at, placed *s);
/* Where the boundary between two values of light is drawn, one line for all levels between them; NAN: there is none. */
float ISA(light_threshold)(const encre_params *p, float one, float two);
/* Strength of the boundary between two values of light; the levels are those of p. */
float ISA(light_contrast)(const fine *n, const encre_params *p, float one, float two);

/* thin.c: marks thin things, by the slices across them (slices.h); places their cracks again; marks and places sites
 * between those. */
void ISA(thin_rows)(void *data, int y0, int y1, int thread);
void ISA(thin_place)(const fine *n, const found *at, placed *s);
void ISA(thin_mark)(const fine *n, int y, uint8_t *hits, uint16_t *ridge); /* hits: scratch, n->spans */
bool ISA(thin_site)(const fine *n, const found *at, placed *s);

/* mirrors.c: finds where the eye passes through or off the front surface. */
int32_t ISA(seen_run)(fine *n);
/* How clearly a ridge of what is sampled from `s` stands out of its surroundings: 0..1. */
float ISA(seen_clarity)(const fine *n, const found *at, int s);

/* valleys.c: how bright forms are that are lit from the eye, and marks where that has valleys. */
void ISA(valley_plan)(fine *n, const edges *e, arena *a);
ptrdiff_t ISA(valley_scratch)(const fine *n); /* floats a thread */
int32_t ISA(valley_run)(fine *n);
bool ISA(valley_site)(const fine *n, const found *at, placed *s);

/* ridges.c */
ptrdiff_t ISA(ridge_scratch)(const frame *f); /* floats a thread */
void ISA(ridge_rows)(void *data, int y0, int y1, int thread);

/* steps.c */
/* Of the pixels about a site of colours, along its axis, the share at which these turn back. Where that is much, they
 * hold more lines than they can show. */
float ISA(color_turns)(const fine *n, const found *at);
bool ISA(ridge_site)(const fine *n, const found *at, placed *s);
/* Strength, not weighted, of a site between colours of a sample, or levels of light, that differ this much. */
float ISA(color_strength)(const fine *n, const found *at, int sample, float difference);

/* ---- sites.c --------------------------------------------------------------------------------------------- */

/* Finds where a placed site takes its controls; returns the style there. */
int ISA(fine_controls)(const fine *n, const found *at, placed *s);
static inline int fine_style(const fine *n, const found *at, placed *s)
{
	return n->f->style ? ISA(fine_controls)(n, at, s) : 0;
}
/* The site gets this strength, weighted, if it is larger than what it has; returns whether it is an edge now. */
bool ISA(fine_weigh)(const fine *n, placed *s, int style, enum source source, float strength);
/* Likewise, with another weight than the source's. */
bool ISA(fine_weigh_by)(const fine *n, placed *s, float weight, enum source source, float strength);
/* The control color_edge at a site; and the least strength that it gives one between two colours, in the space of the
 * metric. */
float ISA(fine_painted)(const fine *n, const placed *s);
void ISA(fine_paint)(const fine *n, placed *s, const float *one, const float *two);
void ISA(fine_place)(const fine *n, const found *at, placed *s); /* s is cleared, and gets no controls */
float ISA(fine_strength)(const fine *n, const found *at);        /* that of the site, which need not be placed for it */
/* Fills cell and member. */
int32_t ISA(fine_sort)(fine *n);

/* ---- gather.c: makes all sites of the marks, after bounding how many of them a tile has ------------------ */

int32_t ISA(fine_bound)(fine *n);
int32_t ISA(fine_gather)(fine *n);

/* ---- chains/: sites and links of what chains tell -------------------------------------------------------- */

/* Finds their sites, and where pixels make none. */
int32_t ISA(chains_find)(fine *n);
/* Takes back the marks of what comes as chains. */
int32_t ISA(chains_leave)(fine *n);
/* Links their sites. */
int32_t ISA(chains_link)(fine *n);
/* gaps.c: drops lines that pass behind outlines, near these. */
int32_t ISA(chains_keep_away)(fine *n);

/* ---- join ------------------------------------------------------------------------------------------------ */

/* claims.c: drops sites that an earlier family owns, and of each family what is no line. */
int32_t ISA(fine_claim)(fine *n);

/* links.c: the kept sites of its family that a site may be linked to; at most ROOM. */
enum { ROOM = 64 };
int ISA(close_sites)(const fine *n, uint32_t i, uint32_t *to);
/* Of four pixels from (x, y) on with cracks between all: two that lie aslant show one thing, which goes on between the
 * others. 1: the first and the last; 2: the other two; 0: neither do. */
int ISA(crack_passage)(const fine *n, int x, int y);
/* Number of the kept site of a crack at a pixel, or n->count. */
uint32_t ISA(crack_number)(const fine *n, int family, int x, int y, int axis);
/* Fills at and to, ascending. */
int32_t ISA(fine_link)(fine *n);
/* Adds links, of sites that may be new. */
int32_t ISA(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t count);
/* ends.c: sites behind all others, and with them all cells. */
int32_t ISA(fine_add_sites)(fine *n, const site *from, uint32_t count);
/* chains/hidden.c: lines that lie behind things. */
int32_t ISA(chains_add_hidden)(fine *n);
/* Leaves the links between kept sites: where a chain was dropped, the one that it met goes on. */
int32_t ISA(fine_unlink_dropped)(fine *n);
int32_t ISA(fine_smooth)(fine *n);

/* ties.c: links sites of thin things to cracks, when each are linked. */
int32_t ISA(fine_tie)(fine *n);
/* density.c: bounds the radius of lines between colours, and of light, by the room they have. */
int32_t ISA(fine_crowd)(fine *n);
/* borders.c: likewise of light beside older lines. */
int32_t ISA(fine_give_way)(fine *n);
/* slender.c: bounds the radius of lines of thin things, and at tips. */
int32_t ISA(fine_slender)(fine *n);
/* ends.c: leads loose ends on to what lies ahead. */
int32_t ISA(fine_join_ends)(fine *n);
/* doubles.c: drops chains that run along others. */
int32_t ISA(fine_drop_beside)(fine *n);

/* picture.c: whether an edge like a's runs from a to b; whether lines from a and b enclose something that ends at x, y.
 */
bool ISA(picture_agrees)(const fine *n, const site *a, const site *b);
bool ISA(picture_wedge)(const fine *n, const site *a, const site *b, int rank, float x, float y);
bool ISA(picture_corner)(const fine *n, const site *a, const site *b, float x, float y);

/* forms.c: thins lines of forms out that are short or faint, as wholes, and edges inside small things. */
int32_t ISA(fine_ease_forms)(fine *n);

/* chains.c: whether a line ends at a site, tied to nothing and not cut off by the frame; drops what branches off a line
 * and ends at once, and what is too short. */
bool ISA(leads_nowhere)(const fine *n, uint32_t i);
int32_t ISA(fine_cut_spurs)(fine *n);
int32_t ISA(fine_drop_short)(fine *n);
/* Lengths along its chain from each site to the nearest end that is tied to nothing, INFINITY beyond `reach`. */
int32_t ISA(fine_free_lengths)(const fine *n, float reach, float *length);

#endif
