/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How dark pixels are, and which of their style's tones show it. */
#include "base/step.h"
#include "tones/tones.h"

#include <string.h>

/* Where only small blacks are spotted the first tone is theirs, and the darkest level has the second. */
static int slot_of(const frame *f, int level)
{
	int slot = level + tone_spots_small(f);
	return slot < TONE_SLOTS ? slot : TONE_SLOTS - 1;
}

/* Called with a constant number of channels each time: planes vectorise best. */
KERNEL void split(const float *restrict in, const int channels, int n, float (*restrict plane)[TONE_CHUNK])
{
	for (int i = 0; i < n; i++)
		for (int c = 0; c < channels; c++)
			plane[c][i] = in[channels * i + c];
}

/* Where the darkest level has wholly ended, and how far light colours keep out of it. */
typedef struct spared {
	float end, share;
} spared;

static spared spared_of(const encre_params *p)
{
	const encre_level *next = p->shade_levels.level + 1;
	float end = p->shade_levels.count > 1 ? next->threshold + max(0.5f * next->transition, 1e-3f) : 0;
	return (spared){end, p->tone_local};
}

/* Light as tones take it: in the shade what is light has up to twice of it, but no more than the next level begins
 * with, so that where the light falls is still seen. The square root is near how light a colour looks. */
static inline float spare(spared s, float lit, float bright)
{
	float more = lit * (1 + s.share * positive(2 * sqrtf(clamp01(bright)) - 1));
	return max(lit, min(more, s.end));
}

/* How light a colour looks between black and dark: from 0 to 1 by the cube roots, as the eye has it. Red-brown hair is
 * as light as brown skin, but redder, and paint and cloth of a strong red or blue look darker than they are: of deep
 * colours what is lighter than a quarter of the way from black to dark is taken as darker, so that some more lie below
 * dark, and none that is not black gets black. */
float ISA(tone_counts_as)(const encre_params *p, float bright, float r, float g, float b, float black, float dark)
{
	static const float quarter = 0.25f;
	if (!(dark > black))
		return 1;
	float first = tone_cube_root(black), last = tone_cube_root(dark), own = tone_cube_root(positive(bright));
	float from = first + quarter * (last - first), span = last - from;
	float end = span + p->tone_reds * tone_deep(r, g, b) * last;
	own = p->tone_reds > 0 && own > from ? from + (own - from) * span / end : own;
	return clamp01((own - first) / (last - first));
}

/* The light that a colour has that is no black, of which it has a share where it is lit: none just above one, or a
 * shaded one would be as black as black in any light and the next as white as white. In the shade it has hardly less
 * than others, or the shaded half of a dark face, features and all, would be black beside a lit one in a tone: squares
 * of one over each are added. What is mirrored over it and outshines it (mirrored: its lightness, 0 for none) gives
 * light back: a sea under a light sky is no black. form: how far it has the same share of any light instead, that of a
 * middle one, so that its planes are told apart: lighter in the light, darker in the shade, but for solid, which goes
 * up to `end`. */
static const float middle_light = 0.7f;

static inline float light_left(float lit, float share, float bright, float mirrored, float form, float end)
{
	float own = bright / max3(bright, mirrored, FLT_MIN), shaded = most_one(lit);
	float left = share / max(mix(own * own, 1, share), FLT_MIN);
	float both = shaded * shaded * (1 - left * left) + left * left;
	float kept = lit * left / sqrtf(max(both, FLT_MIN));
	float told = max(mix(kept, min(left / middle_light, 1) * lit, form), min(kept, end));
	return left < 1 && lit > 0 ? told : lit;
}

static const float clear_from = 0.7f; /* share of light that a glazed thing mirrors from which on it is a mirror */

/* How far what a pixel mirrors lies over a colour of its own, as on the sea, wet stone or lacquer: 0 for metals, which
 * have none, and where nothing tells what mirrors. The colour is that without the share that mirroring takes of it;
 * left: what that leaves. */
static void glazed_row(const frame *f, int y, int x, int n, float (*restrict color)[TONE_CHUNK], float *restrict glazed,
		       float *restrict left)
{
	const float *gloss = layer_row(f, ENCRE_LAYER_GLOSS, y), *albedo = layer_row(f, ENCRE_LAYER_ALBEDO, y);
	for (int i = 0; gloss && i < n; i++) {
		const float *g = gloss + (ptrdiff_t)3 * (x + i), *a = albedo + (ptrdiff_t)3 * (x + i);
		float mirrors = max3(g[0], g[1], g[2]), bright = max3(color[0][i], color[1][i], color[2][i]);
		float all = max3(a[0] - color[0][i], a[1] - color[1][i], a[2] - color[2][i]);
		float share = clamp01(mirrors / max(max(all, mirrors), FLT_MIN));
		glazed[i] = share * clamp01(50 * bright / max(1 - mirrors, 0.05f));
		left[i] = max(1 - mirrors * glazed[i], 0.05f);
	}
}

/* The light of a sky that is seen: of one as dark as spotted blacks none, and without end from half as light again on,
 * which the gray world of a new scene is. */
static float night_light(const encre_params *p, float r, float g, float b)
{
	float own = tone_lightness(p, r, g, b), black = p->tone_black,
	      light = (own - black) * (2 / max(black, FLT_MIN));
	return own < black ? -1 : light < 1 ? light : INFINITY;
}

/* Light of the sky, that is seen or mirrored: without end, or as bright as it looks. Nothing is seen of a transparent
 * film. */
static inline float sky_light(const frame *f, metering m, float other, float alpha)
{
	float sky = f->params->tone_sky;
	return sky > 0 && alpha > 0 ? min(exposed(m, max(other, 0)) * sky, FLT_MAX) : INFINITY;
}

/* Mirrors and glass have no light of their own: it becomes that of the thing they show, and the sky's where they show
 * none, as where nothing is, whether it is known what they show or not. What mirrors black is as dark as it looks.
 * Glazed things are mirrors where they show another thing clearly. */
static void mirrored_row(const frame *f, const encre_params *p, int y, int x, int n, const float *restrict other,
			 float (*restrict color)[TONE_CHUNK], const float *restrict glazed, float *restrict light)
{
	const float *seen = layer_row(f, ENCRE_LAYER_SEEN_COLOR, y), *depth = layer_row(f, ENCRE_LAYER_SEEN_DEPTH, y);
	const float *front = layer_row(f, ENCRE_LAYER_DEPTH, y), *gloss = layer_row(f, ENCRE_LAYER_GLOSS, y);
	const float *combined = layer_row(f, ENCRE_LAYER_COMBINED, y) + (ptrdiff_t)4 * x;
	metering m = metering_of(f, p);
	float least = max(p->tone_black, 0.05f), dark = p->tone_dark;
	spared own = spared_of(p);
	for (int i = 0; !seen && front && i < n; i++) {
		bool nothing = !(depth_of(front[x + i]) < INFINITY);
		float sky = sky_light(f, m, other[i], combined[4 * i + 3]);
		light[i] = nothing && max3(color[0][i], color[1][i], color[2][i]) < 0.05f ? sky : light[i];
	}
	for (int i = 0; seen && i < n; i++) {
		const float *s = seen + (ptrdiff_t)3 * (x + i);
		float bright = max3(s[0], s[1], s[2]), lit = exposed(m, bounded(other[i] / max(bright, least)));
		lit = spare(own, lit, bright);
		bool nothing = depth && !(depth_of(depth[x + i]) < INFINITY);
		bool shows = max3(color[0][i], color[1][i], color[2][i]) < 0.05f;
		float shown = tone_looks(p, s[0], s[1], s[2]);
		float share = ISA(tone_counts_as)(p, shown, s[0], s[1], s[2], least, dark);
		lit = shown >= least ? light_left(lit, share, shown, 0, p->tone_form, own.end) : -1;
		if (glazed[i] > 0.5f) {
			float own_depth = depth_of(front[x + i]);
			bool itself = depth && fabsf(depth[x + i] - own_depth) <= 0.02f * own_depth;
			const float *g = gloss + (ptrdiff_t)3 * (x + i);
			shows = shows && !itself && max3(g[0], g[1], g[2]) >= clear_from;
		}
		if (nothing)
			lit = sky_light(f, m, other[i], combined[4 * i + 3]);
		light[i] = !shows ? light[i] : nothing ? lit : max(light[i], lit);
	}
	bool night = ((const tone_frame *)f->tones)->night && front && p->tone_black > 0;
	for (int i = 0; night && i < n; i++) {
		const float *e = combined + (ptrdiff_t)4 * i;
		bool seen_sky = !(depth_of(front[x + i]) < INFINITY) && e[3] > tone_film;
		light[i] = seen_sky ? night_light(p, e[0], e[1], e[2]) : light[i];
	}
}

bool ISA(tone_caught)(const frame *f, int y, int x, int n, bool *caught)
{
	const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y), *d = layer_row(f, ENCRE_LAYER_DIFFUSE, y);
	bool any = false;
	if (!((const tone_frame *)f->tones)->caught)
		return false;
	for (int i = 0; i < n; i++) {
		const float *own = d + (ptrdiff_t)3 * (x + i);
		caught[i] = !(depth_of(depth[x + i]) < INFINITY) && max3(own[0], own[1], own[2]) > 0;
		any |= caught[i];
	}
	return any;
}

/* Light that levels are compared with; what shines or reflects is not in the dark, but for what dark glazed things
 * reflect that is no brighter than full light: the sky alone would cut the sea by the angle it is seen at. Nothing
 * there: INFINITY. */
void ISA(tone_light)(const frame *f, const encre_params *p, int y, int x, int n, float *restrict light)
{
	const float *settled = ((const tone_frame *)f->tones)->settled, *controls = controls_at(f, x, y);
	if (settled) {
		memcpy(light, settled + (ptrdiff_t)y * f->width + x, (size_t)n * sizeof *light);
		return;
	}
	float e[4][TONE_CHUNK], a[3][TONE_CHUNK], d[3][TONE_CHUNK], painted[TONE_CHUNK] = {0}, rest[TONE_CHUNK];
	float glazed[TONE_CHUNK] = {0}, left[TONE_CHUNK];
	metering m = metering_of(f, p);
	float black = p->tone_black, dark = p->tone_dark;
	bool seen = p->tone_black_by == tone_black_by_LUMINANCE;
	spared own = spared_of(p);
	const uint8_t *spotted = ((const tone_frame *)f->tones)->spotted;
	spotted = spotted ? spotted + (ptrdiff_t)y * f->width + x : NULL;
	split(layer_row(f, ENCRE_LAYER_COMBINED, y) + (ptrdiff_t)4 * x, 4, n, e);
	split(layer_row(f, ENCRE_LAYER_COLOR, y) + (ptrdiff_t)3 * x, 3, n, a);
	split(layer_row(f, ENCRE_LAYER_DIFFUSE, y) + (ptrdiff_t)3 * x, 3, n, d);
	for (int i = 0; controls && i < n; i++)
		painted[i] = painted_light(controls, i);
	for (int i = 0; i < n; i++)
		left[i] = 1;
	if (max(black, dark) > 0)
		glazed_row(f, y, x, n, a, glazed, left);
	for (int i = 0; i < n; i++) {
		float bright = max3(a[0][i], a[1][i], a[2][i]);
		float lit = spare(own, exposed(m, max3(d[0][i], d[1][i], d[2][i])), bright) + painted[i];
		float r = e[0][i] - a[0][i] * d[0][i], g = e[1][i] - a[1][i] * d[1][i], b = e[2][i] - a[2][i] * d[2][i];
		float mirrored = glazed[i] * clamp01(tone_lightness(p, r, g, b));
		rest[i] = max3(r, g, b);
		float own_black = seen ? black * left[i] : black, own_dark = seen ? dark * left[i] : dark;
		float own_bright = tone_looks(p, a[0][i], a[1][i], a[2][i]);
		own_black = spotted && !spotted[i] ? 0 : own_black;
		float share = ISA(tone_counts_as)(p, own_bright, a[0][i], a[1][i], a[2][i], own_black, own_dark);
		lit = light_left(lit, share, own_bright, mirrored, p->tone_form, own.end);
		float shine = spotted ? (rest[i] > 0.5f ? rest[i] : -1) : rest[i] - glazed[i];
		light[i] = own_bright < own_black ? max(shine, -1) : max(lit, rest[i]);
	}
	if (p->tone_mirrors)
		mirrored_row(f, p, y, x, n, rest, a, glazed, light);
	bool caught[TONE_CHUNK], any = ISA(tone_caught)(f, y, x, n, caught);
	for (int i = 0; any && i < n; i++)
		light[i] = caught[i] ? exposed(m, max3(d[0][i], d[1][i], d[2][i])) : light[i];
	const float *open = ((const tone_frame *)f->tones)->open;
	open = open ? open + (ptrdiff_t)y * f->width + x : NULL;
	for (int i = 0; open && i < n; i++)
		light[i] = light[i] >= 0 ? max(light[i], open[i]) : light[i];
}

/* How the light passes a threshold: never, in one step, or by and by. */
enum { ALL, STEP, SLOPE };

KERNEL float past(float x, const int how, float threshold, float rate, float steep, float least, float most)
{
	if (how == SLOPE)
		return clamp01((x - threshold) * rate + 0.5f);
	float share = step_passed(x, threshold, steep);
	share = most < threshold ? 0 : share;
	return how != STEP ? 0 : least > threshold ? 1 : share;
}

/* How steep the edges of steps are at n pixels, and the least and most light of each and the four beside it: where all
 * are on one side of a step it has no edge, however much they differ, or dusk between blacks would be gray specks. */
typedef struct edges_of {
	float steep[TONE_CHUNK], least[TONE_CHUNK], most[TONE_CHUNK];
} edges_of;

static void edge_row(const frame *f, const encre_params *p, int y, int x, int n, const float *restrict light,
		     edges_of *e)
{
	float above[TONE_CHUNK], below[TONE_CHUNK], row[TONE_CHUNK + 2];
	ISA(tone_light)(f, p, step_beside(y, -1, f->height), x, n, above);
	ISA(tone_light)(f, p, step_beside(y, 1, f->height), x, n, below);
	ISA(tone_light)(f, p, y, step_beside(x, -1, f->width), 1, row);
	ISA(tone_light)(f, p, y, step_beside(x + n - 1, 1, f->width), 1, row + n + 1);
	memcpy(row + 1, light, (size_t)n * sizeof *row);
	bool spotted = ((const tone_frame *)f->tones)->spotted; /* light beside a black does not run out */
	for (int i = 0; spotted && i < n + 2; i++)
		row[i] = positive(row[i]);
	for (int i = 0; spotted && i < n; i++) {
		above[i] = positive(above[i]);
		below[i] = positive(below[i]);
	}
	for (int i = 0; i < n; i++) {
		e->steep[i] = step_steepness(step_differs(row[i], row[i + 1], row[i + 2]),
					     step_differs(above[i], row[i + 1], below[i]));
		e->least[i] = min(min(min(row[i], row[i + 1]), row[i + 2]), min(above[i], below[i]));
		e->most[i] = max(max(max(row[i], row[i + 1]), row[i + 2]), max(above[i], below[i]));
	}
}

typedef struct band_of_light {
	float in, in_rate, out, out_rate; /* thresholds */
	float base, start, along, fall;   /* the darkness, and how it falls */
} band_of_light;

KERNEL void want_band(const band_of_light *b, const int enters, const int leaves, int n, const float *restrict light,
		      const edges_of *restrict edges, const float *restrict added, float *restrict share,
		      float *restrict sum)
{
	for (int i = 0; i < n; i++) {
		float x = light[i], steep = edges->steep[i], least = edges->least[i], most = edges->most[i];
		float entered = enters == ALL ? 1 : past(x, enters, b->in, b->in_rate, steep, least, most);
		float here = positive(entered - past(x, leaves, b->out, b->out_rate, steep, least, most));
		share[i] += here;
		sum[i] += here * clamp01(b->base - b->fall * clamp01((x - b->start) * b->along) + added[i]);
	}
}

static bool is_step(const encre_level *l)
{
	return !(l->transition > 1e-30f);
}

static void want_level(const encre_params *p, int level, float gradient, int n, const float *restrict light,
		       const edges_of *restrict edges, const float *restrict added, float *restrict share,
		       float *restrict sum)
{
	const encre_level *own = p->shade_levels.level + level, *next = own + 1;
	bool last = level == p->shade_levels.count - 1;
	int enters = level == 0 ? ALL : is_step(own) ? STEP : SLOPE;
	int leaves = last ? ALL : is_step(next) ? STEP : SLOPE;
	float start = level == 0 ? 0 : own->threshold, span = last ? 0 : next->threshold - start;
	band_of_light b = {
		.in = start,
		.in_rate = enters == SLOPE ? 1 / own->transition : 0,
		.out = last ? 0 : next->threshold,
		.out_rate = leaves == SLOPE ? 1 / next->transition : 0,
		.base = 1 - own->intensity + p->tone_darkness,
		.start = start,
		.along = span > 1e-30f ? 1 / span : 0,
		.fall = last ? 0 : gradient * (next->intensity - own->intensity),
	};
#define CASE(in, out)                                                                                                  \
	if (enters == in && leaves == out)                                                                             \
		want_band(&b, in, out, n, light, edges, added, share, sum);
	CASE(ALL, ALL)
	CASE(ALL, STEP)
	CASE(ALL, SLOPE)
	CASE(STEP, ALL)
	CASE(STEP, STEP)
	CASE(STEP, SLOPE)
	CASE(SLOPE, ALL)
	CASE(SLOPE, STEP)
	CASE(SLOPE, SLOPE)
#undef CASE
}

/* The mean darkness of what is there, from sums. sky: it is there, too; solid: as ink or paper, for no tone has where
 * to stick to. */
static void finish(const float *restrict depth, const bool *restrict caught, bool sky, bool solid, int n,
		   float *restrict share, float *restrict dark)
{
	for (int i = 0; i < n; i++) {
		int there = sky | caught[i] | ((depth[i] > 0) & (depth[i] < depth_end));
		float own = there ? share[i] : 0;
		dark[i] = own > 0 ? clamp01(dark[i] / max(own, FLT_MIN)) : 0;
		share[i] = most_one(own);
	}
	for (int i = 0; sky && solid && i < n; i++)
		dark[i] = caught[i] || depth_of(depth[i]) < INFINITY ? dark[i] : dark[i] >= 0.5f ? 1 : 0;
}

/* A stroke here and there shades nothing: on a wall in full light it is rain. */
static void few(int n, float *restrict dark)
{
	static const float none = 0.02f, all = 0.05f;
	for (int i = 0; i < n; i++)
		dark[i] *= clamp01((dark[i] - none) * (1 / (all - none)));
}

/* What is cleared as a whole has smaller dots and fewer strokes until it has none. What can't be less dark without
 * being grey is there or not. */
static void clear(const uint8_t *restrict keep, const uint8_t *restrict ease, bool eases, int n, float *restrict share,
		  float *restrict dark)
{
	for (int i = 0; i < n; i++) {
		float left = (float)ease[i] * (1.0f / 255), whole = ease[i] > 127 ? 1 : 0;
		dark[i] *= eases ? left : 1;
		share[i] *= (float)keep[i] * (1.0f / 255) * (eases ? 1 : whole);
	}
}

/* Small blacks have a tone of their own, and no other. */
static void want_blacks(const frame *f, const encre_params *p, const tone_slot *slots, int y, int x, int n,
			const float *restrict light, tone_wanted *w)
{
	int own = slots->like;
	float dark = clamp01(1 + p->tone_darkness);
	const uint8_t *spotted = ((const tone_frame *)f->tones)->spotted + (ptrdiff_t)y * f->width + x;
	if (!memchr(spotted, TONE_SPOTTED, (size_t)n))
		return;
	if (slots->kind != tone_1_NONE && !w->any[own]) {
		memset(w->share[own], 0, (size_t)n * sizeof *w->share[own]);
		memset(w->dark[own], 0, (size_t)n * sizeof *w->dark[own]);
		w->any[own] = true;
	}
	for (int k = 0; k < TONE_SLOTS; k++)
		for (int i = 0; w->any[k] && i < n; i++) {
			bool black = spotted[i] && light[i] < 0;
			w->share[k][i] = black ? k == own : w->share[k][i];
			w->dark[k][i] = !black ? w->dark[k][i] : k == own ? dark : 0;
		}
}

void ISA(tone_want)(const frame *f, const encre_params *p, const tone_slot *slots, int y, int x, int n, tone_wanted *w)
{
	float light[TONE_CHUNK] = {0}, added[TONE_CHUNK], none[TONE_CHUNK];
	edges_of edges;
	bool steps = false;
	const float *controls = controls_at(f, x, y), *depth = layer_row(f, ENCRE_LAYER_DEPTH, y) + x;
	ISA(tone_light)(f, p, y, x, n, light);
	for (int level = 1; level < p->shade_levels.count; level++)
		steps |= is_step(p->shade_levels.level + level) && !p->tone_crisp;
	for (int i = 0; i < n; i++) {
		edges.steep[i] = 0;
		edges.least[i] = edges.most[i] = light[i];
	}
	if (steps)
		edge_row(f, p, y, x, n, light, &edges);
	for (int i = 0; i < n; i++)
		added[i] = none[i] = 0;
	for (int i = 0; controls && i < n; i++)
		added[i] = controls[CONTROL_COUNT * i + CONTROL_HATCHING];
	for (int k = 0; k < TONE_SLOTS; k++)
		w->any[k] = false;
	for (int level = 0; level < p->shade_levels.count; level++) {
		const tone_slot *own = slots + slot_of(f, level);
		int k = own->like;
		if (own->kind == tone_1_NONE)
			continue;
		if (!w->any[k]) {
			memset(w->share[k], 0, (size_t)n * sizeof *w->share[k]);
			memset(w->dark[k], 0, (size_t)n * sizeof *w->dark[k]);
		}
		w->any[k] = true;
		want_level(p, level, own->gradient, n, light, &edges, own->kind == tone_1_GRAIN ? none : added,
			   w->share[k], w->dark[k]);
	}
	if (tone_spots_small(f))
		want_blacks(f, p, slots, y, x, n, light, w);
	const tone_frame *t = f->tones;
	bool caught[TONE_CHUNK] = {false};
	ISA(tone_caught)(f, y, x, n, caught);
	const tone_detail *detail = &t->detail;
	bool shows_sky = p->tone_mirrors && (f->params->tone_sky > 0 || (t->night && p->tone_black > 0));
	size_t at = (size_t)y * (size_t)f->width + (size_t)x;
	for (int k = 0; k < TONE_SLOTS; k++) {
		if (!w->any[k])
			continue;
		finish(depth, caught, shows_sky, tone_sticks(slots + k), n, w->share[k], w->dark[k]);
		if (slots[k].kind == tone_1_HATCH)
			few(n, w->dark[k]);
		if (detail->keep)
			clear(detail->keep + at, detail->ease + at, tone_is_screen(slots + k) || tone_marked(slots + k),
			      n, w->share[k], w->dark[k]);
		w->any[k] = tone_any(w->dark[k], n);
	}
}
