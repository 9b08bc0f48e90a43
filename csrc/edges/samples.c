/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers -> rows of samples, in a quantity that edge detectors can compare, padded with the nearest at the frame's
 * border. */
#include "edges/edges.h"
#include "base/metric.h"
#include "base/pixel.h"

/* ---- layers -> samples ----------------------------------------------------------------------------------- */

/* Interleaved channels, cut to low..high, to planes. Called with a constant number of channels each time. */
KERNEL void split(const float *restrict in, const int channels, int n, float low, float high, float *restrict a,
		  float *restrict b, float *restrict c)
{
	for (int i = 0; i < n; i++) {
		float u = in[i * channels], v = in[i * channels + 1], w = in[i * channels + 2];
		a[i] = min(max(u, low), high);
		b[i] = min(max(v, low), high);
		c[i] = min(max(w, low), high);
	}
}

/* 1/z is linear on planes on screen, under an orthographic camera z is: there -z, -INFINITY where nothing is. */
/* Channels stay as they lie: what is taken across them is so in the end alone. */
static void normal_samples(const float *restrict normal, int n, float *restrict out)
{
	for (int i = 0; i < 3 * n; i++)
		out[i] = min(max(normal[i], -pixel_great), pixel_great);
}

static void depth_samples(const edges *e, const float *restrict z, int n, float *restrict out)
{
	float near = e->p->depth_near, far = e->p->depth_far;
	if (!e->inverse)
		for (int i = 0; i < n; i++) {
			float d = depth_of(z[i]);
			out[i] = min(max(d, near), far);
		}
	else if (e->ortho)
		for (int i = 0; i < n; i++)
			out[i] = -depth_of(z[i]);
	else
		for (int i = 0; i < n; i++) {
			float u = 1 / depth_of(z[i]);
			out[i] = min(u, pixel_great);
		}
}

static void mark_samples(const uint8_t *restrict marked, int n, float *restrict out)
{
	for (int i = 0; i < n; i++)
		out[i] = marked[i];
}

/* Row y, inside the frame, of plane 0; other planes follow e->plane_samples apart. */
static void sample_row(const ring *r, int y, float *out)
{
	const edges *e = r->e;
	int n = e->f->width;
	float *second = out + e->plane_samples, *third = second + e->plane_samples;
	bool lit = e->p->color_layer == color_layer_LIT;
	switch ((int)r->source) {
	case SOURCE_OBJECT: memcpy(out, layer_row(e->f, ENCRE_LAYER_OBJECT, y), (size_t)n * sizeof *out); return;
	case SOURCE_MATERIAL: memcpy(out, layer_row(e->f, ENCRE_LAYER_MATERIAL, y), (size_t)n * sizeof *out); return;
	case SOURCE_MARK: mark_samples(e->marked + (ptrdiff_t)y * n, n, out); return;
	case SOURCE_DEPTH: depth_samples(e, layer_row(e->f, ENCRE_LAYER_DEPTH, y), n, out); return;
	case SOURCE_NORMAL:
		if (r->step == 3)
			normal_samples(layer_row(e->f, ENCRE_LAYER_NORMAL, y), n, out);
		else
			split(layer_row(e->f, ENCRE_LAYER_NORMAL, y), 3, n, -pixel_great, pixel_great, out, second,
			      third);
		return;
	case SOURCE_COLOR:
		if (lit)
			split(layer_row(e->f, ENCRE_LAYER_COMBINED, y), 4, n, pixel_zero, pixel_one, out, second,
			      third);
		else
			split(layer_row(e->f, ENCRE_LAYER_ALBEDO, y), 3, n, pixel_zero, pixel_one, out, second, third);
		break;
	case SOURCE_SEEN:
		split(layer_row(e->f, ENCRE_LAYER_SEEN_NORMAL, y), 3, n, -pixel_great, pixel_great, out, second, third);
		return;
	case SAMPLE_SEEN_COLOR:
		split(layer_row(e->f, ENCRE_LAYER_SEEN_COLOR, y), 3, n, pixel_zero, pixel_one, out, second, third);
		break;
	case SAMPLE_SEEN_DEPTH:
		for (int i = 0; i < n; i++)
			out[i] = seen_sample(e, layer_row(e->f, ENCRE_LAYER_SEEN_DEPTH, y)[i]);
		return;
	default:
		if (e->fine) {
			ISA(shade_exposed)(e->f, y, out);
			return;
		}
		ISA(shade_tones)(e->f, y, 0, n, out);
		for (int i = 0; i < n; i++)
			out[i] = second[i] = third[i] = clamp01(out[i]);
	}
	ISA(metric_space)(e->contrast ? e->p->contrast_metric : contrast_metric_RGB, n, out, second, third);
}

/* ---- rings ----------------------------------------------------------------------------------------------- */

ring ISA(ring_of)(const edges *e, enum source s, int thread)
{
	int channels = channels_of(s), step = s == SOURCE_NORMAL && !e->fine ? channels : 1;
	ring r = {.e = e, .source = s, .reach = e->reach[s], .planes = channels / step, .step = step, .y = -1};
	r.data = e->samples + thread * e->thread_samples + e->ring_at[s];
	for (int i = 0; i < MAX_ROWS; i++)
		r.held[i] = -1;
	return r;
}

static void pad(const ring *r, float *row)
{
	float *last = row + (ptrdiff_t)r->step * (r->e->f->width - 1);
	for (int j = 1; j <= r->reach; j++)
		for (int c = 0; c < r->step; c++) {
			row[c - j * r->step] = row[c];
			last[c + j * r->step] = last[c];
		}
}

void ISA(ring_fill)(ring *r, int y)
{
	int rows = 2 * r->reach + 1, height = r->e->f->height;
	ptrdiff_t plane = r->step * r->e->plane_samples;
	if (r->y == y)
		return;
	r->y = y;
	for (int k = 0; k < rows; k++) {
		int i = clamp_index(y - r->reach + k, height), slot = i % rows;
		r->row[k] = r->data + slot * r->planes * plane + (ptrdiff_t)r->reach * r->step;
		if (r->held[slot] == i)
			continue;
		r->held[slot] = i;
		sample_row(r, i, r->row[k]);
		for (int p = 0; p < r->planes; p++)
			pad(r, r->row[k] + p * plane);
	}
}

void ISA(ring_window)(const ring *r, int x0, int plane, const float **row)
{
	for (int k = 0; k <= 2 * r->reach; k++)
		row[k] = r->row[k] + plane * r->e->plane_samples + (ptrdiff_t)x0 * r->step;
}
