/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random scenes: soups of triangles with holes, things replaced and removed, lamps of every kind; seen by the
 * rasteriser, or by depths that have nothing to do with them. */
#include "fuzz.h"

#include <string.h>

enum { SHAPES = 4, THINGS = 6, LAMPS = 4, TEXTURES = 2 };

/* Of the last job: it lives until the next one is made. */
static encre_scene *kept;

static float *some(int n, double low, double high)
{
	float *at = take((size_t)n * sizeof *at + 1);
	double odd = chance(0.1) ? 0.02 : 0;
	for (int k = 0; k < n; k++)
		at[k] = chance(odd) ? weird() : (float)(low + (high - low) * share());
	return at;
}

static encre_geometry random_geometry(void)
{
	encre_geometry g = {.n_points = chance(0.1) ? whole(0, 3) : whole(3, 60)};
	g.n_triangles = g.n_points ? whole(0, 80) : 0;
	g.points = random_triples(g.n_points);
	int32_t *corners = take(3 * (size_t)g.n_triangles * sizeof *corners + 1);
	double odd = chance(0.02) ? 0.01 : 0;
	for (int k = 0; k < 3 * g.n_triangles; k++)
		corners[k] = chance(odd) ? weird_int() : whole(0, g.n_points - 1);
	g.corners = corners;
	if (chance(0.5))
		g.normals = some(9 * g.n_triangles, -1, 1);
	if (chance(0.4)) {
		int32_t *textures = take((size_t)g.n_triangles * sizeof *textures + 1);
		for (int k = 0; k < g.n_triangles; k++)
			textures[k] = chance(0.02) ? weird_int() : whole(-1, TEXTURES);
		g.textures = textures;
		g.uvs = some(6 * g.n_triangles, -2, 3);
	}
	if (chance(0.01))
		g.n_triangles = -whole(1, INT32_MAX);
	return g;
}

static encre_texture random_texture(void)
{
	encre_texture t = {whole(1, 9), whole(1, 9), whole(0, 2), whole(0, 1), NULL};
	uint8_t *alpha = take(81);
	for (int k = 0; k < 81; k++)
		alpha[k] = (uint8_t)whole(0, 255);
	t.alpha = alpha;
	if (chance(0.02))
		t.width = -whole(0, 9);
	return t;
}

static encre_lamp random_lamp(void)
{
	encre_lamp l = {.type = chance(0.99) ? whole(ENCRE_SUN, ENCRE_ELLIPSE) : weird_int(),
			.shadows = chance(0.9),
			.light_set = chance(0.9) ? 0 : whole(0, 63),
			.shadow_set = chance(0.9) ? 0 : whole(0, 63),
			.width = chance(0.4) ? 0 : (float)(3 * share()),
			.height = (float)(3 * share()),
			.spot_angle = (float)(3 * share()),
			.spot_blend = (float)between(0, 1),
			.spread = chance(0.5) ? 3.14159f : (float)(3 * share()),
			.flat = chance(0.3)};
	random_matrix(l.model);
	for (int c = 0; c < 3; c++)
		l.color[c] = chance(0.02) ? weird() : (float)magnitude(-1, 3);
	for (int k = 0; k < 3; k++)
		l.model[4 * k + 3] += 6 * (share() - 0.5);
	if (chance(0.03))
		l.width = chance(0.5) ? weird() : (float)magnitude(-20, 20);
	return l;
}

static void fill(encre_context *context)
{
	for (int k = whole(1, 2 * SHAPES); k > 0; k--) {
		encre_geometry g = random_geometry();
		encre_scene_geometry(context, kept, whole(0, SHAPES - 1), chance(0.95) ? &g : NULL);
	}
	for (int k = whole(0, TEXTURES); k > 0; k--) {
		encre_texture t = random_texture();
		encre_scene_texture(context, kept, whole(0, TEXTURES - 1), chance(0.95) ? &t : NULL);
	}
	for (int k = whole(1, 2 * THINGS); k > 0; k--) {
		encre_instance in = {.geometry = whole(0, SHAPES - 1),
				     .light_sets = chance(0.8) ? UINT64_MAX : bits(),
				     .shadow_sets = chance(0.8) ? UINT64_MAX : bits(),
				     .camera = chance(0.8)};
		random_matrix(in.model);
		encre_scene_instance(context, kept, whole(0, THINGS - 1), chance(0.95) ? &in : NULL);
	}
	for (int k = whole(0, LAMPS); k > 0; k--) {
		encre_lamp l = random_lamp();
		encre_scene_lamp(context, kept, whole(0, LAMPS - 1), chance(0.95) ? &l : NULL);
	}
}

/* What the rasteriser sees of one more geometry, which joins the scene. */
static void see(encre_context *context, encre_light_job *job)
{
	encre_geometry g = random_geometry();
	encre_mesh mesh = {.kind = ENCRE_TRIANGLES,
			   .n_points = g.n_points,
			   .n_primitives = g.n_triangles,
			   .points = g.points,
			   .corners = g.corners,
			   .object_index = 1};
	random_matrix(mesh.model);
	encre_instance in = {.geometry = SHAPES, .light_sets = UINT64_MAX, .shadow_sets = UINT64_MAX, .camera = 1};
	memcpy(in.model, mesh.model, sizeof in.model);
	if (encre_scene_geometry(context, kept, SHAPES, &g) || encre_scene_instance(context, kept, THINGS, &in))
		return;
	encre_raster_job seen = {.clip_start = job->clip_start,
				 .clip_end = job->clip_end,
				 .frame = job->frame,
				 .depth = job->depth,
				 .meshes = &mesh,
				 .n_meshes = 1};
	memcpy(seen.view, job->view, sizeof seen.view);
	memcpy(seen.projection, job->projection, sizeof seen.projection);
	encre_raster(context, &seen);
}

static int32_t run(encre_context *context, void *job)
{
	return encre_light(context, job);
}

task random_light(void)
{
	static encre_light_job job;
	memset(&job, 0, sizeof job);
	task t = {.name = "light",
		  .run = run,
		  .kind = ENCRE_LIGHT,
		  .job = &job,
		  .progress = &job.progress,
		  .n_outputs = 1};
	int width = chance(0.3) ? whole(1, 5) : whole(1, 20), height = chance(0.3) ? whole(1, 5) : whole(1, 20);
	encre_context *context = encre_create(ENCRE_API_VERSION);
	encre_scene_free(kept);
	job.scene = kept = encre_scene_create();
	fill(context);
	scene shown = random_scene(width, height);
	job.depth = picture(width, height, 1, NULL);
	paint(&job.depth, DEPTHS, &shown);
	if (chance(0.5)) {
		job.normal = picture(width, height, 3, NULL);
		paint(&job.normal, DIRECTIONS, &shown);
	}
	if (chance(0.99))
		job.diffuse = t.output[0] = picture(width, height, 3, NULL);
	if (chance(0.5)) {
		job.shine = picture(width, height, 6, NULL);
		paint(&job.shine, chance(0.9) ? COLORS : DIRECTIONS, &shown);
		job.specular = t.output[t.n_outputs++] = picture(width, height, 3, NULL);
	}
	if (chance(0.3)) {
		job.turned = picture(width, height, 3, NULL);
		paint(&job.turned, DIRECTIONS, &shown);
	}
	job.frame = (encre_frame){width, height, 0, 0, 0};
	if (chance(0.3)) {
		job.frame = (encre_frame){width, height, whole(0, 300), whole(0, 300), 0};
		job.frame.width += job.frame.x + whole(0, 300);
		job.frame.height += job.frame.y + whole(0, 300);
	}
	random_lens(job.view, job.projection, &job.clip_start, &job.clip_end);
	for (int k = 0; k < 27; k++)
		job.world[k] = (float)(share() - 0.3);
	if (chance(0.01))
		job.world[whole(0, 26)] = weird();
	job.sharp = chance(0.3);
	job.rims = chance(0.5);
	static encre_bend bends[4];
	job.bends = bends;
	job.n_bends = chance(0.5) ? whole(0, 4) : 0;
	for (int k = 0; k < job.n_bends; k++) {
		for (int i = 0; i < 16; i++)
			bends[k].model[i] = chance(0.003) ? (double)weird() : 6 * share() - 3;
		bends[k].amount = chance(0.99) ? (float)share() : weird();
		bends[k].fade = chance(0.99) ? (float)share() : weird();
	}
	if (chance(0.7))
		see(context, &job);
	encre_destroy(context);
	return t;
}
