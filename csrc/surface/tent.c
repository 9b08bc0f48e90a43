/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A blur by a tent, as sums that go on from pixel to pixel: the next has one more of each pixel ahead, and one less of
 * each behind. */
#include "surface/tent.h"

#include <string.h>

void ISA(tent_row)(int n, int reach, const uint16_t *restrict line, uint16_t *restrict out)
{
	int32_t sum[TENT_CHANNELS] = {0}, ahead[TENT_CHANNELS] = {0}, behind[TENT_CHANNELS] = {0};
	float share = 1 / (float)(reach * reach);
	for (int k = 1 - reach; k <= reach; k++)
		for (int c = 0; c < TENT_CHANNELS; c++) {
			int32_t v = line[TENT_CHANNELS * k + c];
			sum[c] += v * (reach - (k < 0 ? -k : k));
			ahead[c] += k > 0 ? v : 0;
			behind[c] += k > 0 ? 0 : v;
		}
	for (int x = 0; x < n; x++)
		for (int c = 0; c < TENT_CHANNELS; c++) {
			out[TENT_CHANNELS * x + c] = (uint16_t)((float)sum[c] * share + 0.5f);
			sum[c] += ahead[c] - behind[c];
			ahead[c] += line[TENT_CHANNELS * (x + reach + 1) + c] - line[TENT_CHANNELS * (x + 1) + c];
			behind[c] += line[TENT_CHANNELS * (x + 1) + c] - line[TENT_CHANNELS * (x - reach + 1) + c];
		}
}

static const uint16_t *row_at(const uint16_t *rows, int width, int height, int y)
{
	return rows + (ptrdiff_t)TENT_CHANNELS * width * clamp_index(y, height);
}

void ISA(tent_begin)(const uint16_t *rows, int width, int height, int reach, int y, int32_t *restrict sums)
{
	int n = TENT_CHANNELS * width;
	memset(sums, 0, (size_t)n * 3 * sizeof *sums);
	for (int k = 1 - reach; k <= reach; k++) {
		const uint16_t *restrict row = row_at(rows, width, height, y + k);
		int32_t weight = reach - (k < 0 ? -k : k), *restrict side = sums + (ptrdiff_t)n * (k > 0 ? 1 : 2);
		for (int i = 0; i < n; i++)
			sums[i] += row[i] * weight;
		for (int i = 0; i < n; i++)
			side[i] += row[i];
	}
}

void ISA(tent_next)(const uint16_t *rows, int width, int height, int reach, int y, int32_t *sums)
{
	int n = TENT_CHANNELS * width;
	const uint16_t *restrict last = row_at(rows, width, height, y + reach + 1),
				 *restrict next = row_at(rows, width, height, y + 1),
				 *restrict first = row_at(rows, width, height, y - reach + 1);
	int32_t *restrict sum = sums, *restrict ahead = sums + n, *restrict behind = ahead + n;
	for (int i = 0; i < n; i++) {
		sum[i] += ahead[i] - behind[i];
		ahead[i] += last[i] - next[i];
		behind[i] += next[i] - first[i];
	}
}
