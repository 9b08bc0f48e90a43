/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A face takes of an image's lines what lies within its corners, of the level of detail whose texels are about pixels
 * there. A line goes on in the next face by the edge that it leaves by, and in the next line by the point that they
 * share. */
#include "chains/sheets.h"

#include <string.h>

/* Pixels that a texel is long, at least, for its level to be taken. */
static const float least_texel = 0.9f;
static const double fourth_root = 1.5874010519681994; /* of 4: the cube root */
static const double on_edge = 1e-3;                   /* texels from an edge of a face along which a line runs */
static const double least_height = 0.02;              /* texels from an edge of a face to its corner */
static const double at_end = 1e-6;                    /* share of a line from its end that is that */

static uint64_t stir2(uint64_t a, uint64_t b)
{
	uint64_t h = (a ^ (b + 0x9e3779b97f4a7c15u + (a << 6) + (a >> 2))) * 0xff51afd7ed558ccdu;
	return h ^ h >> 32;
}

bool face_make(const chains *c, int body_number, int inside, int32_t number, face *f)
{
	const body *b = c->bodies + body_number;
	const encre_mesh *m = b->mesh;
	int32_t image = turned_away(b, inside, number) ? -1 : image_of(c, m, number);
	if (image < 0)
		return false;
	*f = (face){.c = c, .b = b, .body = body_number, .number = number, .of = c->images[image]};
	int beyond[5] = {0};
	for (uint32_t k = 0; k < 3; k++) {
		f->corner[k] = b->spots[topology_point(m, 3 * (uint32_t)number + k)];
		corner at = f->corner[k];
		beyond[0] += at.z < c->job->clip_start;
		beyond[1] += at.x < (c->x0 - MARGIN) * at.w;
		beyond[2] += at.x > (c->x1 + MARGIN) * at.w;
		beyond[3] += at.y < (c->y0 - MARGIN) * at.w;
		beyond[4] += at.y > (c->y1 + MARGIN) * at.w;
		for (int i = 0; i < 2; i++)
			f->uv[k][i] = (double)m->uv[6 * (size_t)number + 2 * k + (size_t)i];
	}
	for (int k = 0; k < 5; k++)
		if (beyond[k] == 3)
			return false;
	f->area = (f->uv[1][0] - f->uv[0][0]) * (f->uv[2][1] - f->uv[0][1]) -
		  (f->uv[1][1] - f->uv[0][1]) * (f->uv[2][0] - f->uv[0][0]);
	double turn = outline_turn(f->corner, f->corner + 1, f->corner + 2);
	f->texel = fabs(turn / f->area) / ((double)f->of->width * f->of->height);
	double longest = 0, texels = fabs(f->area) * f->of->width * f->of->height;
	for (int k = 0; k < 3; k++) {
		double x = (f->uv[(k + 1) % 3][0] - f->uv[k][0]) * f->of->width,
		       y = (f->uv[(k + 1) % 3][1] - f->uv[k][1]) * f->of->height;
		longest = fmax(longest, sqrt(x * x + y * y));
	}
	if (!(texels > least_height * longest)) /* all of it shows one row of texels, drawn out */
		return false;
	f->finest = (double)pixel_cbrt((float)(f->texel / (double)(least_texel * least_texel)));
	f->mirrored = (turn > 0) == (f->area > 0);
	world_face(m, number, f->p);
	return f->texel > 0 && f->texel < INFINITY;
}

void level_range(const face *f, int level, double *low, double *high)
{
	double w = f->finest;
	for (int k = 0; k < level; k++)
		w *= fourth_root;
	*low = level ? w / fourth_root : -INFINITY;
	*high = level + 1 < f->of->n_levels || !level ? w : INFINITY;
}

/* Leaves of a part what lies where a u + b v + c is not below 0. */
static void cut_part(face_part *p, double a, double b, double c)
{
	face_part from = *p;
	p->n = 0;
	for (int i = 0; i < from.n; i++) {
		const double *at = from.at[i], *next = from.at[i + 1 < from.n ? i + 1 : 0];
		double here = a * at[0] + b * at[1] + c, there = a * next[0] + b * next[1] + c;
		if (here >= 0 && p->n < PART_ROOM)
			memcpy(p->at[p->n++], at, sizeof from.at[i]);
		if ((here >= 0) != (there >= 0) && p->n < PART_ROOM) {
			double t = here / (here - there);
			for (int k = 0; k < 2; k++)
				p->at[p->n][k] = at[k] + t * (next[k] - at[k]);
			p->n++;
		}
	}
}

/* Likewise of what a face's corners have. */
static void cut_by(const face *f, face_part *p, const double value[3])
{
	double a = 0, b = 0, c = 0;
	if (value[0] >= 0 && value[1] >= 0 && value[2] >= 0)
		return;
	for (int i = 0; i < 3; i++) {
		const double *one = f->uv[(i + 1) % 3], *other = f->uv[(i + 2) % 3];
		double of = value[i] / f->area;
		a -= of * (other[1] - one[1]);
		b += of * (other[0] - one[0]);
		c += of * ((other[1] - one[1]) * one[0] - (other[0] - one[0]) * one[1]);
	}
	cut_part(p, a, b, c);
}

static void show_part(const sheet *s, face_part *p)
{
	const face *f = s->f;
	const chains *c = f->c;
	double side[7][3];
	int n = 5;
	for (int i = 0; i < 3; i++) {
		const corner *at = f->corner + i;
		side[0][i] = at->z - c->job->clip_start;
		side[1][i] = at->x - (c->x0 - MARGIN) * at->w;
		side[2][i] = (c->x1 + MARGIN) * at->w - at->x;
		side[3][i] = at->y - (c->y0 - MARGIN) * at->w;
		side[4][i] = (c->y1 + MARGIN) * at->w - at->y;
	}
	for (int k = 0; k < 2; k++)
		if (fabs(k ? s->to : s->from) < INFINITY) {
			for (int i = 0; i < 3; i++)
				side[n][i] = k ? s->to - f->corner[i].w : f->corner[i].w - s->from;
			n++;
		}
	p->n = 3;
	memcpy(p->at, f->uv, sizeof f->uv);
	for (int k = 0; k < n; k++)
		cut_by(f, p, side[k]);
}

bool sheet_make(sheet *s, const face *f, int level)
{
	*s = (sheet){.f = f, .l = f->of->level + level, .level = level};
	level_range(f, level, &s->from, &s->to);
	for (int i = 0; i < 3; i++) {
		const double *a = f->uv[(i + 1) % 3], *b = f->uv[(i + 2) % 3];
		double x = (b[0] - a[0]) * f->of->width, y = (b[1] - a[1]) * f->of->height;
		s->near[i] = on_edge * sqrt(x * x + y * y) / (fabs(f->area) * f->of->width * f->of->height);
	}
	show_part(s, &s->shown);
	return s->shown.n > 0;
}

bool sheet_turn(sheet *s, int32_t x, int32_t y)
{
	const face *f = s->f;
	const double beyond = 2.5, room = 0.01; /* texels, of lines that go on into the next tile; and for rounding */
	double size[2] = {s->l->width, s->l->height}, uv[3][2];
	bool one = f->of->wrap == ENCRE_EXTEND || f->of->wrap == ENCRE_CLIP, back[2];
	face_part p = s->shown;
	s->tile[0] = x;
	s->tile[1] = y;
	for (int k = 0; k < 2 && !one; k++) {
		double low = s->tile[k] - beyond / size[k], high = s->tile[k] + 1 + beyond / size[k];
		cut_part(&p, !k, k, -low);
		cut_part(&p, -!k, -k, high);
	}
	if (!p.n)
		return false;
	for (int k = 0; k < 2; k++) {
		double low = INFINITY, high = -INFINITY;
		back[k] = f->of->wrap == ENCRE_MIRROR && s->tile[k] & 1;
		for (int i = 0; i < p.n; i++) {
			double at = p.at[i][k] - s->tile[k];
			at = size[k] * (back[k] ? 1 - at : at);
			low = fmin(low, at);
			high = fmax(high, at);
		}
		s->low[k] = (float)(low - room);
		s->high[k] = (float)(high + room);
		for (int i = 0; i < 3; i++) {
			uv[i][k] = f->uv[i][k] - s->tile[k];
			uv[i][k] = size[k] * (back[k] ? 1 - uv[i][k] : uv[i][k]);
		}
	}
	double area = (uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) - (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]);
	for (int i = 0; i < 3; i++) {
		const double *a = uv[(i + 1) % 3], *b = uv[(i + 2) % 3];
		s->share[i][0] = -(b[1] - a[1]) / area;
		s->share[i][1] = (b[0] - a[0]) / area;
		s->share[i][2] = -(s->share[i][0] * a[0] + s->share[i][1] * a[1]);
	}
	return true;
}

/* Cuts shares [from, to] of a way along which a value goes from a to b to where that is not below 0; whether either end
 * has moved. */
static void cut_way(double a, double b, double t[2], int by[2], int cut)
{
	if (a < 0 && b < 0) {
		t[1] = -1;
	} else if (a < 0) {
		double at = a / (a - b);
		if (at > t[0]) {
			t[0] = at;
			by[0] = cut;
		}
	} else if (b < 0) {
		double at = a / (a - b);
		if (at < t[1]) {
			t[1] = at;
			by[1] = cut;
		}
	}
}

enum { UNCUT = -1, BY_LEVEL = 3 };

/* Whether a line along an edge of the face is the face's: of two that have the edge, the first's. */
static bool owns_edge(const face *f, int i, int32_t *other)
{
	int32_t number = f->b->shape->edge_of[3 * (size_t)f->number + (size_t)((i + 1) % 3)];
	if (number < 0)
		return false;
	const mesh_edge *e = f->b->shape->edges + number;
	*other = e->face[1];
	return e->face[0] == f->number && e->face[1] >= 0;
}

/* On the mesh, by which what is at one place of the image is told apart where several faces show it: the face, or the
 * edge or corner that the place is on. share: of the face's corners. */
static uint64_t spot_of(const sheet *s, const double share[3])
{
	const face *f = s->f;
	int on[3], n = 0;
	for (int i = 0; i < 3; i++)
		if (fabs(share[i]) < s->near[i])
			on[n++] = i;
	if (!n || n == 3)
		return (uint64_t)1 << 40 | (uint32_t)f->number;
	if (n == 1) {
		int32_t edge = f->b->shape->edge_of[3 * (size_t)f->number + (size_t)((on[0] + 1) % 3)];
		return (uint64_t)(edge < 0 ? 4 : 2) << 40 | (uint32_t)(edge < 0 ? f->number : edge);
	}
	uint32_t corner = 3 * (uint32_t)f->number + (uint32_t)(3 - on[0] - on[1]);
	return (uint64_t)3 << 40 | (uint32_t)f->b->shape->place[topology_point(f->b->mesh, corner)];
}

static uint64_t node_of(const sheet *s, uint64_t place, int32_t number, int e, int by, const double share[3])
{
	const face *f = s->f;
	const texel_line *from = s->l->line + number;
	int32_t x = s->tile[0], y = s->tile[1];
	uint64_t node;
	if (by == UNCUT) {
		x += from->shift[e] & 1;
		y += from->shift[e] >> 1 & 1;
		node = stir2(stir2(place, (uint64_t)(uint32_t)from->point[e]), spot_of(s, share));
	} else if (by == BY_LEVEL) {
		node = stir2(stir2(place, (uint64_t)(uint32_t)number + ((uint64_t)1 << 34)),
			     (uint64_t)(uint32_t)f->number << 1 | (uint64_t)e);
	} else {
		int32_t edge = f->b->shape->edge_of[3 * (size_t)f->number + (size_t)((by + 1) % 3)];
		node = stir2(stir2(place, (uint64_t)(uint32_t)number + ((uint64_t)1 << 33)),
			     (uint64_t)(uint32_t)(edge < 0 ? -f->number - 2 : edge));
	}
	return stir2(node, (uint64_t)(uint32_t)x << 32 | (uint32_t)y) >> 1 | (uint64_t)1 << 62;
}

bool sheet_line(const sheet *s, int32_t number, double at[2][2], line *out)
{
	const face *f = s->f;
	const texel_line *from = s->l->line + number;
	double share[2][3], w[2] = {0}, t[2] = {0, 1};
	int by[2] = {UNCUT, UNCUT};
	int32_t along = -1;
	for (int i = 0; i < 3; i++) {
		for (int e = 0; e < 2; e++)
			share[e][i] = s->share[i][0] * at[e][0] + s->share[i][1] * at[e][1] + s->share[i][2];
		if (share[0][i] < 0 && share[1][i] < 0 && (share[0][i] < -s->near[i] || share[1][i] < -s->near[i]))
			return false;
	}
	for (int i = 0; i < 3; i++) {
		if (fabs(share[0][i]) < s->near[i] && fabs(share[1][i]) < s->near[i]) {
			if (!owns_edge(f, i, &along))
				return false;
			share[0][i] = share[1][i] = 0;
		}
		cut_way(share[0][i], share[1][i], t, by, i);
		for (int e = 0; e < 2; e++)
			w[e] += share[e][i] * f->corner[i].w;
	}
	if (s->from > -INFINITY)
		cut_way(w[0] - s->from, w[1] - s->from, t, by, BY_LEVEL);
	if (s->to < INFINITY)
		cut_way(s->to - w[0], s->to - w[1], t, by, BY_LEVEL);
	if (t[0] < at_end) {
		t[0] = 0;
		by[0] = UNCUT;
	}
	if (t[1] > 1 - at_end) {
		t[1] = 1;
		by[1] = UNCUT;
	}
	if (!(t[1] > t[0] + 1e-12))
		return false;
	double middle = w[0] + 0.5 * (t[0] + t[1]) * (w[1] - w[0]),
	       gap = (double)from->apart / 16 * (double)(1 << s->level);
	if (f->texel * gap * gap < f->c->gone * f->c->gone * middle * middle * middle)
		return false;
	*out = (line){.body = f->body,
		      .other = -1,
		      .edge = (int32_t)(stir2((uint64_t)number, (uint64_t)f->number + 1) & 0xffffff),
		      .own = {f->number, along},
		      .n_own = along >= 0 ? 2 : 1,
		      .kind = ENCRE_CHAIN_COLOR,
		      .object = object_of(f->b->mesh, f->number),
		      .link = {-1, -1}};
	for (int e = 0; e < 2; e++)
		for (int i = 0; i < 3; i++) {
			double of = share[0][i] + t[e] * (share[1][i] - share[0][i]);
			out->c[e].x += of * f->corner[i].x;
			out->c[e].y += of * f->corner[i].y;
			out->c[e].w += of * f->corner[i].w;
			out->c[e].z += of * f->corner[i].z;
			for (int k = 0; k < 3; k++)
				out->p[e][k] += of * f->p[i][k];
		}
	if (!line_clip(f->c, out))
		return false;
	bool mirrored = f->mirrored != (f->of->wrap == ENCRE_MIRROR && ((s->tile[0] ^ s->tile[1]) & 1));
	out->color[0] = from->color[mirrored];
	out->color[1] = from->color[!mirrored];
	uint64_t place = stir2((uint64_t)(uint32_t)f->body << 8 | (uint32_t)s->level, (uint64_t)f->of->key);
	for (int e = 0; e < 2; e++)
		out->node[e] = node_of(s, place, number, e, by[e], share[e]);
	return true;
}
