/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/pixel.h"

const float pixel_zero = 0, pixel_half = 0.5f, pixel_one = 1, pixel_most = FLT_MAX, pixel_great = 1e15f;
