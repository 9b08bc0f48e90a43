/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the edge stage share: samples.c turns layers into rows of samples, sources.c turns
 * those into the strength of each source, edges.c weighs them and decides. */
#ifndef ENCRE_EDGES_H
#define ENCRE_EDGES_H

#include "edges/detect.h"
#include "edges/window.h"

enum { MAX_ROWS = 2 * MAX_REACH + 1 };

/* What is sampled: each source, SOURCE_SEEN in three ways, of which its own name stands for the normal. */
enum { SAMPLE_SEEN_COLOR = SOURCE_COUNT, SAMPLE_SEEN_DEPTH, SAMPLE_COUNT };

typedef struct edges {
	const frame *f;
	const encre_params *p; /* the scene's */
	gaussians gauss;
	bool on[SAMPLE_COUNT];
	bool fine;           /* sites (fine.h) and not pixels are found */
	bool dog;            /* the detector of depth and normals, else Sobel */
	bool contrast;       /* colour and light are compared by the inter-color metric, else by DOG */
	bool inverse, ortho; /* depth is compared as 1/z, or as z under an orthographic camera */
	float depth_factor;  /* from a detector's response on the samples to strength */
	float weight[SOURCE_COUNT][UINT8_MAX + 1]; /* by style */
	float bump[UINT8_MAX + 1];                 /* by style: of what normals show where chains tell of creases */
	int reach[SAMPLE_COUNT];

	uint8_t *marked; /* width * height: 1 at the pixel that a line drawn by hand passes by; NULL: none is sought */
	struct held_rings *rings; /* for each thread */
	float *samples;           /* rings of all sources, for each thread */
	ptrdiff_t thread_samples, plane_samples;
	ptrdiff_t ring_at[SAMPLE_COUNT];
	/* width * height, of colours with contrast_local: how much they differ there, and at most nearby; FINE knows
	   the latter only, of SAMPLE_SEEN_COLOR, too */
	float *difference[SAMPLE_COUNT], *full[SAMPLE_COUNT];
	wide_window window; /* likewise */
} edges;

/* The rows of samples about the one worked on. Row y lies in slot y modulo their number. */
typedef struct ring {
	const edges *e;
	enum source source;
	int reach, planes;
	int step; /* floats from a pixel to the next: the channels of the only plane, or 1 */
	float *data;
	int held[MAX_ROWS];   /* which row lies in the slot; -1 = none */
	int y;                /* the row about which it has the window; -1 = none */
	float *row[MAX_ROWS]; /* plane 0, sample 0 of its rows; outside the frame of the nearest */
} ring;

/* Channels that are compared. */
static inline int channels_of(enum source s)
{
	return (s >= SOURCE_NORMAL && s <= SOURCE_LIGHT) || s == SOURCE_SEEN || (int)s == SAMPLE_SEEN_COLOR ? 3 : 1;
}

/* What the inter-color metric compares. */
static inline bool is_color(int s)
{
	return s == SOURCE_COLOR || s == SOURCE_LIGHT || s == SAMPLE_SEEN_COLOR;
}

static const float least_full_contrast = 0.25f; /* with contrast_local */

/* The difference of colours that gives an edge of full strength, at pixel x, y. */
static inline float full_contrast(const edges *e, int s, int x, int y)
{
	if (!e->full[s])
		return e->p->contrast_full;
	float most = e->full[s][(ptrdiff_t)y * e->f->width + x];
	return most > least_full_contrast ? most : least_full_contrast;
}

/* Weight of the source color where color_edge is painted: its darks take it away. Where DOG compares colours, they are
 * multiplied with the control (W 3.1). */
static inline float painted_weight(const edges *e, float weight, float control)
{
	return control < 0 ? weight * (1 + control) : e->contrast ? weight : weight + control;
}

/* The least strength, weighted, between two colours where color_edge is painted with more than 0: all white, they are
 * an edge from a CIEDE2000 of 5 on, and no less than half a line. `difference`: a hundredth of it. */
static inline float painted_strength(const edges *e, float control, float difference)
{
	float most = e->p->edge_threshold > 0.5f ? e->p->edge_threshold : 0.5f;
	return e->contrast && control > 0 ? most * min(1, 20 * control * difference) : 0;
}

/* What distances of what is seen are compared in: linear on planes on screen. 0 or less: nothing there. */
static inline float seen_sample(const edges *e, float z)
{
	float most = pixel_great, height = e->f->camera.height;
	float u = e->ortho ? (z > 0 ? -z / height : -most) : z > 0 ? 1 / z : 0;
	return min(max(u, -most), most);
}

/* An empty ring in the memory of a thread. */
ring ISA(ring_of)(const edges *e, enum source s, int thread);
/* Makes the rows of the window about row y that it does not hold yet. `reach` pixels more lie before the first of a row
 * and after the last. */
void ISA(ring_fill)(ring *r, int y);
/* Pointers to pixel x0 of a plane of these rows, as detect.h wants them. */
void ISA(ring_window)(const ring *r, int x0, int plane, const float **row);

/* Strength of the ring's source at n <= TILE pixels from (x0, y); negative = none. The ring has the window about y. */
void ISA(source_strength)(const ring *r, int y, int x0, int n, float *restrict strength);
/* Raises weighted strengths of colours to what is painted there. */
void ISA(source_painted)(const ring *r, int y, int x0, int n, float *restrict strength);
/* Largest colour difference across these pixels. */
void ISA(source_difference)(const ring *r, int x0, int n, float *restrict difference);

/* The detector FINE, which lies above this room (fine/fine.c): planned with what the stage will keep in frame.edges.
 */
void ISA(fine_plan)(frame *f, const edges *e, arena *a);
int32_t ISA(fine_run)(frame *f);

#endif
