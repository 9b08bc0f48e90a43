/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edges of a mesh at which an image does not go on: two faces show other parts of it, or other images, and colors part
 * there though no image has a curve for it. */
#include "base/pixel.h"
#include "chains/sheets.h"

#include <stdlib.h>
#include <string.h>

static const double goes_on = 1e-5;        /* of u and v, by which a corner may differ in two faces */
static const double beside = 1.5;          /* texels from the edge at which a face's color is looked at */
static const double most_beside = 1.0 / 3; /* of the way to the corner across */
enum { LOOKS = 3, LEAST_APART = 12 /* of 765: what differs less is one color */ };

static int32_t texel_at(double u, int32_t n, int32_t wrap)
{
	if (wrap == ENCRE_MIRROR) {
		double turn = u - 2 * floor(u / 2);
		u = turn > 1 ? 2 - turn : turn;
	} else if (wrap == ENCRE_REPEAT) {
		u -= floor(u);
	}
	return clamp_index((int)floor(fmin(fmax(u, 0), 1) * n), n);
}

/* What a face shows along the edge that its corners `from` and `to` have: sRGB, 0xrrggbb; -1: somewhere it is clear. */
static int32_t color_along(const encre_colored *of, float uv[3][2], const uint32_t end[2])
{
	double sum[3] = {0};
	const float *across = uv[3 - end[0] - end[1]];
	for (int k = 0; k < LOOKS; k++) {
		double share = (k + 0.5) / LOOKS, at[2], way[2], step;
		for (int i = 0; i < 2; i++) {
			at[i] = (double)uv[end[0]][i] + share * ((double)uv[end[1]][i] - (double)uv[end[0]][i]);
			way[i] = (double)across[i] - at[i];
		}
		double x = way[0] * of->width, y = way[1] * of->height, texels = sqrt(x * x + y * y);
		step = texels > 0 ? fmin(beside / texels, most_beside) : 0;
		int32_t column = texel_at(at[0] + step * way[0], of->width, of->wrap),
			row = texel_at(at[1] + step * way[1], of->height, of->wrap);
		size_t texel = (size_t)row * (size_t)of->width + (size_t)column;
		const float *color = of->colors + 3 * texel;
		if (of->alpha && of->alpha[texel] < 128)
			return -1;
		for (int i = 0; i < 3; i++)
			sum[i] += (double)srgb_encode(clamp01(color[i]));
	}
	int32_t code = 0;
	for (int i = 0; i < 3; i++)
		code = code << 8 | clamp_index((int)(sum[i] / LOOKS * 255 + 0.5), 256);
	return code;
}

/* A face's corners in the image, and which of them are the ends of an edge, in its order. False: it has not both. */
static bool lies(const body *b, int32_t face, const mesh_edge *e, float uv[3][2], uint32_t end[2])
{
	const float *from = b->mesh->uv + 6 * (size_t)face;
	uint32_t found = 0;
	memcpy(uv, from, 6 * sizeof *from);
	for (uint32_t k = 0; k < 3; k++) {
		int32_t place = b->shape->place[topology_point(b->mesh, 3 * (uint32_t)face + k)];
		for (uint32_t i = 0; i < 2; i++)
			if (place == e->end[i]) {
				end[i] = k;
				found |= 1u << i;
			}
	}
	for (int k = 0; k < 6; k++)
		if (!(fabsf(from[k]) < 1e5f))
			return false;
	return found == 3 && end[0] != end[1];
}

bool seam_line(const chains *c, int number, int32_t edge, line *out)
{
	const body *b = c->bodies + number;
	const mesh_edge *e = b->shape->edges + edge;
	if (e->face[1] < 0 || (e->flags & EDGE_MANY))
		return false;
	const encre_colored *of[2];
	float uv[2][3][2];
	uint32_t end[2][2];
	for (int k = 0; k < 2; k++) {
		int32_t image = image_of(c, b->mesh, e->face[k]);
		if (image < 0 || !lies(b, e->face[k], e, uv[k], end[k]))
			return false;
		of[k] = c->job->images + image;
	}
	bool same = of[0] == of[1];
	for (int k = 0; same && k < 2; k++)
		for (int i = 0; i < 2; i++) {
			double d = (double)uv[0][end[0][k]][i] - (double)uv[1][end[1][k]][i];
			same &= fabs(of[0]->wrap == ENCRE_REPEAT ? d - floor(d + 0.5) : d) < goes_on;
		}
	if (same)
		return false;
	int32_t color[2];
	for (int k = 0; k < 2; k++)
		color[k] = color_along(of[k], uv[k], end[k]);
	if (color[0] < 0 || color[1] < 0 || color_apart(color[0], color[1]) < LEAST_APART)
		return false;
	*out = (line){.body = number,
		      .other = -1,
		      .edge = edge,
		      .own = {e->face[0], e->face[1]},
		      .n_own = 2,
		      .kind = ENCRE_CHAIN_COLOR,
		      .object = object_of(b->mesh, e->face[0]),
		      .link = {-1, -1}};
	for (int k = 0; k < 2; k++) {
		out->c[k] = b->spots[e->end[k]];
		world_point(b->mesh, e->end[k], out->p[k]);
		out->node[k] = ((uint64_t)(number + 1) << 32 | (uint32_t)e->end[k]) | (uint64_t)1 << 61;
	}
	if (!line_clip(c, out))
		return false;
	bool ahead = (end[0][0] + 1) % 3 == end[0][1], left = (b->faces[e->face[0]] < 0) == ahead;
	out->color[0] = color[!left]; /* of its way, as the screen shows it */
	out->color[1] = color[left];
	return true;
}
