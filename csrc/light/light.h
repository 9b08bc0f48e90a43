/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files that draw light share: the picture with a margin around it, and what each pixel's centre shows. */
#ifndef ENCRE_LIGHT_H
#define ENCRE_LIGHT_H

#include "light/lamp.h"
#include "light/pack.h"

/* Pixels around the images that are drawn, too: where a shadow is soft, a pixel of the border takes part in what is
 * done with others as far away as that; where all are hard, the line of an edge goes through places beside it. */
enum { LIGHT_MARGIN = 31, LIGHT_MARGIN_HARD = 7 };

/* Of the squares of the full frame over which points are dealt the first begins so far within the margin: pictures stay
 * as they are when the margin grows. */
enum { DEALT_FROM = 1 };

enum { SURFACE_NOTHING = -1, SURFACE_STRAY = -2 /* of no geometry: only depth and normal tell of it */ };

typedef struct surface {
	vec at, normal;             /* normal: by which light falls; towards the eye, as `across` */
	vec lift, across;           /* how far above it rays begin that graze it; of the triangle, length 1 */
	int32_t instance, triangle; /* or SURFACE_... */
	bool turned;                /* whether a normal map tells the normal */
} surface;

/* What a lamp does at a pixel: 0 where none of its light would come. Of a lamp with a size its middle's doings, LIT or
 * DARK where they were asked for, lie CORE_SHIFT higher. */
enum { LIT = 1, DARK = 2, MIXED = LIT | DARK, CORE_SHIFT = 2 };

/* An ellipsoid that bends light. */
typedef struct bend {
	double inverse[12]; /* world -> the ball of radius 1 */
	float amount, fade;
} bend;

typedef struct light {
	const encre_light_job *job;
	bands *bands;
	world world;
	int margin;
	int width, height;  /* with the margin */
	double origin[3];   /* of the scene, which is 0 in the world */
	double view[16];    /* world -> camera */
	double inverse[16]; /* clip -> world */
	double farthest;    /* depth up to which something is looked for beyond the images */
	surface *surfaces;
	uint8_t *state, *silhouette; /* silhouette: where it passes, 0: nowhere, see silhouette.c */
	float *plain;                /* light without shadows */
	float *share;                /* what of it comes */
	float *cut;   /* two each: where on the ways to the right and down an edge passes, negative: nowhere */
	float *asked; /* of lamps with a size: what the first points of a pixel say, see soft.c */
	float *spare; /* shares while they are smoothed */
	float *exact; /* 1: the share is that of an edge whose place is known; by_line; negative: few points were asked,
		       * and agree with those about */
	float *sum;   /* three each: the light of all lamps so far */
	double clip[16]; /* world -> clip */
	lamp lamp;
	bool soft;   /* whether its shadows are */
	bool shines; /* whether it makes highlights */
	vec eye;     /* where the camera stands; with eye_far: the way to it, the same everywhere */
	bool eye_far;
	lamp_points points;
	bend bends[ENCRE_MAX_BENDS];
	int n_bends;
} light;

/* A triangle in the world. */
typedef struct facet {
	int32_t count, triangle; /* of instances up to its own; 0: none yet */
	double corner[3][3], first[3], second[3], across[3];
	vec side, normal[3]; /* of length 1; normals of the corners, where it is smooth */
} facet;

/* Those that place.c found last, by the last bits of their numbers: neighbours mostly show the same. */
enum { FACETS = 64 };
typedef struct facets {
	facet of[FACETS];
} facets;
#define FACETS_NONE ((facets){{{0}}})

/* What rays that go to a lamp remember of each other. `shaft`, for such as are asked at once, may be NULL. */
typedef struct rays {
	hint hint;
	shaft *shaft;
	facets facets;
} rays;
#define RAYS(shaft) ((rays){HINT_NONE, shaft, FACETS_NONE})

/* bend.c: reads the job's ellipsoids; bends a surface's normal; what share of a way from a place lies in ellipsoids
 * that hold the place. */
void ISA(bend_make)(light *l);
void ISA(bend_normal)(const light *l, surface *s);
float ISA(bend_free)(const light *l, vec at, vec way);

/* place.c: fills the surfaces. */
int32_t ISA(place_run)(light *l);
/* What the way of sight through a place in pixels of the picture with its margin meets on the surface that the centre
 * of another pixel shows; *inside: whether it is still the same triangle. */
surface ISA(place_on)(const light *l, facets *known, const surface *near, float x, float y, bool *inside);
/* What lies nearest of an instance at a place in pixels of the picture with its margin. */
surface ISA(place_of)(const light *l, facets *known, int32_t number, double x, double y);
/* silhouette.c: finds silhouettes, if the job asks for rims; what the light of pixel i is that of; the lamp's light
 * there.
 */
int32_t ISA(silhouette_run)(light *l);
surface ISA(silhouette_place)(const light *l, facets *known, ptrdiff_t i);
float ISA(silhouette_light)(const light *l, rays *from, ptrdiff_t i);
/* Where in the full frame a place is, in pixels; far outside if it is behind the camera. */
void ISA(place_pixel)(const light *l, vec at, double out[2]);

/* shadow.c: the shares of light of one lamp; soft.c: of one with a size. shadow_plain: its light on a surface, what is
 * in the way aside. */
float ISA(shadow_plain)(const light *l, const surface *s);
int32_t ISA(shadow_run)(light *l);
int32_t ISA(soft_run)(light *l);
/* In `asked`: how much of the light of a pixel's first points comes, 2 more for each kind; PARTED: of all of the lamp's
 * light. */
enum { COUNTED, PARTED, CROOKED, UNASKED = -1 };

static inline int asked_kind(float asked)
{
	return (int)(0.5f * asked);
}

/* narrow.c: puts what the edges of narrow penumbrae leave into `spare`, where all points are asked, and how much that
 * counts into `exact`; narrow_thin where there are edges of something thin. It looks NARROW_REACH pixels far. */
enum { NARROW_REACH = 4 };
static const float narrow_thin = -1;
static const float by_line = 2; /* `exact` where straight.c knows the share */
int32_t ISA(narrow_run)(light *l);
/* lone.c: what a pixel's share lacks so that grain does not let it stand out from all about it; what of the light of
 * all lamps a pixel within the margin keeps. */
float ISA(lone_grain)(const light *l, const float *share, int x, int y);
float ISA(lone_rim)(const light *l, int x, int y);
/* straight.c: the share of a lamp's light that comes to a place if a line or corner parts it, by its LAMP_FIRST points,
 * of which each gives `value`, and those whose bits are set, but not all, are seen. False if none does. */
bool ISA(straight_share)(const light *l, const surface *s, const lamp_point *points, const float *value, uint32_t seen,
			 rays *from, float *share);
/* ask.c: adds a point's light to *all, and to *seen if nothing is in its way. */
void ISA(ask_point)(const light *l, const surface *s, const lamp_point *q, float *all, float *seen, rays *from);

/* Points of a lamp that are asked from places at once, side by side. */
typedef struct asking {
	int count;
	vecs at, normal, lift, across;
	float off[PACK];
	float square[2][PACK], disc[2][PACK];
	pack rays;
	surface first; /* once more, where there are no more */
	lamp_point first_point;
	float value[PACK]; /* of those that were asked last; 0 where none would come */
} asking;

/* Adds a point to fewer than PACK; start: as of a shaft. */
void ISA(ask_add)(asking *a, const surface *s, const lamp_point *q, int start);
/* Empties it: the bits of those, of at least one, whose light comes. through: may be NULL. */
unsigned ISA(ask_all)(const light *l, asking *a, shaft *through);
/* Sums what `count` points that were asked last give, as ask_point() does. */
static inline void ask_sum(const asking *a, unsigned comes, int first, int count, float *all, float *seen)
{
	for (int k = first; k < first + count; k++) {
		*all += a->value[k];
		*seen += comes >> k & 1 ? a->value[k] : 0;
	}
}

/* Of the pixels `left`, a bit each from (x, y) on, row by row of SHAFT_SIDE, those that lie on one surface, and a shaft
 * from them and, with `apron`, from the pixels about them. */
uint64_t ISA(ask_group)(const light *l, int x, int y, uint64_t left, int apron, shaft *to);
/* What is nearest on the way to the lamp's middle; false if nothing is. */
bool ISA(ask_thrower)(const light *l, const surface *s, vec *place);

/* A bit for each pixel of the square from (x, y) on, above row `end`, that is wanted, row by row of SHAFT_SIDE;
 * wanted() is called for all, and may fill what they have. */
static inline uint64_t square_of(light *l, int x, int y, int end, bool (*wanted)(light *l, int x, int y))
{
	uint64_t bits = 0;
	for (int v = y; v < y + SHAFT_SIDE && v < end; v++)
		for (int u = x; u < x + SHAFT_SIDE && u < l->width; u++)
			bits |= (uint64_t)wanted(l, u, v) << ((v - y) * SHAFT_SIDE + u - x);
	return bits;
}

/* shine.c: adds the lamp's highlights to a row of the picture. */
void ISA(shine_row)(const light *l, int y);
/* Fills `cut`. */
void ISA(edge_rows)(void *light, int y0, int y1, int thread);

/* The line by which a shadow passes a pixel's centre: dot of (x, y) = far, in pixels from it, through (a, 0) and (0,
 * b). */
typedef struct edge_line {
	float x, y, far, a, b;
} edge_line;

bool ISA(edge_at)(const light *l, int x, int y, edge_line *e);

/* The lamp's light at a pixel, as a part of it and of what the world and the lamps before it give there. */
static inline float part_of(const light *l, ptrdiff_t i)
{
	const float *sum = l->sum + 3 * i, *color = l->lamp.color;
	float own = l->plain[i] * max(max(color[0], color[1]), color[2]), before = max(max(sum[0], sum[1]), sum[2]);
	return own / (own + before);
}

static inline int core_at(const light *l, ptrdiff_t i)
{
	return l->state[i] >> (l->soft ? CORE_SHIFT : 0) & MIXED;
}

static inline bool one_surface(const surface *a, const surface *b)
{
	vec d = minus(b->at, a->at);
	float near = 0.3f * sqrtf(dot(d, d));
	return dot(a->across, b->across) > 0.5f && fabsf(dot(d, a->across)) <= near && fabsf(dot(d, b->across)) <= near;
}

/* Whether a place shows the surface of another pixel, and some of the lamp's light may come there. */
static inline bool goes_on(const light *l, int x, int y, int u, int v)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x, j = (ptrdiff_t)v * l->width + u;
	return u >= 0 && v >= 0 && u < l->width && v < l->height && l->state[j] &&
	       one_surface(l->surfaces + i, l->surfaces + j);
}

#endif
