/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encre: comic-book rendering of finished layers, as a plain C library.
 *
 * A caller fills an encre_job with images it owns (the layers of a rendered frame and the outputs it wants),
 * parameter blocks packed after encre_stage_info(), a camera and a frame, and calls encre_render(). Nothing is
 * kept of the job after the call. Sizes of all structs are fixed; new fields are added at the end and
 * ENCRE_API_VERSION grows. A context may be used by one thread at a time; several contexts are independent. */
#ifndef ENCRE_H
#define ENCRE_H

#include <stdbool.h>
#include <stdint.h>

#if defined _WIN32
#define ENCRE_API __declspec(dllexport)
#else
#define ENCRE_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

enum { ENCRE_API_VERSION = 25 };

/* What every function that returns int32_t returns. */
enum encre_code {
	ENCRE_OK = 0,
	ENCRE_ERROR_ARGUMENT = 1,  /* the sentence in encre_error() names the thing and the cure */
	ENCRE_ERROR_MEMORY = 2,    /* an allocation failed; outputs are unspecified */
	ENCRE_ERROR_CANCELLED = 3, /* progress returned false, or encre_cancel(); outputs are unspecified */
	ENCRE_RUNNING = 4,         /* encre_poll() alone: work goes on */
};

/* ---- images ---------------------------------------------------------------------------------------------- */

/* A caller-owned image of float32 samples. data NULL = absent, else a multiple of 4. Sample c of pixel (x, y), row 0 at
 * the top, lies at (char *)data + y * row_stride + x * pixel_stride + 4 * c. Strides are in bytes, multiples of 4, at
 * most 2^45; 0 stands for "packed". A pixel_stride is at least a pixel; a row_stride at least a row, or negative and so
 * long (a picture stored bottom-up), or the other way round, where columns follow each other in memory. Inputs may
 * share memory. An output shares no byte with anything else of the job; between the samples of another image of the
 * same strides it may lie, as where the channels of several are stored pixel by pixel. */
typedef struct encre_image {
	float *data;
	int32_t width, height, channels, reserved;
	int64_t pixel_stride, row_stride;
} encre_image;

/* The layers that encre_render() reads; encre_layer_info() gives names, channels and meanings. */
enum encre_layer {
	ENCRE_LAYER_COMBINED = 0, /* 4: the rendered image, scene-linear, premultiplied alpha */
	ENCRE_LAYER_COLOR,        /* 3: diffuse surface colour, scene-linear */
	ENCRE_LAYER_ALBEDO,       /* 3: unlit colour of any surface (absent: color) */
	ENCRE_LAYER_DIFFUSE,      /* 3: diffuse light without the surface colour */
	ENCRE_LAYER_SPECULAR,     /* 3: reflected specular light (absent: 0) */
	ENCRE_LAYER_DEPTH,        /* 1: distance along the view axis, scene units; nothing: >= 1e9, <= 0, not finite */
	ENCRE_LAYER_NORMAL,       /* 3: world-space normal averaged over the pixel; 0 = nothing there */
	ENCRE_LAYER_OBJECT,       /* 1: object index, an integer in a float (absent: constant) */
	ENCRE_LAYER_MATERIAL,     /* 1: material index, likewise */
	ENCRE_LAYER_STYLE,        /* 1: style number, 0 = the scene's (absent: 0) */
	ENCRE_LAYER_CONTROLS,     /* painted controls -1..1, one for each encre_control_info() (absent: 0) */
	/* What the eye sees: in a mirror the thing mirrored, through clear glass the thing behind it, else the surface
	   itself; averaged over the pixel. FINE draws lines in it if seen_color and seen_normal are there. */
	ENCRE_LAYER_SEEN_COLOR,  /* 3: unlit colour */
	ENCRE_LAYER_SEEN_NORMAL, /* 3: normal in the space of the camera, which looks along -z */
	ENCRE_LAYER_SEEN_DEPTH,  /* 1: as depth, along the way that light takes; 0 = nothing there (may be absent) */
	ENCRE_LAYER_HIGHLIGHTS,  /* 3: what of specular comes straight from lamps (absent: 0) */
	ENCRE_LAYER_BACKGROUND,  /* 3: what of combined is light of the world behind everything (absent: all of it where
				    nothing is there, else 0) */
	/* Where on the thing: by what drawn texture sticks to a surface, from this frame alone. In units of the rest
	   position, which are those of object space as a rule, but for a scale that is not the same all ways. */
	ENCRE_LAYER_ANCHOR,  /* 16: of what is at the pixel's centre, 0 to 2 its rest position P: where it was before
				its mesh was bent; 3 to 5 the normal there, of length 1, as the resting surface is
				shaded; 6 how much of P a pixel spans on a surface that faces the camera, > 0, 0 =
				nothing there; 7 to 9 and 10 to 12 by how much P grows per pixel to the right and down;
				13 to 15 the direction in which the resting surface bends most, either way along it, as
				long as it bends that way alone: 1 of a cylinder, 0 of a ball or a plane (absent: nothing
				sticks) */
	ENCRE_LAYER_GLOSS,   /* 3: unlit colour of what mirrors: specular without its light (absent: 0) */
	ENCRE_LAYER_TANGENT, /* 3: the direction on the resting surface in which U of its UV map grows, of length 1; 0:
				it has none (absent: none has) */
	ENCRE_LAYER_CARD,    /* 4: of what is at the pixel's centre, its place on a sheet that stands where the object
				has its origin, faces the eye and rolls with the object's up: 0 and 1 to the right and
				up, in world units; 2 and 3 by how much they grow per pixel to the right, so that they
				grow by 3 and less 2 downward; 0 = nothing there (absent: as nothing) */
	ENCRE_LAYER_COUNT
};

/* The images that encre_render() writes; absent ones are not computed. */
enum encre_output {
	ENCRE_OUTPUT_COMBINED = 0, /* 4: the finished picture, scene-linear, premultiplied alpha */
	ENCRE_OUTPUT_LINES,        /* 4: ink * T, T: the lines alone, premultiplied */
	ENCRE_OUTPUT_SURFACE,      /* 4: the picture before the lines */
	ENCRE_OUTPUT_EDGES,        /* 1: edge strength */
	ENCRE_OUTPUT_LIGHT,        /* 3: discrete, tinted light */
	ENCRE_OUTPUT_TONES,        /* 4: the ink of tones alone, premultiplied */
	ENCRE_OUTPUT_COUNT
};

typedef struct encre_layer_description {
	const char *name, *help; /* static storage */
	int32_t channels;
	int32_t required; /* layers only: 1 = encre_render() refuses a job without it */
} encre_layer_description;

/* A painted control: a channel of the layer `controls`, -1..1, neutral at 0. Meshes carry it as the attribute
 * encre_<name>, files in channel `channel`, 0 to 2, of the pass `saved`. */
typedef struct encre_control_description {
	const char *name, *label;
	const char *white, *black; /* what 1 and -1 do */
	const char *saved;
	int32_t channel, reserved;
} encre_control_description;

/* NULL past the end. */
ENCRE_API const encre_layer_description *encre_layer_info(int32_t layer);
ENCRE_API const encre_layer_description *encre_output_info(int32_t output);
ENCRE_API const encre_control_description *encre_control_info(int32_t control);

/* ---- parameters ------------------------------------------------------------------------------------------ */

enum { ENCRE_MAX_LEVELS = 16 };

/* One level of discrete light. threshold and transition of the first are ignored. */
typedef struct encre_level {
	float intensity, threshold, transition, color[3];
} encre_level;

typedef struct encre_levels {
	int32_t count; /* 1..ENCRE_MAX_LEVELS, darkest first */
	encre_level level[ENCRE_MAX_LEVELS];
} encre_levels;

enum encre_type {
	ENCRE_BOOL = 0, /* int32_t 0 or 1 */
	ENCRE_INT,      /* int32_t */
	ENCRE_FLOAT,    /* float */
	ENCRE_ENUM,     /* int32_t, the number of one of the items */
	ENCRE_COLOR,    /* float[3], scene-linear */
	ENCRE_IMAGE,    /* encre_image; data NULL = none */
	ENCRE_LEVELS,   /* encre_levels */
};

enum encre_scope {
	ENCRE_FRAME = 0, /* read from the scene's parameters (style 0) only */
	ENCRE_SURFACE,   /* read from the style of the pixel */
};

typedef struct encre_enum_item {
	const char *id, *label, *help;
	int64_t number; /* never reordered: files store it */
} encre_enum_item;

/* One parameter. Strings have static storage. enabled_if: "" or terms joined by '&', each `id`, `!id` or
 * `id=ITEM|ITEM`; it greys a widget out and changes nothing else. */
typedef struct encre_param_info {
	const char *id, *label, *help, *unit, *enabled_if;
	const encre_enum_item *items; /* ENCRE_ENUM */
	int32_t n_items;
	int32_t type, scope;
	int32_t offset;                                /* bytes from the start of the parameter block */
	double value[3];                               /* default; COLOR has three */
	double hard_min, hard_max, soft_min, soft_max; /* INT and FLOAT */
	const encre_levels *levels;                    /* default of ENCRE_LEVELS */
	int32_t is_switch;                             /* BOOL: 1 = whether its stage draws at all */
	int32_t reserved;
} encre_param_info;

typedef struct encre_stage_description {
	const char *id, *label, *help;
	const encre_param_info *params;
	int32_t n_params;
	int32_t reserved;
} encre_stage_description;

/* Stage number `stage` in the order in which panels show them; NULL past the end. */
ENCRE_API const encre_stage_description *encre_stage_info(int32_t stage);

/* Bytes of one parameter block. */
ENCRE_API int64_t encre_params_size(void);
/* Fills a block with the defaults. */
ENCRE_API void encre_params_init(void *params);
/* NULL if the block can be rendered with, else a sentence (static storage or in `text`, capacity `size` > 0). */
ENCRE_API const char *encre_params_check(const void *params, char *text, int64_t size);

/* ---- rendering ------------------------------------------------------------------------------------------- */

typedef struct encre_context encre_context;

/* Called between bands on the calling thread only, fraction 0..1, never decreasing; false cancels. Its own context,
 * which is at work, refuses all that it is asked for meanwhile, and encre_destroy() does nothing. */
typedef bool (*encre_progress)(void *user, double fraction);

#define ENCRE_SHADE 0.35f

typedef struct encre_camera {
	float view[9];        /* rotation world -> camera, row by row: of length 1, at right angles; may be mirrored */
	int32_t orthographic; /* 0 or 1 */
	float height;         /* height of the full frame in scene units, orthographic: > 0; perspective: at a depth
				 of 1, by which paint lies still in the sky; 0: not known */
	float distance;       /* perspective: depth of what the picture is about, which a relative line_far_distance
				 is a multiple of; 0: not known, and that is in scene units */
	float light; /* with shade_meter LAMPS: diffuse light that is full light, 1; 0: not known, and light is as it
			is */
	float shade; /* likewise, less than that: light of the shade, which is ENCRE_SHADE; between these light grows
			evenly, and below; 0: it does everywhere */
} encre_camera;

/* Full frame in pixels, at most 65536 each way, and where the images' top left pixel lies in it (border rendering).
 * `number`: which frame of its animation it is, for lines that are drawn anew. */
typedef struct encre_frame {
	int32_t width, height, x, y, number;
} encre_frame;

/* What an edge of a mesh is to the eye: bits, of which one may have several. */
enum encre_chain_kind {
	ENCRE_CHAIN_CONTOUR = 1,    /* the surface turns away */
	ENCRE_CHAIN_BORDER = 2,     /* the surface ends */
	ENCRE_CHAIN_NUMBER = 4,     /* the number of the object changes */
	ENCRE_CHAIN_CREASE = 8,     /* the surface bends */
	ENCRE_CHAIN_MEET = 16,      /* two surfaces pass through each other */
	ENCRE_CHAIN_MARK = 32,      /* drawn by hand */
	ENCRE_CHAIN_BEVEL = 64,     /* the middle of a bend over several faces */
	ENCRE_CHAIN_SMOOTH = 128,   /* beside others: it is shaded smoothly */
	ENCRE_CHAIN_OTHER = 256,    /* beside MEET: of two objects */
	ENCRE_CHAIN_MATERIAL = 512, /* the number of the material changes */
	ENCRE_CHAIN_FLUSH = 1024,   /* beside others: the surface goes on at the same depth in another one, of the same
				       object or material: a line by its bend alone */
	ENCRE_CHAIN_ROUND = 2048,   /* beside others: of a form that is shaded as if it were round */
	ENCRE_CHAIN_HIDDEN = 4096,  /* beside others: something lies before it */
	ENCRE_CHAIN_COLOR = 8192,   /* colors part in an image that lies on the surface */
};

/* Why a run ends. */
enum encre_chain_end {
	ENCRE_END_NONE = 0,   /* it goes on */
	ENCRE_END_NODE = 1,   /* its chain does, or others meet there */
	ENCRE_END_HIDDEN = 2, /* something lies before it */
	ENCRE_END_FRAME = 3,  /* the frame, or a clip plane */
	ENCRE_END_LOOP = 4,   /* it comes back to where it began */
};

/* A point of a run: of a polyline along edges of meshes, as far as it can be seen. Those of a run follow each other.
 * What it tells but for the place is of the way to it from the point before; of a run's first, of the way from it. */
typedef struct encre_chain_point {
	float x, y;     /* pixels of the full frame; centres are whole numbers */
	float depth;    /* along the view axis, scene units */
	float bend;     /* degrees by which the surface bends across the edge, crease_offset included; MARK: 180 */
	float gap;      /* CONTOUR, BORDER: pixels by which it lies before what is behind; 1e9: nothing is; HIDDEN: how
			   many meshes lie before it */
	float along[2]; /* pixels along the whole edge, of any border of the frame, at the point before and here */
	float over;     /* BEVEL: degrees by which the surface bends over the faces beside it, too; else 0 */
	float fade;     /* BEVEL: 0..1: how much of the width it has that this would give it; else 0 */
	int32_t mesh;   /* number of the mesh in its job; of MEET that of the first of both */
	int32_t edge;   /* number of the edge in the mesh, or of the meet: less than 2^24; with `mesh` its identity */
	int32_t kind;   /* bits of enum encre_chain_kind */
	int32_t side;   /* CONTOUR, BORDER: where the surface lies: 1 right of the way, y down, -1 left; else 0 */
	int32_t object; /* number of the object that it is of */
	int32_t behind; /* CONTOUR, BORDER: of what is seen beyond it; 0: nothing */
	int32_t run;    /* ascending from 0 */
	int32_t end;    /* of the first and the last of a run: enum encre_chain_end; else ENCRE_END_NONE */
	int32_t color[2]; /* COLOR: what it parts, left and right of the way: sRGB, 0xrrggbb; else 0 */
} encre_chain_point;

/* What a line is, by what lies on its two sides: whose settings draw it. */
enum encre_line {
	ENCRE_LINE_OUTLINE = 0, /* something before another thing, or before nothing */
	ENCRE_LINE_CONTACT,     /* beside what it touches */
	ENCRE_LINE_INNER,       /* one part of a thing before another */
	ENCRE_LINE_CREASE,      /* where a surface bends */
	ENCRE_LINE_INTERSECTION,
	ENCRE_LINE_MATERIAL,
	ENCRE_LINE_COLOR,
	ENCRE_LINE_SHADOW, /* between levels of light */
	ENCRE_LINE_MIRROR,
	ENCRE_LINE_SUGGESTIVE,
	ENCRE_LINE_MARK,
	ENCRE_LINE_HIDDEN, /* behind other things */
	ENCRE_LINE_COUNT
};

typedef struct encre_line_description {
	const char *id;    /* static storage: as in the parameter line_<id>_pen */
	const char *label; /* what several of them are called */
} encre_line_description;

/* NULL past the end. */
ENCRE_API const encre_line_description *encre_line_info(int32_t line);

/* A point of a stroke: of a polyline that a pen has drawn, as wide and as dark as it is there by the hand's pressure,
 * taper, wobble, dashes and overshoot; bristles, pictures along it and the grain of paper are left out. Those of a
 * stroke follow each other; a dot has one. Where strokes cross, a later one lies over an earlier one. */
typedef struct encre_stroke_point {
	float x, y;     /* pixels of the full frame; centres are whole numbers */
	float width;    /* pixels, at least 0: to where the ink is half as dark */
	float ink[4];   /* scene-linear colour, and how dark it is in its middle, 0..1 */
	float depth;    /* along the view axis, scene units */
	int32_t stroke; /* ascending from 0 */
	int32_t kind;   /* enum encre_line: of the whole stroke */
	int32_t object; /* of the whole stroke: number of the object that the line is of; 0: not known */
	int32_t mesh;   /* where `chains` tell the line: as in encre_chain_point; else -1 */
	int32_t edge;   /* likewise */
	int32_t pass;   /* of a pen that draws each line several times: which, from 0 */
	int32_t end;   /* of the first and the last of a stroke: enum encre_chain_end; else, and where the stroke is cut
			  as its kind or its object changes or a dash ends, ENCRE_END_NONE */
	int32_t hider; /* of ENCRE_END_HIDDEN: number of the object that lies before it; else 0 */
} encre_stroke_point;

typedef struct encre_job {
	encre_image layers[ENCRE_LAYER_COUNT];
	encre_image outputs[ENCRE_OUTPUT_COUNT];
	encre_camera camera;
	encre_frame frame;
	const void *params; /* n_styles blocks of encre_params_size() bytes, the first at a multiple of 8; block k is
			       style k, 0 the scene's */
	int32_t n_styles;   /* 1..256; a style number outside counts as 0 */
	int32_t reserved;
	encre_progress progress; /* may be NULL */
	void *user;
	int64_t nonfinite; /* out: how many values of the layers that are read were NaN or infinite and read as 0 */
	int64_t same; /* 0, or a number that is one of this context's next jobs' only if its layers and chains hold the
			 same values: then edges are found once for all, as long as they are the same */
	/* What encre_chains() gave for this frame, in the same pixels; NULL: nothing is known. FINE takes lines of
	 * shapes from it where `chained` tells so, and finds the others in the layers. */
	const encre_chain_point *chains;
	int64_t n_chains;
	const uint8_t *chained; /* by object number, bits: 1 = all its lines of shapes are in `chains`, 2 = all of
				 * colors on its surfaces */
	int64_t n_chained;
	int32_t tell_strokes; /* 1: `strokes` are asked for, which edge_detector FINE alone has; 0: not */
	int32_t reserved_2;
	/* out, where asked for: the context's own, until its next job of this kind that asks */
	const encre_stroke_point *strokes;
	int64_t n_strokes; /* how many points */
} encre_job;

/* `api_version`: ENCRE_API_VERSION of the caller. NULL if it is not this library's, or without memory. */
ENCRE_API encre_context *encre_create(int32_t api_version);
ENCRE_API void encre_destroy(encre_context *context); /* NULL is allowed */
/* Threads to use, the calling one included; 0 (default) = as many as processors. Results never depend on it;
 * where threads can't be started, fewer are used. At most 1024. */
ENCRE_API int32_t encre_set_threads(encre_context *context, int32_t threads);
/* 0 = baseline instructions, 1 (default) = the best that processor and build have. Results never depend on it. */
ENCRE_API int32_t encre_set_simd(encre_context *context, int32_t level);
/* The sentence of the last error of this context, "" if none; valid until its next call. NULL context: why
 * encre_create() fails. */
ENCRE_API const char *encre_error(const encre_context *context);

/* Runs all stages. `combined`, `color`, `diffuse`, `depth`, `normal` and params are required; every present image
 * must have the channels that encre_layer_info() tells and one common size of at least 1x1 and at most
 * 65536x65536, and one output at least be present, or strokes be asked for. With the switches of all stages
 * (is_switch) off in every style, the output combined equals the layer bit for bit but for values that are not finite;
 * unless edges or light are asked for, no other layer is read then. Distances to edge pixels have 16 bits: images with
 * a diagonal of more than 32766 pixels are refused where lines by line_search NEAREST or smudging reach farther than
 * that. */
ENCRE_API int32_t encre_render(encre_context *context, encre_job *job);

/* ---- rasteriser ------------------------------------------------------------------------------------------ */

enum encre_primitive {
	ENCRE_TRIANGLES = 0, /* 3 corners each */
	ENCRE_LINES = 1,     /* 2 corners each: lines by hand, which only encre_chains() shows */
};

/* One mesh. Attributes are interpolated perspective-correctly between corners; lines have none, and no numbers. */
typedef struct encre_mesh {
	int32_t kind; /* enum encre_primitive */
	int32_t n_primitives;
	int32_t n_points;
	int32_t n_channels;      /* attribute channels per corner, 0..ENCRE_MAX_CHANNELS; missing ones are 0 */
	const float *points;     /* n_points x 3, object space */
	const int32_t *corners;  /* n_primitives x 3, of lines x 2, indices into points; NULL = 0, 1, 2, ... */
	const float *attributes; /* corner-major: n_primitives x 3 x n_channels; NULL = 0 */
	const int32_t *material; /* material number per primitive; NULL = material_index for all */
	const int32_t *style;    /* style number per primitive; NULL = style_index for all */
	double model[16];        /* object -> world, row by row */
	int32_t object_index, material_index, style_index;
	int32_t open; /* 1: light goes through it: of its edges none is a chain, and it hides none; colors part on it */
	const int32_t *object; /* object number per primitive; NULL = object_index for all */
	const uint8_t *edges; /* of triangles, enum encre_edge of the edge from corner k at bits 2 k and 2 k + 1; NULL =
				 all ENCRE_EDGE_FLAT */
	float crease_offset;  /* degrees: added to the bend of every edge */
	int32_t seed; /* of a copy: shifts where it rests in the layer `anchor`, by up to about its size, so that no two
			 of them are drawn by the same hand; 0 = not */
	const float *normals; /* of triangles, object space: n_primitives x 3 x 3 at the corners, by which surfaces are
				 shaded; NULL = flat */
	const float *rest; /* of triangles: n_primitives x 3 x 3, rest positions at the corners, in any unit; NULL = the
			      points */
	const float *rest_normals; /* likewise: by which the resting surface is shaded; NULL = flat */
	const float *uv;           /* of triangles: n_primitives x 3 x 2 at the corners; NULL = 0 */
} encre_mesh;

/* What a crease along an edge of a triangle is taken for. */
enum encre_edge {
	ENCRE_EDGE_FLAT = 0,   /* between surfaces that are shaded flat */
	ENCRE_EDGE_SMOOTH = 1, /* between such as are shaded smoothly */
	ENCRE_EDGE_NONE = 2,   /* inside a face, or never a crease: only an end of the surface */
};

enum { ENCRE_MAX_CHANNELS = 24 };

typedef struct encre_raster_job {
	const encre_mesh *meshes;
	int32_t n_meshes;
	int32_t n_channels;      /* channels of `attributes` */
	double view[16];         /* world -> camera (looking along -z), row by row */
	double projection[16];   /* camera -> clip, row by row, for the full frame (OpenGL convention) */
	double clip_start;       /* nearest distance along the view axis that is drawn, scene units */
	double clip_end;         /* farthest; <= clip_start = no limit */
	encre_frame frame;       /* full frame and place of the images in it */
	encre_image depth;       /* out, 1 channel: distance along the view axis, 1e10 = nothing */
	encre_image normal;      /* out, 3: geometric, unit, world space, facing the camera; 0 = nothing */
	encre_image object;      /* out, 1: object_index, 0 = nothing */
	encre_image material;    /* out, 1 */
	encre_image style;       /* out, 1 */
	encre_image attributes;  /* out, n_channels; 0 = nothing */
	encre_progress progress; /* may be NULL */
	void *user;
	encre_image coincident; /* out, 1: the object number of a later surface that coincides with the one in front and
				   is of another object; 0 = none */
	encre_image shading;    /* out, 3: by which the surface is shaded: the meshes' normals, interpolated and of
				   length 1, world space, on the side of `normal`'s face; where there are none, `normal` */
	encre_image beyond;  /* in, 1: only what lies farther than this is drawn; at `depth`'s 1e10 nothing is. May be
				absent */
	encre_image anchor;  /* out, 16: the layer `anchor`; 0 = nothing. A pixel's span is that of the whole mesh, by
				how large its surface is in the world and at rest, so that it does not jump from face to
				face. Derivatives are those of the face in front, exact, of one that is seen on its edge
				at most 64 spans long */
	encre_image tangent; /* out, 3: the layer `tangent`, by the meshes' uv; 0 where these do not grow */
	encre_image card;    /* out, 4: the layer `card`. A sheet stands no nearer along the view axis than a quarter of
				how far away its origin is, or it would race where that is beside the camera */
} encre_raster_job;

/* Draws the front-most surface at every pixel centre: z-tested, clipped at clip_start, back faces kept, adjacent
 * triangles neither overlap nor leave gaps (top-left rule); where surfaces coincide, as far as floats tell: the earlier
 * mesh, then the earlier primitive. Absent outputs are skipped; present ones share one size, and one is present at
 * least. Arrays of meshes lie at multiples of 4, the meshes at one of 8. Indices out of range are an error. */
ENCRE_API int32_t encre_raster(encre_context *context, encre_raster_job *job);

/* ---- chains ---------------------------------------------------------------------------------------------- */

/* An image on surfaces, as they look without light. */
typedef struct encre_colored {
	int64_t key;           /* a number that no other colors have */
	int32_t width, height; /* 1 to ENCRE_MAX_COLORED */
	const float *colors;   /* height x width x 3, scene-linear; v = 0 is the first row's lower end */
	int32_t wrap;          /* beyond 0..1: enum encre_extension, or ENCRE_MIRROR */
	int32_t closest;       /* 1: texels are not mixed */
	const uint8_t *alpha;  /* height x width: below a half nothing is there; NULL: all is */
} encre_colored;

enum { ENCRE_MIRROR = 3, ENCRE_MAX_COLORED = 8192 };

typedef struct encre_chain_job {
	const encre_mesh *meshes; /* as in encre_raster_job */
	int32_t n_meshes;
	int32_t width, height; /* of the images; what lies up to 80 pixels beside them is there as well */
	float least_bend;      /* degrees: what bends less is no crease */
	double view[16];       /* as in encre_raster_job */
	double projection[16];
	double clip_start, clip_end;
	encre_frame frame;
	encre_progress progress; /* may be NULL */
	void *user;
	/* out: the context's own, until its next job of this kind */
	const encre_chain_point *points;
	int64_t n_points;
	int32_t most_before; /* what is hidden is told, too, where so many meshes lie before it at most; 0: it is not */
	int32_t reserved;
	/* Where colors part in images that lie on the meshes, by their uv; found once for each image, as long as jobs
	 * have it. */
	const encre_colored *images;
	int32_t n_images;
	int32_t n_image;      /* numbers of materials that `image` knows */
	const int32_t *image; /* by number of material: which of the images its colors are those of; -1: of none */
	const void *params;   /* as in encre_job: what tells which contrast can be a line; NULL: none is */
	int32_t n_styles, spare;
} encre_chain_job;

/* Finds the lines that meshes know, as runs along their edges, each as far as it can be seen. The same bytes on any
 * number of threads. */
ENCRE_API int32_t encre_chains(encre_context *context, encre_chain_job *job);

/* Unit normals of facets as of one smooth surface: at each corner the mean, by area and angle, of the facets around its
 * point that hang together by edges at which they bend by less than `angle` (0 to pi radians). A facet is a triangle
 * that has one normal, within 3 degrees, and nearly its own, within 15; points at one place count as one where two
 * facets meet there, and no third. mesh: of triangles, whose `normals` are read, NULL: all are facets. normals
 * (n_primitives, 3, 3), in object space: those of other triangles are the mesh's. */
ENCRE_API int32_t encre_smooth(encre_context *context, const encre_mesh *mesh, float angle, float *normals);

/* ---- light ----------------------------------------------------------------------------------------------- */

/* What light falls on and what throws shadows, kept from frame to frame: geometry, of which a tree is built once;
 * instances, which place geometry in the world; lamps; textures, which say where geometry has holes. Each has a key
 * that the caller chooses, a number of its kind; given again it replaces what was there, NULL removes it. Everything is
 * copied. A scene may be used by one thread at a time, with any context. */
typedef struct encre_scene encre_scene;

/* Triangles in object space; where a corner is not finite there is none. */
typedef struct encre_geometry {
	int32_t n_points, n_triangles;
	const float *points;    /* n_points x 3 */
	const int32_t *corners; /* n_triangles x 3, indices into points */
	const float *normals; /* n_triangles x 3 x 3: unit normals at the corners, by which light falls; NULL = flat */
	const float *uvs; /* n_triangles x 3 x 2: where the corners are in the triangle's texture; NULL: no textures */
	const int32_t *textures; /* n_triangles: keys of textures; one that is not there is solid everywhere */
} encre_geometry;

enum encre_extension { ENCRE_REPEAT = 0, ENCRE_EXTEND, ENCRE_CLIP /* nothing is there */ };

/* Where a surface is solid: rays go through where `alpha`, as its texels are mixed there, is below a half. */
typedef struct encre_texture {
	int32_t width, height; /* 1 to ENCRE_MAX_TEXELS */
	int32_t extension;     /* enum encre_extension: what lies beyond 0..1 */
	int32_t closest;       /* 1: texels are not mixed */
	const uint8_t *alpha;  /* height x width, packed; v = 0 is the first row's lower end */
} encre_texture;

typedef struct encre_instance {
	int64_t geometry;     /* its key; it must be there as long as instances show it */
	double model[16];     /* object -> world, row by row; one that has no inverse places nothing */
	uint64_t light_sets;  /* bit k: lamps whose light_set is k light it */
	uint64_t shadow_sets; /* bit k: it throws shadows in the light of lamps whose shadow_set is k */
	int32_t camera;       /* 1: the camera sees it, 0: it only throws shadows */
	int32_t reserved;
} encre_instance;

enum encre_lamp_type {
	ENCRE_SUN = 0,
	ENCRE_POINT,
	ENCRE_SPOT,
	ENCRE_RECTANGLE,
	ENCRE_ELLIPSE,
};

/* A lamp, in Cycles' units. It stands at the origin of its own space and shines along -z. */
typedef struct encre_lamp {
	int32_t type;                  /* enum encre_lamp_type */
	int32_t shadows;               /* 0: what is in the way does not matter */
	int32_t light_set, shadow_set; /* 0..63, see encre_instance */
	float color[3];                /* sun: W/m2 that fall on what faces it; else W that it radiates */
	float width, height; /* sun: the angle that it fills, radians, in width; point and spot: radius, in world space,
				in width; else sides, or diameters, in its own space */
	float spot_angle;    /* of the whole cone, radians, up to pi */
	float spot_blend;    /* 0..1: how much of the cone is soft */
	float spread;        /* rectangle, ellipse: into which angle it shines, radians; pi = everywhere in front */
	int32_t flat;        /* point and spot: 0 = a sphere, 1 = a disc that faces what it lights */
	int32_t matt;        /* 1: it makes no highlights */
	double model[16];    /* its own space -> world, row by row */
} encre_lamp;

enum { ENCRE_MAX_BENDS = 64 };

/* An ellipsoid in which light falls as on its own surface, and what lies in it throws no shadows. */
typedef struct encre_bend {
	double model[16]; /* a ball of radius 1 -> world, row by row; one without an inverse does nothing */
	float amount;     /* 0..1: how far normals are bent */
	float fade;       /* 0..1: over which part of the radius, from its surface inwards, that begins */
} encre_bend;

typedef struct encre_light_job {
	encre_scene *scene;
	double view[16]; /* as in encre_raster_job */
	double projection[16];
	double clip_start, clip_end;
	encre_frame frame; /* full frame and place of the images in it */
	encre_image depth; /* in: the layer `depth` */
	encre_image
		normal; /* in: the layer `normal`, which tells of surfaces that are not in the scene; may be absent */
	encre_image diffuse;  /* out: the layer `diffuse`: direct light without the colour of the surface */
	encre_image shine;    /* in: as encre_material() draws it, what makes highlights; may be absent */
	encre_image turned;   /* in: likewise, normals by which light falls where they are not 0; may be absent */
	encre_image specular; /* out: highlights of the lamps, 3; may be absent */
	float world[27]; /* light from all sides: colours that are multiplied by 1, x, y, z, xy, yz, 3 zz - 1, xz and
			    xx - yy of the normal and summed */
	int32_t n_bends; /* 0..ENCRE_MAX_BENDS */
	const encre_bend *bends;
	bool sharp; /* shadows are those of lamps without a size, which takes a half to a third of the time */
	bool rims;  /* beside other things light is that of half a pixel within, and bounded by what the same one has
		     * about: no dashes nor single pixels in tones */
	bool unshadowed;         /* nothing throws shadows */
	encre_progress progress; /* may be NULL */
	void *user;
} encre_light_job;

/* NULL without memory. */
ENCRE_API encre_scene *encre_scene_create(void);
/* NULL is allowed; a scene that is being lit is freed at the end of that. */
ENCRE_API void encre_scene_free(encre_scene *scene);
/* Each returns a code; after an error the scene is as it was before, and the context has the sentence. While a scene is
 * lit by any context, in the background from encre_start() to the end of the work, these, encre_scene_reach() and
 * another's encre_light() are refused. */
ENCRE_API int32_t encre_scene_geometry(encre_context *context, encre_scene *scene, int64_t key,
				       const encre_geometry *geometry);
ENCRE_API int32_t encre_scene_instance(encre_context *context, encre_scene *scene, int64_t key,
				       const encre_instance *instance);
ENCRE_API int32_t encre_scene_texture(encre_context *context, encre_scene *scene, int64_t key,
				      const encre_texture *texture);
ENCRE_API int32_t encre_scene_lamp(encre_context *context, encre_scene *scene, int64_t key, const encre_lamp *lamp);

/* Fills reached[n] with 1 where nothing of the scene throws a shadow on the whole of a way (n x 3) that begins at a
 * place (n x 3), in the light of a lamp with this shadow_set, else with 0. */
ENCRE_API int32_t encre_scene_reach(encre_context *context, encre_scene *scene, int32_t n, const float *places,
				    const float *ways, int32_t shadow_set, uint8_t *reached);

/* Draws the light of the scene's lamps and of its world on what the camera sees: for each pixel's centre what of the
 * scene lies at the layer's depth. Edges of shadows are exact between the centres, and 2 pixels wide where the lamp has
 * no size. A pixel that shows nothing takes the light of its nearest neighbour, so that contours keep theirs. A border
 * equals its part of the full frame where its depth does; beyond the images the scene's own surfaces count. */
ENCRE_API int32_t encre_light(encre_context *context, encre_light_job *job);

/* ---- materials ------------------------------------------------------------------------------------------- */

/* What surfaces look like without light, computed for each pixel by small programs: a node tree, compiled. They work on
 * registers of one number. */

enum { ENCRE_MAX_REGISTERS = 1024, ENCRE_INPUTS = 8, ENCRE_DATA = 2 };

typedef struct encre_operation_description {
	const char *name; /* static storage */
	int32_t inputs, outputs;
} encre_operation_description;

/* What the operation with this code takes and gives; NULL past the end. csrc/material/operations.rows.h tells what each
 * does. */
ENCRE_API const encre_operation_description *encre_operation_info(int32_t code);

typedef struct encre_operation {
	int32_t code, out;        /* the first of the registers that it writes, which it must not read */
	int32_t in[ENCRE_INPUTS]; /* registers */
	int32_t data[ENCRE_DATA];
} encre_operation;

/* What a program leaves in its registers, in this order. */
enum encre_result {
	ENCRE_RESULT_COLOR = 0,      /* 3: of matt surfaces */
	ENCRE_RESULT_GLOSS = 3,      /* 3: of what is reflected, or shows through */
	ENCRE_RESULT_EMISSION = 6,   /* 3 */
	ENCRE_RESULT_ALPHA = 9,      /* 1 = nothing shows through */
	ENCRE_RESULT_ROUGHNESS = 10, /* of reflections */
	ENCRE_RESULT_SHINE = 11,     /* 3: of highlights, where a lamp is looked at straight from above */
	ENCRE_RESULT_SHINE_ROUGHNESS = 14,
	ENCRE_RESULT_COAT = 15, /* of highlights of a coat above it, which is colourless, and its roughness */
	ENCRE_RESULT_COAT_ROUGHNESS = 16,
	ENCRE_RESULT_TURNED = 17,  /* 3: the way in which light takes the surface to face; 0: its normal */
	ENCRE_RESULT_HOLDOUT = 20, /* the share that is a hole in the picture, of what does not show through */
	ENCRE_RESULTS = 21
};

typedef struct encre_program {
	const encre_operation *operations;
	int32_t n_operations, n_registers; /* registers are 0 at the start */
	int32_t result[ENCRE_RESULTS];     /* registers; what is left in several may be the same */
} encre_program;

/* Colours with alpha, 4 numbers a texel, row 0 at the bottom, of levels of detail one after the other: each half as
 * wide and high as the one before, rounded down, but at least 1. Either scene-linear `texels`; or `bytes`, whose
 * colours the 256 finite numbers of `curve`, none below the one before, make scene-linear once those between texels are
 * known, and whose alpha is in 255ths. */
typedef struct encre_picture {
	const float *texels;
	const uint8_t *bytes;
	const float *curve;
	int32_t width, height, levels;
	int32_t wrap;     /* enum encre_extension */
	int32_t straight; /* 1: colours of bytes are to be multiplied by alpha */
	int32_t reserved;
} encre_picture;

/* Writes the levels of detail behind the first one of a picture of bytes, each texel the mean light of up to four.
 * bytes: those of the picture, which is else as encre_material() takes it. */
ENCRE_API int32_t encre_picture_levels(encre_context *context, const encre_picture *picture, uint8_t *bytes);

/* Gives a picture flat colors, `most` (1 to ENCRE_MAX_FLAT) at most: areas in which little changes, or changes slowly,
 * get one color, and texels at their borders are mixed as before. Writes the first level, alpha apart; what alpha
 * leaves out (below one half) stays. texels: the picture's own `texels` or `bytes`. */
enum { ENCRE_MAX_FLAT = 64 };
ENCRE_API int32_t encre_flatten(encre_context *context, const encre_picture *picture, int32_t most, void *texels);

typedef struct encre_materials {
	const encre_program *programs; /* by the number of the material */
	const encre_picture *textures;
	const float *constants;
	const float *things; /* n_things x n_values: what is the same all over an object, by its number */
	int32_t n_programs, n_textures, n_constants, n_things, n_values, reserved;
} encre_materials;

typedef struct encre_material_job {
	const encre_materials *materials;
	double view[16]; /* as in encre_raster_job */
	double projection[16];
	encre_frame frame;
	encre_image object, material, depth, normal; /* in: what encre_raster() drew; object 0 = nothing */
	encre_image attributes;                      /* in; may be absent */
	encre_image color, gloss, emission;          /* out, 3: scene-linear, at least 0; 0 where nothing is */
	encre_image surface;                         /* out, 2: alpha and roughness, 0 to 1 */
	encre_image shine;       /* out, 6: of highlights the colour and roughness, of a coat's how bright and rough */
	encre_image turned;      /* out, 3: normals of normal maps and bumps, 0 where there are none */
	encre_image holdout;     /* out, 1: the share that is a hole, at least 0 */
	encre_progress progress; /* may be NULL */
	void *user;
} encre_material_job;

/* Absent outputs are skipped. Programs that can't be run, as they read what is not there, are an error. */
ENCRE_API int32_t encre_material(encre_context *context, encre_material_job *job);

/* ---- baking ---------------------------------------------------------------------------------------------- */

/* Lines where colours meet, drawn into a texture. Of `params`, one block, these count: line_thickness in texels,
 * contrast_metric, contrast_threshold, contrast_full, contrast_local and contrast_window in texels. */
typedef struct encre_bake_job {
	encre_image texture; /* 3 or 4 channels; a fourth is kept as it is */
	/* 3 channels, or absent: how long a step is on the surface. A step of x texels to the right and y down has the
	 * squared length E x^2 + 2 F x y + G y^2; the unit is that of line_thickness, best a texel of mean size. Lines
	 * then have the same width everywhere on the surface. 0, or what is not finite, stands for 1, 0, 1. */
	encre_image form;
	encre_image
		output; /* as texture: texture * (1 - coverage), in the values that it stores; absent: only measures */
	const void *params;
	int32_t linear;         /* 0: sRGB-encoded values, 1: linear ones */
	int32_t wrap_x, wrap_y; /* 1: the texture tiles in this direction */
	int32_t reserved;
	encre_progress progress; /* may be NULL */
	void *user;
	int64_t nonfinite; /* out: how many values of the texture were NaN or infinite and read as 0 */
	double greatest;   /* out: the greatest difference by contrast_metric of two opposite neighbours of a texel */
} encre_bake_job;

enum { ENCRE_MAX_TEXELS = 32768 };

/* Widths and heights are 1 to ENCRE_MAX_TEXELS, the same for all images. Without a form each texel draws a disc of
 * radius line_thickness * strength / 2 about its centre, with it an ellipse about the boundary that it sees. */
ENCRE_API int32_t encre_bake(encre_context *context, encre_bake_job *job);

/* ---- samples --------------------------------------------------------------------------------------------- */

/* Light from which a denoiser could not take all noise, evened out, so that levels of it end in smooth curves: never
 * across an outline or a fold, and where nothing was noisy nothing changes. All images have the same size. */
typedef struct encre_even_job {
	encre_image light;       /* 3: denoised; changed in place */
	encre_image rendered;    /* 3: as it was rendered */
	encre_image normal;      /* 3 */
	encre_image depth;       /* 1: as in enum encre_layer */
	encre_image object;      /* 1, or absent: numbers of objects */
	encre_progress progress; /* may be NULL */
	void *user;
} encre_even_job;

/* Pixels around a part of a frame from which on it comes out as in the whole. */
enum { ENCRE_EVEN_REACH = 64 };

ENCRE_API int32_t encre_even(encre_context *context, encre_even_job *job);

/* The mean of each factor x factor pixels of a large picture. */
typedef struct encre_average_job {
	encre_image large; /* `factor` times as wide and as high as `output`, of as many channels, at most
			      ENCRE_MAX_CHANNELS */
	encre_image output;
	int32_t factor; /* 1 or more */
	int32_t reserved;
	encre_progress progress; /* may be NULL */
	void *user;
} encre_average_job;

ENCRE_API int32_t encre_average(encre_context *context, encre_average_job *job);

/* ---- others' functions ----------------------------------------------------------------------------------- */

typedef void (*encre_function)(void *argument);

/* A function of another library's, such as a denoiser's, that is to be a step in the background. */
typedef struct encre_call_job {
	encre_function function;
	void *argument;
	encre_progress progress; /* may be NULL; asked before it is called, not while it runs */
	void *user;
} encre_call_job;

ENCRE_API int32_t encre_call(encre_context *context, encre_call_job *job);

/* ---- in the background ----------------------------------------------------------------------------------- */

enum encre_kind {
	ENCRE_RENDER = 0,   /* encre_job */
	ENCRE_RASTER = 1,   /* encre_raster_job */
	ENCRE_LIGHT = 2,    /* encre_light_job */
	ENCRE_BAKE = 3,     /* encre_bake_job */
	ENCRE_MATERIAL = 4, /* encre_material_job */
	ENCRE_CALL = 5,     /* encre_call_job */
	ENCRE_CHAINS = 6,   /* encre_chain_job */
	ENCRE_EVEN = 7,     /* encre_even_job */
	ENCRE_AVERAGE = 8,  /* encre_average_job */
};

/* A job of some kind, with progress NULL. */
typedef struct encre_step {
	int32_t kind; /* enum encre_kind */
	int32_t reserved;
	void *job;
} encre_step;

enum { ENCRE_MAX_STEPS = 64 };

/* Starts steps, 1 to ENCRE_MAX_STEPS, that run one after the other on a thread of the library's while the caller goes
 * on; a step may read what an earlier one has drawn. It returns at once: ENCRE_OK, or an error, and nothing has begun.
 * The steps are copied. Jobs, and all that they name, are the work's until it has ended: till then nobody else reads
 * outputs, changes inputs, uses a scene or frees anything. Of this context, which the work uses, only the three
 * functions below, encre_error() and encre_destroy() may be called, on the thread that started it; others are refused.
 */
ENCRE_API int32_t encre_start(encre_context *context, const encre_step *steps, int32_t n_steps);
/* ENCRE_RUNNING, or how the work has ended: with the code of the first step that failed, after which no other was
 * begun, and its sentence in encre_error(). It never waits. `fraction` (may be NULL) gets how much is done, 0..1.
 * Without work it says again how the last has ended, at first ENCRE_OK. */
ENCRE_API int32_t encre_poll(encre_context *context, double *fraction);
/* Asks the work to end soon with ENCRE_ERROR_CANCELLED and returns at once; what has ended already stays as it is. */
ENCRE_API void encre_cancel(encre_context *context);
/* Waits for the work to end; returns as encre_poll(). encre_destroy() cancels and waits, too. */
ENCRE_API int32_t encre_wait(encre_context *context);

#ifdef __cplusplus
}
#endif
#endif
