/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inline maths of single pixels. No libm but sqrtf, fabsf, floorf, fminf, fmaxf: others give other bits on other
 * machines. Everything is free of branches, so that a loop over a row vectorises, and within 4 ulp on the domain that
 * its comment names (srgb_encode: 6, where its constant cancels half of the power). */
#ifndef ENCRE_PIXEL_H
#define ENCRE_PIXEL_H

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

static inline int32_t float_bits(float x)
{
	int32_t i;
	memcpy(&i, &x, sizeof i);
	return i;
}

static inline float bits_float(int32_t i)
{
	float x;
	memcpy(&x, &i, sizeof x);
	return x;
}

/* Unlike fminf() and fmaxf() these never are calls. Where a or b is NaN: b. */
static inline float min(float a, float b)
{
	return a < b ? a : b;
}

static inline float max(float a, float b)
{
	return a > b ? a : b;
}

/* Bounds whose values the compiler is not to see (pixel.c). A select by a comparison with a number that it knows, gcc
 * 12 takes apart, and two in a row into nine instructions; with one that it does not know each is one. Sums and
 * squares of what is no greater than pixel_great stay finite. */
extern const float pixel_zero, pixel_half, pixel_one, pixel_most, pixel_great;

/* A bijective hash. */
static inline uint32_t mix_bits(uint32_t n)
{
	n = (n ^ n >> 16) * 0x7feb352du;
	n = (n ^ n >> 15) * 0x846ca68bu;
	return n ^ n >> 16;
}

/* NaN gives 0. */
static inline float positive(float x)
{
	return max(x, pixel_zero);
}

/* NaN gives 1. */
static inline float most_one(float x)
{
	return min(x, pixel_one);
}

/* NaN gives 0. */
static inline float clamp01(float x)
{
	return most_one(positive(x));
}

static inline int clamp_index(int i, int n)
{
	return i < 0 ? 0 : i < n ? i : n - 1;
}

/* Of a picture that tiles. */
static inline int wrap_index(int i, int n)
{
	i %= n;
	return i < 0 ? i + n : i;
}

static inline float mix(float a, float b, float t)
{
	return a + (b - a) * t;
}

/* mix() that is exact at t = 1 too, however large a is, and does not overflow between finite numbers. */
static inline float blend(float a, float b, float t)
{
	return a * (1 - t) + b * t;
}

/* Infinities become the largest numbers, so that they make no NaN later. */
static inline float bounded(float x)
{
	return min(max(x, -pixel_most), pixel_most);
}

static inline float max3(float a, float b, float c)
{
	return max(max(a, b), c);
}

/* The brightest channel of what a pixel has beside diffuse light on its colour: what shines, reflects or lets light
 * through. */
static inline float other_light(const float combined[4], const float color[3], const float diffuse[3])
{
	return max3(combined[0] - color[0] * diffuse[0], combined[1] - color[1] * diffuse[1],
		    combined[2] - color[2] * diffuse[2]);
}

/* Rec. 709 luminance of a linear colour. */
static inline float luminance(float r, float g, float b)
{
	return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

/* Depths from `depth_end` on mean that nothing is there; what is written for it, as Cycles does, is `depth_nothing`. */
static const float depth_end = 1e9f, depth_nothing = 1e10f;
/* What a depth layer's value means: INFINITY where nothing is there (0, negative and NaN come from other renderers). */
static inline float depth_of(float z)
{
	return z > 0 && z < depth_end ? z : INFINITY;
}

/* Cube root, x = 0 or 1e-30 <= x <= 1e30. A third of the exponent is within 4 %, a Halley step cubes that. Then the
 * root is cut to 8 bits, so that its cube is exact, and mended by the binomial series of (1 + d)^(1/3). */
static inline float pixel_cbrt(float x)
{
	float t = bits_float(float_bits(x) / 3 + 0x2a5137a0);
	float c = t * t * t;
	t = t - t * ((c - x) / (c + c + x));
	t = bits_float((float_bits(t) + 0x8000) & ~0xffff);
	c = t * t * t;
	float d = (x - c) / c;
	t = t + t * d * (1.0f / 3 - d * (1.0f / 9 - d * (5.0f / 81)));
	return x > 0 ? t : 0;
}

/* sRGB transfer function of IEC 61966-2-1, x in 0..1, exactly 1 at 1. x^(1/2.4) is c^(5/4), c the cube root. */
static inline float srgb_encode(float x)
{
	float c = pixel_cbrt(x), power = c * sqrtf(sqrtf(c));
	return x <= 0.0031308f ? 12.92f * x : power + 0.055f * (power - 1);
}

/* Nearest whole number, |x| < 2^22: there the sum has no digits for a fraction. Unlike a select of +-1/2, gcc 12
 * vectorises it with AVX2. */
static inline float nearest_int(float x)
{
	return (x + 12582912.0f) - 12582912.0f;
}

/* 2^n * e^r for |r| <= 0.35 and n -126..127. */
static inline float scaled_exp(float r, int32_t n)
{
	float tail = 1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720 + r * (1.0f / 5040)));
	float p = 1 + r * (1 + r * (0.5f + r * (1.0f / 6 + r * tail)));
	return p * bits_float((n + 127) << 23);
}

/* e^x, x cut to -87..88. ln 2 in two parts, the first short enough that n times it is exact. */
static inline float pixel_exp(float x)
{
	x = x > -87 ? x : -87;
	x = x < 88 ? x : 88;
	float n = nearest_int(x * 1.44269504f);
	return scaled_exp((x - n * 0.693359375f) + n * 2.12194440e-4f, (int32_t)n);
}

/* The logarithm of x > 0, finite, to the base 2, by the series of artanh. */
static inline double pixel_log2(float x)
{
	float normal = x < FLT_MIN ? x * 16777216.0f : x;
	int32_t bits = float_bits(normal) - 0x3f3504f3; /* mantissa from sqrt(1/2) to sqrt(2) */
	int32_t exponent = (bits >> 23) - (x < FLT_MIN ? 24 : 0);
	double m = (double)bits_float((bits & 0x7fffff) + 0x3f3504f3);
	double s = (m - 1) / (m + 1), z = s * s;
	double series = 1 + z * (1.0 / 3 + z * (1.0 / 5 + z * (1.0 / 7 + z * (1.0 / 9 + z * (1.0 / 11)))));
	return (double)exponent + 2.8853900817779268 * s * series;
}

/* Natural, of x > 0, finite. */
static inline float pixel_log(float x)
{
	return (float)(pixel_log2(x) * 0.69314718055994531);
}

/* x^y for x >= 0, finite, y >= 0; 0 where that is below 2^-126, 2^127 where it is above. The exponent needs double: it
 * is multiplied by up to 128 before it is looked at to a part in 2^24. */
static inline float pixel_pow(float x, float y)
{
	double t = (double)y * pixel_log2(x);
	double u = t > 127 ? 127 : t < -126 ? -126 : t;
	float n = nearest_int((float)u);
	float power = scaled_exp((float)((u - (double)n) * 0.69314718055994531), (int32_t)n);
	power = x > 0 && t >= -126 ? power : 0;
	return y > 0 ? power : 1;
}

/* Inverse of srgb_encode, x in 0..1. */
static inline float srgb_decode(float x)
{
	float power = pixel_pow((x + 0.055f) * (1 / 1.055f), 2.4f);
	return x <= 0.04045f ? x * (1 / 12.92f) : power;
}

/* Angle of (x, y) in -pi..pi; 0 for (0, 0). Finite, and not so small that their ratio's operands are subnormal. */
static inline float pixel_atan2(float y, float x)
{
	float ax = fabsf(x), ay = fabsf(y);
	float low = ax < ay ? ax : ay, high = ax < ay ? ay : ax;
	/* beyond tan(pi/8): atan(low/high) = pi/4 + atan((low - high)/(low + high)) */
	int folded = low > 0.414213562f * high;
	float over = folded ? low - high : low, under = folded ? low + high : high;
	float t = over / (under > 0 ? under : 1), z = t * t;
	float series = 1.99777106478e-1f + z * (-1.38776856032e-1f + z * 8.05374449538e-2f);
	float a = t + t * z * (-3.33329491539e-1f + z * series);
	a = folded ? 0.785398163f + a : a;
	a = ax < ay ? 1.57079633f - a : a;
	a = x < 0 ? 3.14159265f - a : a;
	return y < 0 ? -a : a;
}

/* Sine of x + quarter * pi/2, |x| <= 1e4. pi/2 in two parts, the first short enough that n times it is exact. */
static inline float sine(float x, int32_t quarter)
{
	float n = nearest_int(x * 0.636619772f);
	int32_t j = (int32_t)n + quarter;
	float r = (float)(((double)x - (double)n * 1.57079632673412561417) - (double)n * 6.07710050650619224932e-11);
	float z = r * r;
	float s = r + r * z * (-1.6666654611e-1f + z * (8.3321608736e-3f + z * -1.9515295891e-4f));
	float c = 1 - 0.5f * z +
		  z * z * (4.166664568298827e-2f + z * (-1.388731625493765e-3f + z * 2.443315711809948e-5f));
	float value = j & 1 ? c : s;
	return j & 2 ? -value : value;
}

static inline float pixel_sin(float x)
{
	return sine(x, 0);
}

static inline float pixel_cos(float x)
{
	return sine(x, 1);
}

#endif
