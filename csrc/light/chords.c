/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Halving on a chord of a lamp, eight rays at a time. */
#include "light/chords.h"

void ISA(chord_ends)(const view *w, float along, float *low, float *high)
{
	*high = w->square ? 2 : sqrtf(max(1 - along * along, 0));
	*low = -*high;
	for (int c = 0; c < 2 && w->square; c++) {
		if (fabsf(w->across[c]) < 1e-3f)
			continue;
		float middle = -w->along[c] * along / w->across[c], half = fabsf(1 / w->across[c]);
		*low = max(*low, middle - half);
		*high = max(*low, min(*high, middle + half));
	}
}

unsigned ISA(spots_seen)(const view *w, const spot *of, int count)
{
	asking ask;
	ask.count = 0;
	for (int k = 0; k < count; k++) {
		float x = w->across[0] * of[k].across + w->along[0] * of[k].along;
		float y = w->across[1] * of[k].across + w->along[1] * of[k].along;
		lamp_point q = {.square = {0.5f + 0.5f * x, 0.5f + 0.5f * y}, .disc = {x, y}};
		ISA(ask_add)(&ask, w->at, &q, 0);
	}
	return ISA(ask_all)(w->light, &ask, w->from->shaft);
}

/* Where halving looks, whatever it finds: into at[1] first, then, from at[k], at[2 k] or at[2 k + 1]. */
static void halves(float low, float high, float along, int count, spot *at)
{
	float from[2 * PACK], to[2 * PACK];
	from[1] = low;
	to[1] = high;
	for (int k = 1; k < count; k++) {
		at[k] = (spot){0.5f * (from[k] + to[k]), along};
		from[2 * k] = from[k];
		to[2 * k] = from[2 * k + 1] = at[k].across;
		to[2 * k + 1] = to[k];
	}
}

/* Halves until what is seen ends within `enough`, or is to be looked for beyond these places. */
static void halve(const view *w, const spot *at, int count, unsigned seen, float *low, float *high)
{
	for (int k = 1; k < count && *high - *low > w->enough;) {
		bool lit = seen >> k & 1;
		*(lit ? high : low) = at[k].across;
		k = 2 * k + !lit;
	}
}

/* Its places are asked together, also such as turn out not to matter. */
bool ISA(cross_chord)(view *w, int k, float along, float guess, float wide)
{
	enum { FEW = 4 }; /* places of two halvings */
	enum { LOW = FEW, HIGH, FIRST, LAST, ALL };
	_Static_assert((int)ALL == (int)PACK, "at[0] is free");
	float first, last;
	ISA(chord_ends)(w, along, &first, &last);
	float low = max(guess - wide, first), high = min(guess + wide, last), rim = 0.015f * (last - first);
	if (low >= high) {
		low = first;
		high = last;
	}
	spot at[PACK] = {[0] = {high, along},
			 [LOW] = {low, along},
			 [HIGH] = {high, along},
			 [FIRST] = {first + rim, along},
			 [LAST] = {last - rim, along}};
	halves(low, high, along, FEW, at);
	unsigned seen = ISA(spots_seen)(w, at, PACK);
	if (seen >> FIRST & 1 || !(seen >> LAST & 1))
		return false;
	const bool lit = seen >> HIGH & 1, dark = !(seen >> LOW & 1), beyond = !lit || !dark;
	if (beyond) {
		const bool below = !dark && low > first;
		if (!below && (lit || high >= last))
			return false;
		float from = below ? first : high;
		high = below ? low : last;
		low = from;
		at[0] = (spot){below ? low : high, along};
		halves(low, high, along, PACK, at);
		seen = ISA(spots_seen)(w, at, PACK);
		if ((seen & 1) == below)
			return false;
	}
	halve(w, at, beyond ? PACK : FEW, seen, &low, &high);
	while (high - low > w->enough) {
		at[0] = (spot){high, along};
		halves(low, high, along, PACK, at);
		halve(w, at, PACK, ISA(spots_seen)(w, at, PACK), &low, &high);
	}
	w->chord[k] = along;
	w->cut[k] = 0.5f * (low + high);
	return true;
}
