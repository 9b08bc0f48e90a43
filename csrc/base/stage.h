/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a stage is, and what it can see.
 *
 * To add a stage: write NAME.rows.h (a STAGE row, then its parameters), name it in all.rows.h and in STAGES below in
 * the order in which stages run, and write NAME.c: row kernels, the run function, the descriptor
 * `const stage STAGE_SYMBOL(NAME) = {...}`. A stage that changes the picture has a SWITCH: a frame in which all are off
 * is only copied. Its products, if others read them, are fields of `frame`.
 *
 * Stage files are compiled once per instruction set; everything in them is static but the descriptor and the few
 * functions that are declared here and named with ISA(). */
#ifndef ENCRE_STAGE_H
#define ENCRE_STAGE_H

#include "base/arena.h"
#include "base/bands.h"
#include "base/params.h"
#include "base/pixel.h"

#include <stddef.h>

/* ENCRE_ISA is `base` or `v3`, given by the build. */
#ifndef ENCRE_ISA
#define ENCRE_ISA base
#endif
#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)
#define ISA(name) JOIN(name, ENCRE_ISA)
#define STAGE_SYMBOL(name) ISA(JOIN(stage, name))

/* A kernel that gets constants where it is called, and is to be a loop of its own for each: compilers that go by size
 * alone, as clang does, would make one for all of them that is not vectorised. */
#define KERNEL static inline __attribute__((always_inline))

#define STAGES(X)                                                                                                      \
	X(edges)                                                                                                       \
	X(shade)                                                                                                       \
	X(example) X(gouache) X(smudge) X(paper) X(wash) X(hatch) X(tones) X(rim) X(specks) X(print) X(relief) X(lines)

#define NUMBER(name) STAGE_##name,
enum { STAGES(NUMBER) N_STAGES };
#undef NUMBER

/* ---- frame: what stages read and make -------------------------------------------------------------------- */

typedef struct plane {
	float *data;   /* NULL = absent; pixels are packed: channels floats each */
	ptrdiff_t row; /* floats from one row to the next; may be negative */
} plane;

enum source {
	SOURCE_OBJECT,
	SOURCE_MATERIAL,
	SOURCE_DEPTH,
	SOURCE_NORMAL,
	SOURCE_COLOR,
	SOURCE_LIGHT,
	SOURCE_MARK,
	SOURCE_SEEN, /* this and what follows: FINE's only */
	SOURCE_SUGGESTIVE,
	SOURCE_HIDDEN,
	SOURCE_COUNT
};

/* Channels of the layer `controls`. */
#define CONTROL(id, ...) CONTROL_##id,
enum control {
#include "base/controls.rows.h"
	CONTROL_COUNT
};
/* Channels of the layer `anchor`. */
enum {
	ANCHOR_POSITION = 0, /* rest position, 3 */
	ANCHOR_NORMAL = 3,   /* rest normal, 3 */
	ANCHOR_PIXEL = 6,    /* rest units per pixel of a surface that faces the camera; 0 = nothing there */
	ANCHOR_RIGHT = 7,    /* growth of the position to the right neighbour, 3 */
	ANCHOR_DOWN = 10,    /* and to the lower one */
	ANCHOR_FORM = 13,    /* where it bends most, as long as it bends that way alone, 0..1; 3 */
	ANCHOR_COUNT = 16
};
/* Channels of the layer `card`. */
enum {
	CARD_POSITION = 0, /* to the right and up on the sheet, 2 */
	CARD_RIGHT = 2,    /* its growth to the right neighbour, 2; 0 = nothing there */
	CARD_COUNT = 4
};
_Static_assert((int)CONTROL_COUNT <= (int)ENCRE_MAX_CHANNELS, "encre_raster() draws them in one go");

/* The pixel that a thread asks for next, and where its rows end. Each in a line of the cache of its own. */
typedef struct ahead {
	int x, y, end, apart[13];
} ahead;

/* From light to what thresholds are compared with: up to a light by one factor, beyond it by another. Full light is
 * what becomes 1. */
typedef struct metering {
	float knee, below, beyond, full;
} metering;

/* What was drawn as strokes, for whoever asked: made by malloc(). */
typedef struct drawn_strokes {
	encre_stroke_point *point;
	size_t count, room;
} drawn_strokes;

typedef struct frame {
	int width, height;
	plane layer[ENCRE_LAYER_COUNT]; /* finite values, controls within -1..1, ALBEDO never absent; depth as given */
	plane output[ENCRE_OUTPUT_COUNT]; /* COMBINED never absent: stages from shade on change it in place */
	encre_camera camera;
	encre_frame place;
	float scale;                     /* pixels of this frame per "px" of a parameter (length_unit) */
	metering metered;                /* of light by shade_meter */
	const encre_chain_point *chains; /* these four as the job has them */
	int64_t n_chains;
	const uint8_t *chained;
	int64_t n_chained;
	drawn_strokes *strokes; /* of lines, to be told; NULL: nobody asks */
	int n_styles;
	const encre_params *params; /* [n_styles]; [0] is the scene's */
	const uint8_t *style;       /* width * height, < n_styles; NULL when n_styles is 1 */
	/* render: what the first reading reads, and the picture that it draws; how far each thread has asked for it */
	struct {
		plane from;
		int channels;
	} read[ENCRE_LAYER_COUNT + 1];
	int reads;
	ahead *ahead;
	bool want_edges; /* someone reads edges: lines, smudging or the output */
	int reading;     /* grows when layers are read anew, as some were not clean */
	bool edges_kept; /* what the stage of edges has made of the same layers before is there again, where it plans */
	switches any;    /* the switch is on in some style */
	bands *bands;

	/* edges: */
	uint8_t *edge;   /* width * height: 0, or 1 + enum source of an edge pixel; NULL unless want_edges */
	float *strength; /* width * height, valid at edge pixels: their strength */
	uint8_t *near; /* width * height, valid at edge pixels: place (dy + 2) * 5 + dx + 2 of the pixel with the least
			  depth in the 5x5 window, from which an edge takes its controls */
	/* nearest.c (planned when smudging or a search needs it): */
	bool nearest_planned; /* by any stage: nearest_plan() takes its memory once */
	int16_t *
		nearest; /* width * height x 2: dx, dy to the Euclidean-nearest edge pixel; NEAREST_NONE in dx = none */
	void *nearest_scratch; /* NULL once nearest is filled */
	/* search.c, likewise: the edge of every pixel by another search; done: it is filled */
	void *search;
	bool search_planned, search_done;
	/* paper: heights h(p) after roughness, clamped to 0..1; call ISA(paper_row) */
	void *paper;
	void **kept_sheet; /* the context's: the built-in sheet of its frames before, or NULL; made by malloc() */
	void **kept_spots; /* likewise: the places of spots that are known (tones/blue.h) */
	void *example;     /* the painted balls of each style */
	/* edges, lines: scratch */
	void *edges, *lines;
	bool hatches_along; /* no stage between shade and hatching draws by the whole picture */
	float *bright; /* shade: what hatching asks of rows, by thread those that are drawn together (bright_row());
			  NULL: it finds out itself */
	void *gouache; /* gouache: room and strokes */
	void *wash;    /* wash: masks of washes and noise that sticks */
	void *rim;     /* rim: sites along silhouettes */
	void *specks;  /* specks: what is no black */
	void *tones;   /* tones: those of each style, and ink of strokes */
	void *fine;    /* sites and links of detector FINE (fine.h), else NULL; then edge, strength and near are NULL */
	late *late;
} frame;

enum { NEAREST_NONE = INT16_MIN, NEAREST_FAR = INT16_MAX - 1 /* pixels: no edge farther than that is counted */ };

/* Pixels per "px" of a parameter, in a full frame of this height. */
static inline float scale_of(const encre_params *scene, int height)
{
	if (scene->length_unit == length_unit_PIXELS)
		return (float)scene->supersample;
	return (float)height / (scene->length_unit == length_unit_MM ? scene->page_height : 1080);
}

enum { NEAR_ROWS = 2 /* of all layers, looked at and drawn together: that many stay in the cache */ };

static inline float *bright_row(const frame *f, int y, int thread)
{
	return f->bright + ((ptrdiff_t)thread * NEAR_ROWS + y % NEAR_ROWS) * f->width;
}

/* How far, in pixels, anyone looks for the nearest edge pixel. */
static inline float nearest_reach(const encre_params *params, int n_styles, float scale)
{
	float reach = 0;
	bool any_lines = false;
	for (int i = 0; i < n_styles; i++) {
		float range = params[i].use_smudging ? params[i].smudge_range * scale : 0;
		reach = range > reach ? range : reach;
		any_lines |= params[i].use_lines;
	}
	float widest =
		any_lines && params->line_search == line_search_NEAREST ? 0.5f * params->line_thickest * scale : 0;
	return widest > reach ? widest : reach;
}

/* The image with strides: 0 stands for those of pixels and rows without gaps. */
static inline encre_image with_strides(encre_image image)
{
	if (!image.pixel_stride)
		image.pixel_stride = (int64_t)sizeof(float) * image.channels;
	if (!image.row_stride)
		image.row_stride = image.pixel_stride * image.width;
	return image;
}

/* Of an image that has strides. */
static inline float *pixel_at(const encre_image *image, int x, int y)
{
	return (float *)((char *)image->data + y * image->row_stride + x * image->pixel_stride);
}

/* Asks the memory for pixels x..end - 1 of a row, which are wanted soon, between other work: that goes on meanwhile. */
static inline void fetch(plane p, int channels, int y, int x, int end)
{
	enum { LINE = 16 };
	const float *row = p.data + y * p.row;
	for (ptrdiff_t i = (ptrdiff_t)channels * x; i < (ptrdiff_t)channels * end; i += LINE)
		__builtin_prefetch(row + i, 0, 2);
	__asm__ volatile(""); /* or the compiler takes it for nothing */
}

/* Likewise some of the rows that the thread looks at next. Who draws with the first reading calls it now and then,
 * about as often as AHEAD pixels are drawn: so few that the memory's queue holds what is asked for, or it waits. */
static inline void fetch_ahead(const frame *f, int thread)
{
	enum { AHEAD = 8 };
	ahead *a = f->ahead + thread;
	if (a->y >= a->end)
		return;
	int end = f->width - a->x < AHEAD ? f->width : a->x + AHEAD;
	for (int i = 0; i < f->reads; i++)
		fetch(f->read[i].from, f->read[i].channels, a->y, a->x, end);
	a->x = end < f->width ? end : 0;
	a->y += end == f->width;
}

/* NULL where it is absent. */
static inline const float *layer_row(const frame *f, enum encre_layer layer, int y)
{
	plane p = f->layer[layer];
	return p.data ? p.data + y * p.row : NULL;
}

static inline float *output_row(const frame *f, enum encre_output output, int y)
{
	plane p = f->output[output];
	return p.data ? p.data + y * p.row : NULL;
}

/* Interleaved channels of n pixels to planes, `apart` floats from one to the next: loops over these vectorise best.
 * Called with a constant number of channels each time. */
KERNEL void split_channels(const float *restrict in, const int channels, int n, ptrdiff_t apart, float *restrict plane)
{
	for (int i = 0; i < n; i++)
		for (int c = 0; c < channels; c++)
			plane[c * apart + i] = in[channels * i + c];
}

/* The painted controls of pixel x of row y, then those of the pixels after it; NULL where nothing is painted. */
static inline const float *controls_at(const frame *f, int x, int y)
{
	const float *row = layer_row(f, ENCRE_LAYER_CONTROLS, y);
	return row ? row + (ptrdiff_t)CONTROL_COUNT * x : NULL;
}

/* Likewise the ANCHOR_COUNT channels of the layer `anchor`; NULL where it is absent. */
static inline const float *anchor_at(const frame *f, int x, int y)
{
	const float *row = layer_row(f, ENCRE_LAYER_ANCHOR, y);
	return row ? row + (ptrdiff_t)ANCHOR_COUNT * x : NULL;
}

/* How far a surface is a metal, by its colour as a mirror (the layer `gloss`): plain surfaces mirror some hundredths of
 * the light, which stay highlights on them. */
static inline float metal_share(const float *gloss)
{
	return clamp01(8 * (max3(gloss[0], gloss[1], gloss[2]) - 0.06f));
}

/* How far a normal points along one of the camera's axes, 0..2: right, up, towards the eye. */
static inline float turned_to(const frame *f, int axis, const float *normal)
{
	const float *v = f->camera.view + 3 * axis;
	return v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2];
}

/* What is painted onto the light of pixel i of controls_at(), exposed: half at full paint. */
static inline float painted_light(const float *controls, ptrdiff_t i)
{
	return controls ? 0.5f * controls[CONTROL_COUNT * i + CONTROL_LIGHT] : 0;
}

/* INFINITY where nothing is there. */
static inline float depth_at(const frame *f, int x, int y)
{
	return depth_of(layer_row(f, ENCRE_LAYER_DEPTH, y)[x]);
}

static inline int style_at(const frame *f, int x, int y)
{
	return f->style ? f->style[(ptrdiff_t)y * f->width + x] : 0;
}

static inline const encre_params *params_at(const frame *f, int x, int y)
{
	return f->params + style_at(f, x, y);
}

/* By which a style's thresholds are compared with light. */
static inline metering metering_of(const frame *f, const encre_params *p)
{
	metering m = f->metered;
	m.below = min(p->shade_exposure * m.below, FLT_MAX);
	m.beyond = min(p->shade_exposure * m.beyond, FLT_MAX);
	return m;
}

static inline float exposed(metering m, float light)
{
	return min(light, m.knee) * m.below + max(light - m.knee, 0) * m.beyond;
}

/* Light that a style's levels are compared with: the brightest channel of diffuse light, exposed, and what is painted
 * onto it. */
static inline float exposed_at(const frame *f, const encre_params *p, int x, int y)
{
	const float *d = layer_row(f, ENCRE_LAYER_DIFFUSE, y) + (ptrdiff_t)3 * x;
	return exposed(metering_of(f, p), max3(d[0], d[1], d[2])) + painted_light(controls_at(f, x, y), 0);
}

/* Parameters of the style of pixel x of row y, and in *end where the run of pixels with that style ends, at most x1. */
static inline const encre_params *style_run(const frame *f, int y, int x, int x1, int *end)
{
	*end = x1;
	if (!f->style)
		return f->params;
	const uint8_t *style = f->style + (ptrdiff_t)y * f->width;
	for (int i = x + 1; i < x1; i++)
		if (style[i] != style[x]) {
			*end = i;
			break;
		}
	return f->params + style[x];
}

typedef struct stage {
	const char *id;
	/* What no single row can say, of one style's parameters: NULL, or a sentence in text[size]. May be NULL. */
	const char *(*check)(const encre_params *params, char *text, size_t size);
	/* Whether it reads edges of this frame. NULL: never. */
	bool (*reads_edges)(const frame *f);
	/* Takes the stage's products and scratch from the arena. May be NULL. */
	void (*plan)(frame *f, arena *a);
	/* These return ENCRE_OK, ENCRE_ERROR_CANCELLED or ENCRE_ERROR_MEMORY. Each may be NULL; not all. */
	/* What needs parameters alone. Called when planned, before any layer may be read. */
	int32_t (*prepare)(frame *f);
	/* Reads rows of layers, and the rows beside them, with the look that says whether they are clean, and once more
	 * where they were not: what run() would read again. May be NULL. */
	bands_kernel first_rows;
	/* Called in order. */
	int32_t (*run)(frame *f);
	/* Draws rows of the picture, given the frame, and reads of the picture the same rows alone, of layers those and
	 * the ones beside them. So it runs where these are in the cache: with the look at the layers that says whether
	 * they are clean, if no stage with run() draws before, and then once more where they were not; else after
	 * run(). */
	bands_kernel rows;
	/* Whether run() changes the picture, or makes what rows() needs. NULL: it does. */
	bool (*draws)(const frame *f);
} stage;

#define DECLARE(name) extern const stage JOIN(stage, JOIN_(name, base)), JOIN(stage, JOIN_(name, v3));
STAGES(DECLARE)
#undef DECLARE

/* lit.c: I of discrete shading for pixels x0..x1-1 of row y, each by its own style, whether or not shading is on. */
void ISA(shade_tones)(const frame *f, int y, int x0, int x1, float *tone);
/* lit.c: light as levels are compared with it, of row y. */
void ISA(shade_exposed)(const frame *f, int y, float *light);
/* hatch.c: brightness that keeps the pencil away from n <= 256 pixels, at most 1. Planes of the layers, `apart` floats
 * from one to the next, light as levels are compared with it, and I of discrete shading. */
void ISA(hatch_bright)(const encre_params *p, int n, ptrdiff_t apart, const float *restrict combined,
		       const float *restrict color, const float *restrict diffuse, const float *restrict exposed,
		       const float *restrict tone, float *restrict bright);
/* paper.c: heights h of the paper (after roughness, 0..1) for pixels x0..x1-1 of row y; `none` where there is no
 * paper (lines see 1, hatching 0.5). Coordinates are of this frame's images; the sheet starts at the full frame's
 * top left. */
void ISA(paper_row)(const frame *f, int y, int x0, int x1, float none, float *height);
/* hatch.c: of n <= 256 pixels of a style, from x on of row y, their brightness 0..1 becomes the pencil's cover. False,
 * and nothing is written, where the pencil reaches none of them. */
bool ISA(hatch_cover)(const frame *f, const encre_params *p, int y, int x, int n, float *bright);
/* specks.c: fills specks in the picture, in `ink` as well unless its data is NULL. */
int32_t ISA(specks_fill)(frame *f, bool drawn, plane ink);
/* nearest.c: exact Euclidean nearest edge pixels; ties: least distance, row, column. plan is called by the stages
 * that read frame.nearest (twice is once); run fills it if it isn't filled. Edges farther than `reach` pixels may be
 * reported as none. */
void ISA(nearest_plan)(frame *f, arena *a);
int32_t ISA(nearest_run)(frame *f);
/* The way from a pixel to its nearest edge, with detector FINE the nearest site, and where line_search walks or
 * dilates the edge that it finds; false if none is within reach. After nearest_run(). */
bool ISA(nearest_edge)(const frame *f, int x, int y, float reach, float way[2]);

#endif
