/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Programs of materials: what the room's files share. */
#ifndef ENCRE_MATERIAL_H
#define ENCRE_MATERIAL_H

#include "base/stage.h"

enum {
	MATERIAL_BLOCK = 64,  /* pixels that a program is run for at once */
	MATERIAL_OUTPUTS = 7, /* the most that an operation has */
};

/* What an operation of a program is there for. */
enum {
	LEADS = 1,       /* to a result */
	LEADS_ASIDE = 2, /* to another result than normals */
	JUMPS = 4,       /* as operations.rows.h tells, and leads aside */
};

/* Pixels of one material, and what programs read of them. */
typedef struct block {
	const encre_materials *materials;
	const encre_program *program;
	const uint8_t *wanted;     /* by operation: LEADS, LEADS_ASIDE and JUMPS */
	uint8_t wants;             /* those of which one is to be run */
	int n;                     /* of MATERIAL_BLOCK; what lies beyond is computed, and means nothing */
	float aside[2];            /* from the middle of a pixel to where it is looked at, right and down, in pixels */
	float *reg;                /* program->n_registers x MATERIAL_BLOCK */
	float *reach;              /* by how much these differ within the pixel, at most; NULL: not asked for */
	bool jump[MATERIAL_BLOCK]; /* whether something may within the pixel; reach adds to it by operations of JUMPS */
	float channel[ENCRE_MAX_CHANNELS][MATERIAL_BLOCK];
	float right[ENCRE_MAX_CHANNELS][MATERIAL_BLOCK]; /* by how much it grows from a pixel to the next */
	float down[ENCRE_MAX_CHANNELS][MATERIAL_BLOCK];
	float place[3][MATERIAL_BLOCK], normal[3][MATERIAL_BLOCK];
	float beside[2][3][MATERIAL_BLOCK];                           /* by how much the place grows, right and down */
	float incoming[3][MATERIAL_BLOCK], camera[5][MATERIAL_BLOCK]; /* as operations.rows.h has them */
	int32_t thing[MATERIAL_BLOCK];
} block;

/* in[k] and out[k]: registers, MATERIAL_BLOCK numbers each. */
typedef void (*operation_run)(const block *b, const encre_operation *o, const float *const in[], float *const out[]);

/* by[k]: by how much in[k] differs within a pixel; out[k]: by how much what operation_run() gives does. */
typedef void (*operation_reach)(const block *b, const encre_operation *o, const float *const in[],
				const float *const by[], float *const out[]);

/* How many numbers an operation takes and gives; NULL: there is none of that code. */
const encre_operation_description *operation_info(int32_t code);
int operation_count(void);
bool operation_jumps(int32_t code);

/* Writes the levels of detail behind the first one of a picture of bytes, which are these. */
void picture_levels(const encre_picture *t, uint8_t *bytes);

/* Runs a block's program: of its operations those that are wanted. With `reach` the middle's, and tells of jumps. */
void ISA(material_run)(block *b);
/* Computes a job's outputs. Returns ENCRE_OK, ENCRE_ERROR_MEMORY or ENCRE_ERROR_CANCELLED. */
int32_t ISA(material_draw)(bands *pool, const encre_material_job *job);
int32_t material_draw_base(bands *pool, const encre_material_job *job);
#ifdef ENCRE_HAVE_V3
int32_t material_draw_v3(bands *pool, const encre_material_job *job);
#endif

#define EACH(name, inputs, value, jumps, reach)
#define OPERATION(name, inputs, outputs, jumps, reach)                                                                 \
	void ISA(run_##name)(const block *b, const encre_operation *o, const float *const in[], float *const out[]);   \
	void ISA(reach_##reach)(const block *b, const encre_operation *o, const float *const in[],                     \
				const float *const by[], float *const out[]);
#include "material/operations.rows.h"

#endif
