/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "api/same.h"

#include <stdlib.h>
#include <string.h>

typedef struct writer {
	char *to; /* NULL: it only counts */
	size_t size;
} writer;

static void put(writer *w, const void *from, size_t size)
{
	if (w->to)
		memcpy(w->to + w->size, from, size);
	w->size += size;
}

/* Pixels that an IMAGE shows may change where they are, so that there is no macro for one. */
#define STAGE(...)
#define BOOL(id, ...) put(w, &p->id, sizeof p->id);
#define SWITCH BOOL
#define INT BOOL
#define FLOAT BOOL
#define ENUM BOOL
#define COLOR BOOL
#define LEVELS BOOL

/* What edges read of a style: their own rows, what is too short for a line, and of light the rows of its levels. */
static void put_style(writer *w, const encre_params *p, bool light)
{
#include "edges/edges.rows.h"
	put(w, &p->line_shortest, sizeof p->line_shortest);
	put(w, &p->line_smooth, sizeof p->line_smooth);
	put(w, &p->line_gap, sizeof p->line_gap);
	put(w, &p->line_halo, sizeof p->line_halo);
	put(w, &p->use_lines, sizeof p->use_lines);
	if (light) {
#include "surface/shade.rows.h"
	}
}

#undef STAGE
#undef BOOL
#undef SWITCH
#undef INT
#undef FLOAT
#undef ENUM
#undef COLOR
#undef LEVELS

static void put_key(writer *w, const frame *f, int64_t layers)
{
	bool light = false;
	int threads = bands_threads(f->bands);
	for (int i = 0; i < f->n_styles; i++)
		light |= f->params[i].line_shadow_strength > 0;
	put(w, &layers, sizeof layers);
	put(w, &f->width, sizeof f->width);
	put(w, &f->height, sizeof f->height);
	put(w, &f->camera, sizeof f->camera);
	put(w, &f->place, sizeof f->place);
	put(w, &f->scale, sizeof f->scale);
	put(w, &f->metered, sizeof f->metered);
	put(w, &f->n_styles, sizeof f->n_styles);
	put(w, &threads, sizeof threads); /* for each the stage plans memory */
	for (int i = 0; i < f->n_styles; i++)
		put_style(w, f->params + i, light);
}

bool edges_are_of(kept_edges *kept, const frame *f, int64_t layers)
{
	writer w = {0};
	/* the output is drawn with the edges */
	if (layers && f->want_edges && !f->output[ENCRE_OUTPUT_EDGES].data) {
		put_key(&w, f, layers);
		w.to = malloc(w.size);
	}
	if (w.to) {
		w.size = 0;
		put_key(&w, f, layers);
	}
	if (w.to && kept->key && w.size == kept->size && !memcmp(w.to, kept->key, w.size)) {
		free(w.to);
		return true;
	}
	edges_drop(kept);
	kept->key = w.to;
	kept->size = w.size;
	return false;
}

void edges_drop(kept_edges *kept)
{
	late_free(kept->late);
	kept->late = NULL;
	free(kept->key);
	kept->key = NULL;
	kept->size = 0;
}
