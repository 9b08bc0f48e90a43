/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linked into a library whose every basic block calls this (-fsanitize-coverage=trace-pc): work as a number, the same
 * on a busy machine and a quiet one. */
__attribute__((visibility("default"))) unsigned long work;

void __sanitizer_cov_trace_pc(void)
{
	work++;
}
