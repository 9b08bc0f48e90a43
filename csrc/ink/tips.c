/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From sites and links to what is drawn of them: how wide, dark and where each link ends, by pen, hand and stroke. */
#include "ink/discs.h"
#include "ink/tips.h"
#include "ink/pen.h"
#include "ink/strips.h"
#include "ink/thickets.h"
#include "ink/turns.h"
#include "fine/near.h"

enum { CHUNK = 1024, AHEAD = 16 };

/* Of half a line's width the rim is frayed by this share at most, or thin lines would come to pieces. */
static const float most_frayed = 0.08f;

/* How much of that is left of a line in its room: none where it takes half of that, or beside another it would be
 * beads. */
static float frayed_in(float crowd, float radius)
{
	return clamp01(2 - 4 * radius * crowd);
}

/* ---- pens ------------------------------------------------------------------------------------------------ */

typedef struct gather {
	frame *f;
	const fine *n;
	capsules *all;
	pens *pens;     /* by style */
	uint8_t *whose; /* by site, which of its style's pens draws it */
	bool varied;    /* some hand's noise is asked for */
	bool second;    /* lines have another ink in the dark */
	bool bounded;   /* lines may cover so much of the picture only */
	bool fewer;     /* for that, some of them are left out */
	bool pressed;   /* and hands press more here and less there */
	bool parted;    /* dashes or pictures lie along lines */
	uint32_t strokes;
	spots at;    /* of all sites; NULL without noise */
	beats beats; /* unset unless lines are parted */
	turns turns; /* no corners are looked for where no pen asks */
	uint32_t stroke;
	pen_end *end;                 /* of this stroke */
	const strip *(*strips)[PENS]; /* by style */
	float *farther;               /* by site: pixels that a stroke goes on beyond a corner; NULL: no pen does */
	float *length;                /* to the nearest free end, by site; NULL where no line tapers */
	float *kept;                  /* by site: what of its line is not left out; NULL: all */
	float *press;                 /* by site: how much of its hand's pressure varies; NULL: all */
	float *radius;                /* by site: evened along its line, before it tapers or is crowded */
} gather;

/* What the pen gives before its line is evened: `out` is its radius, `fade` the share of that. Tells whose hand it is.
 */
static pen_end pen_end_of(const gather *g, const site *made, uint8_t *whose)
{
	const frame *f = g->f;
	const placed *s = &made->placed;
	pen pen;
	pen_end e = {.x = s->x, .y = s->y};
	*whose = 0;
	if (!ISA(pen_of)(f, s->near_x, s->near_y, (enum source)s->source, s->strength, &pen))
		return e;
	const pens *all = g->pens + (pen.p - f->params);
	if (all->differ || pen.p->line_contact_width != 1 || pen.p->line_intersection_width != 1 ||
	    pen.p->line_outer_width != 1) {
		enum line kind = ISA(line_of)(f, made);
		*whose = all->of[kind];
		pen.radius = min(pen.radius * ISA(line_width)(f, pen.p, made, kind) * all->hand[*whose].pen_width,
				 0.5f * f->params->line_thickest * f->scale);
	}
	const hand *h = all->hand + *whose;
	if (*whose) {
		float intensity = min(pen.pressed * h->pen_intensity, 1e30f);
		pen.gain = min(h->pen_steepness * intensity, 1e30f);
		pen.bias = max(0, 1 - 0.5f * intensity);
	}
	e.out = pen.radius * (1 - (float)s->eased / 255);
	e.fade = h->pen_softness;
	e.gain = pen.gain;
	e.ease = pen.gain > 0 ? min(1 / pen.gain, 1e30f) : 0;
	e.bias = pen.bias;
	e.paper = h->pen_grain;
	e.limit = min(pen.limit, 1e30f); /* finite: it is interpolated */
	return e;
}

static const hand *hand_of(const gather *g, uint32_t i)
{
	const placed *s = &g->n->site[i].placed;
	return g->pens[style_at(g->f, s->near_x, s->near_y)].hand + g->whose[i];
}

static bool inks(const frame *f, const site *made)
{
	return params_at(f, made->placed.near_x, made->placed.near_y)->use_lines;
}

/* Half the width beside a place where dashes part: caps of lines are round, so space is left for these. */
static float dashed(const frame *f, const hand *h, const beat *b, float radius)
{
	if (!(b->length > 0))
		return radius;
	float space = 0.5f * min(h->pen_dash_space * f->scale + 2 * radius, b->length - 1);
	float whole = clamp01(b->whole - space + 0.5f), half = clamp01(b->half - b->born * space + 0.5f);
	return radius * whole * mix(1, half, min(1, b->born * space));
}

/* `radius`: evened along the line. t: what the hand does to it, or NULL. Whether a thing's two lines are one is asked
 * of an even hand that presses as hard as this one: or a wire would be one line here and two hairs there. */
static void finish(const frame *f, const site *made, const hand *h, float radius, float length, float kept,
		   const touch *t, const beat *b, pen_end *e)
{
	const placed *s = &made->placed;
	float crowd = made->linked.crowd, even = e->out, lift = 1;
	if (!inks(f, made))
		return;
	float taper = h->pen_taper * f->scale;
	if (t) {
		float frayed = frayed_in(crowd, max(radius, even)),
		      whole = max(radius + frayed * t->rough * min(t->fray, most_frayed * radius), 0);
		radius = dashed(f, h, b, whole * t->left);
		lift = whole > 0 ? radius / whole : 0;
		even += h->pen_pressure * even + min(t->fray, most_frayed * even);
	}
	if (length < taper) {
		radius *= length / taper;
		lift *= length / taper;
	}
	if (radius * crowd > 1)
		radius = 1 / crowd;
	radius *= kept;
	lift *= kept;
	if (even * crowd > 1)
		even = 1 / crowd;
	float filled = filled_by(made, even);
	if (made->found.axis == AXIS_ROW)
		e->x += filled * s->inside;
	else
		e->y += filled * s->inside;
	if (t) {
		e->x += t->dx;
		e->y += t->dy;
		e->bristles = h->pen_dry > 0 ? STREAKS : 0;
	}
	e->out = lift * filled * s->half + radius;
	e->fade *= radius;
	float ramp = min(e->ease, 1 - e->bias),
	      middle = e->out - e->fade * (e->bias + 0.5f * ramp); /* on the highest paper */
	if (ramp > 0 && middle > 0)
		e->reach = max(middle, 0.5f) + 0.5f * max(e->fade * ramp, 1);
}

/* What the pen gives all strokes before their lines are evened. */
static void make_pens(void *data, int first, int end, int thread)
{
	(void)thread;
	const gather *g = data;
	for (int i = first; i < end && !stopped_at(g->n, i); i++) {
		const site *made = g->n->site + i;
		if (i + AHEAD < end) {
			const placed *next = &made[AHEAD].placed;
			__builtin_prefetch(layer_row(g->f, ENCRE_LAYER_DEPTH, next->near_y) + next->near_x);
		}
		if (made->linked.dropped) {
			g->whose[i] = 0;
			continue;
		}
		pen_end drawn = pen_end_of(g, made, g->whose + i), none = {.x = made->placed.x, .y = made->placed.y};
		uint32_t strokes = (uint32_t)hand_of(g, (uint32_t)i)->pen_strokes;
		for (uint32_t k = 0; k < g->strokes; k++)
			g->all->end[(size_t)k * g->n->count + (size_t)i] = k < strokes ? drawn : none;
	}
	if (g->at.x) {
		spots to = spots_from(&g->at, (size_t)first);
		ISA(spots_fill)(g->f, g->n->site + first, end - first, &to);
	}
}

/* The hands of the sites from i on, at most SPAN; returns how many. */
static int hands_from(const gather *g, int i, int end, strokes *s)
{
	int n = end - i < SPAN ? end - i : SPAN;
	s->at = spots_from(&g->at, (size_t)i);
	s->stroke = (int)g->stroke;
	for (int k = 0; k < n; k++) {
		const placed *at = &g->n->site[i + k].placed;
		s->hand[k] = hand_of(g, (uint32_t)(i + k));
		s->again[k] = g->pens[style_at(g->f, at->near_x, at->near_y)].again[g->whose[i + k]];
	}
	return n;
}

/* Ink gathers from a turn of 60 degrees on, all of it at one of 120. Turns and bends are not known where only styles
 * without lines ask for them: those draw nothing. */
static float swollen(const gather *g, uint32_t i, const hand *h)
{
	float pool = g->turns.turn ? h->pen_pool * clamp01(g->turns.turn[i] - 0.5f) : 0,
	      curve = g->turns.bend ? h->pen_curve * g->turns.bend[i] : 0;
	return (1 + pool) * (1 + curve);
}

static void press_pens(void *data, int first, int end, int thread)
{
	(void)thread;
	const gather *g = data;
	float most = 0.5f * g->f->params->line_thickest * g->f->scale, factor[SPAN];
	for (int i = first, n; i < end && !bands_stopped(g->f->bands); i += n) {
		strokes s;
		n = hands_from(g, i, end, &s);
		for (int k = 0; k < n; k++)
			factor[k] = 1;
		if (g->at.x)
			ISA(pen_pressures)(&s, n, factor);
		for (int k = 0; g->press && k < n; k++)
			factor[k] = mix(1, factor[k], g->press[i + k]);
		for (int k = 0; k < n; k++) {
			g->radius[i + k] = g->n->site[i + k].linked.dropped ? 0 : g->end[i + k].out;
			float swell = swollen(g, (uint32_t)(i + k), s.hand[k]);
			if (s.hand[k]->pen_pressure > 0 || swell != 1)
				g->radius[i + k] = min(g->radius[i + k] * factor[k] * swell, most);
		}
	}
}

/* Where a site lies in the strip of its pen: between .7 and 1.4 times as long as was asked for. */
static strip_end strip_end_of(const gather *g, uint32_t i, const hand *h)
{
	const placed *at = &g->n->site[i].placed;
	strip_end e = {.of = g->strips[style_at(g->f, at->near_x, at->near_y)][g->whose[i]]};
	if (!e.of)
		return e;
	e.left = 1 - h->pen_strip;
	beat b = ISA(beat_of)(&g->beats, i, 0.70710678f * h->pen_strip_length * g->f->scale);
	e.at = b.at;
	e.octave = b.octave;
	e.length = b.length * (1 + b.born);
	/* of two lengths at once nothing would be seen, so each piece has its own time to become two */
	float hash = (float)(int32_t)(mix_bits((uint32_t)b.number) >> 8) * (1.0f / 16777216);
	e.born = clamp01((b.born - 0.15f - 0.7f * hash) * 8 + 0.5f);
	return e;
}

/* How far strokes of a line go on beyond corners. */
static float overshoot_of(const site *s, const hand *h)
{
	return h->pen_overshoot * (is_colored(s) ? h->pen_overshoot_color : 1);
}

static void finish_pens(void *data, int first, int end, int thread)
{
	(void)thread;
	const gather *g = data;
	touch touches[SPAN];
	for (int i = first, n; i < end && !bands_stopped(g->f->bands); i += n) {
		strokes s;
		n = hands_from(g, i, end, &s);
		if (g->at.x)
			ISA(pen_touches)(g->f, &s, n, touches);
		for (int k = 0; k < n; k++) {
			const site *made = g->n->site + i + k;
			size_t at = (size_t)g->stroke * g->n->count + (size_t)(i + k);
			const hand *h = s.hand[k];
			bool drawn = g->stroke < (uint32_t)h->pen_strokes;
			const touch *t = drawn && inks(g->f, made) && ISA(pen_varies)(h) ? touches + k : NULL;
			if (made->linked.dropped)
				continue;
			beat beat = {0};
			if (t && h->pen_dash > 0)
				beat = ISA(beat_of)(&g->beats, (uint32_t)(i + k),
						    (h->pen_dash + h->pen_dash_space) * g->f->scale);
			if (drawn)
				finish(g->f, made, h, g->radius[i + k], g->length ? g->length[i + k] : INFINITY,
				       g->kept ? g->kept[i + k] : 1, t, &beat, g->end + i + k);
			if (g->farther)
				g->farther[i + k] = t && drawn ? t->farther * overshoot_of(made, h) * g->f->scale : 0;
			if (g->all->dry && t)
				memcpy(g->all->dry[at], t->ink, sizeof t->ink);
			if (g->all->strip)
				g->all->strip[at] = t ? strip_end_of(g, (uint32_t)(i + k), h) : (strip_end){0};
			if (g->all->ink)
				ISA(line_ink)(g->f, made, g->all->ink[at]);
		}
	}
}

/* A stroke's end beyond a corner, where the pen is lifted: never farther than this share of the stroke, or what is tiny
 * bristles. */
static const float most_beyond = 0.2f;

static void go_on(const gather *g, uint32_t k)
{
	static const float lifted = 0.35f;
	const spur *s = g->all->spur + k;
	size_t from = (size_t)g->stroke * g->n->count + s->site, to = spur_end(g->all, g->stroke, k);
	pen_end *e = g->all->end + to;
	*e = g->all->end[from];
	float far = min(g->farther[s->site], most_beyond * s->room);
	if (g->n->site[s->site].linked.dropped || !(far > 0.5f) || !(e->reach > 0)) {
		e->reach = 0;
		return;
	}
	e->limit = g->end[s->back].limit; /* where lines meet, they have that of the nearest */
	e->x += far * s->dx;
	e->y += far * s->dy;
	e->out *= lifted;
	e->fade *= lifted;
	if (g->all->dry)
		memcpy(g->all->dry[to], g->all->dry[from], sizeof *g->all->dry);
	if (g->all->strip)
		g->all->strip[to] = g->all->strip[from];
	if (g->all->ink)
		memcpy(g->all->ink[to], g->all->ink[from], sizeof *g->all->ink);
}

/* The ends of one stroke. */
static int32_t make_stroke(gather *g, uint32_t stroke)
{
	frame *f = g->f;
	g->stroke = stroke;
	g->end = g->all->end + (size_t)stroke * g->n->count;
	g->radius = late_take(&f->late, g->n->count, sizeof *g->radius);
	if (!g->radius)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)g->n->count, CHUNK, press_pens, g);
	if (!code)
		code = ISA(capsules_even)(f, &g->radius);
	if (!code)
		code = bands_run(f->bands, (int)g->n->count, CHUNK, finish_pens, g);
	if (!code && g->second)
		code = ISA(second_ink)(f, g->end, g->all->ink + (size_t)stroke * g->n->count);
	for (uint32_t k = 0; !code && k < g->all->spurs; k++)
		go_on(g, k);
	late_drop(&f->late, g->radius);
	return code;
}

static int32_t make_strokes(gather *g)
{
	frame *f = g->f;
	if (g->varied) {
		size_t count = g->n->count;
		float *at = late_take(&f->late, 4 * count, sizeof *at);
		if (!at)
			return ENCRE_ERROR_MEMORY;
		g->at = (spots){at, at + count, at + 2 * count, at + 3 * count};
	}
	g->whose = late_take(&f->late, g->n->count, sizeof *g->whose);
	g->kept = g->fewer ? late_take(&f->late, g->n->count, sizeof *g->kept) : NULL;
	g->press = g->pressed ? late_take(&f->late, g->n->count, sizeof *g->press) : NULL;
	if (!g->whose || (g->fewer && !g->kept) || (g->pressed && !g->press))
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)g->n->count, CHUNK, make_pens, g);
	if (!code && g->pressed)
		code = ISA(thickets_press)(f, g->all->end, g->press);
	if (!code && g->bounded)
		code = ISA(thickets_thin)(f, g->strokes, &g->at, g->all->end, g->kept);
	if (!code && g->parted)
		code = ISA(beats_find)(f, &g->at, &g->beats);
	for (uint32_t k = 0; !code && k < g->strokes; k++)
		code = make_stroke(g, k);
	late_drop(&f->late, g->beats.step);
	late_drop(&f->late, g->press);
	late_drop(&f->late, g->kept);
	late_drop(&f->late, g->whose);
	late_drop(&f->late, g->at.x);
	late_drop(&f->late, g->pens);
	return code;
}

int32_t ISA(capsules_gather)(frame *f, bool inked, capsules *all)
{
	const fine *n = f->fine;
	gather g = {.f = f, .n = n, .all = all, .strokes = 1};
	bool dry = false, moved = false, striped = false;
	float taper = 0, farther = 0;
	bool pooled = false, curved = false;
	g.pens = late_take(&f->late, (size_t)f->n_styles, sizeof *g.pens);
	if (!g.pens)
		return ENCRE_ERROR_MEMORY;
	for (int i = 0; i < f->n_styles; i++) {
		g.pens[i] = ISA(pens_of)(f, f->params + i);
		uint32_t strokes = ISA(pens_strokes)(g.pens + i);
		bool bounded = f->params[i].use_lines && f->params[i].line_density < 1;
		g.bounded |= bounded;
		g.fewer |= bounded && f->params[i].line_fewer > 0;
		g.second |= ISA(takes_second)(f->params + i);
		for (int k = 0; f->params[i].use_lines && k < PENS; k++) {
			const hand *h = g.pens[i].hand + k;
			if (!(g.pens[i].used >> k & 1))
				continue;
			g.strokes = strokes > g.strokes ? strokes : g.strokes;
			g.varied |= ISA(pen_varies)(h);
			g.pressed |= bounded && h->pen_pressure > 0;
			dry |= h->pen_dry > 0;
			striped |= h->pen_strip > 0;
			g.parted |= h->pen_strip > 0 || h->pen_dash > 0;
			moved |= h->pen_wobble > 0;
			taper = max(taper, h->pen_taper * f->scale);
			farther = max(farther, h->pen_overshoot * f->scale);
			pooled |= h->pen_pool > 0;
			curved |= h->pen_curve != 0;
		}
	}
	g.varied |= g.fewer;
	int32_t code = farther > 0 || pooled ? ISA(turns_find)(f, 6 * farther, &g.turns) : ENCRE_OK;
	if (!code && curved)
		code = ISA(curves_find)(f, &g.turns);
	if (!code && striped)
		code = ISA(strips_make)(f, g.pens, &g.strips);
	if (code)
		return code;
	size_t ends = (size_t)g.strokes * ((size_t)n->count + g.turns.spurs);
	if (ends > UINT32_MAX)
		return ENCRE_ERROR_MEMORY;
	all->count = n->count;
	all->spur = g.turns.spur;
	all->spurs = g.turns.spurs;
	all->strokes = g.strokes;
	all->ends = g.strokes * n->count;
	g.farther = g.turns.spurs ? late_take(&f->late, n->count, sizeof *g.farther) : NULL;
	all->moved = moved;
	size_t bands = (size_t)(f->height - 1) / BAND + 1;
	all->end = late_take(&f->late, ends, sizeof *all->end);
	all->ink = inked ? late_take(&f->late, ends, sizeof *all->ink) : NULL;
	all->dry = dry ? late_take(&f->late, ends, sizeof *all->dry) : NULL;
	all->strip = striped ? late_take(&f->late, ends, sizeof *all->strip) : NULL;
	all->first = late_take(&f->late, bands + 1, sizeof *all->first);
	if (!all->end || !all->first || (g.turns.spurs && !g.farther) || (inked && !all->ink) || (dry && !all->dry) ||
	    (striped && !all->strip))
		return ENCRE_ERROR_MEMORY;
	if (taper > 0) {
		g.length = late_take(&f->late, n->count, sizeof *g.length);
		if (!g.length)
			return ENCRE_ERROR_MEMORY;
		code = ISA(fine_free_lengths)(n, taper, g.length);
		if (code)
			return code;
	}
	code = make_strokes(&g);
	return code ? code : ISA(capsules_list)(f, g.strokes, all);
}
