/* SPDX-License-Identifier: MIT */
/* The inner loops with SSE4.1: compile this file with -msse4.1; without it, it is empty. */
#include "soft.h"

#ifdef __SSE4_1__

#include "lanes_sse41.h"

#include "kernels.h"

const nacre_soft_kernels nacre_soft_sse41 = KERNELS;

#endif
