/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens the inline maths and colour metrics of csrc/ to tests: no public function of the library shows them bare. */
#include "base/metric.c"
#include "base/pixel.c"

#define PROBE(name, call)                                                                                              \
	ENCRE_API void probe_##name(int n, const float *x, const float *y, float *out)                                 \
	{                                                                                                              \
		for (int i = 0; i < n; i++)                                                                            \
			out[i] = call;                                                                                 \
	}
PROBE(cbrt, pixel_cbrt(x[i]))
PROBE(srgb, srgb_encode(x[i]))
PROBE(exp, pixel_exp(x[i]))
PROBE(log, pixel_log(x[i]))
PROBE(pow, pixel_pow(x[i], y[i]))
PROBE(atan2, pixel_atan2(x[i], y[i]))
PROBE(sin, pixel_sin(x[i]))
PROBE(cos, pixel_cos(x[i]))
PROBE(depth, depth_of(x[i]))
PROBE(luminance, luminance(x[i], y[i], 0.25f))
#undef PROBE

/* Planes of n colours: x, y, z after each other. */
ENCRE_API void probe_space(int metric, int n, float *colors)
{
	ISA(metric_space)(metric, n, colors, colors + n, colors + 2 * n);
}

ENCRE_API void probe_difference(int metric, int n, const float *a, const float *b, float *greatest)
{
	const float *p[3] = {a, a + n, a + 2 * n}, *q[3] = {b, b + n, b + 2 * n};
	color_metric by = {metric, 1, 1, 1};
	ISA(metric_difference)(&by, n, p, q, greatest);
}
