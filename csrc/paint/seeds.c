/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where strokes lie, and what they are: points of the endless set, of which one that was born early is a large stroke
 * and one that was born late a small one. What comes nearer has its strokes grow with it, until they are as long as may
 * be, and new ones are born between them. */
#include "paint/paint.h"
#include "surface/solid.h"

/* A stroke is so many times as long as the way from one to the next, were there those alone that are no smaller. */
static const float spread = 1.8f;
/* Strokes of between so many times the room for them are drawn: in full from the second to the third. */
static const float fits[4] = {1, 2.4f, 3, 9};
static const float bold = 0.25f;          /* of all strokes */
static const float largest_alone = 0.75f; /* of the largest, where there is all room */

/* ---- surfaces ---------------------------------------------------------------------------------------------- */

/* The sky is a sphere about the eye. */
static void sky_rest(const frame *f, int x, int y, int i, tone_rest *rest)
{
	const float *v = f->camera.view;
	float per = f->camera.height / (float)f->place.height;
	float own[3] = {((float)(f->place.x + x) + 0.5f - 0.5f * (float)f->place.width) * per,
			(0.5f * (float)f->place.height - (float)(f->place.y + y) - 0.5f) * per, -1};
	float over = 1 / sqrtf(own[0] * own[0] + own[1] * own[1] + 1), right = 0, down = 0, way[3];
	for (int c = 0; c < 3; c++) {
		way[c] = (v[c] * own[0] + v[3 + c] * own[1] + v[6 + c] * own[2]) * over;
		right += way[c] * v[c];
		down -= way[c] * v[3 + c];
	}
	for (int c = 0; c < 3; c++) {
		rest->at[ANCHOR_POSITION + c][i] = rest->at[ANCHOR_NORMAL + c][i] = way[c];
		rest->at[ANCHOR_RIGHT + c][i] = (v[c] - right * way[c]) * per * over;
		rest->at[ANCHOR_DOWN + c][i] = (-v[3 + c] - down * way[c]) * per * over;
	}
	rest->at[ANCHOR_PIXEL][i] = per * over;
}

/* What no place is known of lies in the picture, as a wall before the eye. */
static void flat_rest(const frame *f, int x, int y, int i, tone_rest *rest)
{
	rest->at[ANCHOR_POSITION][i] = (float)(f->place.x + x) + 0.5f;
	rest->at[ANCHOR_POSITION + 2][i] = -(float)(f->place.y + y) - 0.5f;
	rest->at[ANCHOR_NORMAL + 1][i] = -1;
	rest->at[ANCHOR_PIXEL][i] = rest->at[ANCHOR_RIGHT][i] = 1;
	rest->at[ANCHOR_DOWN + 2][i] = -1;
}

void ISA(paint_rest)(const frame *f, int y, int x, int n, tone_rest *rest)
{
	const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y) + x;
	bool known = ISA(tone_rest_fill)(f, NULL, y, x, n, rest) != NULL;
	for (int i = 0; i < n; i++) {
		bool sky = !(depth_of(depth[i]) < INFINITY) && !f->camera.orthographic && f->camera.height > 0;
		if (known && !sky && rest->at[ANCHOR_PIXEL][i] > 0)
			continue;
		for (int c = 0; c < ANCHOR_COUNT; c++)
			rest->at[c][i] = 0;
		(sky ? sky_rest : flat_rest)(f, x + i, y, i, rest);
	}
}

/* ---- seeds ------------------------------------------------------------------------------------------------- */

static inline float square(float x)
{
	return x * x;
}

/* The length of the smallest strokes where there is so much room. */
static inline float least_of(const gouache *g, float room)
{
	return min(max(fits[0] * room, g->least), largest_alone * g->size);
}

/* That of a stroke born when so many were on a pixel. */
static inline float length_of(const gouache *g, float born, float room)
{
	float own = spread / sqrtf(born), length = min(own, g->size), room_for_it = max(room, g->least / fits[1]);
	return length * paint_smooth(1, fits[1] / fits[0], own / least_of(g, room)) *
	       (1 - paint_smooth(fits[2], fits[3], length / room_for_it));
}

bool ISA(paint_find)(const gouache *g, int y)
{
	const frame *f = g->f;
	paint_seed *to = g->seeds + (ptrdiff_t)g->a_row * y;
	point_reader r = {.set = *f->kept_spots, .wanted = &g->wanted};
	int count = 0;
	for (int from = 0; from < f->width; from += TONE_TOGETHER) {
		int n = f->width - from < TONE_TOGETHER ? f->width - from : TONE_TOGETHER;
		float room[TONE_TOGETHER];
		tone_rest rest;
		tone_field chart[2];
		ISA(paint_room)(g, y, from, n, room);
		ISA(paint_rest)(f, y, from, n, &rest);
		/* or on a face that lies between two axes some pixels would have one, some the other */
		for (int i = 0; i < n; i++) {
			rest.at[ANCHOR_NORMAL + 1][i] *= 0.97f;
			rest.at[ANCHOR_NORMAL + 2][i] *= 1.03f;
		}
		ISA(tone_surface_chart)(&rest, n, 1, 0, chart);
		for (int i = 0; i < n; i++) {
			float area = point_area(chart, i), own = room[i];
			point_grid grid;
			point found[POINTS_MOST];
			if (!(area > 0) || !params_at(f, from + i, y)->use_gouache)
				continue;
			float wanted = square(spread / least_of(g, own));
			int points = point_grid_fill(chart, i, wanted / area, &grid) ? points_in(&grid, &r, found) : 0;
			for (int k = 0; k < points && count < g->a_row; k++) {
				float size = length_of(g, found[k].born * area, own);
				if (size > 0.1f * g->least)
					to[count++] = (paint_seed){{found[k].way[0], found[k].way[1]},
								   found[k].born,
								   size,
								   from + i,
								   found[k].name};
			}
		}
	}
	g->count[y] = count;
	return !r.lacks;
}

/* ---- strokes ----------------------------------------------------------------------------------------------- */

static inline float share_of(uint32_t name, uint32_t k)
{
	return (float)(mix_bits(name * 0x9e3779b9u + k) >> 8) * 0x1p-24f;
}

static void oklab(const float rgb[3], float lab[3])
{
	float l = pixel_cbrt(0.4122214708f * rgb[0] + 0.5363325363f * rgb[1] + 0.0514459929f * rgb[2]),
	      m = pixel_cbrt(0.2119034982f * rgb[0] + 0.6806995451f * rgb[1] + 0.1073969566f * rgb[2]),
	      s = pixel_cbrt(0.0883024619f * rgb[0] + 0.2817188376f * rgb[1] + 0.6299787005f * rgb[2]);
	lab[0] = 0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s;
	lab[1] = 1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s;
	lab[2] = 0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s;
}

static void from_oklab(const float lab[3], float rgb[3])
{
	float l = lab[0] + 0.3963377774f * lab[1] + 0.2158037573f * lab[2],
	      m = lab[0] - 0.1055613458f * lab[1] - 0.0638541728f * lab[2],
	      s = lab[0] - 0.0894841775f * lab[1] - 1.2914855480f * lab[2];
	l = l * l * l;
	m = m * m * m;
	s = s * s * s;
	rgb[0] = 4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s;
	rgb[1] = -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s;
	rgb[2] = -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s;
}

/* The picture's color there, a little lighter or darker, warmer or cooler. */
static void color_of(const frame *f, const encre_params *p, int x, int y, uint32_t name, float color[3])
{
	const float *rgba = output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x;
	float lab[3], rgb[3], clear = rgba[3] > 0 ? 1 / max(rgba[3], 1e-6f) : 0;
	for (int c = 0; c < 3; c++)
		rgb[c] = min(positive(rgba[c] * clear), 16);
	oklab(rgb, lab);
	float v = p->gouache_variety;
	lab[0] += 0.036f * v * (share_of(name, 1) - 0.5f) * (0.4f + lab[0]);
	lab[1] += 0.010f * v * (share_of(name, 2) - 0.5f);
	lab[2] += 0.017f * v * (share_of(name, 3) - 0.5f);
	lab[0] = positive(lab[0]);
	from_oklab(lab, color);
	for (int c = 0; c < 3; c++)
		color[c] = positive(color[c]);
}

/* How 1 / depth grows to the next pixel, on the side where it does less: the other may lie beyond an edge. */
static float slope_of(const gouache *g, int x, int y, int right, int down)
{
	const frame *f = g->f;
	float own = paint_under(g, UNDER_NEAR, y)[x];
	float next = paint_under(g, UNDER_NEAR, clamp_index(y + down, f->height))[clamp_index(x + right, f->width)];
	float last = paint_under(g, UNDER_NEAR, clamp_index(y - down, f->height))[clamp_index(x - right, f->width)];
	return fabsf(next - own) < fabsf(own - last) ? next - own : own - last;
}

static bool parted(const gouache *g, int x, int y, int u, int v)
{
	const frame *f = g->f;
	const float *own = layer_row(f, ENCRE_LAYER_OBJECT, y), *other = layer_row(f, ENCRE_LAYER_OBJECT, v);
	float near = paint_under(g, UNDER_NEAR, y)[x], next = paint_under(g, UNDER_NEAR, v)[u];
	return (own && own[x] != other[u]) || fabsf(near - next) > step_of_depth * max(near, next);
}

/* Whose middle lies beside the end of its surface is small: a little later no pixel may have it. */
static float inside(const gouache *g, int x, int y)
{
	static const float left[] = {0.3f, 0.6f, 0.85f};
	for (int k = 0; k < 3; k++)
		for (int j = 0; j < 8; j++) {
			static const int ways[8][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
						       {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
			if (parted(g, x, y, clamp_index(x + (k + 1) * ways[j][0], g->f->width),
				   clamp_index(y + (k + 1) * ways[j][1], g->f->height)))
				return left[k];
		}
	return 1;
}

void ISA(paint_strokes)(const gouache *g, int y)
{
	const frame *f = g->f;
	const paint_seed *seeds = g->seeds + (ptrdiff_t)g->a_row * y;
	const float *objects = layer_row(f, ENCRE_LAYER_OBJECT, y);
	solid_memory memory = {0};
	for (int i = 0; i < g->count[y]; i++) {
		const paint_seed *seed = seeds + i;
		int x = seed->column;
		float size = seed->size * inside(g, x, y);
		const encre_params *p = params_at(f, x, y);
		tone_rest rest;
		tone_ground ground;
		ISA(paint_rest)(f, y, x, 1, &rest);
		ISA(tone_ground_fill)(&rest, 1, &ground);
		solid_place at = {{rest.at[0][0], rest.at[1][0], rest.at[2][0]},
				  rest.at[ANCHOR_PIXEL][0],
				  objects ? (uint32_t)(int32_t)max(min(objects[x], 1e9f), -1e9f) : 0};
		float turns[2], bent = 0;
		solid_noise(&at, 4 * g->size, 71, &memory, turns);
		for (int c = 0; c < 3; c++)
			bent += square(rest.at[ANCHOR_FORM + c][0]);
		float angle = (0.35f + 0.5f * turns[0]) * (1 - 0.6f * clamp01(bent)) +
			      0.35f * (share_of(seed->name, 4) - 0.5f);
		float c = pixel_cos(angle), s = pixel_sin(angle);
		float ax = c * ground.along[0][0] + s * ground.across[0][0],
		      ay = c * ground.along[1][0] + s * ground.across[1][0];
		float length = sqrtf(ax * ax + ay * ay), over = length > 0 ? 1 / length : 0;
		paint_stroke stroke = {
			.x = (float)(f->place.x + x) + 0.5f + seed->way[0],
			.y = (float)(f->place.y + y) + 0.5f + seed->way[1],
			.along = {over > 0 ? ax * over : 1, ay * over},
			.half = stroke_half * size * (0.85f + 0.3f * share_of(seed->name, 5)),
			.wide = stroke_wide * size * (0.85f + 0.3f * share_of(seed->name, 6)),
			.near = paint_under(g, UNDER_NEAR, y)[x],
			.slope = {slope_of(g, x, y, 1, 0), slope_of(g, x, y, 0, 1)},
			.object = objects ? objects[x] : 0,
			.body = p->gouache_body,
			.born = seed->born,
			.name = seed->name,
		};
		/* most strokes keep to their step of light, some go beyond it */
		stroke.light = paint_under(g, UNDER_LIGHT, y)[x];
		stroke.strays = (share_of(seed->name, 8) < bold ? 1.8f : 1) * 0.16f * (stroke.light + 0.1f);
		stroke.bend = 0.25f * (share_of(seed->name, 7) - 0.5f) / stroke.half;
		for (int k = 0; k < 3; k++)
			stroke.paint[k] = paint_under(g, UNDER_PAINT + k, y)[x];
		color_of(f, p, x, y, seed->name, stroke.color);
		g->strokes[g->first[y] + i] = stroke;
	}
}
