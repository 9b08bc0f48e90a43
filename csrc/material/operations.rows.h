/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* What programs of materials are made of.
 *
 *   EACH(name, inputs, value of a, b and c)   one number of at most three
 *   OPERATION(name, inputs, outputs)          a function in machine.c, texture.c, patterns.c or voronoi.c
 *
 * `data` of an operation: of constant and thing, which; of channel, the channel; of footprint, the first of three
 * channels and the first of six constants, what u and v grow by with each; of texture, which; of ramp and steps, the
 * first of its constants, a place and a colour with alpha for each stop, and how many stops; of curve, the first of
 * its constants and how many of them lie evenly from 0 to 1; of brick, the first of nine constants: offset, its
 * frequency, squash, its frequency, size of the mortar, its smoothness, bias, width and height of a brick; of noise,
 * the first of two: whole octaves, and the share of the next; of voronoi and its like, how lengths are measured (0:
 * Euclidean, 1: Manhattan, 2: Chebychev), and the sum of 1 where the third coordinate does not count and 2 where chances
 * are PCG's (Blender 5), not Jenkins'. These take a place, how random the points are and how smooth, and give a
 * distance, a colour and a point. beside is by how much the place grows to the pixels right and down, for bumps. No
 * guard: included once per use, which defines EACH and OPERATION. */
OPERATION(constant, 0, 1)
OPERATION(channel, 0, 1)
OPERATION(place, 0, 3)
OPERATION(normal, 0, 3)
OPERATION(thing, 0, 1)
EACH(add, 2, a + b)
EACH(subtract, 2, a - b)
EACH(multiply, 2, a * b)
EACH(divide, 2, b != 0 ? a / b : 0)
EACH(minimum, 2, a < b ? a : b)
EACH(maximum, 2, a > b ? a : b)
EACH(less, 2, a < b ? 1 : 0)
EACH(greater, 2, a > b ? 1 : 0)
EACH(mix, 3, a + c * (b - a))
EACH(absolute, 1, fabsf(a))
EACH(floor, 1, floorf(a))
EACH(root, 1, a > 0 ? sqrtf(a) : 0)
EACH(clamp, 1, clamp01(a))
EACH(sine, 1, pixel_sin(min(max(a, -1e4f), 1e4f)))
EACH(cosine, 1, pixel_cos(min(max(a, -1e4f), 1e4f)))
EACH(angle, 2, pixel_atan2(far_from_nothing(a), far_from_nothing(b)))
EACH(power, 2, signed_power(bounded(a), bounded(b)))
OPERATION(footprint, 0, 4)
OPERATION(texture, 6, 4)
OPERATION(ramp, 1, 4)
OPERATION(steps, 1, 4)
OPERATION(curve, 1, 1)
OPERATION(to_hsv, 3, 3)
OPERATION(from_hsv, 3, 3)
OPERATION(checker, 3, 1)
OPERATION(brick, 2, 2)
OPERATION(noise, 4, 1)
OPERATION(voronoi, 4, 7)
OPERATION(voronoi_second, 4, 7)
OPERATION(voronoi_smooth, 5, 7)
OPERATION(voronoi_edge, 4, 1)
OPERATION(beside, 0, 6)
#undef EACH
#undef OPERATION
