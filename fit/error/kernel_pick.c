/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/kernel.h"

const struct kernel *kernel_pick(void)
{
#ifdef KERNEL_HAVE_AVX2
	if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
	    __builtin_cpu_supports("avx512bw"))
		return &kernel_avx512;
	if (__builtin_cpu_supports("avx2"))
		return &kernel_avx2;
#endif
	return &kernel_plain;
}
