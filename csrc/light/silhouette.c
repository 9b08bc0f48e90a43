/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pixels beside another thing. Their centres lie anywhere within a pixel of their thing's silhouette, and a face, or a
 * shade, that is narrower than a pixel and runs along it is met by some of them only: it would be dashed. So all take
 * the light of what lies half a pixel from there: as far as centres do in the mean. Shadows stay those of the centre.
 */
#include "light/light.h"

enum { PARTS = 16 }; /* of a pixel, in one of which the silhouette is found */
static const int sides[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

static surface beside(const light *l, facets *known, int x, int y, int side, double far)
{
	const int32_t thing = l->surfaces[(ptrdiff_t)y * l->width + x].instance;
	return ISA(place_of)(l, known, thing, x + 0.5 + far * sides[side][0], y + 0.5 + far * sides[side][1]);
}

/* In how many parts of a pixel its thing goes on to a side; PARTS: as far as to the next pixel, whatever that shows. */
static int room(const light *l, facets *known, int x, int y, int side)
{
	const int32_t thing = l->surfaces[(ptrdiff_t)y * l->width + x].instance;
	int far = 0;
	for (int step = PARTS / 2; step; step /= 2)
		far += beside(l, known, x, y, side, (far + step) / (double)PARTS).instance == thing ? step : 0;
	return far + (far == PARTS - 1 && beside(l, known, x, y, side, 1).instance == thing);
}

/* The side on which another thing is nearest, while the same lies on the opposite one, and how far it is. */
static uint8_t find(const light *l, facets *known, int x, int y)
{
	const surface *s = l->surfaces + (ptrdiff_t)y * l->width + x;
	int least = PARTS, nearest = 0;
	bool same[4];
	if (s->instance < 0 || s->turned || !x || !y || x == l->width - 1 || y == l->height - 1)
		return 0;
	for (int k = 0; k < 4; k++)
		same[k] = s[(ptrdiff_t)sides[k][1] * l->width + sides[k][0]].instance == s->instance;
	for (int k = 0; k < 4; k++) {
		const int far = !same[k] && same[k ^ 1] ? room(l, known, x, y, k) : PARTS;
		nearest = far < least ? k : nearest;
		least = far < least ? far : least;
	}
	return (uint8_t)(least < PARTS ? 1 + 4 * least + nearest : 0);
}

static void find_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	facets known = FACETS_NONE;
	for (int y = y0; y < y1 && !bands_stopped(l->bands); y++)
		for (int x = 0; x < l->width; x++)
			l->silhouette[(ptrdiff_t)y * l->width + x] = l->job->rims ? find(l, &known, x, y) : 0;
}

int32_t ISA(silhouette_run)(light *l)
{
	return bands_run(l->bands, l->height, 0, find_rows, l);
}

surface ISA(silhouette_place)(const light *l, facets *known, ptrdiff_t i)
{
	const surface *own = l->surfaces + i;
	const int found = l->silhouette[i] - 1, part = found / 4, x = (int)(i % l->width), y = (int)(i / l->width);
	if (found < 0)
		return *own;
	surface s = beside(l, known, x, y, found % 4, (part + 0.5) / PARTS - 0.5);
	return s.instance == own->instance ? s : *own;
}

float ISA(silhouette_light)(const light *l, rays *from, ptrdiff_t i)
{
	const surface s = ISA(silhouette_place)(l, &from->facets, i);
	const float plain = ISA(shadow_plain)(l, &s);
	float all = 0, seen = 0;
	if (l->plain[i] > 0 || !(plain > 0))
		return plain * l->share[i];
	for (int k = 0; k < (l->lamp.soft ? LAMP_PLAIN : 1); k++)
		ISA(ask_point)(l, &s, l->lamp.soft ? l->points.plain + k : &l->points.middle, &all, &seen, from);
	return all > 0 ? plain * seen / all : 0;
}
