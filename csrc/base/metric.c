/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour differences: Herring's weighted RGB (2016, eq. 3.1), CIE76, CIEDE2000 (Sharma, Wu & Dalal 2005) and CMC l:c
 * (Clarke, McDonald & Rigg 1984). CIE differences are divided by 100, so that black to white is 1 with each. */
#include "base/metric.h"
#include "base/pixel.h"

enum { RUN = 8 /* pixels, a vector */ };

/* ---- spaces ---------------------------------------------------------------------------------------------- */

/* f of CIE L*a*b*: a cube root, with a straight line instead of its steep foot. */
static inline float lab_f(float t)
{
	return t > 216.0f / 24389 ? pixel_cbrt(t) : t * (841.0f / 108) + 4.0f / 29;
}

/* sRGB matrix of IEC 61966-2-1 in four digits. X and Z are divided by the white's, the sum of their row, and written as
 * differences from green: thus r = g = b has no chroma to the last bit, and no hue made of rounding errors. */
static void to_lab(int n, float *restrict r, float *restrict g, float *restrict b)
{
	for (int i = 0; i < n; i++) {
		float dr = r[i] - g[i], db = b[i] - g[i];
		float x = lab_f(g[i] + dr * (0.4124f / 0.9505f) + db * (0.1805f / 0.9505f));
		float y = lab_f(g[i] + dr * 0.2126f + db * 0.0722f);
		float z = lab_f(g[i] + dr * (0.0193f / 1.0890f) + db * (0.9505f / 1.0890f));
		r[i] = 116 * y - 16;
		g[i] = 500 * (x - y);
		b[i] = 200 * (y - z);
	}
}

static bool differ(const float *restrict c, float from)
{
	int32_t bits = 0;
	for (int i = 0; i < RUN; i++)
		bits |= float_bits(c[i]) ^ float_bits(from);
	return bits != 0;
}

/* Called with a constant n, but at the end of a row. */
KERNEL void encode(int n, float *restrict c)
{
	for (int i = 0; i < n; i++)
		c[i] = srgb_encode(c[i]);
}

/* Surfaces often have one colour: what is as the pixels before it keeps their result. */
static void to_srgb(int n, float *restrict c)
{
	float of = 0, is = 0; /* black is black */
	for (; n >= RUN; n -= RUN, c += RUN) {
		float last = c[RUN - 1];
		if (differ(c, of))
			encode(RUN, c);
		else
			for (int k = 0; k < RUN; k++)
				c[k] = is;
		of = last;
		is = c[RUN - 1];
	}
	encode(n, c);
}

/* Of sRGB: half the sum of the largest and the least channel, and the place in the plane across the way of greys. */
static void to_hsl(int n, float *restrict r, float *restrict g, float *restrict b)
{
	for (int i = 0; i < n; i++) {
		float most = max3(r[i], g[i], b[i]), least = -max3(-r[i], -g[i], -b[i]);
		float y = r[i] - 0.5f * (g[i] + b[i]), z = 0.866025404f * (g[i] - b[i]);
		r[i] = 0.5f * (most + least);
		g[i] = y;
		b[i] = z;
	}
}

/* And back: of all colours with these ways across, the one that is so light. */
static void from_hsl(float *v)
{
	float apart = v[2] / 0.866025404f, half = 0.5f * fabsf(apart);
	float mean = v[0] - 0.5f * (max(v[1], half) + min(v[1], -half));
	float r = mean + v[1], g = mean + 0.5f * apart, b = mean - 0.5f * apart;
	v[0] = r;
	v[1] = g;
	v[2] = b;
}

static bool is_lab(int metric)
{
	return metric != contrast_metric_RGB && metric != contrast_metric_HSL;
}

void ISA(metric_space)(int metric, int n, float *restrict r, float *restrict g, float *restrict b)
{
	if (is_lab(metric)) {
		to_lab(n, r, g, b);
		return;
	}
	to_srgb(n, r);
	to_srgb(n, g);
	to_srgb(n, b);
	if (metric == contrast_metric_HSL)
		to_hsl(n, r, g, b);
}

/* ---- differences of two colours -------------------------------------------------------------------------- */

typedef struct color {
	float x, y, z; /* encoded red, green, blue, or L*, a*, b* */
} color;

static inline float square(float x)
{
	return x * x;
}

static inline float rgb(color p, color q)
{
	float red = 0.5f * (p.x + q.x);
	return sqrtf((2 + red) * square(p.x - q.x) + 4 * square(p.y - q.y) + (3 - red) * square(p.z - q.z)) / 3;
}

/* Herring's future work (2016, 5.3), after Constable (2011). Hue differs by at most twice the chroma. */
static inline float hsl(const color_metric *m, color p, color q)
{
	float light = m->lightness * (p.x - q.x), one = sqrtf(square(p.y) + square(p.z)),
	      two = sqrtf(square(q.y) + square(q.z)), chroma = one - two;
	float turn = square(p.y - q.y) + square(p.z - q.z) - square(chroma);
	turn = turn > 0 ? turn : 0;
	return sqrtf(square(light) + square(m->saturation * chroma) + square(0.5f * m->hue) * turn);
}

static inline float cie76(color p, color q)
{
	return 0.01f * sqrtf(square(p.x - q.x) + square(p.y - q.y) + square(p.z - q.z));
}

/* sqrt(c^7 / (c^7 + 25^7)): 0 for greys, 1 for strong colours. */
static inline float chroma_share(float c)
{
	float c7 = square(c * c * c) * c;
	return sqrtf(c7 / (c7 + 6103515625.0f));
}

#define PI 3.14159265f
#define DEGREES(x) ((x) * (PI / 180))

static inline float ciede2000(color p, color q)
{
	float mean = 0.5f * (sqrtf(square(p.y) + square(p.z)) + sqrtf(square(q.y) + square(q.z)));
	float stretch = 1.5f - 0.5f * chroma_share(mean);
	float ap = stretch * p.y, aq = stretch * q.y;
	float cp = sqrtf(square(ap) + square(p.z)), cq = sqrtf(square(aq) + square(q.z));
	float hp = pixel_atan2(p.z, ap), hq = pixel_atan2(q.z, aq);
	hp = hp < 0 ? hp + 2 * PI : hp;
	hq = hq < 0 ? hq + 2 * PI : hq;
	/* exactly opposite hues count as not more than half a turn apart, whatever the last bits say */
	int far = fabsf(hq - hp) > PI + 2e-6f;
	float sum = hp + hq;
	float hue = 0.5f * sum + (far ? (sum < 2 * PI ? PI : -PI) : 0);
	int grey = cp * cq == 0; /* no hue: the other's counts */
	hue = grey ? sum : hue;
	float sine = pixel_sin(0.5f * (hq - hp));
	float dh = grey ? 0 : 2 * sqrtf(cp * cq) * (far ? -sine : sine);

	float light = square(0.5f * (p.x + q.x) - 50), chroma = 0.5f * (cp + cq);
	float t = 1 - 0.17f * pixel_cos(hue - DEGREES(30)) + 0.24f * pixel_cos(2 * hue) +
		  0.32f * pixel_cos(3 * hue + DEGREES(6)) - 0.20f * pixel_cos(4 * hue - DEGREES(63));
	float bend = pixel_exp(-square((hue - DEGREES(275)) / DEGREES(25)));
	float rotation = -2 * chroma_share(chroma) * pixel_sin(DEGREES(60) * bend);
	float l = (q.x - p.x) / (1 + 0.015f * light / sqrtf(20 + light));
	float c = (cq - cp) / (1 + 0.045f * chroma);
	float h = dh / (1 + 0.015f * chroma * t);
	float sum2 = square(l) + square(c) + square(h) + rotation * c * h;
	return 0.01f * sqrtf(sum2 > 0 ? sum2 : 0);
}

float ISA(metric_ciede2000)(int metric, const float *one, const float *two)
{
	float value[2][3];
	memcpy(value[0], one, sizeof value[0]);
	memcpy(value[1], two, sizeof value[1]);
	for (int k = 0; !is_lab(metric) && k < 2; k++) {
		if (metric == contrast_metric_HSL)
			from_hsl(value[k]);
		for (int c = 0; c < 3; c++)
			value[k][c] = srgb_decode(clamp01(value[k][c]));
		to_lab(1, value[k], value[k] + 1, value[k] + 2);
	}
	return ciede2000((color){value[0][0], value[0][1], value[0][2]},
			 (color){value[1][0], value[1][1], value[1][2]});
}

/* Weighs by the first colour; l:c = 2:1. The cosines of its hue come from a* and b* themselves, and so does the test
 * for 164..345 degrees: the other half of the circle lies within 89.5 degrees of 74.5. */
static inline float cmc_of(color p, float c1, float dl, float dc, float dh2)
{
	float over = c1 > 0 ? 1 / c1 : 0, cosine = p.y * over, sine = p.z * over;
	/* cos and sin of 74.5, cos of 89.5 degrees */
	int warm = cosine * 0.267238376f + sine * 0.963630453f > 0.00872653550f;
	float near = 0.56f + 0.2f * fabsf(cosine * -0.978147601f - sine * 0.207911691f); /* 168 degrees */
	float away = 0.36f + 0.4f * fabsf(cosine * 0.819152044f - sine * 0.573576436f);  /* 35 degrees */
	float t = warm ? away : near;
	float c4 = square(c1 * c1), f = sqrtf(c4 / (c4 + 1900));
	float sl = p.x < 16 ? 0.511f : 0.040975f * p.x / (1 + 0.01765f * p.x);
	float sc = 0.0638f * c1 / (1 + 0.0131f * c1) + 0.638f;
	float sh = sc * (f * t + 1 - f);
	return square(dl / (2 * sl)) + square(dc / sc) + dh2 / square(sh);
}

/* The larger of the two orders: an edge has no first side. */
static inline float cmc(color p, color q)
{
	float c1 = sqrtf(square(p.y) + square(p.z)), c2 = sqrtf(square(q.y) + square(q.z));
	float dl = p.x - q.x, dc = c1 - c2;
	float dh2 = square(p.y - q.y) + square(p.z - q.z) - square(dc);
	dh2 = dh2 > 0 ? dh2 : 0;
	float one = cmc_of(p, c1, dl, dc, dh2), two = cmc_of(q, c2, dl, dc, dh2);
	return 0.01f * sqrtf(one > two ? one : two);
}

/* ---- rows ------------------------------------------------------------------------------------------------ */

/* Called with a constant function each time, which the compiler inlines into a loop of its own. */
KERNEL void greatest_of(float (*difference)(color, color), int n, const float *const a[3], const float *const b[3],
			float *restrict greatest)
{
	const float *restrict ax = a[0], *restrict ay = a[1], *restrict az = a[2];
	const float *restrict bx = b[0], *restrict by = b[1], *restrict bz = b[2];
	for (int i = 0; i < n; i++) {
		float d = difference((color){ax[i], ay[i], az[i]}, (color){bx[i], by[i], bz[i]});
		greatest[i] = d > greatest[i] ? d : greatest[i];
	}
}

static void greatest_hsl(const color_metric *m, int n, const float *const a[3], const float *const b[3],
			 float *restrict greatest)
{
	for (int i = 0; i < n; i++) {
		float d = hsl(m, (color){a[0][i], a[1][i], a[2][i]}, (color){b[0][i], b[1][i], b[2][i]});
		greatest[i] = d > greatest[i] ? d : greatest[i];
	}
}

void ISA(metric_difference)(const color_metric *metric, int n, const float *const a[3], const float *const b[3],
			    float *restrict greatest)
{
	switch (metric->kind) {
	case contrast_metric_HSL: greatest_hsl(metric, n, a, b, greatest); break;
	case contrast_metric_CIE76: greatest_of(cie76, n, a, b, greatest); break;
	case contrast_metric_CIEDE2000: greatest_of(ciede2000, n, a, b, greatest); break;
	case contrast_metric_CMC: greatest_of(cmc, n, a, b, greatest); break;
	default: greatest_of(rgb, n, a, b, greatest);
	}
}
