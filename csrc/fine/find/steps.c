/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where exactly a ridge lies between pixels, and how strong it is: the shares of what lies on both sides in the pixels
 * between tell how far into them a boundary reaches. */
#include "fine/near.h"
#include "base/metric.h"

static const float least_of_step = 0.4f; /* share of a step that slopes beside it may not explain; test_fine_sites */
static const float alike = 1.5f; /* times the width of a stripe, the most of what is one beside it; test_fine_sites */
static const float least_gain = 0.667f; /* test_scale */
static const float least_turn = 0.3f;   /* of what changes near a site, on both sides of a pixel; test_fine_passes */
/* Where a step has one pixel beside it up to what holds two surfaces: so many times what changes beyond its other side
 * is a surface that turns away, and so far from its middle the last pixel is of one face; test_fine_sites */
static const float turns_away = 2.5f, clear_of_last = 0.47f;
static const float crease_ramp = 0.37f; /* of the difference of normals at crease_angle; test_fine_sites */
static const float seen_jump_from = 0.1f, seen_jump_ramp = 0.03f; /* of a depth; test_fine_sites */

/* The value of pixel x, y, which lies at `in`, in linear terms. */
static inline void read(const fine *n, enum form form, const float *in, int x, int y, float *value)
{
	if (form == FORM_DISTANCE)
		value[0] = seen_sample(n->e, in[0]);
	else if (form == FORM_LIGHT)
		value[0] = bounded(exposed_at(n->f, params_at(n->f, x, y), x, y));
	else
		for (int c = 0; c < 3; c++)
			value[c] = form == FORM_COLOR ? clamp01(in[c]) : bounded(in[c]);
}

/* Values at -reach..reach along the axis of a site, read outwards up to where a pixel holds two surfaces: so far they
 * go. */
static void read_along(const fine *n, int source, const found *at, int reach, float (*value)[3], int *far)
{
	const frame *f = n->f;
	const sample_info *is = samples + source;
	bool lit = source == SOURCE_COLOR && n->e->p->color_layer == color_layer_LIT;
	plane from = f->layer[lit ? ENCRE_LAYER_COMBINED : is->layer];
	int channels = lit ? 4 : is->form == FORM_DISTANCE ? 1 : 3, x = at->column, y = at->row;
	read(n, is->form, from.data + y * from.row + (ptrdiff_t)channels * x, x, y, value[reach]);
	for (int side = -1; side <= 1; side += 2) {
		int held = 0;
		for (int k = 1; k <= reach; k++) {
			x = at->axis ? x : clamp_index(at->column + side * k, f->width);
			y = at->axis ? clamp_index(at->row + side * k, f->height) : y;
			held += held == k - 1 && !closed_at(n, source, x, y);
			if (held == k)
				read(n, is->form, from.data + y * from.row + (ptrdiff_t)channels * x, x, y,
				     value[reach + side * k]);
			else
				memcpy(value[reach + side * k], value[reach + side * held],
				       (size_t)is->planes * sizeof **value);
		}
		far[side > 0] = held;
	}
}

/* How much of the first of two values is in a mixture of them. */
static float share(const float *value, const float *first, const float *second, int planes)
{
	float dot = 0, square = 0;
	for (int c = 0; c < planes; c++) {
		dot += (value[c] - second[c]) * (first[c] - second[c]);
		square += (first[c] - second[c]) * (first[c] - second[c]);
	}
	return square > 0 ? clamp01(dot / square) : 0.5f;
}

/* `count` colours, at most 8, in the space of the metric. */
static void encode(const fine *n, float (*value)[3], int count)
{
	enum { RUN = 8 }; /* as many at once take less time than five */
	float plane[3][RUN];
	for (int k = 0; k < RUN; k++)
		for (int c = 0; c < 3; c++)
			plane[c][k] = value[k < count ? k : count - 1][c];
	ISA(metric_space)(n->e->p->contrast_metric, RUN, plane[0], plane[1], plane[2]);
	for (int k = 0; k < count; k++)
		for (int c = 0; c < 3; c++)
			value[k][c] = plane[c][k];
}

float ISA(color_strength)(const fine *n, const found *at, int sample, float difference)
{
	float full = full_contrast(n->e, sample, at->column, at->row);
	return metric_strength(difference, n->e->p->contrast_threshold, full);
}

/* Which values stand for the two sides of a step: the outer ones, unless the step is one side of a stripe. */
static void sides(float (*value)[3], int planes, int *low, int *high)
{
	bool inner = distance2(value[1], value[3], planes) > distance2(value[0], value[4], planes);
	*low = inner ? 1 : 0;
	*high = inner ? 3 : 4;
}

static void put(const found *at, float offset, placed *s)
{
	offset = offset < -1 ? -1 : offset > 1 ? 1 : offset;
	s->x = (float)at->column + (at->axis ? 0 : on_grid(offset));
	s->y = (float)at->row + (at->axis ? on_grid(offset) : 0);
}

/* Where light passes a threshold between two of five pixels, nearest to the third; INFINITY: it does not. */
static float passes_at(float (*value)[3], float threshold)
{
	float best = INFINITY;
	for (int k = 0; k < 4; k++) {
		float one = value[k][0] - threshold, two = value[k + 1][0] - threshold;
		float offset = (float)(k - 2) + one / (one - two);
		if ((one > 0) != (two > 0) && fabsf(offset) < fabsf(best))
			best = offset;
	}
	return best;
}

/* Where light steps over a threshold the fill of a level ends: the line runs there, and not in the step's middle. Where
 * pixels have averaged a hard edge light is not linear between two of them: about its half the place is as far off as
 * that of its half is from the middle. */
static void put_threshold(const found *at, float (*value)[3], float threshold, float middle, placed *s)
{
	float place = passes_at(value, threshold), step = value[4][0] - value[0][0];
	float half = passes_at(value, value[0][0] + 0.5f * step);
	float slopes = fabsf(value[1][0] - value[0][0]) + fabsf(value[4][0] - value[3][0]);
	if (!(place < INFINITY))
		return;
	if (half < INFINITY && fabsf(step) > 0) {
		float off = fabsf((threshold - value[0][0]) / step - 0.5f);
		place += clamp01(1 - 4 * slopes / fabsf(step)) * clamp01(1 - 8 * off) * (middle - half);
	}
	put(at, place, s);
}

float ISA(color_turns)(const fine *n, const found *at)
{
	enum { LOOK = 8, NEAR = 2 };
	float value[2 * LOOK + 1][3], most = 0, turns = 0;
	int far[2];
	read_along(n, families[at->family].sample, at, LOOK, value, far);
	for (int k = LOOK - NEAR; k <= LOOK + NEAR; k++)
		most = max(most, distance2(value[k], value[LOOK], 3));
	float least = least_turn * least_turn * most;
	for (int k = 1; k < 2 * LOOK; k++) {
		const float *a = value[k - 1], *b = value[k], *c = value[k + 1];
		float dot = 0;
		for (int i = 0; i < 3; i++)
			dot += (b[i] - a[i]) * (c[i] - b[i]);
		turns += dot < 0 && distance2(a, b, 3) > least && distance2(b, c, 3) > least;
	}
	return turns / (float)(far[0] + far[1] + 1);
}

static bool may_be_weak(const fine *n, const found *at, const placed *s)
{
	return families[at->family].faint && s->strength > 0 && s->strength >= least_faint * n->e->p->edge_threshold;
}

/* As fine_weigh(); what is seen counts as far as it stands out, which is asked only where it matters. */
static bool weigh(const fine *n, const found *at, placed *s, int style, float strength)
{
	const family_info *is = families + at->family;
	if (is->sample == SOURCE_NORMAL && n->replaced &&
	    (n->replaced[(ptrdiff_t)at->row * n->f->width + at->column] & 1))
		return ISA(fine_weigh_by)(n, s, n->e->bump[style], SOURCE_NORMAL, strength);
	enum source source = is->sample < SOURCE_SEEN ? is->sample : SOURCE_SEEN;
	bool edge = ISA(fine_weigh)(n, s, style, source, strength);
	if (is->word != WORD_MORE || !(edge || may_be_weak(n, at, s)))
		return edge;
	s->strength = 0;
	return ISA(fine_weigh)(n, s, style, source, strength * ISA(seen_clarity)(n, at, is->sample));
}

/* Likewise; what is not as strong as an edge may be weak. */
static bool weigh_weak(const fine *n, const found *at, placed *s, int style, float strength)
{
	bool edge = weigh(n, at, s, style, strength);
	s->weak |= !edge;
	return edge || may_be_weak(n, at, s);
}

/* Whether what lies on both sides of a stripe is about as narrow as itself: of checks neither colour is a ground, and
 * each boundary is a line. Boundaries are where values are halfway between stripe and ground. */
static bool among_alike(const fine *n, int source, const found *at)
{
	enum { LOOK = 6 };
	float value[2 * LOOK + 1][3], base[3], along[3], square = 0,
							 edge[2][2] = {{INFINITY, INFINITY}, {INFINITY, INFINITY}};
	int far[2];
	read_along(n, source, at, LOOK, value, far);
	for (int c = 0; c < 3; c++) {
		base[c] = 0.5f * (value[LOOK - 2][c] + value[LOOK + 2][c]);
		along[c] = value[LOOK][c] - base[c];
		square += along[c] * along[c];
	}
	for (int side = 0; side < 2; side++) {
		float before = 0.5f * square;
		for (int k = 1, found = 0; k <= LOOK && found < 2; k++) {
			const float *v = value[LOOK + (side ? k : -k)];
			float beyond = -0.5f * square;
			for (int c = 0; c < 3; c++)
				beyond += (v[c] - base[c]) * along[c];
			if ((beyond < 0) != (before < 0))
				edge[side][found++] = (float)k - beyond / (beyond - before);
			before = beyond;
		}
	}
	float most = alike * (edge[0][0] + edge[1][0]);
	return edge[0][1] - edge[0][0] < most && edge[1][1] - edge[1][0] < most;
}

/* Of how many pixels a stripe's strength is the sum: in px, so that it is a line at all sizes of the frame or at none.
 * In small frames that is at most twice what the pixel in its middle shows, and in large ones two thirds at least of
 * what it would be in pixels: what is clear there is no hair. */
static float stripe_gain(const fine *n, const stripe *b)
{
	float in_px = 1 / n->f->scale;
	return in_px < 1 ? max(in_px, least_gain) : max(1, min(in_px, 2 * b->peak / b->area));
}

/* How much wider than the widest a stripe of light is one line, too, where it goes on beside one that is narrow enough:
 * so much samples of a pixel are off by. */
static const float light_slack = 0.2f; /* test_fine_sites */

/* How wide a stripe is, by what it lies on beyond the outer two of five values, which may be a part of it. value: of
 * seven pixels. */
static float stripe_width(float (*value)[3], int planes, const stripe *b)
{
	float along[7] = {0}, base[2];
	for (int c = 0; c < planes; c++) {
		float way = b->e[c] / b->area;
		for (int k = 0; k < 7; k++)
			along[k] += way * value[k][c];
	}
	for (int side = 0; side < 2; side++) {
		float inner = along[side ? 4 : 2], near = along[side ? 5 : 1], far = along[side ? 6 : 0];
		base[side] = near < inner ? min(near, far) : near;
	}
	float area = 0;
	for (int k = 1; k < 6; k++)
		area += along[k] - mix(base[0], base[1], (float)k / 6);
	return area / (along[3] - 0.5f * (base[0] + base[1]));
}

/* A stripe, narrow enough that its two boundaries are one line. value: of five pixels, of light and colours of seven.
 */
static bool band_site(const fine *n, const found *at, placed *s, float (*value)[3])
{
	const family_info *is = families + at->family;
	int form = samples[is->sample].form, planes = samples[is->sample].planes;
	stripe b;
	if (form == FORM_COLOR)
		encode(n, value - 1, 7);
	if (!stripe_of((const float (*)[3])value, planes, n->floor[at->family], is->faint, &b))
		return false;
	if (form == FORM_COLOR &&
	    ((b.weak && stripe_width(value - 1, planes, &b) > widest_weak) || among_alike(n, is->sample, at)))
		return false;
	if (form == FORM_LIGHT) {
		float width = stripe_width(value - 1, planes, &b);
		b.weak |= width > widest_band;
		if (width > widest_band + light_slack)
			return false;
	}
	s->weak = b.weak;
	put(at, b.offset, s);
	int style = fine_style(n, at, s);
	if (form == FORM_VECTOR)
		return weigh(n, at, s, style,
			     clamp01((b.area - n->floor[samples[is->sample].step]) / (crease_ramp * n->crease)));
	float difference = 0;
	color_metric metric = metric_of(n->e->p);
	if (form == FORM_LIGHT) { /* the stripe may be narrower than a pixel, and so darker than what is seen of it */
		float rise = b.e[0] > 0 ? 1 : -1,
		      near = rise * value[0][0] > rise * value[4][0] ? value[0][0] : value[4][0];
		difference = ISA(light_contrast)(n, n->f->params + style, near, near + 2 * b.e[0]);
	} else {
		float gain = stripe_gain(n, &b);
		float peak[3] = {b.base[0] + gain * b.e[0], b.base[1] + gain * b.e[1], b.base[2] + gain * b.e[2]};
		const float *a[3] = {peak, peak + 1, peak + 2}, *low[3] = {b.base, b.base + 1, b.base + 2};
		ISA(metric_difference)(&metric, 1, a, low, &difference);
		if (is->sample == SOURCE_COLOR)
			ISA(fine_paint)(n, s, peak, b.base);
	}
	return weigh_weak(n, at, s, style, ISA(color_strength)(n, at, is->sample, difference));
}

/* Pixels from where colours have a step to a joint of materials that a mesh tells; test_fine_sites */
static const float joint_reach = 0.75f;

/* Where the pixel's colour steps: at a joint of the mesh's materials that passes there, which colours that few samples
 * or none have averaged show as stairs. */
static float joint_near(const fine *n, const found *at, float offset)
{
	float least = joint_reach, best = offset;
	int down = at->axis == AXIS_COLUMN;
	for (int k = -1; n->joints && k <= 0; k++) {
		int x = at->column + (down ? 0 : k), y = at->row + (down ? k : 0);
		float place = x < 0 || y < 0 ? 0 : n->joints[2 * ((ptrdiff_t)y * n->f->width + x) + down];
		float apart = fabsf(place + (float)k - offset);
		if (place > 0 && apart < least) {
			least = apart;
			best = place + (float)k;
		}
	}
	return best;
}

/* Which sides of a step of normals have a greater one within two pixels that goes back, as bits: the rim of a ball
 * turns so up to where it touches something. v: of the site, which are known as far as `far` on both sides. */
static int outdone(const float (*v)[3], const int *far)
{
	int sides = 0;
	float own = distance2(v[1], v[-1], 3);
	for (int side = 0; side < 2; side++)
		for (int k = 1; k < far[side]; k++) {
			int off = side ? k : -k;
			float dot = 0;
			for (int c = 0; c < 3; c++)
				dot += (v[off + 1][c] - v[off - 1][c]) * (v[1][c] - v[-1][c]);
			sides |= (dot < 0 && distance2(v[off + 1], v[off - 1], 3) > own) << side;
		}
	return sides;
}

bool ISA(ridge_site)(const fine *n, const found *at, placed *s)
{
	float around[7][3], difference = 0, bend = 0, step = 0;
	int source = families[at->family].sample, planes = samples[source].planes, form = samples[source].form;
	bool band = families[at->family].kind == KIND_BAND;
	int far[2], low = 0, high = 4;
	/* what outdoes a step is looked for farther, and what a stripe of light lies on */
	int reach = (form == FORM_VECTOR) != band ? 3 : 2;
	if (form == FORM_LIGHT && is_nothing(n, at->column, at->row))
		return false;
	read_along(n, source, at, reach, around, far);
	float (*value)[3] = around + reach - 2;
	if (band)
		return far[0] >= 2 && far[1] >= 2 && band_site(n, at, s, value);
	sides(value, planes, &low, &high);
	float offset = -1.5f;
	for (int k = 1; k <= 3; k++)
		offset += share(value[k], value[low], value[high], planes);
	float middle = offset;
	offset = unbiased(offset);
	put(at, at->family == FAMILY_COLOR ? joint_near(n, at, offset) : offset, s);
	int style = fine_style(n, at, s);

	if (form == FORM_COLOR)
		encode(n, value, 5);
	/* where a surface turns away it turns ever faster: the slope up to the last pixel, or to what goes back, goes
	 * on at least as steeply */
	int back = form == FORM_VECTOR ? outdone((const float (*)[3])around + reach, far) : 0;
	int from = far[0] < 2 || back & 1, to = 4 - (far[1] < 2 || back & 2);
	for (int c = 0; c < planes; c++) {
		float d = value[3][c] - value[1][c],
		      j = d - (value[from + 1][c] - value[from][c]) - (value[to][c] - value[to - 1][c]);
		bend += j * j;
		step += d * d;
	}
	for (int c = 0; c < 3 && c < planes; c++) {
		float way = 127 * (value[3][c] - value[1][c]) / (step > 0 ? 1.001f * sqrtf(step) : 1);
		s->step[c] = (int8_t)(way > -127 ? way < 127 ? way : 127 : -127); /* or no number: squares overflow */
	}
	bend = sqrtf(bend);
	if (from + 4 - to == 1 && (from ? -middle : middle) < clear_of_last) { /* but not so much faster than beyond */
		float beyond = distance2(value[from ? 4 : 1], value[from ? 3 : 0], planes);
		bend = max(bend, sqrtf(step) - turns_away * sqrtf(beyond));
	}
	if (!(bend > least_of_step * sqrtf(step) && bend > n->floor[at->family]))
		return false;
	if (form == FORM_VECTOR)
		return weigh_weak(n, at, s, style, clamp01((bend - n->floor[at->family]) / (crease_ramp * n->crease)));
	if (form == FORM_DISTANCE) {
		/* as in cracks.c, what each side's straight continuation misses at the other: a plane's horizon is none
		 */
		float l = value[3][0] - 3 * value[1][0] + 2 * value[0][0],
		      r = value[1][0] - 3 * value[3][0] + 2 * value[4][0], most = 0;
		float j = max(0, max(min(l, -r), min(-l, r)));
		for (int k = 0; k < 5; k++)
			most = max(most, value[k][0]);
		j = n->e->ortho ? j : most > 0 ? j / most : 0;
		return weigh_weak(n, at, s, style, clamp01((j - seen_jump_from) / seen_jump_ramp));
	}
	color_metric metric = metric_of(n->e->p);
	if (form == FORM_LIGHT) {
		const encre_params *own = n->f->params + style;
		difference = ISA(light_contrast)(n, own, value[low][0], value[high][0]);
		put_threshold(at, value, ISA(light_threshold)(own, value[low][0], value[high][0]), middle, s);
	} else {
		const float *a[3] = {value[low], value[low] + 1, value[low] + 2},
			    *b[3] = {value[high], value[high] + 1, value[high] + 2};
		ISA(metric_difference)(&metric, 1, a, b, &difference);
		if (source == SOURCE_COLOR)
			ISA(fine_paint)(n, s, value[low], value[high]);
	}
	return weigh_weak(n, at, s, style, ISA(color_strength)(n, at, source, difference));
}
