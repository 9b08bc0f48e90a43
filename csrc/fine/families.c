/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables that families.rows.h makes, and what the compiler must find true of its rows. */
#include "fine/fine.h"

#define FAMILY(id, kind, sample, rank, floor, unit, faint, crumb, word, bit)                                           \
	{#id, KIND_##kind, sample, RANK_##rank, floor, UNIT_##unit, FAINT_##faint, crumb, WORD_##word, bit},
const float least_faint = 0.5f;                           /* test_fine_sites */
const float clear_of_older = 1.5f, clear_of_turn = 0.75f; /* test_fine_passes */
const family_info families[FAMILY_COUNT] = {
#include "fine/families.rows.h"
};

#define FOUND_CHAIN(id, sample)
#define FOUND_CRACK(id, sample)
#define FOUND_THIN(id, sample)
#define FOUND_VALLEY(id, sample)
#define FOUND_BAND(id, sample) [sample].band = FAMILY_##id,
#define FOUND_STEP(id, sample) [sample].step = FAMILY_##id,
#define SAMPLE(id, from, count, as) [id].layer = ENCRE_LAYER_##from, [id].planes = (count), [id].form = FORM_##as,
#define FAMILY(id, kind, sample, ...) FOUND_##kind(id, sample)
const sample_info samples[SAMPLE_COUNT] = {
#include "fine/families.rows.h"
};

#define FAMILY(id, kind, sample, rank, floor, unit, faint, crumb, word, bit)                                           \
	[WORD_##word][bit] = FAMILY_##id, [WORD_##word][(bit) + 1] = FAMILY_##id,
const uint8_t marked_family[WORD_COUNT][16] = {
#include "fine/families.rows.h"
};

/* ---- what holds of the rows ------------------------------------------------------------------------------ */

#define STEP_OF_CHAIN(id, sample)
#define STEP_OF_CRACK(id, sample)
#define STEP_OF_THIN(id, sample)
#define STEP_OF_VALLEY(id, sample)
#define STEP_OF_BAND(id, sample)
#define STEP_OF_STEP(id, sample) STEP_IN_##sample = FAMILY_##id,
#define FAMILY(id, kind, sample, ...) STEP_OF_##kind(id, sample)
enum { /* one each, or the compiler refuses */
#include "fine/families.rows.h"
};

#define CHECK_CHAIN(id, sample)
#define CHECK_CRACK(id, sample)
#define CHECK_THIN(id, sample)
#define CHECK_VALLEY(id, sample)
#define CHECK_BAND(id, sample)                                                                                         \
	_Static_assert(FAMILY_##id + 1 == STEP_IN_##sample, #id ": a band stands before the step of its sample");
#define CHECK_STEP(id, sample)
#define FAMILY(id, kind, sample, rank, floor, unit, faint, crumb, word, bit)                                           \
	_Static_assert((KIND_##kind == KIND_CRACK) == (WORD_##word == WORD_CRACK),                                     \
		       #id ": cracks have marks of their own");                                                        \
	_Static_assert(KIND_##kind == KIND_VALLEY || ((int)(sample) >= SOURCE_SEEN && (int)(sample) < NO_SAMPLE) ==    \
							     (WORD_##word == WORD_MORE),                               \
		       #id ": what is seen has marks of its own");                                                     \
	_Static_assert((bit) + 1 < (WORD_##word == WORD_CRACK   ? 8                                                    \
				    : WORD_##word == WORD_RIDGE ? 14                                                   \
								: 16),                                                 \
		       #id ": the word has no such bit");                                                              \
	_Static_assert((bit) % 2 == 0, #id ": it has a pair of bits");                                                 \
	_Static_assert((int)(crumb) <= (int)ROOM, #id ": so many are not looked at");                                  \
	CHECK_##kind(id, sample)
#include "fine/families.rows.h"

#define FAMILY(id, kind, sample, rank, floor, unit, faint, crumb, word, bit)                                           \
	+((uint64_t)3 << (16 * WORD_##word + (bit)))
_Static_assert((0
#include "fine/families.rows.h"
		) == (0
#define FAMILY(id, kind, sample, rank, floor, unit, faint, crumb, word, bit)                                           \
	| ((uint64_t)3 << (16 * WORD_##word + (bit)))
#include "fine/families.rows.h"
		      ),
	       "two families have the same bit");
