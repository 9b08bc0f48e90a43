/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggestive contours: where a smooth form nearly turns away from the eye (DeCarlo et al. 2003). On the screen they are
 * the valleys of how bright it is in the light of a lamp at the eye (Lee et al. 2007): a nose, lips and folds from the
 * front, where nothing jumps and nothing bends sharply. The light is blurred so far as one surface goes, between cracks
 * and creases; a valley counts by how far it rises again on both sides. */
#include "base/between.h"
#include "fine/near.h"

#include <string.h>

/* Of the blur's deviation, so far it looks, and so far away from a valley it must have risen; where it can't be
 * followed half as far again, as beside an outline, the line is thinner. */
static const float blur_reach = 2.5f, flank = 1.5f, room = 1.5f;
static const float full_rise = 0.08f;   /* that gives full strength; test_forms */
static const float least_bend = 0.005f; /* over a flank: less is not looked at */
/* Of the way down and up across: what is as rough as the first has no valleys; test_forms */
static const float most_rough = 0.25f, rough_ramp = 0.2f;
static const float least_sigma = 1.5f, most_sigma = 64; /* pixels */

/* ---- light from the eye, blurred ------------------------------------------------------------------------- */

static int reach_of(const fine *n)
{
	return (int)(blur_reach * n->form_sigma) + 1;
}

void ISA(valley_plan)(fine *n, const edges *e, arena *a)
{
	const frame *f = n->f;
	size_t pixels = (size_t)f->width * (size_t)f->height;
	if (!e->on[SOURCE_SUGGESTIVE])
		return;
	n->form_sigma = min(max(f->params->suggestive_size * f->scale, least_sigma), most_sigma);
	n->lit_rows = arena_take(a, pixels, sizeof *n->lit_rows);
	n->lit = arena_take(a, pixels, sizeof *n->lit);
}

/* Whether two surfaces meet on the way between two pixels, or one bends there that is shaded flat: it bends at its
 * edges alone, however little, and has no valley there. */
static bool parts(const fine *n, int x, int y, int axis)
{
	if (x < 0 || y < 0)
		return false;
	ptrdiff_t i = (ptrdiff_t)y * n->f->width + x;
	return (n->crack[i] & mark_of(FAMILY_CRACK, axis)) || (n->bent && n->bent[i] >> axis & 1);
}

static bool is_cut(const fine *n, int x, int y)
{
	return parts(n, x, y, AXIS_ROW) || parts(n, x, y, AXIS_COLUMN) || parts(n, x - 1, y, AXIS_ROW) ||
	       parts(n, x, y - 1, AXIS_COLUMN);
}

/* How bright a pixel is in the light of a lamp at the eye, -1..1: below 0 where it is seen aslant, off the middle. */
static float eye_light(const fine *n, int x, int y)
{
	const float *normal = layer_row(n->f, ENCRE_LAYER_NORMAL, y) + (ptrdiff_t)3 * x, *view = n->f->camera.view + 6;
	return view[0] * bounded(normal[0]) + view[1] * bounded(normal[1]) + view[2] * bounded(normal[2]);
}

/* Weighted sums of what is fitted by a line, of a tile. */
typedef struct sums {
	float open[TILE]; /* 1 as long as nothing unknown lies between */
	float s0[TILE], s1[TILE], s2[TILE], t0[TILE], t1[TILE];
} sums;

static void add(sums *m, const float *restrict value, int n, float way, float weight)
{
	float first = weight * way, second = first * way;
	for (int i = 0; i < n; i++) {
		float open = value[i] == value[i] ? m->open[i] : 0, v = open > 0 ? value[i] : 0;
		m->open[i] = open;
		m->s0[i] += weight * open;
		m->s1[i] += first * open;
		m->s2[i] += second * open;
		m->t0[i] += weight * v;
		m->t1[i] += first * v;
	}
}

static bool any_open(const sums *m, int n)
{
	float all = 0;
	for (int i = 0; i < n; i++)
		all += m->open[i];
	return all > 0;
}

static void open_all(sums *m, const float *restrict value, int n)
{
	for (int i = 0; i < n; i++)
		m->open[i] = value[i] == value[i] ? 1 : 0;
}

/* Where the line lies at its middle: a mean would bend where a surface ends. */
static void fitted(const sums *m, const float *restrict value, int n, float *restrict out)
{
	for (int i = 0; i < n; i++) {
		float det = m->s0[i] * m->s2[i] - m->s1[i] * m->s1[i];
		float at = (m->s2[i] * m->t0[i] - m->s1[i] * m->t1[i]) / (det > 0 ? det : 1);
		out[i] = det > 0 && value[i] == value[i] ? at : NAN;
	}
}

static float weight_at(const fine *n, int k)
{
	float far = (float)k / n->form_sigma;
	return pixel_exp(-0.5f * far * far);
}

static void blur_rows(void *data, int y0, int y1, int thread)
{
	const fine *n = data;
	int width = n->f->width, reach = reach_of(n);
	float *row = n->scratch + thread * n->thread_scratch + reach;
	for (int y = y0; y < y1 && !bands_stopped(n->f->bands); y++) {
		for (int x = 0; x < width; x++)
			row[x] = is_cut(n, x, y) ? NAN : eye_light(n, x, y);
		for (int k = 1; k <= reach; k++)
			row[-k] = row[width - 1 + k] = NAN;
		for (int x0 = 0; x0 < width; x0 += TILE) {
			int count = width - x0 < TILE ? width - x0 : TILE;
			sums m = {.open = {0}};
			for (int side = -1; side <= 1; side += 2) {
				open_all(&m, row + x0, count);
				for (int k = side > 0; k <= reach && any_open(&m, count); k++)
					add(&m, row + x0 + side * k, count, (float)(side * k), weight_at(n, k));
			}
			fitted(&m, row + x0, count, n->lit_rows + (ptrdiff_t)y * width + x0);
		}
	}
}

static void blur_columns(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	int width = n->f->width, height = n->f->height, reach = reach_of(n);
	for (int y = y0; y < y1 && !bands_stopped(n->f->bands); y++)
		for (int x0 = 0; x0 < width; x0 += TILE) {
			int count = width - x0 < TILE ? width - x0 : TILE;
			const float *own = n->lit_rows + (ptrdiff_t)y * width + x0;
			sums m = {.open = {0}};
			for (int side = -1; side <= 1; side += 2) {
				open_all(&m, own, count);
				for (int k = side > 0; k <= reach && any_open(&m, count); k++) {
					int row = y + side * k;
					if (row < 0 || row >= height)
						break;
					add(&m, own + (ptrdiff_t)side * k * width, count, (float)(side * k),
					    weight_at(n, k));
				}
			}
			fitted(&m, own, count, n->lit + (ptrdiff_t)y * width + x0);
		}
}

/* ---- valleys --------------------------------------------------------------------------------------------- */

static float lit_at(const fine *n, int x, int y)
{
	return n->lit[(ptrdiff_t)clamp_index(y, n->f->height) * n->f->width + clamp_index(x, n->f->width)];
}

/* The way across a valley at a pixel, of length 1, and where along the axis that is nearer to it the floor lies. */
typedef struct valley {
	float dx, dy, offset, floor;
	int axis;
} valley;

static bool valley_of(const fine *n, int x, int y, valley *v)
{
	float p[3][3], all = 0;
	for (int j = 0; j < 3; j++)
		for (int i = 0; i < 3; i++)
			all += p[j][i] = lit_at(n, x + i - 1, y + j - 1);
	if (!(all == all))
		return false;
	float gx = 0.5f * (p[1][2] - p[1][0]), gy = 0.5f * (p[2][1] - p[0][1]);
	float xx = p[1][2] + p[1][0] - 2 * p[1][1], yy = p[2][1] + p[0][1] - 2 * p[1][1];
	float xy = 0.25f * (p[2][2] + p[0][0] - p[2][0] - p[0][2]);
	float half = 0.5f * (xx - yy), radius = sqrtf(half * half + xy * xy), bend = 0.5f * (xx + yy) + radius;
	float far = flank * n->form_sigma;
	if (!(bend * far * far > least_bend))
		return false;
	float dx = half >= 0 ? half + radius : xy, dy = half >= 0 ? xy : radius - half;
	float length = sqrtf(dx * dx + dy * dy);
	v->dx = length > 0 ? dx / length : 1;
	v->dy = length > 0 ? dy / length : 0;
	v->axis = fabsf(v->dx) >= fabsf(v->dy) ? AXIS_ROW : AXIS_COLUMN;
	v->offset = -(gx * v->dx + gy * v->dy) / (bend * (v->axis == AXIS_ROW ? v->dx : v->dy));
	float along = v->axis == AXIS_ROW ? gx : gy, again = v->axis == AXIS_ROW ? xx : yy;
	v->floor = p[1][1] + (along + 0.5f * again * v->offset) * v->offset;
	return v->offset > -0.5f && v->offset <= 0.5f;
}

/* Between pixels; of the nearest where others are not known. */
static float lit_between(const fine *n, float x, float y)
{
	int left = (int)floorf(x), top = (int)floorf(y);
	float u = x - (float)left, v = y - (float)top;
	float light = mix(mix(lit_at(n, left, top), lit_at(n, left + 1, top), u),
			  mix(lit_at(n, left, top + 1), lit_at(n, left + 1, top + 1), u), v);
	return light == light ? light : lit_at(n, (int)floorf(x + 0.5f), (int)floorf(y + 0.5f));
}

/* How far it rises on one side, and of its width how much the line has by the room there. */
static float rise_of(const fine *n, const placed *s, const valley *v, float side, float *share)
{
	float far = flank * n->form_sigma;
	int steps = 0;
	for (; (float)steps < room * far; steps++) {
		float x = s->x + side * (float)(steps + 1) * v->dx, y = s->y + side * (float)(steps + 1) * v->dy;
		float light = lit_at(n, (int)floorf(x + 0.5f), (int)floorf(y + 0.5f));
		if (!(light == light))
			break;
	}
	float open = (float)steps;
	*share = min(*share, clamp01((open - far) / ((room - 1) * far)));
	return open > far ? lit_between(n, s->x + side * far * v->dx, s->y + side * far * v->dy) - v->floor : 0;
}

/* By how much light goes down and up more, over a flank each way, than down once and up again, which is `direct`. */
static float unrest(const fine *n, const placed *s, float dx, float dy, float *direct)
{
	int steps = (int)(flank * n->form_sigma);
	float first = 0, last = 0, least = INFINITY, way = 0;
	for (int k = -steps; k <= steps; k++) {
		float x = s->x + (float)k * dx, y = s->y + (float)k * dy, u = x - floorf(x);
		int left = clamp_index((int)floorf(x), n->f->width),
		    right = clamp_index((int)floorf(x) + 1, n->f->width),
		    top = clamp_index((int)floorf(y), n->f->height),
		    bottom = clamp_index((int)floorf(y) + 1, n->f->height);
		float light = mix(mix(eye_light(n, left, top), eye_light(n, right, top), u),
				  mix(eye_light(n, left, bottom), eye_light(n, right, bottom), u), y - floorf(y));
		first = k == -steps ? light : first;
		way += k == -steps ? 0 : fabsf(light - last);
		last = light;
		least = min(least, light);
	}
	*direct = first + last - 2 * least;
	return way - *direct;
}

/* How far a surface is smooth at a valley: what is rough would be covered in lines. */
static float smoothness(const fine *n, const placed *s, const valley *v)
{
	float across, along, rough = unrest(n, s, v->dx, v->dy, &across);
	rough += unrest(n, s, -v->dy, v->dx, &along);
	return across > 0 ? clamp01((most_rough - rough / across) / rough_ramp) : 0;
}

bool ISA(valley_site)(const fine *n, const found *at, placed *s)
{
	valley v;
	if (!valley_of(n, at->column, at->row, &v) || v.axis != at->axis)
		return false;
	s->x = (float)at->column + (v.axis == AXIS_ROW ? v.offset : 0);
	s->y = (float)at->row + (v.axis == AXIS_COLUMN ? v.offset : 0);
	float share = 1, left = rise_of(n, s, &v, -1, &share), right = rise_of(n, s, &v, 1, &share);
	float strength = clamp01(min(left, right) / full_rise);
	strength *= strength > 0 ? smoothness(n, s, &v) : 0;
	crack_place(at, v.offset, s);
	int style = fine_style(n, at, s);
	bool edge = ISA(fine_weigh)(n, s, style, SOURCE_SUGGESTIVE, strength);
	float least = least_faint * n->e->p->edge_threshold;
	s->weak = !edge;
	/* what fades out is no wider than a hair where it ends */
	share *= least > 0 ? clamp01((s->strength - least) / (3 * least)) : 1;
	s->eased = (uint8_t)(255 * (1 - share) + 0.5f);
	return s->strength > 0 && s->strength >= least;
}

static void mark_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	int width = n->f->width;
	for (int y = y0; y < y1 && !bands_stopped(n->f->bands); y++)
		for (int x = 0; x < width; x++) {
			valley v;
			placed s = {0};
			if (!valley_of(n, x, y, &v))
				continue;
			found at = {(uint16_t)x, (uint16_t)y, FAMILY_VALLEY, (uint8_t)v.axis};
			if (!ISA(valley_site)(n, &at, &s))
				continue;
			n->ridge[(ptrdiff_t)y * width + x] |= RIDGE_MORE;
			n->more[(ptrdiff_t)y * width + x] |= mark_of(FAMILY_VALLEY, v.axis);
		}
}

/* ---- edges of meshes ------------------------------------------------------------------------------------- */

static void note_bend(void *user, const passage *p)
{
	const fine *n = user;
	bool bends = p->of->kind & (ENCRE_CHAIN_CREASE | ENCRE_CHAIN_MEET | ENCRE_CHAIN_BEVEL);
	if (bends && !(p->of->kind & ENCRE_CHAIN_SMOOTH))
		n->bent[(ptrdiff_t)p->y * n->f->width + p->x] |= (uint8_t)(1 << p->down);
}

static int32_t find_bends(fine *n)
{
	size_t pixels = (size_t)n->f->width * (size_t)n->f->height;
	if (!n->f->n_chains)
		return ENCRE_OK;
	n->bent = late_take(&n->f->late, pixels, 1);
	if (!n->bent)
		return ENCRE_ERROR_MEMORY;
	memset(n->bent, 0, pixels);
	between_each(n->f, note_bend, n);
	return ENCRE_OK;
}

int32_t ISA(valley_run)(fine *n)
{
	int32_t code = find_bends(n);
	code = code ? code : bands_run(n->f->bands, n->f->height, 0, blur_rows, n);
	code = code ? code : bands_run(n->f->bands, n->f->height, 0, blur_columns, n);
	return code ? code : bands_run(n->f->bands, n->f->height, 0, mark_rows, n);
}

ptrdiff_t ISA(valley_scratch)(const fine *n)
{
	return n->form_sigma > 0 ? n->f->width + 2 * reach_of(n) : 0;
}
