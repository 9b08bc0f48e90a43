/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bends over several narrow faces: from afar one line, at the middle one of the edges. Across the middle of an edge the
 * surface is followed to both sides, from triangle to triangle, as far as two edges on the screen are one. */
#include "chains/chains.h"

enum { STEPS = 16 /* triangles that are passed to a side, at most */ };
static const double strip = 2.5;       /* pixels over which bends are one */
static const double reach = 1.4 * 2.5; /* no line from there on */
static const float bends = 1;          /* degrees: what bends less is flat */

/* The way across an edge from its middle. */
typedef struct section {
	const body *b;
	double x, y, along_x, along_y; /* the middle on the screen, and the edge's way there */
	double middle[3], axis[3];     /* in space */
} section;

typedef struct side {
	int32_t face;      /* where the strip ends */
	int32_t beside;    /* the first edge that bends; -1 */
	double far;        /* pixels to the last one */
	float sum, beyond; /* of bends, and of the next beyond the strip */
} side;

static bool is_before(const corner *c)
{
	return c->w > 0;
}

static bool section_of(const body *b, const mesh_edge *e, section *s)
{
	const corner *p = b->spots + e->end[0], *q = b->spots + e->end[1];
	double ends[2][3];
	if (!is_before(p) || !is_before(q))
		return false;
	s->b = b;
	s->x = (p->x + q->x) / (p->w + q->w); /* of means of homogeneous coordinates: the middle in space */
	s->y = (p->y + q->y) / (p->w + q->w);
	double x = q->x / q->w - p->x / p->w, y = q->y / q->w - p->y / p->w, length = sqrt(x * x + y * y);
	if (!(length >= 0.3))
		return false;
	s->along_x = x / length;
	s->along_y = y / length;
	for (int k = 0; k < 2; k++)
		world_point(b->mesh, e->end[k], ends[k]);
	minus3(ends[1], ends[0], s->axis);
	for (int k = 0; k < 3; k++)
		s->middle[k] = 0.5 * (ends[0][k] + ends[1][k]);
	return true;
}

/* The edge of a triangle by which the section leaves it, not `from`; -1: none. *far: pixels from the middle. */
static int32_t leaves_by(const section *s, int32_t face, int32_t from, double *far)
{
	const body *b = s->b;
	int32_t best = -1;
	*far = -1;
	for (uint32_t c = 3 * (uint32_t)face; c < 3 * (uint32_t)face + 3; c++) {
		int32_t number = b->shape->edge_of[c];
		if (number == from || number < 0)
			continue;
		const mesh_edge *e = b->shape->edges + number;
		const corner *p = b->spots + e->end[0], *q = b->spots + e->end[1];
		double at[2][3], to[3], share[2];
		if (!is_before(p) || !is_before(q))
			return -1;
		for (int k = 0; k < 2; k++) {
			world_point(b->mesh, e->end[k], at[k]);
			minus3(at[k], s->middle, to);
			share[k] = dot3(to, s->axis);
		}
		if ((share[0] <= 0) == (share[1] <= 0))
			continue;
		double f = share[0] / (share[0] - share[1]), w = (1 - f) * p->w + f * q->w;
		double x = ((1 - f) * p->x + f * q->x) / w - s->x, y = ((1 - f) * p->y + f * q->y) / w - s->y;
		double away = fabs(y * s->along_x - x * s->along_y);
		if (away > *far) {
			*far = away;
			best = number;
		}
	}
	return best;
}

static void follow(const section *s, int32_t edge, int32_t face, side *out)
{
	const body *b = s->b;
	*out = (side){.face = face, .beside = -1};
	for (int step = 0; step < STEPS; step++) {
		double far;
		int32_t next = leaves_by(s, face, edge, &far);
		const mesh_edge *e = b->shape->edges + next;
		if (next < 0 || far > strip * reach || e->flags & (EDGE_BORDER | EDGE_MANY))
			return;
		int32_t other = e->face[e->face[0] == face];
		bool bent = e->bend >= bends;
		if (far > reach && bent) {
			out->beyond = e->bend;
			return;
		}
		if (b->faces[other] * b->faces[face] <= 0)
			return;
		edge = next;
		face = other;
		if (far > reach)
			continue;
		out->face = other;
		if (!bent)
			continue;
		out->beside = out->beside < 0 ? next : out->beside;
		out->far = far;
		out->sum += e->bend;
	}
}

/* Of two edges that share the middle between them, the nearer has the line. */
static bool is_middle(const body *b, const mesh_edge *e, int32_t number, const side two[2])
{
	float off = fabsf(two[0].sum - two[1].sum);
	int32_t beside = two[two[0].sum > two[1].sum ? 0 : 1].beside;
	if (off < 0.6f * e->bend)
		return true;
	if (off >= 1.4f * e->bend || beside < 0)
		return false;
	const mesh_edge *other = b->shape->edges + beside;
	double mine = b->spots[e->end[0]].z + b->spots[e->end[1]].z;
	double its = b->spots[other->end[0]].z + b->spots[other->end[1]].z;
	return fabs(mine - its) > 1e-6 * mine ? mine < its : number < beside;
}

float bevel_bend(const chains *c, const body *b, int32_t number, float *fade)
{
	(void)c;
	const mesh_edge *e = b->shape->edges + number;
	section s;
	side two[2];
	if (!section_of(b, e, &s))
		return 0;
	for (int k = 0; k < 2; k++)
		follow(&s, number, e->face[k], two + k);
	double wide = two[0].far + two[1].far;
	if (wide > reach || wide == 0 || !is_middle(b, e, number, two))
		return 0;
	double share = (reach - wide) / (0.4 * strip);
	if (e->flags & EDGE_SMOOTH) { /* a round form bends on beyond */
		double on = min(two[0].beyond, two[1].beyond) / max(e->bend, 1), kept = (0.25 - on) / 0.13;
		share = (share < 1 ? share : 1) * (kept < 0 ? 0 : kept > 1 ? 1 : kept);
	}
	*fade = share > 1 ? 1 : (float)share;
	double across[2][3];
	for (int k = 0; k < 2; k++) {
		double p[3][3];
		world_face(b->mesh, two[k].face, p);
		across3(p, across[k]);
	}
	float all = two[0].sum + two[1].sum + e->bend, net = angle3(across[0], across[1]);
	return min(all, net) + b->mesh->crease_offset;
}
