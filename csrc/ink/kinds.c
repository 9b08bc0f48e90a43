/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What kind a line of FINE is, by what lies on both sides of a site, and which ink it has. */
#include "ink/pen.h"

#include "base/pixel.h"
#include "base/stage.h"
#include "fine/near.h"
#include "ink/discs.h"

/* A jump in depth of this share, beyond what both sides explain, is one: where an edge of depth has half its strength.
 */
static const float least_jump = 0.0065f;
/* Px by which an outline lies before what is behind it, at least. */
static const float least_gap = 6;
/* Links each way over which an outline goes on. */
enum { BRIDGE = 24 };

/* ---- kinds ----------------------------------------------------------------------------------------------- */

static float inverse_at(const frame *f, int x, int y)
{
	float z = depth_at(f, x, y);
	if (f->camera.orthographic)
		return z < INFINITY ? -z / f->camera.height : -1e30f;
	return 1 / z;
}

static bool same_object(const frame *f, int x, int y, int qx, int qy)
{
	const float *p = layer_row(f, ENCRE_LAYER_OBJECT, y), *q = layer_row(f, ENCRE_LAYER_OBJECT, qy);
	return !p || p[x] == q[qx];
}

/* What each side, continued straight, misses of the other, as a share of the nearer one. A side that is one pixel wide,
 * beyond which another object is, tells no slope: it goes on as deep. */
static float jump_at(const frame *f, int x, int y, int dx, int dy)
{
	float inverse[4], near;
	int u[4], v[4];
	for (int k = 0; k < 4; k++) {
		u[k] = clamp_index(x + (k - 1) * dx, f->width);
		v[k] = clamp_index(y + (k - 1) * dy, f->height);
		inverse[k] = inverse_at(f, u[k], v[k]);
	}
	for (int k = 0; k < 4; k += 3)
		if (!same_object(f, u[k], v[k], u[k ? 2 : 1], v[k ? 2 : 1]))
			inverse[k] = inverse[k ? 2 : 1];
	near = f->camera.orthographic ? 1 : max(inverse[1], inverse[2]);
	return near > 0 ? max(0, jump(inverse[0], inverse[1], inverse[2], inverse[3])) / near : 0;
}

/* A line of the sources that depth and number tell: where the site lies between two pixels, of these; a junction's, of
 * the two that are farthest apart. */
static enum line shape_of(const frame *f, const found *at, enum source source)
{
	int x = at->column, y = at->row, dx = at->axis != AXIS_COLUMN, dy = at->axis != AXIS_ROW;
	int qx = clamp_index(x + dx, f->width), qy = clamp_index(y + dy, f->height);
	bool same = same_object(f, x, y, qx, qy);
	if (same && source == SOURCE_DEPTH)
		return LINE_INNER;
	bool nothing = !(depth_at(f, x, y) < INFINITY) || !(depth_at(f, qx, qy) < INFINITY);
	return nothing || jump_at(f, x, y, dx, dy) >= least_jump ? LINE_OUTLINE : LINE_CONTACT;
}

static bool is_outline(const frame *f, const site *s)
{
	enum source source = (enum source)s->placed.source;
	return (source == SOURCE_OBJECT || source == SOURCE_DEPTH) && s->found.family != FAMILY_THIN && !is_chain(s) &&
	       shape_of(f, &s->found, source) == LINE_OUTLINE;
}

/* The next site of a line: where it meets others, the one most straight on; or UINT32_MAX. */
static uint32_t straight_on(const fine *n, uint32_t from, uint32_t i)
{
	const placed *a = &n->site[from].placed, *b = &n->site[i].placed;
	float x = b->x - a->x, y = b->y - a->y, best = 0;
	uint32_t next = UINT32_MAX;
	if (links_at(n, i) == 2)
		return next_of(n, from, i);
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		const site *c = n->site + n->to[k];
		float u = c->placed.x - b->x, v = c->placed.y - b->y, along = x * u + y * v;
		float ahead = along / sqrtf(u * u + v * v + 1e-12f);
		if (n->to[k] == from || c->linked.dropped || !(ahead > best))
			continue;
		best = ahead;
		next = n->to[k];
	}
	return next;
}

/* Whether the line is an outline a little farther on both sides. A gap a pixel wide is seen where it covers centres of
 * pixels and not where its line passes between two rows: there things would seem to touch. */
static bool goes_on(const frame *f, uint32_t i)
{
	const fine *n = f->fine;
	int sides = 0;
	for (uint32_t k = n->at[i]; k < n->at[i + 1] && sides < 2; k++) {
		uint32_t from = i, at = n->to[k];
		bool found = false;
		for (int links = 0; links < BRIDGE && !found && at != UINT32_MAX && !n->site[at].linked.dropped;
		     links++) {
			uint32_t next = straight_on(n, from, at);
			found = is_outline(f, n->site + at);
			from = at;
			at = next;
		}
		sides += found;
	}
	return sides == 2;
}

/* Likewise of a line that chains tell: what it bounds touches what is behind, or lies before it. */
static enum line chain_line(const fine *n, const site *s)
{
	const chain_site *of = chain_of(n, s);
	switch ((enum source)s->placed.source) {
	case SOURCE_OBJECT:
	case SOURCE_DEPTH:
		if (of->folded)
			return LINE_INNER;
		return (of->kind & (ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER)) && of->gap > least_gap * n->f->scale
			       ? LINE_OUTLINE
			       : LINE_CONTACT;
	case SOURCE_NORMAL: return of->kind & ENCRE_CHAIN_MEET ? LINE_INTERSECTION : LINE_CREASE;
	case SOURCE_MATERIAL: return LINE_MATERIAL;
	case SOURCE_COLOR: return LINE_COLOR;
	default: return LINE_MARK;
	}
}

enum line ISA(line_of)(const frame *f, const site *s)
{
	const fine *n = f->fine;
	uint32_t i = told_by(n, (uint32_t)(s - n->site));
	enum line shape;
	s = n->site + i;
	if (is_chain(s))
		return chain_line(n, s);
	switch ((enum source)s->placed.source) {
	case SOURCE_OBJECT:
	case SOURCE_DEPTH:
		shape = shape_of(f, &s->found, (enum source)s->placed.source);
		return shape == LINE_CONTACT && goes_on(f, i) ? LINE_OUTLINE : shape;
	case SOURCE_NORMAL: return LINE_CREASE;
	case SOURCE_MATERIAL: return LINE_MATERIAL;
	case SOURCE_COLOR: return LINE_COLOR;
	case SOURCE_LIGHT: return LINE_LIGHT;
	case SOURCE_SEEN: return LINE_SEEN;
	case SOURCE_SUGGESTIVE: return LINE_SUGGESTIVE;
	case SOURCE_HIDDEN: return LINE_HIDDEN;
	default: return LINE_MARK;
	}
}

/* Px by which an outline lies before what is behind it, from which on it is an outer one, and wholly. */
static const float outer_from = 24, outer_full = 96;
/* Height of the frame at a depth of 1 where it is not known: of a lens of 40 mm. */
static const float usual_height = 0.5f;
/* Pixels aside of a contour where it is asked what lies behind it: past a second shell, a lid, a strip of trim. */
enum { ASIDE = 1 };

static float outer(float gap)
{
	return clamp01((gap - outer_from) / (outer_full - outer_from));
}

/* A share of the nearer depth, of inverse ones, or of the frame's height: how far one lies behind another. */
static float behind(const frame *f, float near, float far)
{
	if (f->camera.orthographic)
		return near - far;
	return near < far ? 0 : far > 0 ? near / far - 1 : INFINITY;
}

/* Likewise what is seen about a contour of a mesh, continued straight up to that. */
static float behind_chain(const frame *f, const site *s, int x, int y)
{
	const chain_site *of = chain_of(f->fine, s);
	float own = f->camera.orthographic ? -of->depth / f->camera.height : 1 / of->depth, most = 0;
	if (!(of->kind & (ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER)))
		return 0;
	for (int k = 0; k < 4; k++) {
		int dx = k < 2, dy = k >= 2, first = k & 1 ? 1 + ASIDE : -ASIDE,
		    second = k & 1 ? 2 + 3 * ASIDE : -1 - 3 * ASIDE;
		int u[2] = {clamp_index(x + dx * first, f->width), clamp_index(x + dx * second, f->width)},
		    v[2] = {clamp_index(y + dy * first, f->height), clamp_index(y + dy * second, f->height)};
		float far = inverse_at(f, u[0], v[0]), farther = inverse_at(f, u[1], v[1]);
		if (same_object(f, u[0], v[0], u[1], v[1]))
			far = max(far, 1.5f * far - 0.5f * farther);
		most = max(most, behind(f, own, far));
	}
	return most;
}

/* Likewise about a line between pixels. */
static float behind_pixels(const frame *f, const site *s, int x, int y)
{
	bool row = s->found.axis != AXIS_COLUMN, column = s->found.axis != AXIS_ROW;
	float share = 0;
	for (int aside = 0; aside <= ASIDE; aside++)
		share = max(share, jump_at(f, x - (row ? aside : 0), y - (column ? aside : 0), row ? 1 + 2 * aside : 0,
					   column ? 1 + 2 * aside : 0));
	return behind(f, 1, 1 - share);
}

float ISA(line_outer)(const frame *f, const site *s)
{
	const fine *n = f->fine;
	s = n->site + told_by(n, (uint32_t)(s - n->site));
	enum source source = (enum source)s->placed.source;
	if (source != SOURCE_OBJECT && source != SOURCE_DEPTH)
		return 0;
	float px = f->scale / (float)f->place.height,
	      far = is_chain(s) ? behind_chain(f, s, (int)floorf(s->placed.x), (int)floorf(s->placed.y))
				: behind_pixels(f, s, s->found.column, s->found.row);
	if (!f->camera.orthographic)
		px *= f->camera.height > 0 ? f->camera.height : usual_height;
	return outer(far / px);
}

float ISA(line_width)(const frame *f, const encre_params *p, const site *s, enum line kind)
{
	if (kind == LINE_OUTLINE && is_chain(s))
		return mix(1, p->line_outer_width, outer(chain_of(f->fine, s)->gap / f->scale));
	return kind == LINE_CONTACT        ? p->line_contact_width
	       : kind == LINE_INTERSECTION ? p->line_intersection_width
					   : 1;
}

/* ---- inks ------------------------------------------------------------------------------------------------ */

bool ISA(inks_by_site)(const encre_params *p)
{
	return p->ink_tint > 0 || p->ink_in_light > 0 || p->ink_on_dark > 0 || p->ink_by_kind;
}

void ISA(line_ink)(const frame *f, const site *made, float ink[3])
{
	const placed *s = &made->placed;
	int x = s->near_x, y = s->near_y;
	const encre_params *p = params_at(f, x, y);
#define LINE(kind, id, ...) [LINE_##kind] = p->line_##id##_ink,
	const float *const kinds[LINE_COUNT] = {LINES(LINE)};
#undef LINE
	const float *own = p->ink_by_kind ? kinds[ISA(line_of)(f, made)] : p->ink_color;
	const float *color = layer_row(f, ENCRE_LAYER_COLOR, y) + (ptrdiff_t)3 * x;
	float lit = p->ink_in_light * clamp01(exposed_at(f, p, x, y));
	for (int c = 0; c < 3; c++) {
		ink[c] = blend(own[c], p->ink_tint_value * color[c], p->ink_tint);
		ink[c] = blend(ink[c], p->ink_light_color[c], lit);
	}
}
