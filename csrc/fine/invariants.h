/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What must hold after the passes of FINE. Debug builds check it and stop the program where it does not. */
#ifndef ENCRE_FINE_INVARIANTS_H
#define ENCRE_FINE_INVARIANTS_H

#include "fine/fine.h"

#ifdef ENCRE_DEBUG
#define BROKEN(name) broken_##name
#else
#define BROKEN(name) NULL
#endif

/* Each returns NULL, or a sentence that is not true though it should be. */
const char *broken_cracks(const fine *n);
const char *broken_ridges(const fine *n);
const char *broken_sites(const fine *n);
const char *broken_cells(const fine *n);
const char *broken_claims(const fine *n);
const char *broken_links(const fine *n);
const char *broken_crowd(const fine *n);
const char *broken_joined(const fine *n);

/* Stops the program of a debug build with the sentence, if there is one. */
#ifdef ENCRE_DEBUG
void demand(const char *pass, const char *broken);
#else
static inline void demand(const char *pass, const char *broken)
{
	(void)pass;
	(void)broken;
}
#endif

#endif
