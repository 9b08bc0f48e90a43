/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rim light: a band along silhouettes, as if a lamp stood behind the things. Wherever a surface ends before one that
 * lies farther back there is a site, exactly where the contour passes if chains tell it. A site reaches as
 * far over its own surface as the band is wide there; each pixel has what the site gives that covers it most. */
#include "base/between.h"
#include "base/pixel.h"

enum { NEAR = 2 /* pixels about the end of a surface whose normals count */, CHUNK = 256 };

typedef struct rim_site {
	float x, y;      /* of its contour, in pixels */
	float width;     /* of the band */
	float low, high; /* depths between which its surface lies */
	int32_t own[2];  /* column and row of the pixel whose surface ends */
} rim_site;

typedef struct rim {
	frame *f;
	size_t *first;   /* [height + 1]: where the sites of a row begin */
	float *cover;    /* per thread a row: how much of a pixel is covered; and one more, see reach_over() */
	int32_t *chosen; /* likewise: the site that does, by its number in the list */
	rim_site *sites;
	float *contours; /* as between_contours() fills it; NULL: there are no chains */
	int reach;       /* pixels */
} rim;

/* How far behind a silhouette the next surface lies at least, as a share of its distance. */
static const float step_behind = 0.05f;

/* ---- sites ------------------------------------------------------------------------------------------------- */

static const float *normal_at(const frame *f, int x, int y)
{
	return layer_row(f, ENCRE_LAYER_NORMAL, y) + (ptrdiff_t)3 * x;
}

static float object_at(const frame *f, int x, int y)
{
	const float *row = layer_row(f, ENCRE_LAYER_OBJECT, y);
	return row ? row[x] : 0;
}

static float span_of(const frame *f, float depth)
{
	return f->camera.orthographic ? f->camera.height : depth;
}

/* Of the surface about a pixel: one alone may be of a face too thin to tell, or hold what is behind. */
static void mean_normal(const frame *f, int x, int y, float z, float slack, float sum[3])
{
	float own = object_at(f, x, y);
	sum[0] = sum[1] = sum[2] = 0;
	for (int v = y - NEAR; v <= y + NEAR; v++)
		for (int u = x - NEAR; u <= x + NEAR; u++) {
			if (u < 0 || v < 0 || u >= f->width || v >= f->height ||
			    !(fabsf(depth_at(f, u, v) - z) <= slack) || object_at(f, u, v) != own)
				continue;
			const float *n = normal_at(f, u, v);
			for (int c = 0; c < 3; c++)
				sum[c] = bounded(sum[c] + n[c]);
		}
}

/* How much of its width the band has where the surface, seen from the camera, ends towards `out` (of length 1). Light
 * that comes along the way of sight reaches all sides. */
static float side(const frame *f, const encre_params *p, const float out[2])
{
	if (p->rim_spread >= 180)
		return 1;
	const float turn = 0.0174532925f;
	float from[2] = {pixel_cos(p->rim_angle * turn), -pixel_sin(p->rim_angle * turn)}, all = 0;
	if (p->rim_space == rim_space_WORLD) {
		float level = pixel_cos(p->rim_elevation * turn);
		float light[3] = {from[0] * level, -from[1] * level, pixel_sin(p->rim_elevation * turn)};
		from[0] = turned_to(f, 0, light);
		from[1] = -turned_to(f, 1, light);
		float length = sqrtf(from[0] * from[0] + from[1] * from[1]), scale = 1 / max(length, 1e-6f);
		from[0] *= scale;
		from[1] *= scale;
		all = clamp01((0.3f - length) * 5);
	}
	float toward = from[0] * out[0] + from[1] * out[1];
	float s = clamp01(3 * (toward - pixel_cos(p->rim_spread * turn)));
	return max(s * (2 - s), all);
}

/* The site between a pixel and the one that lies (dx, dy) beside it, whose surface lies behind; false if none is. */
static bool make_site(const frame *f, int x, int y, int dx, int dy, float place, rim_site *s)
{
	const encre_params *p = params_at(f, x, y);
	float z = depth_at(f, x, y), behind = depth_at(f, x + dx, y + dy);
	if (!p->use_rim || !(behind - z > step_behind * span_of(f, z)))
		return false;
	float slack = min((2 * step_behind + 0.05f) * span_of(f, z), FLT_MAX);
	float normal[3];
	mean_normal(f, x, y, z, slack, normal);
	float out[2] = {turned_to(f, 0, normal), -turned_to(f, 1, normal)};
	float length = sqrtf(out[0] * out[0] + out[1] * out[1]);
	if (!(length > 0.01f && length < 1e4f))
		return false;
	out[0] /= length;
	out[1] /= length;
	float away = clamp01(4 * (out[0] * (float)dx + out[1] * (float)dy));
	*s = (rim_site){.x = (float)x + place * (float)dx,
			.y = (float)y + place * (float)dy,
			.width = p->rim_width * f->scale * away * side(f, p, out),
			.low = z - slack,
			.high = z + min(slack, 0.5f * (behind - z)),
			.own = {x, y}};
	return s->width > 0;
}

/* The site on the way from a pixel to the right, or down. One that is none reaches nowhere. */
static rim_site site_between(const rim *r, int x, int y, int down)
{
	const frame *f = r->f;
	float told = r->contours ? r->contours[2 * ((ptrdiff_t)y * f->width + x) + down] : 0;
	float place = told > 0 ? told : 0.5f;
	int dx = !down, dy = down;
	rim_site s;
	bool found = depth_at(f, x, y) < depth_at(f, x + dx, y + dy)
			     ? make_site(f, x, y, dx, dy, place, &s)
			     : make_site(f, x + dx, y + dy, -dx, -dy, 1 - place, &s);
	return found ? s : (rim_site){.y = INFINITY};
}

/* Sets `bit` where one of two surfaces may end before the other: most need no second look. */
static void mark_ends(const rim *r, const float *restrict z, const float *restrict beside, int n, uint8_t bit,
		      uint8_t *restrict ends)
{
	const frame *f = r->f;
	for (int i = 0; i < n; i++) {
		float one = depth_of(z[i]), other = depth_of(beside[i]), front = min(one, other);
		ends[i] |= max(one, other) - front > step_behind * span_of(f, front) ? bit : 0;
	}
}

/* How many sites there may be on the ways from the pixels of a row to the right and down; these, unless `out` is NULL.
 */
static size_t sites_of_row(const rim *r, int y, rim_site *out)
{
	const frame *f = r->f;
	size_t n = 0;
	const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y);
	for (int x0 = 0; x0 < f->width; x0 += CHUNK) {
		uint8_t ends[CHUNK] = {0};
		int some = f->width - x0 < CHUNK ? f->width - x0 : CHUNK;
		mark_ends(r, depth + x0, depth + x0 + 1, some - (x0 + some == f->width), 1, ends);
		if (y + 1 < f->height)
			mark_ends(r, depth + x0, layer_row(f, ENCRE_LAYER_DEPTH, y + 1) + x0, some, 2, ends);
		for (int i = 0; !out && i < CHUNK; i++)
			n += (ends[i] & 1) + (ends[i] >> 1);
		for (int i = 0; out && i < some; i++) {
			uint64_t eight;
			if (i % 8 == 0 && (memcpy(&eight, ends + i, 8), eight == 0)) {
				i += 7;
				continue;
			}
			for (int down = 0; down < 2; down++)
				if (ends[i] >> down & 1)
					out[n++] = site_between(r, x0 + i, y, down);
		}
	}
	return n;
}

static void count_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	rim *r = data;
	for (int y = y0; y < y1 && !bands_stopped(r->f->bands); y++)
		r->first[y] = sites_of_row(r, y, NULL);
}

static void find_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	rim *r = data;
	for (int y = y0; y < y1 && !bands_stopped(r->f->bands); y++)
		sites_of_row(r, y, r->sites + r->first[y]);
}

/* ---- pixels ------------------------------------------------------------------------------------------------ */

/* How far what is seen at a pixel faces the camera. */
static float facing(const frame *f, int x, int y)
{
	return turned_to(f, 2, normal_at(f, clamp_index(x, f->width), clamp_index(y, f->height)));
}

/* Share of the pixel at which the surface turns away far enough. */
static float turns(const frame *f, const encre_params *p, int x, int y)
{
	if (p->rim_facing >= 1)
		return 1;
	float right = fabsf(facing(f, x + 1, y) - facing(f, x - 1, y)),
	      down = fabsf(facing(f, x, y + 1) - facing(f, x, y - 1));
	return clamp01((p->rim_facing - facing(f, x, y)) / max(0.5f * max(right, down), 1e-3f) + 0.5f);
}

/* What a site covers of the pixels of row y; ends: how near to its end their surface is, where that is in the pixel. */
static void reach_over(const rim *r, int32_t number, int y, float *cover, float *ends, int32_t *chosen)
{
	const frame *f = r->f;
	const rim_site *s = r->sites + number;
	const encre_params *p = params_at(f, s->own[0], s->own[1]);
	float dy = (float)y - s->y, far = s->width + 0.5f, square = far * far - dy * dy;
	if (!(square > 0))
		return;
	float half = sqrtf(square), fade = max(p->rim_softness * s->width, 1);
	int x0 = (int)max(s->x - half, 0), x1 = (int)min(s->x + half + 1, (float)f->width);
	float own = object_at(f, s->own[0], s->own[1]);
	for (int x = x0; x < x1; x++) {
		float dx = (float)x - s->x, far_square = dx * dx + dy * dy;
		if (cover[x] >= 1 && far_square >= 0.25f)
			continue; /* most of a wide band */
		float distance = sqrtf(far_square);
		float part = clamp01((s->width - distance + 0.5f) / fade);
		if (!(part > cover[x]) && !(distance < 0.5f))
			continue;
		float z = depth_at(f, x, y);
		bool inside = z >= s->low && z <= s->high && object_at(f, x, y) == own;
		if (inside ? !params_at(f, x, y)->use_rim : z <= s->high)
			continue;
		if (inside)
			ends[x] = min(ends[x], distance);
		else
			part = min(part, 0.5f - distance);
		if (!(part > cover[x]))
			continue;
		cover[x] = part;
		chosen[x] = number;
	}
}

static void draw_pixel(const frame *f, const rim_site *s, float part, int x, int y, float *rgba)
{
	float z = depth_at(f, x, y);
	bool inside = z >= s->low && z <= s->high && object_at(f, x, y) == object_at(f, s->own[0], s->own[1]);
	int ox = inside ? x : s->own[0], oy = inside ? y : s->own[1];
	const encre_params *p = params_at(f, ox, oy);
	const float *color = layer_row(f, ENCRE_LAYER_COLOR, oy) + (ptrdiff_t)3 * ox;
	float t = part * turns(f, p, ox, oy) * p->rim_strength;
	for (int c = 0; c < 3; c++) {
		float light = bounded(p->rim_color[c] * mix(1, clamp01(color[c]), p->rim_tint));
		rgba[c] = blend(rgba[c], bounded(light * rgba[3]), t);
	}
}

static void draw_rows(void *data, int y0, int y1, int thread)
{
	const rim *r = data;
	const frame *f = r->f;
	float *cover = r->cover + (size_t)thread * 2 * (size_t)f->width, *ends = cover + f->width;
	int32_t *chosen = r->chosen + (size_t)thread * (size_t)f->width;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		int above = y - r->reach - 1, below = y + r->reach + 1; /* a site lies up to a pixel below its row */
		size_t from = r->first[above > 0 ? above : 0], end = r->first[below < f->height ? below : f->height];
		for (int x = 0; x < f->width; x++)
			cover[x] = 0, ends[x] = 1;
		for (size_t i = from; i < end; i++)
			reach_over(r, (int32_t)i, y, cover, ends, chosen);
		float *rgba = output_row(f, ENCRE_OUTPUT_COMBINED, y);
		for (int x = 0; from < end && x < f->width; x++)
			if (cover[x] > 0)
				draw_pixel(f, r->sites + chosen[x], min(cover[x], 0.5f + ends[x]), x, y,
					   rgba + (ptrdiff_t)4 * x);
	}
}

/* ---- stage ------------------------------------------------------------------------------------------------- */

static bool wanted(const frame *f)
{
	return f->any.use_rim;
}

static float *contours_plan(const frame *f, arena *a)
{
	return f->n_chains ? arena_take(a, 2 * (size_t)f->width * (size_t)f->height, sizeof(float)) : NULL;
}

static void plan(frame *f, arena *a)
{
	f->rim = NULL;
	if (!wanted(f))
		return;
	size_t n = (size_t)bands_threads(f->bands) * (size_t)f->width;
	rim *r = arena_take(a, 1, sizeof *r), made = {.f = f,
						      .first = arena_take(a, (size_t)f->height + 1, sizeof *made.first),
						      .cover = arena_take(a, 2 * n, sizeof *made.cover),
						      .chosen = arena_take(a, n, sizeof *made.chosen),
						      .contours = contours_plan(f, a)};
	for (int i = 0; i < f->n_styles; i++) {
		const encre_params *p = f->params + i;
		if (!p->use_rim)
			continue;
		made.reach = (int)max((float)made.reach, min(p->rim_width * f->scale, 1e6f) + 2);
	}
	if (r)
		*r = made;
	f->rim = r;
}

static int32_t run(frame *f)
{
	rim *r = f->rim;
	if (!r)
		return ENCRE_OK;
	if (r->contours)
		between_contours(f, r->contours);
	int32_t code = bands_run(f->bands, f->height, 0, count_rows, r);
	size_t n = 0;
	for (int y = 0; !code && y <= f->height; y++) {
		size_t own = y < f->height ? r->first[y] : 0;
		r->first[y] = n;
		n += own;
	}
	if (code || !n)
		return code;
	if (n > INT32_MAX || !(r->sites = late_take(&f->late, n, sizeof *r->sites)))
		return ENCRE_ERROR_MEMORY;
	code = bands_run(f->bands, f->height, 0, find_rows, r);
	return code ? code : bands_run(f->bands, f->height, 0, draw_rows, r);
}

const stage STAGE_SYMBOL(rim) = {.id = "rim", .plan = plan, .run = run, .draws = wanted};
