/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edges of a context's last frame. They are those of the next, too, if its layers are the same, and what edges read
 * of its parameters is: a slider of ink, of paper or of shade does not find them again. */
#ifndef ENCRE_SAME_H
#define ENCRE_SAME_H

#include "base/stage.h"

typedef struct kept_edges {
	arena_held memory; /* planned by the stage */
	late *late;        /* taken by it besides */
	char *key;         /* what they are of; NULL: of nothing */
	size_t size;       /* bytes of the key; without one 0, or so many for which there is no memory */
} kept_edges;

/* Whether these are the edges of a frame, of which all is known that is known before it is planned. If not, they are
 * dropped, and are taken to become its own: of layers with the number 0 not for long. */
bool edges_are_of(kept_edges *kept, const frame *f, int64_t layers);
/* They are of nothing, and only what is planned stays. */
void edges_drop(kept_edges *kept);

#endif
