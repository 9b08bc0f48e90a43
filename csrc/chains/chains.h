/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines that meshes know: what the files of this room share.
 *
 * Once for what meshes are made of: shapes.c finds their edges and a tree of their triangles, meet.c where they pass
 * through each other. For each frame: candidates.c takes the edges that can be lines, link.c joins them to chains,
 * sight.c tells which parts of each the eye sees, runs.c writes these down as polylines. Edges are followed in double
 * and never become pixels, so that a border of the frame has the points of the whole. */
#ifndef ENCRE_CHAINS_H
#define ENCRE_CHAINS_H

#include "base/arena.h"
#include "base/stage.h"
#include "light/tree.h"
#include "raster/geometry.h"
#include "raster/topology.h"

#include <stdatomic.h>

/* ---- shapes: kept as long as meshes are made of the same ---------------------------------------------------- */

enum edge_flag {
	EDGE_BORDER = 1,    /* one triangle has it */
	EDGE_MANY = 2,      /* more than two have */
	EDGE_SMOOTH = 4,    /* shaded smoothly */
	EDGE_NEVER = 8,     /* inside a face, or never a crease */
	EDGE_SAME_WAY = 16, /* both triangles go along it the same way */
	EDGE_OBJECT = 32,   /* numbers of objects differ */
	EDGE_MATERIAL = 64,
	EDGE_ROUND = 128, /* of a form that is meant to be round: shaded smoothly, or both its ends are */
};

typedef struct mesh_edge {
	int32_t end[2];  /* points, by `place` */
	int32_t face[2]; /* the first two triangles; -1: there is none */
	uint32_t corner; /* the first that it begins at, as topology has it */
	float bend;      /* degrees, without crease_offset */
	uint32_t flags;  /* enum edge_flag */
	int32_t strip;   /* of a bend over several faces it is the middle; -1: of none */
} mesh_edge;

/* A bend over several faces. */
typedef struct strip {
	int32_t edge;    /* in its middle */
	float bend;      /* degrees, without crease_offset */
	float end[2][3]; /* of the way across it from there, object space */
} strip;

/* What a mesh is made of: edges of triangles, or lines by hand, which have no faces and no tree. */
typedef struct shape {
	uint64_t key[2]; /* of all that it follows from */
	bool used;
	int32_t n_triangles, n_edges;
	mesh_edge *edges;
	strip *strips;
	int32_t n_strips;
	int32_t *edge_of; /* by corner; -1: of none */
	int32_t *place;   /* by point: the first at its place */
	uint32_t *next, *piece;
	int8_t *closed; /* by triangle: 1, -1: of a piece that has an inside, seen from outside it goes round against
			   the clock, or with it; 0: it has none */
	uint8_t *first;
	int32_t *order; /* triangles, as leaves of the tree have them */
	tree tree;
} shape;

/* A mesh of the job. */
typedef struct body {
	const encre_mesh *mesh;
	const part *part; /* NULL: it has no primitives */
	const shape *shape;
	double inverse[12];     /* world -> object */
	double low[3], high[3]; /* world space */
	bool solid;             /* it has triangles in the tree, and a place */
	bool near;              /* some of it may be in the frame */
	uint32_t first;         /* running number of its first edge */
	corner *spots;          /* by point, on the screen; of what is near */
	int8_t *faces;          /* by triangle: which way round it is seen: 1, -1; 0: on its edge */
} body;

/* A piece of a line in which two triangles meet. */
typedef struct meet {
	double p[2][3];
	int32_t body[2], face[2];
	uint64_t node[2]; /* what follows in the next triangle has the same */
} meet;

/* Of two bodies, or of one with itself: its meets, which follow each other. */
typedef struct meet_pair {
	int32_t body[2];
	int64_t first, count;
} meet_pair;

typedef struct kept_shapes {
	shape **all;
	int n;
	/* of the last job: bodies with what meets depend on, and meets by pairs of bodies */
	struct placed *placed;
	int n_placed;
	meet_pair *pairs; /* ascending */
	meet *meets;
	int64_t n_pairs, room_pairs, n_meets, room_meets;
	encre_chain_point *points;
	int64_t n_points, room_points;
	struct boundaries **images; /* of the last job */
	int n_images;
} kept_shapes;

/* ---- the frame ----------------------------------------------------------------------------------------------- */

enum { OWN = 8, MARGIN = 80 /* pixels beside the images: what lies there counts for what is seen */ };

/* An edge that can be a line, or part of a meet. Places on it are shares of its length in space. */
typedef struct line {
	double p[2][3]; /* world space */
	corner c[2];
	uint64_t node[2];
	int32_t body, edge, kind, object;
	int32_t own[OWN]; /* faces that do not hide it: of `body`, the last of a meet's of `other` */
	int n_own;
	int32_t other;
	float bend, over, fade;
	int8_t side;
	int32_t color[2]; /* COLOR: left and right of its way on the screen */
	bool clipped[2];
	double whole[2], part[2]; /* between the clip planes, and in the frame with its margin */
	double whole_long;        /* pixels */
	int64_t link[2];          /* 2 x the line that follows at that end, + its end; -1 */
	int64_t first;            /* of its pieces */
	int32_t n_pieces, room;
	int64_t first_hidden; /* likewise, of those that are not seen */
	int32_t n_hidden;
} line;

/* Lines of colors, by chunks of faces. */
typedef struct printed {
	line *line;
	int64_t n, room;
} printed;

typedef struct prints {
	printed *chunk;
	int64_t count, n; /* of chunks, and of all lines */
} prints;

/* Of a line, what can be seen. */
typedef struct seen_piece {
	double from, to;
	float bend, gap;
	int32_t behind;
	bool flush;
	int32_t before; /* how many things lie before it: of what is not seen */
} seen_piece;

typedef struct chains {
	const encre_chain_job *job;
	bands *pool;
	geometry g;
	kept_shapes *kept;
	int n_bodies;
	body *bodies;
	tree tree; /* of bodies */
	int32_t *order;
	double eye[3], back[3]; /* back: towards an eye that is infinitely far */
	bool perspective;
	double pixel;                 /* the size of a pixel at depth 1, or everywhere */
	double x0, y0, x1, y1;        /* the images, in pixels of the full frame */
	struct boundaries **images;   /* by the job's; NULL: it has no lines */
	struct texel_recipe *recipes; /* likewise */
	atomic_uint *lacking;         /* likewise: levels of detail that are seen and not there, bits */
	double gone;                  /* pixels between lines of colors that are not drawn */
	bool best;                    /* whether the best instructions may be used */
	line *lines;
	int64_t n_lines;
	seen_piece *pieces, *hidden; /* hidden: NULL: nobody asks */
	late *late;
} chains;

static inline bool is_line(const encre_mesh *mesh)
{
	return mesh->kind != ENCRE_TRIANGLES;
}

static inline uint32_t next_corner(uint32_t c)
{
	return c % 3 == 2 ? c - 2 : c + 1;
}

static inline int32_t object_of(const encre_mesh *mesh, int32_t face)
{
	return mesh->object ? mesh->object[face] : mesh->object_index;
}

static inline int32_t material_of(const encre_mesh *mesh, int32_t face)
{
	return mesh->material ? mesh->material[face] : mesh->material_index;
}

/* ---- points in double ------------------------------------------------------------------------------------------ */

static inline void minus3(const double a[3], const double b[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[k] - b[k];
}

static inline void cross3(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* By 3 rows of 4. */
static inline void move3(const double m[12], const double p[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3];
}

static inline void world_point(const encre_mesh *mesh, int32_t point, double out[3])
{
	const float *p = mesh->points + 3 * (size_t)point;
	move3(mesh->model, (double[]){(double)p[0], (double)p[1], (double)p[2]}, out);
}

static inline void world_face(const encre_mesh *mesh, int32_t face, double out[3][3])
{
	for (uint32_t k = 0; k < 3; k++)
		world_point(mesh, topology_point(mesh, 3 * (uint32_t)face + k), out[k]);
}

/* Across a triangle, of length twice its area. */
static inline void across3(double p[3][3], double out[3])
{
	double u[3], v[3];
	minus3(p[1], p[0], u);
	minus3(p[2], p[0], v);
	cross3(u, v, out);
}

/* Degrees between two ways of any length; 0 if one has none. */
static inline float angle3(const double a[3], const double b[3])
{
	double n[3], along = dot3(a, b);
	cross3(a, b, n);
	double sine = sqrt(dot3(n, n)), longest = sine > along    ? sine
						  : along > 0     ? along
						  : -along > sine ? -along
								  : sine;
	if (!(longest > 0 && longest < INFINITY))
		return 0;
	return 57.2957795f * pixel_atan2((float)(sine / longest), (float)(along / longest));
}

/* ---- on the screen --------------------------------------------------------------------------------------------- */

typedef struct screen {
	double x, y, depth;
} screen;

static inline screen screen_at(const line *l, double t)
{
	const corner *a = l->c, *b = l->c + 1;
	double w = a->w + t * (b->w - a->w);
	return (screen){(a->x + t * (b->x - a->x)) / w, (a->y + t * (b->y - a->y)) / w, a->z + t * (b->z - a->z)};
}

static inline double apart(screen a, screen b)
{
	double x = b.x - a.x, y = b.y - a.y;
	return sqrt(x * x + y * y);
}

static inline void space_at(const line *l, double t, double p[3])
{
	for (int k = 0; k < 3; k++)
		p[k] = l->p[0][k] + t * (l->p[1][k] - l->p[0][k]);
}

/* The place on a line that is `share` of the way on the screen from the beginning of its whole to the end. */
static inline double place_of(const line *l, double share)
{
	double a = l->c[0].w + l->whole[0] * (l->c[1].w - l->c[0].w),
	       b = l->c[0].w + l->whole[1] * (l->c[1].w - l->c[0].w);
	return l->whole[0] + (l->whole[1] - l->whole[0]) * share * a / (share * a + (1 - share) * b);
}

/* The other way round. */
static inline double share_of(const line *l, double place)
{
	double a = l->c[0].w + l->whole[0] * (l->c[1].w - l->c[0].w),
	       b = l->c[0].w + l->whole[1] * (l->c[1].w - l->c[0].w);
	double t = (place - l->whole[0]) / (l->whole[1] - l->whole[0]);
	return t * b / (a * (1 - t) + b * t);
}

/* ---- the files --------------------------------------------------------------------------------------------------- */

/* shapes.c: what the job's meshes are made of, kept from the last job or found; bodies; a tree of them. Each returns a
 * code of enum encre_code. */
int32_t shapes_find(chains *c);
void shape_free(shape *s);
/* meet.c: where surfaces pass through each other, found again for what has changed. */
int32_t meets_find(chains *c);
/* candidates.c: bodies on the screen; edges that can be lines in the frame. */
int32_t lines_aim(chains *c);
int32_t lines_find(chains *c);
/* clips.c: where the clip planes cut surfaces; counted, or with `out` written there, too. */
int64_t clips_find(const chains *c, line *out);
/* What of a line lies between the clip planes and in the frame with its margin; false: nothing does. */
bool line_clip(const chains *c, line *l);
/* colors.c: where colors part in the images of the job. prints.c: these on the meshes, as lines, which are then moved
 * to where there is room for all. */
int32_t colors_find(chains *c);
int32_t colors_print(chains *c, prints *out);
/* colors.c: makes the levels of detail that images lack; *any: there were such. */
int32_t colors_fill(chains *c, bool *any);
void prints_move(prints *p, line *to);
void prints_free(prints *p);
/* islands.c: the line at an edge of a body at which its image does not go on, and colors part. False: there is none. */
bool seam_line(const chains *c, int number, int32_t edge, line *out);
void colors_free(kept_shapes *kept);
/* bevel.c: how much of its width the line of a bend over several faces has, of which an edge is the middle. */
float strip_fade(const chains *c, const body *b, const mesh_edge *e);
/* link.c: which line follows which. */
int32_t lines_link(chains *c);
/* sight.c: room for the parts of lines that the eye sees, and these. */
int32_t sight_find_base(chains *c);
int32_t sight_find_v3(chains *c);
/* runs.c: these as polylines, in kept->points. */
int32_t runs_write(chains *c);

/* job.c: what encre_chains() does; frame and numbers of the job have been checked. `best`: by the best
 * instructions. *kept: NULL at first. */
int32_t chains_run(bands *pool, encre_chain_job *job, bool best, kept_shapes **kept, char *error, size_t size);
void chains_free(kept_shapes **kept);

/* ---- eye.c ------------------------------------------------------------------------------------------------- */

/* What lies on the way from the eye to a place, which is at share 1. */
typedef struct sight {
	const chains *c;
	double from[3], to[3];
	double least, most; /* shares of the way to the clip planes: what lies before the one and beyond the other does
			       not count */
	double tolerance;   /* it is hidden by what lies before 1 - tolerance, and touched by what lies up to 1 +
			       tolerance */
	double slack;       /* world units by which a triangle that touches may miss it */
	const line *own;    /* whose faces do not count; NULL: all do */
	bool touched;
	int32_t body, face; /* what hides it, asked first the next time; -1: nothing */
	double at;
} sight;

bool ISA(sight_hidden)(sight *s);
/* How many bodies lie before the place, at most `most`. */
int ISA(sight_before)(const sight *s, int most);
/* The nearest on the way and beyond: body, face, at. False: nothing. */
bool ISA(sight_nearest)(sight *s);

#endif
