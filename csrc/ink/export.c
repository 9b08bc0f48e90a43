/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells whoever asks of what was drawn: links of sites as polylines, each as far as a pen goes without a stop. */
#include "ink/discs.h"
#include "ink/pen.h"
#include "ink/tips.h"
#include "ink/turns.h"
#include "fine/near.h"

#include <stdlib.h>

#define SAME(ours, theirs) _Static_assert((int)LINE_##ours == (int)ENCRE_LINE_##theirs, "lines as callers know them");
SAME(OUTLINE, OUTLINE)
SAME(CONTACT, CONTACT)
SAME(INNER, INNER)
SAME(CREASE, CREASE)
SAME(INTERSECTION, INTERSECTION)
SAME(MATERIAL, MATERIAL)
SAME(COLOR, COLOR)
SAME(LIGHT, SHADOW)
SAME(SEEN, MIRROR)
SAME(SUGGESTIVE, SUGGESTIVE)
SAME(MARK, MARK)
SAME(HIDDEN, HIDDEN)
SAME(COUNT, COUNT)
#undef SAME

/* px: what is of another kind or object for less is as the line is around it. */
static const float least_piece = 8;
/* Pixels: what is nowhere as wide is a tenth as dark as ink at most, and not seen. */
static const float least_width = 0.1f;

/* A stroke of the list that is told, before it is put in its place. */
typedef struct piece {
	size_t first, count;
	float depth, width; /* means */
} piece;

typedef struct telling {
	frame *f;
	const fine *n;
	const capsules *all;
	const float *color;
	uint32_t pass;
	const pen_end *end; /* of this pass, by site */
	uint8_t *kind;      /* by site */
	uint8_t *seen;      /* by link, as `fine` has them: it is told */
	uint32_t *path;     /* sites of a line, one after the other */
	uint32_t length;
	drawn_strokes made; /* not in order */
	piece *piece;
	size_t pieces, piece_room;
} telling;

/* ---- lists ----------------------------------------------------------------------------------------------- */

/* Room for one more of `size` bytes; false without memory. */
static bool make_room(void *list, size_t *room, size_t count, size_t size)
{
	void **at = list;
	if (count < *room)
		return true;
	size_t more = *room ? 2 * *room : 1024;
	void *grown = more > SIZE_MAX / 2 / size ? NULL : malloc(more * size);
	if (!grown)
		return false;
	if (*at)
		memcpy(grown, *at, count * size);
	free(*at);
	*at = grown;
	*room = more;
	return true;
}

/* ---- the way along lines --------------------------------------------------------------------------------- */

static bool is_inked(const telling *t, uint32_t i)
{
	return !t->n->site[i].linked.dropped && t->end[i].reach > 0;
}

/* Whether a link is drawn. */
static bool is_drawn(const telling *t, uint32_t i, uint32_t j)
{
	return !t->n->site[i].linked.dropped && !t->n->site[j].linked.dropped && (is_inked(t, i) || is_inked(t, j));
}

/* The end beyond the corner at site i of the stroke that comes there over site j; NULL: there is none. */
static const pen_end *beyond(const telling *t, uint32_t i, uint32_t j)
{
	const spur *s = t->all->spur;
	uint32_t low = 0, high = t->all->spurs;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (s[middle].site < i)
			low = middle + 1;
		else
			high = middle;
	}
	for (; low < t->all->spurs && s[low].site == i; low++) {
		const pen_end *e = t->all->end + spur_end(t->all, t->pass, low);
		if (s[low].over == j && e->reach > 0)
			return e;
	}
	return NULL;
}

/* The next site of a line that comes from `from`; UINT32_MAX: the pen stops at i. The same from both sides. */
static uint32_t next_site(const telling *t, uint32_t from, uint32_t i)
{
	if (!is_inked(t, i))
		return UINT32_MAX;
	uint32_t next = ISA(onward)(t->n, from, i);
	bool goes_on = next != UINT32_MAX && is_drawn(t, i, next) && !beyond(t, i, from) && !beyond(t, i, next);
	return goes_on ? next : UINT32_MAX;
}

static void note(telling *t, uint32_t a, uint32_t b)
{
	const fine *n = t->n;
	for (uint32_t k = n->at[a]; k < n->at[a + 1]; k++)
		t->seen[k] |= n->to[k] == b;
	for (uint32_t k = n->at[b]; k < n->at[b + 1]; k++)
		t->seen[k] |= n->to[k] == a;
}

/* Fills the path with the line over the link from i to j, from its one end to its other, and notes its links. */
static void follow(telling *t, uint32_t i, uint32_t j)
{
	uint32_t first = i, second = j, from = j, at = i, next;
	while ((next = next_site(t, from, at)) != UINT32_MAX && next != j) { /* back to where it begins */
		from = at;
		at = next;
		if (at == i)
			break;
	}
	if (next == UINT32_MAX) {
		first = at;
		second = from;
	}
	t->length = 0;
	t->path[t->length++] = first;
	from = first;
	at = second;
	while (true) {
		note(t, from, at);
		t->path[t->length++] = at;
		next = next_site(t, from, at);
		if (next == UINT32_MAX || at == first || t->length > t->n->count)
			return;
		from = at;
		at = next;
	}
}

/* ---- points ---------------------------------------------------------------------------------------------- */

/* A number that is none of an object's, as a layer may hold, is 0: nothing. */
static int32_t number_at(const frame *f, int x, int y)
{
	float number = object_at(f, x, y);
	return number > 0 && number < 1e9f ? (int32_t)number : 0;
}

static int32_t object_of(const telling *t, uint32_t i)
{
	const site *s = t->n->site + told_by(t->n, i);
	return is_chain(s) ? chain_of(t->n, s)->object : number_at(t->f, s->placed.near_x, s->placed.near_y);
}

/* What the pen_end of a site becomes: the ramp from paper to ink is half as dark at `middle`. */
static encre_stroke_point point_of(const telling *t, uint32_t i, const pen_end *e)
{
	const site *s = t->n->site + i;
	const float *ink = t->all->ink ? t->all->ink[e - t->all->end] : t->color;
	float rise = max(1 - e->bias, 0), middle = e->out - e->fade * (e->bias + 0.5f * min(e->ease, rise));
	encre_stroke_point p = {.x = e->x + (float)t->f->place.x,
				.y = e->y + (float)t->f->place.y,
				.width = e->reach > 0 ? 2 * max(middle, 0) : 0,
				.ink = {ink[0], ink[1], ink[2], clamp01(e->gain * rise)},
				.depth = is_chain(s) ? chain_of(t->n, s)->depth
						     : depth_at(t->f, s->placed.near_x, s->placed.near_y),
				.mesh = is_chain(s) ? chain_of(t->n, s)->mesh : -1,
				.edge = is_chain(s) ? chain_of(t->n, s)->edge : -1,
				.pass = (int32_t)t->pass};
	if (!(p.depth < INFINITY))
		p.depth = 1e10f;
	return p;
}

/* Why a line ends at site i, to which it comes over site j. */
static void tell_end(const telling *t, uint32_t i, uint32_t j, encre_stroke_point *p)
{
	const fine *n = t->n;
	const site *s = n->site + i;
	p->end = is_chain(s) ? chain_of(n, s)->end : ENCRE_END_NONE;
	if (p->end == ENCRE_END_NONE && is_inked(t, i) && links_at(n, i) > 1)
		p->end = ENCRE_END_NODE;
	if (p->end != ENCRE_END_HIDDEN)
		return;
	/* what lies before it a pixel farther on */
	const placed *a = &n->site[j].placed, *b = &s->placed;
	float x = b->x - a->x, y = b->y - a->y, length = sqrtf(x * x + y * y), nearest = INFINITY;
	int px = pixel_of(b->x + (length > 0 ? x / length : 0), t->f->width),
	    py = pixel_of(b->y + (length > 0 ? y / length : 0), t->f->height);
	for (int k = 0; k < 9; k++) {
		int qx = clamp_index(px + k % 3 - 1, t->f->width), qy = clamp_index(py + k / 3 - 1, t->f->height);
		float depth = depth_at(t->f, qx, qy);
		if (!(depth < nearest))
			continue;
		nearest = depth;
		p->hider = number_at(t->f, qx, qy);
	}
}

static bool add_point(telling *t, encre_stroke_point p, int32_t kind, int32_t object)
{
	if (!make_room(&t->made.point, &t->made.room, t->made.count, sizeof p))
		return false;
	p.kind = kind;
	p.object = object;
	t->made.point[t->made.count++] = p;
	return true;
}

/* What was added since `first` is a stroke, if it can be seen. */
static bool end_piece(telling *t, size_t first)
{
	piece p = {.first = first, .count = t->made.count - first};
	float widest = 0;
	if (!make_room(&t->piece, &t->piece_room, t->pieces, sizeof p))
		return false;
	for (size_t i = first; i < t->made.count; i++) {
		const encre_stroke_point *at = t->made.point + i;
		p.depth += at->depth / (float)p.count;
		p.width += at->width / (float)p.count;
		widest = max(widest, at->width);
	}
	if (widest < least_width)
		t->made.count = first;
	else
		t->piece[t->pieces++] = p;
	return true;
}

/* ---- lines ----------------------------------------------------------------------------------------------- */

/* From which site of the path on its line is of another kind or object than at `from`, for long enough. */
static uint32_t part_to(const telling *t, uint32_t from)
{
	const fine *n = t->n;
	float least = least_piece * t->f->scale, other = 0;
	uint32_t cut = t->length - 1;
	for (uint32_t k = from + 1; k < t->length; k++) {
		uint32_t i = t->path[k];
		bool same = t->kind[i] == t->kind[t->path[from]] && object_of(t, i) == object_of(t, t->path[from]);
		if (same) {
			other = 0;
			cut = t->length - 1;
			continue;
		}
		cut = other > 0 ? cut : k;
		other += sqrtf(apart2(n->site + t->path[k - 1], n->site + i)) + 1e-6f;
		if (other >= least)
			return cut;
	}
	return t->length - 1;
}

/* Of what most of the path from..last is. */
static uint32_t told_most(const telling *t, uint32_t from, uint32_t last)
{
	uint32_t best = from, most = 0, votes = 0, now = from;
	for (uint32_t k = from; k <= last; k++) { /* Boyer and Moore's vote */
		bool same = t->kind[t->path[k]] == t->kind[t->path[now]] &&
			    object_of(t, t->path[k]) == object_of(t, t->path[now]);
		if (!votes) {
			now = k;
			votes = 1;
		} else {
			votes += same ? 1 : UINT32_MAX;
		}
		if (votes > most) {
			most = votes;
			best = now;
		}
	}
	return t->path[votes ? now : best];
}

/* What branches off an older line is as wide where it meets that as it is beside it (capsules.c). */
static void narrow(const telling *t, uint32_t junction, uint32_t beside, encre_stroke_point *p)
{
	float width = point_of(t, beside, t->end + beside).width;
	if (branches_off(t->n, junction, beside) && p->width > width)
		p->width = width;
}

static bool tell_part(telling *t, uint32_t from, uint32_t last)
{
	const uint32_t *path = t->path;
	uint32_t end = t->length - 1, about = told_most(t, from, last);
	int32_t kind = t->kind[about], object = object_of(t, about);
	size_t first = t->made.count;
	bool loop = end > 1 && path[0] == path[end], good = true;
	const pen_end *before = from || loop || !end ? NULL : beyond(t, path[0], path[1]),
		      *after = last < end || loop || !end ? NULL : beyond(t, path[end], path[end - 1]);
	if (before)
		good = add_point(t, point_of(t, path[0], before), kind, object);
	for (uint32_t k = from; good && k <= last; k++) {
		encre_stroke_point p = point_of(t, path[k], t->end + path[k]);
		if (loop && (!k || k == end))
			p.end = from || last < end ? ENCRE_END_NODE : ENCRE_END_LOOP;
		else if (end && (!k || k == end))
			tell_end(t, path[k], path[k ? end - 1 : 1], &p);
		if (end && (!k || k == end))
			narrow(t, path[k], path[k ? end - 1 : 1], &p);
		if ((!k && before) || (k == end && after))
			p.end = ENCRE_END_NONE;
		good = add_point(t, p, kind, object);
	}
	if (good && after)
		good = add_point(t, point_of(t, path[end], after), kind, object);
	if (before)
		t->made.point[first].end = ENCRE_END_NODE;
	if (good && after)
		t->made.point[t->made.count - 1].end = ENCRE_END_NODE;
	return good && end_piece(t, first);
}

static bool tell_path(telling *t)
{
	for (uint32_t from = 0, last;; from = last) {
		last = part_to(t, from);
		if (!tell_part(t, from, last))
			return false;
		if (last == t->length - 1)
			return true;
	}
}

static int32_t tell_pass(telling *t)
{
	const fine *n = t->n;
	int32_t code = ENCRE_OK;
	memset(t->seen, 0, n->at[n->count]);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		bool good = true;
		if (!code && n->at[i] == n->at[i + 1] && is_inked(t, i)) {
			t->path[0] = i;
			t->length = 1;
			good = tell_path(t);
		}
		for (uint32_t k = n->at[i]; !code && good && k < n->at[i + 1]; k++) {
			if (t->seen[k] || !is_drawn(t, i, n->to[k]))
				continue;
			follow(t, i, n->to[k]);
			good = tell_path(t);
		}
		code = code || good ? code : ENCRE_ERROR_MEMORY;
	}
	return code;
}

/* ---- order ----------------------------------------------------------------------------------------------- */

/* Of two that cross the darker one shows, and so the wider one, for what is thinner than a pixel is fainter; else what
 * is farther away lies below. */
static int in_order(const void *one, const void *other)
{
	const piece *a = one, *b = other;
	int by = order(a->width, b->width);
	by = by ? by : order(b->depth, a->depth);
	return by ? by : (a->first > b->first) - (a->first < b->first);
}

static int32_t put_in_order(telling *t, drawn_strokes *out)
{
	if (t->pieces)
		qsort(t->piece, t->pieces, sizeof *t->piece, in_order);
	if (out->room < t->made.count) {
		free(out->point);
		out->point = malloc(t->made.count * sizeof *out->point);
		out->room = out->point ? t->made.count : 0;
		if (!out->point)
			return ENCRE_ERROR_MEMORY;
	}
	out->count = 0;
	for (size_t k = 0; k < t->pieces; k++)
		for (size_t i = 0; i < t->piece[k].count; i++) {
			out->point[out->count] = t->made.point[t->piece[k].first + i];
			out->point[out->count++].stroke = (int32_t)k;
		}
	return ENCRE_OK;
}

static void find_kinds(void *data, int first, int end, int thread)
{
	(void)thread;
	const telling *t = data;
	for (int i = first; i < end && !stopped_at(t->n, i); i++) {
		const site *s = t->n->site + i;
		t->kind[i] = s->linked.dropped ? 0 : (uint8_t)ISA(line_of)(t->f, s);
	}
}

int32_t ISA(capsules_tell)(frame *f, const capsules *all, const float color[3])
{
	enum { CHUNK = 1024 };
	const fine *n = f->fine;
	telling t = {.f = f, .n = n, .all = all, .color = color};
	t.kind = late_take(&f->late, n->count, 1);
	t.seen = late_take(&f->late, n->at[n->count], 1);
	t.path = late_take(&f->late, (size_t)n->count + 2, sizeof *t.path);
	int32_t code = t.kind && t.seen && t.path ? ENCRE_OK : ENCRE_ERROR_MEMORY;
	if (!code)
		code = bands_run(f->bands, (int)n->count, CHUNK, find_kinds, &t);
	for (t.pass = 0; !code && t.pass < all->strokes; t.pass++) {
		t.end = all->end + (size_t)t.pass * n->count;
		code = tell_pass(&t);
	}
	if (!code)
		code = put_in_order(&t, f->strokes);
	free(t.made.point);
	free(t.piece);
	late_drop(&f->late, t.path);
	late_drop(&f->late, t.seen);
	late_drop(&f->late, t.kind);
	return code;
}
