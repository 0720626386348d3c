/* SPDX-License-Identifier: MIT */
/* The inner loops with AVX2: compile this file with -mavx2; without it, it is empty. */
#include "soft.h"

#ifdef __AVX2__

#include "lanes_avx2.h"

#include "kernels.h"

const nacre_soft_kernels nacre_soft_avx2 = KERNELS;

#endif
