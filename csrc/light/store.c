/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Things by their keys, and the holes that textures make, which are looked up by theirs. */
#include "light/scene.h"

#include <stdlib.h>
#include <string.h>

/* Where a key is, or would be. */
static int32_t place_of(const store *s, int64_t key)
{
	int32_t low = 0, high = s->count;
	if (high && s->keys[high - 1] < key) /* most keys come in order */
		return high;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		if (s->keys[middle] < key)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

void *store_find(const store *s, int64_t key)
{
	int32_t at = place_of(s, key);
	return at < s->count && s->keys[at] == key ? s->items[at] : NULL;
}

bool store_room(store *s)
{
	if (s->count < s->room)
		return true;
	int32_t room = s->room ? s->room * 2 : 16;
	int64_t *keys = malloc((size_t)room * sizeof *keys);
	void **items = malloc((size_t)room * sizeof *items);
	if (!keys || !items) {
		free(keys);
		free(items);
		return false;
	}
	if (s->count) {
		memcpy(keys, s->keys, (size_t)s->count * sizeof *keys);
		memcpy(items, s->items, (size_t)s->count * sizeof *items);
	}
	free(s->keys);
	free(s->items);
	s->keys = keys;
	s->items = items;
	s->room = room;
	return true;
}

void *store_put(store *s, int64_t key, void *item)
{
	int32_t at = place_of(s, key);
	if (at < s->count && s->keys[at] == key) {
		void *before = s->items[at];
		s->items[at] = item;
		return before;
	}
	memmove(s->keys + at + 1, s->keys + at, (size_t)(s->count - at) * sizeof *s->keys);
	memmove(s->items + at + 1, s->items + at, (size_t)(s->count - at) * sizeof *s->items);
	s->keys[at] = key;
	s->items[at] = item;
	s->count++;
	return NULL;
}

void *store_take(store *s, int64_t key)
{
	int32_t at = place_of(s, key);
	if (at == s->count || s->keys[at] != key)
		return NULL;
	void *item = s->items[at];
	s->count--;
	memmove(s->keys + at, s->keys + at + 1, (size_t)(s->count - at) * sizeof *s->keys);
	memmove(s->items + at, s->items + at + 1, (size_t)(s->count - at) * sizeof *s->items);
	return item;
}

/* ---- holes ------------------------------------------------------------------------------------------------- */

/* A texel's alpha, 0..255. */
static float texel(const texture *t, int x, int y)
{
	if (t->extension == ENCRE_REPEAT) {
		x %= t->width;
		y %= t->height;
		x += x < 0 ? t->width : 0;
		y += y < 0 ? t->height : 0;
	} else if (t->extension == ENCRE_EXTEND) {
		x = x < 0 ? 0 : x < t->width ? x : t->width - 1;
		y = y < 0 ? 0 : y < t->height ? y : t->height - 1;
	}
	bool there = x >= 0 && y >= 0 && x < t->width && y < t->height;
	return there ? (float)t->alpha[(ptrdiff_t)y * t->width + x] : 0;
}

bool solid_at(const store *textures, const shape *s, int32_t triangle, float u, float v)
{
	const texture *t = store_find(textures, s->textures[triangle]);
	const float *uv = s->uvs + 6 * (ptrdiff_t)triangle;
	if (!t)
		return true;
	float x = (float)t->width * (uv[0] + u * (uv[2] - uv[0]) + v * (uv[4] - uv[0]));
	float y = (float)t->height * (uv[1] + u * (uv[3] - uv[1]) + v * (uv[5] - uv[1]));
	if (!(fabsf(x) < 1e9f && fabsf(y) < 1e9f))
		return true;
	if (t->closest)
		return texel(t, (int)floorf(x), (int)floorf(y)) >= 128;
	float left = floorf(x - 0.5f), low = floorf(y - 0.5f), a = x - 0.5f - left, b = y - 0.5f - low;
	int i = (int)left, j = (int)low;
	float below = texel(t, i, j) + a * (texel(t, i + 1, j) - texel(t, i, j));
	float above = texel(t, i, j + 1) + a * (texel(t, i + 1, j + 1) - texel(t, i, j + 1));
	return below + b * (above - below) >= 127.5f;
}
