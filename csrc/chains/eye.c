/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What lies on the way from the eye to a place. Boxes are entered in floats, with room for rounding; triangles are met
 * in double, as a line lies on the very faces that it bounds. */
#include "chains/chains.h"

static const double fuzz = 1e-9; /* of a triangle's sides: neighbours leave no gap */
static const float wide = 1.000001f, narrow = 0.999999f;
static const float padding = 4e-7f; /* of coordinates, by which boxes are larger: a ray may lie in a side of one */

typedef struct local_ray {
	float enters[3], leaves[3], inverse[3], far; /* enters, leaves: where it begins, for either bound */
	int low[3], high[3];                         /* which bounds it meets first and last */
	double origin[3], way[3];
} local_ray;

static inline void aim(local_ray *l, const double from[3], const double to[3], double far)
{
	double size = 0;
	for (int k = 0; k < 3; k++)
		size += fabs(from[k]) + fabs(to[k]);
	float pad = padding * (float)size;
	for (int k = 0; k < 3; k++) {
		l->origin[k] = from[k];
		l->way[k] = to[k] - from[k];
		float way = (float)l->way[k], least = way < 0 ? -1e-18f : 1e-18f;
		l->inverse[k] = 1 / (fabsf(way) < 1e-18f ? least : way);
		float begin = (float)from[k];
		l->enters[k] = l->inverse[k] < 0 ? begin - pad : begin + pad;
		l->leaves[k] = l->inverse[k] < 0 ? begin + pad : begin - pad;
		l->low[k] = l->inverse[k] < 0 ? 3 + k : k;
		l->high[k] = l->inverse[k] < 0 ? k : 3 + k;
	}
	l->far = (float)far * wide;
}

static inline void aim_at(local_ray *l, const body *b, const sight *s, double far)
{
	double from[3], to[3];
	move3(b->inverse, s->from, from);
	move3(b->inverse, s->to, to);
	aim(l, from, to, far);
}

/* The boxes of a node that a ray enters, a bit each. */
static inline unsigned entered(const tree_node *n, const local_ray *l)
{
	const float *x0 = n->bound[l->low[0]], *y0 = n->bound[l->low[1]], *z0 = n->bound[l->low[2]];
	const float *x1 = n->bound[l->high[0]], *y1 = n->bound[l->high[1]], *z1 = n->bound[l->high[2]];
	unsigned bits = 0;
	int32_t in[TREE_WIDE];
	for (int i = 0; i < TREE_WIDE; i++) {
		float t0 = max(max((x0[i] - l->enters[0]) * l->inverse[0], (y0[i] - l->enters[1]) * l->inverse[1]),
			       max((z0[i] - l->enters[2]) * l->inverse[2], 0.0f));
		float t1 = min(min((x1[i] - l->leaves[0]) * l->inverse[0], (y1[i] - l->leaves[1]) * l->inverse[1]),
			       (z1[i] - l->leaves[2]) * l->inverse[2]);
		t1 = min(t1 * wide, l->far);
		in[i] = -(t0 * narrow <= t1);
	}
#ifdef __AVX__ /* one instruction that no compiler makes of the loop */
	float eight __attribute__((vector_size(4 * TREE_WIDE)));
	__builtin_memcpy(&eight, in, sizeof eight);
	bits = (unsigned)__builtin_ia32_movmskps256(eight);
#else
	for (int i = 0; i < TREE_WIDE; i++)
		bits |= in[i] < 0 ? 1u << i : 0;
#endif
	return bits;
}

static inline bool is_own(const sight *s, int32_t body, int32_t face)
{
	const line *own = s->own;
	if (!own || (body != own->body && body != own->other))
		return false;
	for (int i = 0; i < own->n_own; i++)
		if (own->own[i] == face && body == (own->other >= 0 && i == own->n_own - 1 ? own->other : own->body))
			return true;
	return false;
}

typedef struct crossing {
	double t, u, v;    /* along the ray, and along the edges */
	double e[3], f[3]; /* these */
} crossing;

/* False where the ray misses a triangle by far, or passes along it. */
static inline bool crosses(const encre_mesh *m, int32_t face, const local_ray *l, crossing *x)
{
	const float *p[3];
	for (uint32_t k = 0; k < 3; k++)
		p[k] = m->points + 3 * (size_t)topology_point(m, 3 * (uint32_t)face + k);
	double to[3], across[3], beside[3];
	for (int k = 0; k < 3; k++) {
		x->e[k] = (double)p[1][k] - (double)p[0][k];
		x->f[k] = (double)p[2][k] - (double)p[0][k];
		to[k] = l->origin[k] - (double)p[0][k];
	}
	cross3(l->way, x->f, across);
	double det = dot3(x->e, across);
	if (det == 0)
		return false;
	x->u = dot3(to, across) / det;
	if (!(x->u >= -0.01 && x->u <= 1.01))
		return false;
	cross3(to, x->e, beside);
	x->v = dot3(l->way, beside) / det;
	if (!(x->v >= -0.01 && x->u + x->v <= 1.01))
		return false;
	x->t = dot3(x->f, beside) / det;
	return true;
}

/* Whether a triangle that the ray misses is touched all the same, as it lies beside it. */
static bool touches_beside(const sight *s, const crossing *x)
{
	double n[3];
	cross3(x->e, x->f, n);
	double d = s->slack / (sqrt(dot3(n, n)) + 1e-300), e = sqrt(dot3(x->e, x->e)), f = sqrt(dot3(x->f, x->f));
	return x->u >= -d * f && x->v >= -d * e && x->u + x->v <= 1 + d * (e + f) && x->t >= 1 - s->tolerance &&
	       x->t <= 1 + s->tolerance;
}

static bool face_hides(sight *s, int32_t body, int32_t face, const local_ray *l)
{
	crossing x;
	if (!crosses(s->c->bodies[body].mesh, face, l, &x) || is_own(s, body, face))
		return false;
	if (!(x.u >= -fuzz && x.v >= -fuzz && x.u + x.v <= 1 + fuzz)) {
		s->touched = s->touched || touches_beside(s, &x);
		return false;
	}
	if (x.t < s->least)
		return false;
	if (x.t < 1 - s->tolerance) {
		s->body = body;
		s->face = face;
		s->at = x.t;
		return true;
	}
	s->touched |= x.t <= 1 + s->tolerance;
	return false;
}

static bool body_hides(sight *s, int32_t number)
{
	const body *b = s->c->bodies + number;
	const shape *shape = b->shape;
	local_ray l;
	aim_at(&l, b, s, 1 + 2 * s->tolerance);
	int32_t stack[TREE_STACK], top = 1;
	stack[0] = 0;
	while (top) {
		const tree_node *n = shape->tree.nodes + stack[--top];
		for (unsigned bits = entered(n, &l); bits; bits &= bits - 1) {
			int32_t child = n->child[__builtin_ctz(bits)];
			if (child >= 0) {
				stack[top++] = child;
				continue;
			}
			tree_leaf leaf = shape->tree.leaves[~child];
			for (int32_t i = 0; i < leaf.count; i++)
				if (face_hides(s, number, shape->order[leaf.from + i], &l))
					return true;
		}
	}
	return false;
}

bool ISA(sight_hidden)(sight *s)
{
	const chains *c = s->c;
	local_ray l;
	s->touched = false;
	if (s->body >= 0) {
		aim_at(&l, c->bodies + s->body, s, 1);
		if (face_hides(s, s->body, s->face, &l))
			return true;
		s->touched = false;
	}
	s->body = -1;
	aim(&l, s->from, s->to, 1 + 2 * s->tolerance);
	int32_t stack[TREE_STACK], top = c->tree.n_nodes > 0;
	stack[0] = 0;
	while (top) {
		const tree_node *n = c->tree.nodes + stack[--top];
		for (unsigned bits = entered(n, &l); bits; bits &= bits - 1) {
			int32_t child = n->child[__builtin_ctz(bits)];
			if (child >= 0)
				stack[top++] = child;
			else if (body_hides(s, c->order[c->tree.leaves[~child].from]))
				return true;
		}
	}
	return false;
}

int ISA(sight_before)(const sight *s, int most)
{
	const chains *c = s->c;
	sight each = *s;
	local_ray l;
	int found = 0;
	aim(&l, s->from, s->to, 1);
	int32_t stack[TREE_STACK], top = c->tree.n_nodes > 0;
	stack[0] = 0;
	while (top && found < most) {
		const tree_node *n = c->tree.nodes + stack[--top];
		for (unsigned bits = entered(n, &l); bits && found < most; bits &= bits - 1) {
			int32_t child = n->child[__builtin_ctz(bits)];
			if (child >= 0)
				stack[top++] = child;
			else
				found += body_hides(&each, c->order[c->tree.leaves[~child].from]);
		}
	}
	return found;
}

/* ---- the nearest ----------------------------------------------------------------------------------------------- */

/* Of what lies equally near the earlier: shares less apart than the tolerance are equal. */
static void face_nearest(sight *s, int32_t body, int32_t face, const local_ray *l)
{
	crossing x;
	if (!crosses(s->c->bodies[body].mesh, face, l, &x) || is_own(s, body, face) ||
	    !(x.u >= -fuzz && x.v >= -fuzz && x.u + x.v <= 1 + fuzz) || x.t < s->least)
		return;
	double same = s->body >= 0 ? s->tolerance : 0;
	bool earlier = body < s->body || (body == s->body && face < s->face);
	if (!(x.t < s->at - same) && !(x.t < s->at + same && earlier))
		return;
	s->body = body;
	s->face = face;
	s->at = x.t;
}

static void body_nearest(sight *s, int32_t number)
{
	const body *b = s->c->bodies + number;
	const shape *shape = b->shape;
	local_ray l;
	aim_at(&l, b, s, s->at);
	int32_t stack[TREE_STACK], top = 1;
	stack[0] = 0;
	while (top) {
		const tree_node *n = shape->tree.nodes + stack[--top];
		for (unsigned bits = entered(n, &l); bits; bits &= bits - 1) {
			int32_t child = n->child[__builtin_ctz(bits)];
			if (child >= 0) {
				stack[top++] = child;
				continue;
			}
			tree_leaf leaf = shape->tree.leaves[~child];
			for (int32_t i = 0; i < leaf.count; i++)
				face_nearest(s, number, shape->order[leaf.from + i], &l);
			l.far = (float)s->at * 1.00001f;
		}
	}
}

bool ISA(sight_nearest)(sight *s)
{
	const chains *c = s->c;
	local_ray l;
	s->body = -1;
	s->at = s->most;
	aim(&l, s->from, s->to, s->at);
	int32_t stack[TREE_STACK], top = c->tree.n_nodes > 0;
	stack[0] = 0;
	while (top) {
		const tree_node *n = c->tree.nodes + stack[--top];
		for (unsigned bits = entered(n, &l); bits; bits &= bits - 1) {
			int32_t child = n->child[__builtin_ctz(bits)];
			if (child >= 0) {
				stack[top++] = child;
				continue;
			}
			body_nearest(s, c->order[c->tree.leaves[~child].from]);
			l.far = (float)s->at * 1.00001f;
		}
	}
	return s->body >= 0;
}
