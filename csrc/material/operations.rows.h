/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* What programs of materials are made of.
 *
 *   EACH(name, inputs, value, jumps, reach)         one number of at most three, a, b and c
 *   OPERATION(name, inputs, outputs, jumps, reach)  a function in machine.c, texture.c, patterns.c or voronoi.c
 *
 * `jumps`: 1 of what jumps where what it takes does not. `reach`: by how much the value differs from that of the middle
 * within a pixel, at most, of inputs that differ by da, db and dc; INFINITY where it jumps, or nobody knows. What is
 * NaN is INFINITY. Of an OPERATION it names a function: `same` where nothing differs, `unknown` where nothing is known
 * if an input differs at all.
 *
 * `data` of an operation: of constant and thing, which; of channel, the channel; of footprint, the first of three
 * channels and the first of six constants, what u and v grow by with each; of texture, which; of ramp and steps, the
 * first of its constants, a place and a colour with alpha for each stop, and how many stops; of curve, the first of
 * its constants and how many of them lie evenly from 0 to 1; of brick, the first of nine constants: offset, its
 * frequency, squash, its frequency, size of the mortar, its smoothness, bias, width and height of a brick; of noise,
 * the first of two: whole octaves, and the share of the next; of voronoi and its like, how lengths are measured (0:
 * Euclidean, 1: Manhattan, 2: Chebychev), and the sum of 1 where the third coordinate does not count and 2 where chances
 * are PCG's (Blender 5), not Jenkins'. These take a place, how random the points are and how smooth, and give a
 * distance, a colour and a point. beside is by how much the place grows to the pixels right and down, for bumps.
 * incoming is the unit vector to where the place is looked at from, camera the place as the camera has it (right, up,
 * ahead) and in the frame (0 to 1, from the left and from below). No guard: included once per use, which defines EACH
 * and OPERATION. */
OPERATION(constant, 0, 1, 0, same)
OPERATION(channel, 0, 1, 0, channel)
OPERATION(place, 0, 3, 0, place)
OPERATION(normal, 0, 3, 0, same)
OPERATION(incoming, 0, 3, 0, same)
OPERATION(camera, 0, 5, 0, same)
OPERATION(thing, 0, 1, 0, same)
EACH(add, 2, a + b, 0, da + db)
EACH(subtract, 2, a - b, 0, da + db)
EACH(multiply, 2, a * b, 0, fabsf(a) * db + fabsf(b) * da + da * db)
EACH(divide, 2, b != 0 ? a / b : 0, 0, db == 0 && b != 0 ? da / fabsf(b) : da + db > 0 ? INFINITY : 0)
EACH(minimum, 2, a < b ? a : b, 0, max(da, db))
EACH(maximum, 2, a > b ? a : b, 0, max(da, db))
EACH(less, 2, a < b ? 1 : 0, 1, a + da < b - db || a - da >= b + db ? 0 : INFINITY)
EACH(greater, 2, a > b ? 1 : 0, 1, a - da > b + db || a + da <= b - db ? 0 : INFINITY)
EACH(mix, 3, a + c * (b - a), 0, fabsf(1 - c) * da + fabsf(c) * db + fabsf(b - a) * dc + (da + db) * dc)
EACH(absolute, 1, fabsf(a), 0, da)
EACH(floor, 1, floorf(a), 1, floorf(a - da) == floorf(a + da) ? 0 : INFINITY)
EACH(root, 1, a > 0 ? sqrtf(a) : 0, 0, sqrtf(positive(a + da)) - sqrtf(positive(a - da)))
EACH(clamp, 1, clamp01(a), 0, clamp01(a + da) - clamp01(a - da))
EACH(sine, 1, pixel_sin(min(max(a, -1e4f), 1e4f)), 0, da)
EACH(cosine, 1, pixel_cos(min(max(a, -1e4f), 1e4f)), 0, da)
EACH(angle, 2, pixel_atan2(far_from_nothing(a), far_from_nothing(b)), 0, da + db > 0 ? INFINITY : 0)
EACH(power, 2, signed_power(bounded(a), bounded(b)), 0, da + db > 0 ? INFINITY : 0)
EACH(logarithm, 1, a > 0 ? pixel_log(bounded(a)) : 0, 0, da > 0 ? INFINITY : 0)
OPERATION(footprint, 0, 4, 0, same)
OPERATION(texture, 6, 4, 0, unknown)
OPERATION(ramp, 1, 4, 0, unknown)
OPERATION(steps, 1, 4, 1, steps)
OPERATION(curve, 1, 1, 0, unknown)
OPERATION(to_hsv, 3, 3, 0, unknown)
OPERATION(from_hsv, 3, 3, 0, unknown)
OPERATION(checker, 3, 1, 1, checker)
OPERATION(brick, 2, 2, 1, brick)
OPERATION(noise, 4, 1, 0, unknown)
OPERATION(voronoi, 4, 7, 0, unknown)
OPERATION(voronoi_second, 4, 7, 0, unknown)
OPERATION(voronoi_smooth, 5, 7, 0, unknown)
OPERATION(voronoi_edge, 4, 1, 0, unknown)
OPERATION(beside, 0, 6, 0, same)
#undef EACH
#undef OPERATION
