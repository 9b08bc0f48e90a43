/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Surfaces painted by the example of a ball (after Sýkora et al., StyleBlit, 2019): patches of the painting, all
 * facing the eye, are laid on them, so that they keep the work of the brush, each taken from where the ball is lit as
 * the surface is.
 *
 * Patches are cells of a lattice in the space where a thing rests, chosen by the size of a pixel there: they stick to
 * it, and need no other frame. What a pixel shows of a patch follows from its own anchor: the way on the screen to the
 * middle of the cell. So no pixel reads another's. A patch grows with its cell until those of half the size take over:
 * paint that kept its size would slide over the thing as the camera comes nearer. Where patches overlap, the one whose
 * paint is lightest there wins, as strokes lie on each other, and not a straight seam. Coarse colours come from the
 * pixel's own place on the ball. */
#include "surface/ball.h"

enum { CHUNK = 128, CORNERS = 4, CELLS = 2 * CORNERS, NODES = 3 };

static const float to_light[3] = {-0.5f, 0.6f, 0.6245f}; /* from the ball: right, up, to the eye */
static const float flat_light = 0.78102497f;             /* length of the first two */
static const float pitch = 0.3f;                         /* between places of the ball that patches are from */
static const float seam = 0.08f, relief = 0.22f;         /* of weights: how soft seams are, and ragged */
static const float skew = 1.0f / 3, unskew = 1.0f / 6;   /* of the lattice of tetrahedra */

/* ---- where on the ball --------------------------------------------------------------------------------- */

/* Light 0..1, never quite 1, so that what is bright keeps its form. */
static inline float shoulder(float light)
{
	float t = 0.95f * min(positive(light), 1e6f);
	return t < 0.6f ? t : 1 - 0.16f / (t - 0.2f);
}

/* Places on the ball, in radii to the right and up. By the normal, that of the ball; by the light, which is there as on
 * the surface, and beside that where the surface faces, across the light. */
static void place_row(const float *view, float by_light, int n, const float *restrict normals,
		      const float *restrict light, float (*restrict place)[CHUNK])
{
	const float l[2] = {to_light[0] / flat_light, to_light[1] / flat_light};
	for (int i = 0; i < n; i++) {
		float x = normals[3 * i], y = normals[3 * i + 1], z = normals[3 * i + 2];
		float u = view[0] * x + view[1] * y + view[2] * z, v = view[3] * x + view[4] * y + view[5] * z;
		float square = x * x + y * y + z * z;
		int good = (square > 1e-12f) & (square < 1e12f);
		float per = 1 / sqrtf(good ? square : 1);
		u = good ? u * per : 0;
		v = good ? v * per : 0;
		float across = min(max(v * l[0] - u * l[1], -0.95f), 0.95f), rest = sqrtf(1 - across * across);
		float a = max(1.7f * shoulder(light[i]) - 0.7f, -flat_light * rest); /* not on the far side */
		float lack = sqrtf(max(1 - a * a, 0)), along = a * flat_light - lack * rest * to_light[2];
		across *= lack;
		place[0][i] = mix(u, along * l[0] - across * l[1], by_light);
		place[1][i] = mix(v, along * l[1] + across * l[0], by_light);
	}
}

/* ---- patches --------------------------------------------------------------------------------------------- */

static inline uint32_t scramble(uint32_t n)
{
	n = (n ^ n >> 16) * 0x7feb352du;
	n = (n ^ n >> 15) * 0x846ca68bu;
	return n ^ n >> 16;
}

/* Two numbers 0..1 from a scrambled one. */
static inline float low_share(uint32_t hash)
{
	return (float)(int32_t)(hash & 0xffff) * (1.0f / 65536);
}

static inline float high_share(uint32_t hash)
{
	return (float)(int32_t)(hash >> 16) * (1.0f / 65536);
}

/* Of each pixel of a chunk the cells that may reach it, those of the finer octave last. */
typedef struct cells {
	float weight[CELLS][CHUNK], way[CELLS][2][CHUNK]; /* 0: it doesn't; from its middle to the pixel, in pixels */
	uint32_t hash[CELLS][CHUNK];
} cells;

/* The places of pixels in the space where their things rest, and how it lies on the screen. */
typedef struct spots {
	float at[3][CHUNK], inverse[2][3][CHUNK]; /* pixels to the unit of that space, along the surface */
	float rate[CHUNK], finer[CHUNK];          /* patches to the unit, 0: none; share of the finer octave */
} spots;

static inline float octave_share(float rate)
{
	return (float)(float_bits(rate) & 0x7fffff) * (1.0f / 8388608);
}

static void spots_row(const float *restrict anchor, int n, float size, spots *restrict s)
{
	for (int i = 0; i < n; i++) {
		const float *a = anchor + ANCHOR_COUNT * i, *r = a + ANCHOR_RIGHT, *d = a + ANCHOR_DOWN;
		float rr = r[0] * r[0] + r[1] * r[1] + r[2] * r[2], dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
		float rd = r[0] * d[0] + r[1] * d[1] + r[2] * d[2], det = rr * dd - rd * rd;
		float rate = 1 / (a[ANCHOR_PIXEL] * size);
		/* not where nothing is, nor where a surface is seen on its edge */
		int good = (det > 1e-6f * rr * dd) & (det > 1e-36f) & (det < 1e36f) & (rate > 1e-18f) & (rate < 1e18f);
		float per = good ? 1 / det : 0;
		for (int c = 0; c < 3; c++) {
			s->at[c][i] = a[c];
			s->inverse[0][c][i] = (dd * r[c] - rd * d[c]) * per;
			s->inverse[1][c][i] = (rr * d[c] - rd * r[c]) * per;
		}
		s->rate[i] = good ? rate : 0;
		s->finer[i] = good ? octave_share(rate) : 0;
	}
}

/* Where nothing says what rests where, patches lie on the picture: without any, paint would follow the light alone, in
 * rings about each lamp. In units of about a patch: octaves lie apart by their numbers, of which large ones are less
 * exact. */
static void picture_row(int x, int y, int n, float size, spots *restrict s)
{
	const float unit = 64;
	float rate = unit / size, finer = octave_share(rate);
	for (int i = 0; i < n; i++) {
		s->at[0][i] = (float)(x + i) / unit;
		s->at[1][i] = (float)y / unit;
		s->at[2][i] = 0;
		for (int c = 0; c < 3; c++) {
			s->inverse[0][c][i] = c == 0 ? unit : 0;
			s->inverse[1][c][i] = c == 1 ? unit : 0;
		}
		s->rate[i] = rate;
		s->finer[i] = finer;
	}
}

/* The cells of one octave: a cell is one to two patches wide, those of the finer octave half. */
static void cells_row(const spots *restrict s, int n, int finer, cells *restrict c)
{
	for (int i = 0; i < n; i++) {
		int32_t m = (float_bits(s->rate[i]) >> 23) - 127 + finer;
		m = s->rate[i] > 0 ? m : 0;
		float scale = bits_float((m + 126) << 23), aside = 17.3f * (float)m;
		float grown = (1 + s->finer[i]) * (finer ? 0.5f : 1), per = bits_float((128 - m) << 23) / grown;
		float x = min(max(s->at[0][i] * scale + aside, -1e6f), 1e6f),
		      y = min(max(s->at[1][i] * scale + aside, -1e6f), 1e6f),
		      z = min(max(s->at[2][i] * scale + aside, -1e6f), 1e6f);
		float lean = (x + y + z) * skew, bx = floorf(x + lean), by = floorf(y + lean), bz = floorf(z + lean);
		float back = (bx + by + bz) * unskew;
		float ox = x - (bx - back), oy = y - (by - back), oz = z - (bz - back);
		/* the tetrahedron: axes are gone along from the longest rest to the shortest */
		int xy = ox >= oy, yz = oy >= oz, xz = ox >= oz;
		for (int k = 0; k < CORNERS; k++) {
			int gx = k == 0   ? 0
				 : k == 1 ? xy & xz
				 : k == 2 ? xy | xz
					  : 1,
			    gy = k == 0   ? 0
				 : k == 1 ? (1 - xy) & yz
				 : k == 2 ? (1 - xy) | yz
					  : 1,
			    gz = k == 0   ? 0
				 : k == 1 ? (1 - xz) & (1 - yz)
				 : k == 2 ? 1 - (xz & yz)
					  : 1;
			float dx = ox - (float)gx + (float)k * unskew, dy = oy - (float)gy + (float)k * unskew,
			      dz = oz - (float)gz + (float)k * unskew;
			float near = 1 - 2 * (dx * dx + dy * dy + dz * dz);
			/* a cell is the same, whichever octave is the finer */
			uint32_t hash = ((uint32_t)m * 0x9e3779b1u ^ (uint32_t)((int32_t)bx + gx)) * 0x85ebca6bu;
			hash = ((hash ^ hash >> 15) ^ (uint32_t)((int32_t)by + gy)) * 0xc2b2ae35u;
			hash = ((hash ^ hash >> 13) ^ (uint32_t)((int32_t)bz + gz)) * 0x27d4eb2fu;
			hash = scramble(hash);
			float share = finer ? s->finer[i] : 1 - s->finer[i];
			float alive = clamp01(2 * share - low_share(hash));
			float weight = positive(near) * (0.75f + 0.5f * high_share(hash)) * alive;
			int to = finer * CORNERS + k;
			c->weight[to][i] = s->rate[i] > 0 ? weight : 0;
			c->hash[to][i] = hash;
			dx *= per;
			dy *= per;
			dz *= per;
			for (int w = 0; w < 2; w++)
				c->way[to][w][i] =
					s->inverse[w][0][i] * dx + s->inverse[w][1][i] * dy + s->inverse[w][2][i] * dz;
		}
	}
}

/* Of each pixel the three places of the ball about its own from which patches may be. */
typedef struct nodes {
	float weight[NODES][CHUNK], at[NODES][2][CHUNK];
	uint32_t hash[NODES][CHUNK];
} nodes;

static void nodes_row(float (*restrict place)[CHUNK], int n, nodes *restrict found)
{
	const float lean = 0.36602540f, unlean = 0.21132487f;
	for (int i = 0; i < n; i++) {
		float u = place[0][i] * (1 / pitch), v = place[1][i] * (1 / pitch), leant = (u + v) * lean;
		float bu = floorf(u + leant), bv = floorf(v + leant), back = (bu + bv) * unlean;
		float x = u - (bu - back), y = v - (bv - back);
		int wide = x > y;
		for (int k = 0; k < NODES; k++) {
			int right = k == 0 ? 0 : k == 1 ? wide : 1, up = k == 0 ? 0 : k == 1 ? 1 - wide : 1;
			float dx = x - (float)right + (float)k * unlean, dy = y - (float)up + (float)k * unlean;
			found->weight[k][i] = positive(1 - 2 * (dx * dx + dy * dy));
			found->at[k][0][i] = (u - dx) * pitch;
			found->at[k][1][i] = (v - dy) * pitch;
			found->hash[k][i] = (uint32_t)((int32_t)bu + right) * 0x27d4eb2fu ^
					    (uint32_t)((int32_t)bv + up) * 0x165667b1u;
		}
	}
}

/* The colour of a pixel, in square roots, where light falls as at (u, v) of the ball. */
static void color_at(const ball *b, float loose, const cells *c, const nodes *d, int i, float u, float v,
		     float color[4])
{
	struct {
		float score, at[2], detail[4];
	} seen[CELLS * NODES];
	float own[2] = {b->middle[0] + b->radius * u, b->middle[1] - b->radius * v}, patch = 0, node = 0, best = -2;
	int n = 0;
	for (int k = 0; k < CELLS; k++)
		patch = max(patch, c->weight[k][i]);
	for (int j = 0; j < NODES; j++)
		node = max(node, d->weight[j][i]);
	if (!(patch * node > 0)) {
		float detail[4];
		coarse_at(b, own[0], own[1], color);
		between(b->paint, b->width, b->height, own[0], own[1], detail);
		for (int w = 0; w < 4; w++)
			color[w] += detail[w];
		return;
	}
	float per = 1 / (patch * node), least = (1 - 2 * relief - seam) * patch * node;
	for (int k = 0; k < CELLS; k++)
		for (int j = 0; j < NODES; j++) {
			float weight = c->weight[k][i] * d->weight[j][i];
			if (weight < least)
				continue;
			uint32_t hash = scramble(c->hash[k][i] ^ d->hash[j][i]);
			float x = 0.95f * d->at[j][0][i] + 0.25f * (low_share(hash) - 0.5f),
			      y = 0.95f * d->at[j][1][i] + 0.25f * (high_share(hash) - 0.5f);
			float *at = seen[n].at;
			at[0] = b->middle[0] + b->radius * x + c->way[k][0][i] * b->texels;
			at[1] = b->middle[1] - b->radius * y + c->way[k][1][i] * b->texels;
			between(b->paint, b->width, b->height, at[0], at[1], seen[n].detail);
			seen[n].score = weight * per + relief * seen[n].detail[3];
			best = max(best, seen[n].score);
			n++;
		}
	float sum = 0, detail[4] = {0}, at[2] = {0};
	for (int k = 0; k < n; k++) {
		float share = max(seen[k].score - best + seam, 0);
		sum += share;
		for (int w = 0; w < 4; w++)
			detail[w] += share * seen[k].detail[w];
		for (int w = 0; w < 2; w++)
			at[w] += share * seen[k].at[w];
	}
	sum = 1 / sum;
	coarse_at(b, mix(own[0], at[0] * sum, loose), mix(own[1], at[1] * sum, loose), color);
	for (int w = 0; w < 4; w++)
		color[w] += detail[w] * sum;
}

/* ---- stage ----------------------------------------------------------------------------------------------- */

/* Square roots of colours over the surface. */
static void painted_row(const encre_params *p, float other_light, int n, const float *restrict depth,
			const float *restrict combined, const float *restrict own, const float *restrict diffuse,
			float (*restrict color)[4], float *restrict surface)
{
	for (int i = 0; i < n; i++) {
		float alpha = surface[4 * i + 3];
		bool there = depth_of(depth[i]) < INFINITY && alpha != 0;
		for (int c = 0; c < 3; c++) {
			float a = own[3 * i + c], lit = bounded(a * diffuse[3 * i + c]), root = positive(color[i][c]);
			float other = other_light * bounded(combined[4 * i + c] - lit);
			float painted = root * root * mix(1, a, p->example_own_color) * alpha + other;
			painted = blend(surface[4 * i + c], bounded(positive(painted)), p->example_strength);
			surface[4 * i + c] = there ? painted : surface[4 * i + c];
		}
	}
}

/* How large patches are, about, of the ball: small ones follow a form closely, large ones keep longer strokes. */
static const float patch = 0.1375f;

static void example_run(const frame *f, const encre_params *p, int y, int x, int n)
{
	const ball *b = (const ball *)f->example + (p - f->params);
	const float *anchor = anchor_at(f, x, y), *depth = layer_row(f, ENCRE_LAYER_DEPTH, y) + x;
	float light[CHUNK], place[2][CHUNK], color[CHUNK][4], size = patch * p->example_size * f->scale;
	spots at;
	cells c;
	nodes d;
	for (int i = 0; i < n; i++)
		light[i] = exposed_at(f, p, x + i, y);
	place_row(f->camera.view, p->example_light, n, layer_row(f, ENCRE_LAYER_NORMAL, y) + (ptrdiff_t)3 * x, light,
		  place);
	nodes_row(place, n, &d);
	if (anchor)
		spots_row(anchor, n, size, &at);
	else
		picture_row(f->place.x + x, f->place.y + y, n, max(size, 1e-3f), &at);
	for (int finer = 0; finer < 2; finer++)
		cells_row(&at, n, finer, &c);
	for (int i = 0; i < n; i++)
		color_at(b, p->example_loose, &c, &d, i, place[0][i], place[1][i], color[i]);
	painted_row(p, f->params->other_light, n, depth, layer_row(f, ENCRE_LAYER_COMBINED, y) + (ptrdiff_t)4 * x,
		    layer_row(f, ENCRE_LAYER_COLOR, y) + (ptrdiff_t)3 * x,
		    layer_row(f, ENCRE_LAYER_DIFFUSE, y) + (ptrdiff_t)3 * x, color,
		    output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x);
}

static void example_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const frame *f = data;
	for (int y = y0; f->any.use_example && y < y1; y++)
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width - x > CHUNK ? x + CHUNK : f->width, &end);
			if (p->use_example && p->example_image.data)
				example_run(f, p, y, x, end - x);
		}
}

static void plan(frame *f, arena *a)
{
	f->example = NULL;
	if (!f->any.use_example)
		return;
	ball *balls = arena_take(a, (size_t)f->n_styles, sizeof *balls);
	for (int i = 0; i < f->n_styles; i++) {
		ball b = {0};
		if (f->params[i].use_example && f->params[i].example_image.data) {
			b = ISA(ball_of)(f, f->params + i);
			size_t grid = (size_t)b.columns * (size_t)b.rows;
			b.paint = arena_take(a, (size_t)b.width * (size_t)b.height, 4 * sizeof *b.paint);
			b.coarse[0] = arena_take(a, grid, 4 * sizeof *b.coarse[0]);
			b.coarse[1] = arena_take(a, grid, 4 * sizeof *b.coarse[1]);
		}
		if (balls)
			balls[i] = b;
	}
	f->example = balls;
}

static int32_t prepare(frame *f)
{
	ball *balls = f->example;
	int32_t code = ENCRE_OK;
	for (int i = 0; balls && !code && i < f->n_styles; i++)
		if (balls[i].paint)
			code = ISA(ball_paint)(f, balls + i);
	return code;
}

const stage STAGE_SYMBOL(example) = {.id = "example", .plan = plan, .prepare = prepare, .rows = example_rows};
