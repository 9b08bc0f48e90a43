/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes and spots: each has a place on the picture or on the thing, on a lattice as dots have it (dots.c), from which
 * it is shifted, and is drawn from there over other pixels (strokes.c). A stroke follows the surface: the way in which
 * it bends most or, where it bends in none, planes that cut it. Which are drawn, and how wide, tells the darkness along
 * them: in the light few, then all, then a second and a third layer across. Here every pixel finds the marks whose
 * places it holds, in its own row. */
#include "tones/strokes.h"

#include <string.h>

static const float jitter = 0.6f; /* pitches */

/* ---- tables ------------------------------------------------------------------------------------------------ */

/* The area of marks that cover c. Thrown at random it were -ln(1 - c); from a lattice, though shifted, they cover each
 * other less: by how much was measured. */
static float area_for(float c, bool spots)
{
	float left = max(1 - c, 1.0f / 1024), y = 0;
	for (int k = 0; k < 12; k++) {
		float e = pixel_exp(-y);
		y += 2 * (e - left) / (e + left);
	}
	return y / (1 + y * (spots ? 0.395f - 0.027f * y : 0.21f));
}

/* Share of a layer that is drawn where it alone is: each is full at a half of what those before it have left. */
static float cover_of(float dark, int layer)
{
	float left = 1 - dark;
	for (int k = 0; k < layer; k++)
		left = min(2 * left, 1);
	if (dark <= 0.875f)
		return clamp01(1 - max(left, 0.5f));
	return 1 - pixel_cbrt(1 - dark);
}

void ISA(tone_marks_tables)(tone_marks *m)
{
	for (int layer = 0; layer <= TONE_SPOTS; layer++)
		for (int i = 0; i < 256; i++) {
			float dark = (float)i / 255,
			      x = area_for(layer == TONE_SPOTS ? dark : cover_of(dark, layer), layer == TONE_SPOTS) /
				  full_cover;
			float low = min(x, 1), shown = 1.25f * sqrtf(low * sqrtf(low)), over = max(shown - 1, 0);
			float mean = shown < 0.25f ? 2 * shown * shown : shown - 0.125f - 2 * over * over;
			m->shown[layer][i] = shown;
			m->size[layer][i] = mean > 0 ? x / mean : 0;
		}
	for (int i = 0; i < 256; i++) {
		m->way[i][0] = pixel_cos((float)i * (3.14159265f / 256));
		m->way[i][1] = pixel_sin((float)i * (3.14159265f / 256));
	}
}

/* ---- darkness ---------------------------------------------------------------------------------------------- */

bool ISA(tone_marks_wanted)(const encre_params *p)
{
#define IN(n) p->tone_##n == tone_##n##_HATCH || p->tone_##n == tone_##n##_STIPPLE
	return p->use_tones && (IN(1) || IN(2) || IN(3) || IN(4));
#undef IN
}

/* The darkness of n pixels that marks fill, 1..255, 0 of others, and the slot that fills them; of which slots any are.
 */
static unsigned darken(const frame *f, const encre_params *p, const tone_slot *slots, int y, int x, int n,
		       tone_pixel *px)
{
	tone_wanted w;
	unsigned any = 0;
	ISA(tone_want)(f, p, slots, y, x, n, &w);
	for (int i = 0; i < n; i++) {
		float share = 0, sum = 0, best = 0;
		px[i].bits = 0;
		for (int k = 0; k < TONE_SLOTS; k++) {
			if (!w.any[k] || !tone_marked(slots + k))
				continue;
			float here = w.share[k][i];
			px[i].bits = here > best ? (uint8_t)k : px[i].bits;
			best = max(best, here);
			share += here;
			sum += here * w.dark[k][i];
		}
		px[i].dark = share > 0 ? (uint8_t)floorf(255 * clamp01(sum / share) + 0.5f) : 0;
		any |= px[i].dark ? 1u << px[i].bits : 0;
	}
	return any;
}

/* ---- places ------------------------------------------------------------------------------------------------ */

static uint32_t stir(uint32_t h, uint32_t k)
{
	h = (h ^ k) * 2654435761u;
	h ^= h >> 15;
	h *= 2246822519u;
	return h ^ h >> 13;
}

static float share_of(uint32_t h)
{
	return (float)(h >> 8) * 0x1p-24f;
}

/* A number along an axis whatever the octave: odd * 2^exponent. */
typedef struct dyadic {
	int32_t odd, exponent;
} dyadic;

static dyadic dyadic_of(float whole, float scale)
{
	int32_t n = (int32_t)whole, exponent = -(float_bits(scale) >> 23);
	if (n == 0)
		return (dyadic){0, 0};
	for (; (n & 1) == 0; exponent++)
		n /= 2;
	return (dyadic){n, exponent};
}

static int main_axis(const float *normal)
{
	float x = fabsf(normal[0]), y = fabsf(normal[1]), z = fabsf(normal[2]);
	return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/* The layers' lattices lie beside each other, and their strokes across each other. */
static const float beside[TONE_LAYERS] = {0, 0.381966f, 0.763932f};
static const float turned[TONE_LAYERS][2] = {{1, 0}, {0.7071068f, 0.7071068f}, {0.5f, -0.8660254f}};

/* The way in pixels from the middle of pixel i to the point of a layer's lattice that is nearest to it. */
static inline void nearest_point(const tone_lattice *l, int layer, int i, float whole[2], float way[2])
{
	way[0] = way[1] = 0;
	for (int k = 0; k < 2; k++) {
		float at = 2 * (l->at[k][i] + beside[layer] * l->scale[k][i]);
		whole[k] = floorf(at + 0.5f);
		float off = 0.5f * (whole[k] - at);
		way[0] += off * l->across[k][i];
		way[1] += off * l->up[k][i];
	}
}

/* Whether a point of a layer's lattice is in pixel i. */
static inline bool holds(const tone_lattice *l, int layer, int i)
{
	float whole[2], way[2];
	nearest_point(l, layer, i, whole, way);
	return way[0] >= -0.5f && way[0] < 0.5f && way[1] >= -0.5f && way[1] < 0.5f && l->flat[i] <= 0 &&
	       max(fabsf(whole[0]), fabsf(whole[1])) < 1e9f;
}

/* The mark whose place is in pixel x. */
static tone_mark mark_at(const frame *f, const tone_slot *s, int layer, int x, int y)
{
	tone_field chart[2];
	tone_lattice l;
	float whole[2], way[2], weight = 1;
	ISA(tone_chart)(f, s, y, x, 1, chart);
	ISA(tone_lattice_fill)(tone_mark_pitch(s), 1, chart, &l);
	nearest_point(&l, layer, 0, whole, way);
	const float *anchor = s->space == tone_1_space_SURFACE ? anchor_at(f, x, y) : NULL;
	uint32_t h =
		stir(0x9e3779b9u, (uint32_t)(TONE_LAYERS * (anchor ? main_axis(anchor + ANCHOR_NORMAL) : 0) + layer));
	dyadic place[2];
	for (int k = 0; k < 2; k++) {
		weight *= (int32_t)whole[k] & 1 ? l.grown[k][0] : 1;
		place[k] = dyadic_of(whole[k], l.scale[k][0]);
		h = stir(h, (uint32_t)place[k].exponent);
	}
	/* A rank of low discrepancy among those of an octave, so that few are spread as evenly as many. */
	uint32_t rank = h + (uint32_t)place[0].odd * 3242174889u + (uint32_t)place[1].odd * 2447445413u;
	h = stir(stir(h, (uint32_t)place[0].odd), (uint32_t)place[1].odd);
	for (int k = 0; k < 2; k++) {
		float length = sqrtf(l.across[k][0] * l.across[k][0] + l.up[k][0] * l.up[k][0]);
		h = stir(h, 1);
		float aside = (share_of(h) - 0.5f) * jitter * tone_mark_pitch(s) / max(length, 1e-6f);
		way[0] += aside * l.across[k][0];
		way[1] += aside * l.up[k][0];
	}
	float size = sqrtf(weight), turn, length = 0;
	h = stir(h, 2);
	turn = (share_of(h) - 0.5f) * 0.1f;
	h = stir(h, 3);
	if (s->kind == tone_1_HATCH)
		length = stroke_length * tone_mark_pitch(s) * size * (0.7f + 0.6f * share_of(h));
	return (tone_mark){
		.x = (float)x + 0.5f + way[0],
		.y = (float)y + 0.5f + way[1],
		.size = size,
		.rank = share_of(rank),
		.reach = 0.5f * length,
		.turn = turn,
		.slot = s,
		.column = x,
		.layer = (uint8_t)layer,
	};
}

/* ---- ways over the surface --------------------------------------------------------------------------------- */

static float dot3(const float *a, const float *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Two directions in the surface, of length 1: along planes that cut the thing, and across. */
static void planes_at(const float *normal, float along[3], float across[3])
{
	static const float axes[2][3] = {{0.148f, 0.0986f, 0.984f}, {0.148f, 0.984f, 0.0986f}};
	const float *axis = axes[fabsf(dot3(axes[0], normal)) > 0.95f];
	for (int c = 0; c < 3; c++)
		along[c] = axis[(c + 1) % 3] * normal[(c + 2) % 3] - axis[(c + 2) % 3] * normal[(c + 1) % 3];
	float scale = 1 / sqrtf(max(dot3(along, along), 1e-12f));
	for (int c = 0; c < 3; c++)
		along[c] *= scale;
	for (int c = 0; c < 3; c++)
		across[c] = normal[(c + 1) % 3] * along[(c + 2) % 3] - normal[(c + 2) % 3] * along[(c + 1) % 3];
}

/* A way on the screen, either way along it, as a number of 256ths of half a turn. */
static uint8_t angle_of(float x, float y)
{
	float turns = pixel_atan2(y, x) * (1 / 3.14159265f); /* -1..1, and halves are all that counts */
	return (uint8_t)((int)(256 * turns + 256.5f) & 255);
}

/* Ways of the layers' strokes on the screen at a pixel: as they lie on the surface that is seen there. */
static void ways_on_surface(const tone_slot *s, const float *anchor, uint8_t way[TONE_LAYERS])
{
	const float *form = anchor + ANCHOR_FORM, *right = anchor + ANCHOR_RIGHT, *down = anchor + ANCHOR_DOWN;
	float along[3], across[3], on[2][2];
	planes_at(anchor + ANCHOR_NORMAL, along, across);
	/* ways have no sign: their angles are doubled where they are mixed */
	float a = dot3(form, along), b = dot3(form, across), left = 1 - sqrtf(min(a * a + b * b, 1));
	float u = a * a - b * b + 0.25f * left * left, v = 2 * a * b, length = sqrtf(u * u + v * v);
	float p = length + u, q = v, both = sqrtf(p * p + q * q);
	p = both > 1e-9f ? p / both : 0;
	q = both > 1e-9f ? q / both : 1;
	float rr = dot3(right, right), rd = dot3(right, down), dd = dot3(down, down);
	float ra = dot3(right, along), rb = dot3(right, across), da = dot3(down, along), db = dot3(down, across);
	on[0][0] = dd * ra - rd * da;
	on[0][1] = rr * da - rd * ra;
	on[1][0] = dd * rb - rd * db;
	on[1][1] = rr * db - rd * rb;
	for (int layer = 0; layer < TONE_LAYERS; layer++) {
		float c = s->across[0] * turned[layer][0] - s->across[1] * turned[layer][1];
		float d = s->across[1] * turned[layer][0] + s->across[0] * turned[layer][1];
		float one = p * c - q * d, two = q * c + p * d;
		float x = one * on[0][0] + two * on[1][0], y = one * on[0][1] + two * on[1][1];
		float scale = max(fabsf(x), fabsf(y));
		way[layer] = scale > 1e-30f ? angle_of(x / scale, y / scale) : 0;
	}
}

static void ways_on_screen(const tone_slot *s, uint8_t way[TONE_LAYERS])
{
	for (int layer = 0; layer < TONE_LAYERS; layer++)
		way[layer] = angle_of(s->across[0] * turned[layer][0] - s->across[1] * turned[layer][1],
				      -s->across[1] * turned[layer][0] - s->across[0] * turned[layer][1]);
}

/* Whether what is seen at two neighbouring pixels is one surface. */
static bool goes_on(const frame *f, int x0, int y0, int x1, int y1)
{
	if (x1 >= f->width || y1 >= f->height)
		return false;
	const float *object0 = layer_row(f, ENCRE_LAYER_OBJECT, y0), *object1 = layer_row(f, ENCRE_LAYER_OBJECT, y1);
	if (object0 && object0[x0] != object1[x1])
		return false;
	const float *a = anchor_at(f, x0, y0), *b = anchor_at(f, x1, y1);
	if (a && a[ANCHOR_PIXEL] > 0 && b[ANCHOR_PIXEL] > 0) {
		float apart[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
		float grown = dot3(a + ANCHOR_RIGHT, a + ANCHOR_RIGHT) + dot3(a + ANCHOR_DOWN, a + ANCHOR_DOWN);
		return dot3(apart, apart) <= 16 * grown;
	}
	float near = depth_at(f, x0, y0), far = depth_at(f, x1, y1);
	return fabsf(far - near) <= 0.05f * near;
}

/* ---- what strokes need of pixels --------------------------------------------------------------------------- */

static void look_at(const frame *f, const tone_marks *m, const tone_slot *slots, unsigned any, int y, int x, int n)
{
	tone_pixel *px = tone_pixels(f, m, y) + x;
	for (int k = 0; k < TONE_SLOTS; k++) {
		const tone_slot *s = slots + k;
		if (!(any >> k & 1))
			continue;
		tone_field chart[2];
		tone_lattice l;
		bool spots = s->kind == tone_1_STIPPLE, stuck = s->space == tone_1_space_SURFACE && anchor_at(f, x, y);
		uint8_t way[TONE_LAYERS];
		ISA(tone_chart)(f, s, y, x, n, chart);
		ISA(tone_lattice_fill)(tone_mark_pitch(s), n, chart, &l);
		ways_on_screen(s, way);
		for (int i = 0; i < n; i++) {
			if (!px[i].dark || (px[i].bits & TONE_SLOT) != k)
				continue;
			for (int layer = 0; layer < (spots ? 1 : TONE_LAYERS); layer++)
				if (m->shown[spots ? TONE_SPOTS : layer][px[i].dark] > 0 && holds(&l, layer, i))
					px[i].bits |= (uint8_t)(TONE_FOUND << layer);
			if (spots)
				continue;
			if (stuck)
				ways_on_surface(s, anchor_at(f, x + i, y), way);
			memcpy(px[i].way, way, sizeof way);
			px[i].bits |= goes_on(f, x + i, y, x + i + 1, y) ? 0 : TONE_ENDS_RIGHT;
			px[i].bits |= goes_on(f, x + i, y, x + i, y + 1) ? 0 : TONE_ENDS_DOWN;
		}
	}
}

int ISA(tone_marks_look)(const frame *f, const tone_marks *m, int y)
{
	tone_pixel *px = tone_pixels(f, m, y);
	int n = 0;
	memset(px, 0, (size_t)f->width * sizeof *px);
	for (int x = 0, end; x < f->width; x = end) {
		int most = f->width - x > TONE_CHUNK ? x + TONE_CHUNK : f->width;
		const encre_params *p = style_run(f, y, x, most, &end);
		const tone_slot *slots = m->styles[p - f->params].slot;
		unsigned any = ISA(tone_marks_wanted)(p) ? darken(f, p, slots, y, x, end - x, px + x) : 0;
		if (any)
			look_at(f, m, slots, any, y, x, end - x);
	}
	for (int x = 0; x < f->width; x++)
		for (int layer = 0; layer < TONE_LAYERS; layer++)
			n += px[x].bits / TONE_FOUND >> layer & 1;
	return n;
}

void ISA(tone_marks_find)(const frame *f, const tone_marks *m, int y, tone_mark *marks)
{
	const tone_pixel *px = tone_pixels(f, m, y);
	for (int x = 0; x < f->width; x++)
		for (int layer = 0; layer < TONE_LAYERS && px[x].bits >= TONE_FOUND; layer++) {
			if (!(px[x].bits / TONE_FOUND >> layer & 1))
				continue;
			const tone_slot *s = m->styles[style_at(f, x, y)].slot + (px[x].bits & TONE_SLOT);
			*marks++ = mark_at(f, s, layer, x, y);
		}
}
