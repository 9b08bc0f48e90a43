/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The FINE detector: thin, exactly placed edges. Dense passes mark the pixels at which sites lie; sites are counted by
 * row, so that their numbers don't depend on threads, and placed; each family then keeps clear of the earlier ones. */
#include "fine/fine.h"

#include <string.h>

enum { CHUNK = 2048 };

/* How close, in pixels, a family comes to the earlier ones, and a step to a stripe in the same layer. */
static const float clear_of_earlier = 1.5f, clear_of_band = 2.0f;
static const float touching = 0.02f; /* of the depth, apart at most */

/* ---- one site -------------------------------------------------------------------------------------------- */

static float depth_at(const frame *f, int x, int y)
{
	return depth_of(f->layer[ENCRE_LAYER_DEPTH].data[y * f->layer[ENCRE_LAYER_DEPTH].row + x]);
}

/* The pixel, of those that the site parts, of what the line bounds: of the nearest thing, but where two things touch of
 * the one whose line is painted more. */
static void owner_of(const fine *n, const site *s, int *x, int *y)
{
	const frame *f = n->f;
	plane controls = f->layer[ENCRE_LAYER_CONTROLS];
	bool crack = is_crack((enum family)s->family);
	int right = clamp_index(s->column + (crack && s->axis != AXIS_COLUMN), f->width),
	    below = clamp_index(s->row + (crack && s->axis != AXIS_ROW), f->height);
	float least = INFINITY, most = -1;
	for (int qy = s->row; qy <= below; qy++)
		for (int qx = s->column; qx <= right; qx++)
			least = fminf(least, depth_at(f, qx, qy));
	float reach = least + touching * (n->e->ortho ? f->camera.height : least);
	for (int qy = s->row; qy <= below; qy++)
		for (int qx = s->column; qx <= right; qx++) {
			float z = depth_at(f, qx, qy);
			float painted = controls.data ? fabsf(controls.data[qy * controls.row + (ptrdiff_t)6 * qx]) : 0;
			if (z <= reach && (painted > most || (painted == most && z < depth_at(f, *x, *y)))) {
				most = painted;
				*x = qx;
				*y = qy;
			}
		}
}

/* The least depth of the 5x5 among pixels of the object that the line bounds: at the foot of a blade of grass the
 * ground before it is nearer, and has other controls. A thin thing's line may pass where no pixel is its own. */
int ISA(fine_controls)(const fine *n, site *s)
{
	const frame *f = n->f;
	plane object = f->layer[ENCRE_LAYER_OBJECT];
	int x = pixel_of(s->x, f->width), y = pixel_of(s->y, f->height), own_x = s->column, own_y = s->row;
	float least[2] = {INFINITY, INFINITY};
	int least_key[2] = {INT32_MAX, INT32_MAX}, near[2][2] = {{x, y}, {x, y}};
	owner_of(n, s, &own_x, &own_y);
	bool any = !object.data || s->family == FAMILY_THIN;
	if (s->family >= FAMILY_SEEN) /* it lies in the mirror, whatever stands before that */
		least[0] = least[1] = 0;
	float own = any ? 0 : object.data[own_y * object.row + own_x];
	for (int dy = -2; dy <= 2; dy++) {
		if (y + dy < 0 || y + dy >= f->height)
			continue;
		const float *row = f->layer[ENCRE_LAYER_DEPTH].data + (y + dy) * f->layer[ENCRE_LAYER_DEPTH].row;
		for (int dx = -2; dx <= 2; dx++) {
			if (x + dx < 0 || x + dx >= f->width)
				continue;
			float z = depth_of(row[x + dx]);
			int key = dx * dx + dy * dy; /* then row, then column: the order in which they come */
			bool its = any || object.data[(y + dy) * object.row + x + dx] == own;
			for (int k = 0; k <= its; k++)
				if (z < least[k] || (z == least[k] && key < least_key[k])) {
					least[k] = z;
					least_key[k] = key;
					near[k][0] = x + dx;
					near[k][1] = y + dy;
				}
		}
	}
	int k = least_key[1] < INT32_MAX; /* a corner may lie farther from what it belongs to */
	s->near_x = (uint16_t)near[k][0];
	s->near_y = (uint16_t)near[k][1];
	return f->style ? f->style[(ptrdiff_t)s->near_y * f->width + s->near_x] : 0;
}

bool ISA(fine_weigh)(const fine *n, site *s, int style, enum source source, float strength)
{
	float weight = n->e->weight[source][style];
	plane controls = n->f->layer[ENCRE_LAYER_CONTROLS];
	if (source == SOURCE_COLOR && controls.data)
		weight += controls.data[pixel_of(s->y, n->f->height) * controls.row +
					(ptrdiff_t)6 * pixel_of(s->x, n->f->width) + 2];
	float weighted = weight > 0 ? weight * strength : 0;
	if (weighted > s->strength) {
		s->strength = weighted < FLT_MAX ? weighted : FLT_MAX;
		s->source = (uint8_t)source;
	}
	return s->strength > 0 && s->strength >= n->e->p->edge_threshold;
}

static void crack_of(const fine *n, site *s)
{
	if (s->family == FAMILY_CRACK) {
		ISA(crack_site)(n, s);
		ISA(thin_place)(n, s);
	} else if (s->family == FAMILY_MARK)
		ISA(hand_site)(n, s);
	else
		ISA(light_site)(n, s);
}

/* The mean of the cracks between the four pixels from (column, row), with the strongest's strength. */
static void junction_site(const fine *n, site *s)
{
	const int32_t side[4][3] = {{0, 0, AXIS_ROW}, {0, 1, AXIS_ROW}, {0, 0, AXIS_COLUMN}, {1, 0, AXIS_COLUMN}};
	uint8_t right = right_of((enum family)s->family);
	float x = 0, y = 0;
	int found = 0;
	for (int i = 0; i < 4; i++) {
		site one = *s;
		one.column = (uint16_t)(s->column + side[i][0]);
		one.row = (uint16_t)(s->row + side[i][1]);
		one.axis = (uint8_t)side[i][2];
		if (!(n->crack[(ptrdiff_t)one.row * n->f->width + one.column] & right << one.axis))
			continue;
		crack_of(n, &one);
		x += one.x;
		y += one.y;
		found++;
		if (one.strength > s->strength) {
			s->strength = one.strength;
			s->source = one.source;
		}
	}
	s->x = x / (float)found;
	s->y = y / (float)found;
}

static void place_site(const fine *n, site *s)
{
	if (s->axis == AXIS_JUNCTION)
		junction_site(n, s);
	else if (is_crack((enum family)s->family))
		crack_of(n, s);
	else if (s->family == FAMILY_THIN)
		ISA(thin_site)(n, s);
	else
		ISA(ridge_site)(n, s);
}

/* ---- all sites, in order --------------------------------------------------------------------------------- */

static void visit(const fine *n, uint32_t *number, enum family family, int x, int y, enum axis axis)
{
	if (n->site) {
		site *s = n->site + number[family];
		*s = (site){
			.column = (uint16_t)x, .row = (uint16_t)y, .family = (uint8_t)family, .axis = (uint8_t)axis};
		place_site(n, s);
		ISA(fine_controls)(n, s);
	}
	number[family]++;
}

/* Of the four cracks between the pixels from x on: `crack`, `below` are rows of marks. */
static int sides(const uint8_t *crack, const uint8_t *below, int x, uint8_t right)
{
	int down = right << 1;
	return !!(crack[x] & right) + !!(below[x] & right) + !!(crack[x] & down) + !!(crack[x + 1] & down);
}

/* Makes the sites of a row, or counts them while there is no memory for them; number: of the next site, by family. */
static void visit_row(const fine *n, int y, uint32_t *number)
{
	static const enum family kinds[] = {FAMILY_CRACK, FAMILY_MARK, FAMILY_LIGHT};
	int width = n->f->width;
	const uint8_t *crack = n->crack + (ptrdiff_t)y * width, *below = crack + width;
	const uint16_t *ridge = n->ridge + (ptrdiff_t)y * width;
	for (int x = 0; x < width; x++) {
		uint64_t cracks, ridges[2];
		if (x + 8 <= width && (memcpy(&cracks, crack + x, 8), memcpy(ridges, ridge + x, 16),
				       (cracks | ridges[0] | ridges[1]) == 0)) {
			x += 7;
			continue;
		}
		bool inside = x + 1 < width && y + 1 < n->f->height;
		for (size_t k = 0; crack[x] && k < sizeof kinds / sizeof *kinds; k++) {
			uint8_t right = right_of(kinds[k]);
			for (int axis = 0; axis < 2; axis++)
				if (crack[x] & right << axis)
					visit(n, number, kinds[k], x, y, (enum axis)axis);
			if (inside && sides(crack, below, x, right) > 2)
				visit(n, number, kinds[k], x, y, AXIS_JUNCTION);
		}
		for (int marks = ridge[x] & ~MARK_SEEN, bit = 0; marks; marks >>= 1, bit++)
			if (marks & 1)
				visit(n, number, (enum family)(FAMILY_THIN + bit / 2), x, y, (enum axis)(bit % 2));
		for (int marks = ridge[x] & MARK_SEEN ? n->seen[(ptrdiff_t)y * width + x] : 0, bit = 0; marks;
		     marks >>= 1, bit++)
			if (marks & 1)
				visit(n, number, (enum family)(FAMILY_SEEN + bit / 2), x, y, (enum axis)(bit % 2));
	}
}

static void visit_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	for (int y = y0; y < y1; y++) {
		uint32_t number[FAMILY_COUNT] = {0};
		for (int k = 0; n->site && k < FAMILY_COUNT; k++)
			number[k] = n->first[k * n->f->height + y];
		visit_row(n, y, number);
		for (int k = 0; !n->site && k < FAMILY_COUNT; k++)
			n->first[k * n->f->height + y] = number[k];
	}
}

static int32_t gather(fine *n)
{
	frame *f = n->f;
	int32_t code = bands_run(f->bands, f->height, 0, visit_rows, n);
	if (code)
		return code;
	size_t count = 0;
	for (int i = 0; i < FAMILY_COUNT * f->height; i++) {
		uint32_t own = n->first[i];
		n->first[i] = (uint32_t)count;
		count += own;
	}
	n->first[FAMILY_COUNT * f->height] = (uint32_t)count;
	n->site = count < INT32_MAX ? late_take(&f->late, count, sizeof *n->site) : NULL;
	if (!n->site)
		return ENCRE_ERROR_MEMORY;
	n->count = (uint32_t)count;
	return bands_run(f->bands, f->height, 0, visit_rows, n);
}

/* ---- cells ----------------------------------------------------------------------------------------------- */

static size_t cell_of(const fine *n, const site *s)
{
	int x = pixel_of(s->x, n->f->width) / CELL, y = pixel_of(s->y, n->f->height) / CELL;
	return (size_t)y * (size_t)n->across + (size_t)x;
}

int32_t ISA(fine_sort)(fine *n)
{
	size_t cells = (size_t)n->across * (size_t)n->tall;
	late_drop(&n->f->late, n->member);
	n->member = late_take(&n->f->late, n->count, sizeof *n->member);
	if (!n->member)
		return ENCRE_ERROR_MEMORY;
	memset(n->cell, 0, (cells + 1) * sizeof *n->cell);
	for (uint32_t i = 0; i < n->count; i++)
		n->cell[cell_of(n, n->site + i)]++;
	uint32_t end = 0;
	for (size_t i = 0; i <= cells; i++)
		n->cell[i] = end += i < cells ? n->cell[i] : 0;
	for (uint32_t i = n->count; i-- > 0;) /* from the last: each finds its cell's end and moves it down */
		n->member[--n->cell[cell_of(n, n->site + i)]] = i;
	return ENCRE_OK;
}

/* ---- keeping clear --------------------------------------------------------------------------------------- */

typedef struct turn {
	fine *n;
	int family;
	uint32_t first;
} turn;

static bool owned(const fine *n, const site *s)
{
	near_sites of = near_place(n, s->x, s->y, clear_of_band);
	for (uint32_t i; near_next(n, &of, &i);) {
		const site *other = n->site + i;
		if (other->dropped || other->family >= s->family)
			continue;
		bool band = other->family == s->family - 1 && is_band(other->family);
		float clear = band ? clear_of_band : clear_of_earlier;
		if (apart2(s, other) < clear * clear)
			return true;
	}
	return false;
}

static void clear_sites(void *data, int first, int end, int thread)
{
	(void)thread;
	const turn *t = data;
	for (int i = first; i < end; i++) {
		site *s = t->n->site + t->first + i;
		s->dropped = owned(t->n, s);
	}
}

static int32_t clear(fine *n)
{
	int32_t code = ENCRE_OK;
	for (int k = FAMILY_THIN + 1; !code && k < FAMILY_COUNT; k++) {
		turn t = {n, k, n->first[k * n->f->height]};
		int count = (int)(n->first[(k + 1) * n->f->height] - t.first);
		code = bands_run(n->f->bands, count, CHUNK, clear_sites, &t);
		if (!code)
			code = ISA(fine_drop_weak)(n, (enum family)k);
		if (!code)
			code = ISA(fine_drop_crumbs)(n, (enum family)k);
	}
	return code;
}

/* The distance of two colours in the space of the metric below which none is an edge. */
static float least_contrast(const encre_params *p, float weight)
{
	float most = p->contrast_auto ? fminf(p->contrast_max, 0.25f) : p->contrast_max, least = p->contrast_threshold;
	if (weight > 0 && most > least)
		least += (most - least) * fminf(1, p->edge_threshold / weight);
	/* a difference is at most 2/3 of the distance in RGB, and that distance itself in CIE76; the others bend the
	 * space */
	return least * (p->contrast_metric == contrast_metric_RGB     ? 1.5f
			: p->contrast_metric == contrast_metric_CIE76 ? 1
								      : 0.33f);
}

/* ---- the detector ---------------------------------------------------------------------------------------- */

void ISA(fine_plan)(frame *f, const edges *e, arena *a)
{
	size_t pixels = (size_t)f->width * (size_t)f->height;
	float half = f->params->crease_angle * 0.00872664626f; /* in radians */
	fine made = {.f = f, .e = f->edges, .crease = 2 * pixel_sin(half)};
	for (int i = 0; i < f->n_styles; i++)
		made.most_color = fmaxf(made.most_color, e->weight[SOURCE_COLOR][i]);
	made.least_contrast =
		least_contrast(f->params, made.most_color + (f->layer[ENCRE_LAYER_CONTROLS].data ? 1 : 0));
	ISA(fine_floors)(&made);
	made.across = (f->width - 1) / CELL + 1;
	made.tall = (f->height - 1) / CELL + 1;
	made.crack = arena_take(a, pixels, sizeof *made.crack);
	made.ridge = arena_take(a, pixels, sizeof *made.ridge);
	made.first = arena_take(a, (size_t)FAMILY_COUNT * (size_t)f->height + 1, sizeof *made.first);
	made.spans = (f->width - 1) / THIN_SPAN + 1;
	made.hit = arena_take(a, (size_t)made.spans * (size_t)f->height, sizeof *made.hit);
	made.colored = arena_take(a, (size_t)f->height, sizeof *made.colored);
	made.cell = arena_take(a, (size_t)made.across * (size_t)made.tall + 1, sizeof *made.cell);
	if (e->on[SOURCE_SEEN]) {
		made.seen = arena_take(a, pixels, sizeof *made.seen);
		made.through = arena_take(a, pixels, sizeof *made.through);
		made.glimpse = arena_take(a, (size_t)f->height, sizeof *made.glimpse);
	}
	ptrdiff_t scratch[] = {ISA(crack_scratch)(f), ISA(ridge_scratch)(f),
			       e->on[SOURCE_LIGHT] ? ISA(light_scratch)(f) : 0};
	for (int i = 0; i < 3; i++)
		made.thread_scratch = scratch[i] > made.thread_scratch ? scratch[i] : made.thread_scratch;
	made.scratch =
		arena_take(a, (size_t)bands_threads(f->bands) * (size_t)made.thread_scratch, sizeof *made.scratch);
	fine *n = arena_take(a, 1, sizeof *n);
	f->fine = n;
	if (n)
		*n = made;
}

/* edge_strength where a site lies is the largest of its sites'. */
static void show_strength(const fine *n)
{
	plane out = n->f->output[ENCRE_OUTPUT_EDGES];
	for (int y = 0; out.data && y < n->f->height; y++)
		memset(out.data + y * out.row, 0, (size_t)n->f->width * sizeof *out.data);
	for (uint32_t i = 0; out.data && i < n->count; i++) {
		const site *s = n->site + i;
		float *at = out.data + pixel_of(s->y, n->f->height) * out.row + pixel_of(s->x, n->f->width);
		*at = !s->dropped && s->strength > *at ? s->strength : *at;
	}
}

int32_t ISA(fine_run)(frame *f)
{
	fine *n = f->fine;
	int32_t code = n->e->on[SOURCE_LIGHT] ? ISA(light_even)(n) : ENCRE_OK;
	if (!code)
		code = bands_run(f->bands, f->height, 0, ISA(crack_rows), n);
	if (!code)
		code = bands_run(f->bands, f->height, 0, ISA(thin_rows), n);
	if (!code)
		code = n->seen ? ISA(seen_run)(n) : ENCRE_OK;
	if (!code)
		code = bands_run(f->bands, f->height, 0, ISA(ridge_rows), n);
	if (!code)
		code = gather(n);
	late_drop(&f->late, n->light);
	if (!code)
		code = ISA(fine_sort)(n);
	if (!code)
		code = clear(n);
	if (!code)
		code = ISA(fine_link)(n);
	if (!code)
		code = ISA(thin_tie)(n);
	if (!code)
		code = ISA(fine_smooth)(n);
	if (!code && n->e->on[SOURCE_COLOR])
		code = ISA(fine_crowd)(n);
	if (!code)
		code = ISA(fine_join_ends)(n);
	if (!code)
		show_strength(n);
	return code;
}
