/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From marks to sites: they are counted by row, so that their numbers don't depend on threads, placed, and sorted into
 * cells. */
#include "fine/near.h"

#include <string.h>

static const float touching = 0.02f; /* of the depth, apart at most */

/* ---- one site -------------------------------------------------------------------------------------------- */

/* The pixel, of those that the site parts, of what the line bounds: of the nearest thing, but where two things touch of
 * the one whose line is painted more. */
static void owner_of(const fine *n, const found *s, int *x, int *y)
{
	const frame *f = n->f;
	bool crack = is_crack(s->family);
	int right = clamp_index(s->column + (crack && s->axis != AXIS_COLUMN), f->width),
	    below = clamp_index(s->row + (crack && s->axis != AXIS_ROW), f->height);
	float least = INFINITY, most = -1;
	for (int qy = s->row; qy <= below; qy++)
		for (int qx = s->column; qx <= right; qx++)
			least = min(least, depth_at(f, qx, qy));
	float reach = least + touching * (n->e->ortho ? f->camera.height : least);
	for (int qy = s->row; qy <= below; qy++)
		for (int qx = s->column; qx <= right; qx++) {
			float z = depth_at(f, qx, qy);
			const float *controls = controls_at(f, qx, qy);
			float painted = controls ? fabsf(controls[CONTROL_THICKNESS]) : 0;
			if (z <= reach && (painted > most || (painted == most && z < depth_at(f, *x, *y)))) {
				most = painted;
				*x = qx;
				*y = qy;
			}
		}
}

/* The least depth of the 5x5 among pixels of the object that the line bounds: at the foot of a blade of grass the
 * ground before it is nearer, and has other controls. A thin thing's line may pass where no pixel is its own. */
int ISA(fine_controls)(const fine *n, const found *at, placed *s)
{
	const frame *f = n->f;
	plane object = f->layer[ENCRE_LAYER_OBJECT];
	int x = pixel_of(s->x, f->width), y = pixel_of(s->y, f->height), own_x = at->column, own_y = at->row;
	float least[2] = {INFINITY, INFINITY};
	int least_key[2] = {INT32_MAX, INT32_MAX}, near[2][2] = {{x, y}, {x, y}};
	owner_of(n, at, &own_x, &own_y);
	bool any = !object.data || at->family == FAMILY_THIN;
	if (families[at->family].word == WORD_SEEN) /* it lies in the mirror, whatever stands before that */
		least[0] = least[1] = 0;
	float own = any ? 0 : object.data[own_y * object.row + own_x];
	for (int dy = -2; dy <= 2; dy++) {
		if (y + dy < 0 || y + dy >= f->height)
			continue;
		for (int dx = -2; dx <= 2; dx++) {
			if (x + dx < 0 || x + dx >= f->width)
				continue;
			float z = depth_at(f, x + dx, y + dy);
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

bool ISA(fine_weigh)(const fine *n, placed *s, int style, enum source source, float strength)
{
	float weight = n->e->weight[source][style];
	const float *controls = controls_at(n->f, pixel_of(s->x, n->f->width), pixel_of(s->y, n->f->height));
	if (source == SOURCE_COLOR && controls)
		weight += controls[CONTROL_COLOR_EDGE];
	float weighted = weight > 0 ? weight * strength : 0;
	if (weighted > s->strength) {
		s->strength = weighted < FLT_MAX ? weighted : FLT_MAX;
		s->source = (uint8_t)source;
	}
	return s->strength > 0 && s->strength >= n->e->p->edge_threshold;
}

static void crack_of(const fine *n, const found *at, placed *s)
{
	switch ((enum family)at->family) {
	case FAMILY_MARK: ISA(hand_site)(n, at, s); break;
	case FAMILY_LIGHT: ISA(light_site)(n, at, s); break;
	default: ISA(crack_site)(n, at, s); ISA(thin_place)(n, at, s);
	}
}

/* The mean of the cracks between the four pixels from (column, row), with the strongest's strength. */
static void junction_site(const fine *n, const found *at, placed *s)
{
	const int32_t side[4][3] = {{0, 0, AXIS_ROW}, {0, 1, AXIS_ROW}, {0, 0, AXIS_COLUMN}, {1, 0, AXIS_COLUMN}};
	float x = 0, y = 0;
	int count = 0;
	for (int i = 0; i < 4; i++) {
		found one = {(uint16_t)(at->column + side[i][0]), (uint16_t)(at->row + side[i][1]), at->family,
			     (uint8_t)side[i][2]};
		placed its = {0};
		if (!(n->crack[(ptrdiff_t)one.row * n->f->width + one.column] & mark_of(one.family, one.axis)))
			continue;
		crack_of(n, &one, &its);
		x += its.x;
		y += its.y;
		count++;
		if (its.strength > s->strength) {
			s->strength = its.strength;
			s->source = its.source;
		}
	}
	s->x = x / (float)count;
	s->y = y / (float)count;
}

static void place_site(const fine *n, const found *at, placed *s)
{
	switch ((enum kind)families[at->family].kind) {
	case KIND_CRACK: at->axis == AXIS_JUNCTION ? junction_site(n, at, s) : crack_of(n, at, s); break;
	case KIND_THIN: ISA(thin_site)(n, at, s); break;
	case KIND_BAND:
	case KIND_STEP: ISA(ridge_site)(n, at, s); break;
	}
	ISA(fine_controls)(n, at, s);
}

/* ---- all sites, in order --------------------------------------------------------------------------------- */

static void visit(const fine *n, uint32_t *number, int family, int x, int y, int axis)
{
	if (n->site) {
		site *s = n->site + number[family];
		*s = (site){.found = {(uint16_t)x, (uint16_t)y, (uint8_t)family, (uint8_t)axis}};
		place_site(n, &s->found, &s->placed);
	}
	number[family]++;
}

static void visit_marks(const fine *n, uint32_t *number, int x, int y, enum word word, int marks)
{
	for (int bit = 0; marks; marks >>= 1, bit++)
		if (marks & 1)
			visit(n, number, marked_family[word][bit], x, y, bit % 2);
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
		visit_marks(n, number, x, y, WORD_CRACK, crack[x]);
		for (int bit = 0; crack[x] && inside && bit < 8; bit += 2)
			if (sides(crack, below, x, (uint8_t)(1 << bit)) > 2)
				visit(n, number, marked_family[WORD_CRACK][bit], x, y, AXIS_JUNCTION);
		visit_marks(n, number, x, y, WORD_RIDGE, ridge[x] & ~RIDGE_SEEN);
		if (ridge[x] & RIDGE_SEEN)
			visit_marks(n, number, x, y, WORD_SEEN, n->seen[(ptrdiff_t)y * width + x]);
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

int32_t ISA(fine_gather)(fine *n)
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
	code = bands_run(f->bands, f->height, 0, visit_rows, n);
	late_drop(&f->late, n->light);
	n->light = NULL;
	return code;
}

/* ---- cells ----------------------------------------------------------------------------------------------- */

static size_t cell_of(const fine *n, const site *s)
{
	int x = pixel_of(s->placed.x, n->f->width) / CELL, y = pixel_of(s->placed.y, n->f->height) / CELL;
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
