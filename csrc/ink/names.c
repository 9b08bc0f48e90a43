/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What kinds of line are called. */
#include "ink/pen.h"

#define LINE(kind, id, width, label) {#id, label},
static const encre_line_description lines[] = {LINES(LINE)};
#undef LINE

const encre_line_description *encre_line_info(int32_t line)
{
	return line >= 0 && line < LINE_COUNT ? lines + line : NULL;
}
