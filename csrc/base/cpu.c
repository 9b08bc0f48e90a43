/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The processor is asked itself: __builtin_cpu_supports() reads what the compiler's runtime library has found, and that
 * of some, as of the compiler that wheels are built by, never looks and says no to all. */
#include "base/cpu.h"

#ifdef ENCRE_HAVE_V3
#include <cpuid.h>

static bool has(unsigned bits, unsigned wanted)
{
	return (bits & wanted) == wanted;
}

bool cpu_runs_v3(void)
{
	enum {
		FMA = 1 << 12,
		MOVBE = 1 << 22,
		XSAVE = 1 << 27,
		AVX = 1 << 28,
		F16C = 1 << 29, /* of leaf 1, ecx */
		BMI1 = 1 << 3,
		AVX2 = 1 << 5,
		BMI2 = 1 << 8,              /* of leaf 7, ebx */
		LZCNT = 1 << 5,             /* of leaf 0x80000001, ecx */
		REGISTERS = 1 << 1 | 1 << 2 /* SSE's and AVX', which the system saves */
	};
	unsigned a, b, c, d;
	if (!__get_cpuid(1, &a, &b, &c, &d) || !has(c, FMA | MOVBE | XSAVE | AVX | F16C))
		return false;
	if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || !has(b, BMI1 | AVX2 | BMI2))
		return false;
	if (!__get_cpuid(0x80000001, &a, &b, &c, &d) || !has(c, LZCNT))
		return false;
	__asm__ volatile("xgetbv" : "=a"(a), "=d"(d) : "c"(0));
	return has(a, REGISTERS);
}
#else
bool cpu_runs_v3(void)
{
	return false;
}
#endif
