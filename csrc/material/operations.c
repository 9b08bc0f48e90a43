/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be told of operations. */
#include "material/material.h"

static const encre_operation_description descriptions[] = {
#define EACH(name, inputs, value, jumps, reach) {#name, inputs, 1},
#define OPERATION(name, inputs, outputs, jumps, reach) {#name, inputs, outputs},
#include "material/operations.rows.h"
};

static const bool jumping[] = {
#define EACH(name, inputs, value, jumps, reach) jumps,
#define OPERATION(name, inputs, outputs, jumps, reach) jumps,
#include "material/operations.rows.h"
};

int operation_count(void)
{
	return (int)(sizeof descriptions / sizeof *descriptions);
}

const encre_operation_description *operation_info(int32_t code)
{
	return code >= 0 && code < operation_count() ? descriptions + code : NULL;
}

bool operation_jumps(int32_t code)
{
	return jumping[code];
}
