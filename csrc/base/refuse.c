/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/refuse.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

int32_t refuse(char *error, size_t size, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(error, size, format, arguments);
	va_end(arguments);
	return ENCRE_ERROR_ARGUMENT;
}

bool all_finite(const double *values, int n)
{
	for (int i = 0; i < n; i++)
		if (!isfinite(values[i]))
			return false;
	return true;
}
