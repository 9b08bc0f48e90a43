/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes by which Blender draws chances of cells: Jenkins' of two to four numbers (lookup3), and PCG. */
#ifndef ENCRE_MATERIAL_HASH_H
#define ENCRE_MATERIAL_HASH_H

#include <stdint.h>

static inline uint32_t jenkins_rotated(uint32_t x, int k)
{
	return x << k | x >> (32 - k);
}

/* What all of its state begins with. */
static inline uint32_t jenkins_start(uint32_t numbers)
{
	return 0xdeadbeefu + (numbers << 2) + 13u;
}

/* Its last mixing, after which c is the hash. */
static inline uint32_t jenkins_end(uint32_t a, uint32_t b, uint32_t c)
{
	c = (c ^ b) - jenkins_rotated(b, 14);
	a = (a ^ c) - jenkins_rotated(c, 11);
	b = (b ^ a) - jenkins_rotated(a, 25);
	c = (c ^ b) - jenkins_rotated(b, 16);
	a = (a ^ c) - jenkins_rotated(c, 4);
	b = (b ^ a) - jenkins_rotated(a, 14);
	return (c ^ b) - jenkins_rotated(b, 24);
}

static inline uint32_t jenkins_of_two(uint32_t x, uint32_t y)
{
	uint32_t start = jenkins_start(2);
	return jenkins_end(start + x, start + y, start);
}

static inline uint32_t jenkins_of_three(uint32_t x, uint32_t y, uint32_t z)
{
	uint32_t start = jenkins_start(3);
	return jenkins_end(start + x, start + y, start + z);
}

static inline uint32_t jenkins_of_four(uint32_t x, uint32_t y, uint32_t z, uint32_t w)
{
	uint32_t start = jenkins_start(4), a = start + x, b = start + y, c = start + z;
	a = (a - c) ^ jenkins_rotated(c, 4), c += b;
	b = (b - a) ^ jenkins_rotated(a, 6), a += c;
	c = (c - b) ^ jenkins_rotated(b, 8), b += a;
	a = (a - c) ^ jenkins_rotated(c, 16), c += b;
	b = (b - a) ^ jenkins_rotated(a, 19), a += c;
	c = (c - b) ^ jenkins_rotated(b, 4), b += a;
	return jenkins_end(a + w, b, c);
}

/* By 16 bits, with the sign at the top. */
static inline uint32_t pcg_shifted(uint32_t x)
{
	return x >> 16 | (x & 0x80000000u ? 0xffff0000u : 0);
}

static inline void pcg_mix_two(uint32_t v[2])
{
	v[0] += v[1] * 1664525u;
	v[1] += v[0] * 1664525u;
}

static inline void pcg_mix_three(uint32_t v[3])
{
	v[0] += v[1] * v[2];
	v[1] += v[2] * v[0];
	v[2] += v[0] * v[1];
}

/* PCG of two numbers, of which 31 bits count. */
static inline void pcg_of_two(uint32_t v[2])
{
	v[0] = v[0] * 1664525u + 1013904223u;
	v[1] = v[1] * 1664525u + 1013904223u;
	pcg_mix_two(v);
	v[0] ^= pcg_shifted(v[0]);
	v[1] ^= pcg_shifted(v[1]);
	pcg_mix_two(v);
}

/* Likewise of three. */
static inline void pcg_of_three(uint32_t v[3])
{
	for (int c = 0; c < 3; c++)
		v[c] = v[c] * 1664525u + 1013904223u;
	pcg_mix_three(v);
	for (int c = 0; c < 3; c++)
		v[c] ^= pcg_shifted(v[c]);
	pcg_mix_three(v);
}

#endif
