/* SPDX-License-Identifier: MIT */
/* The inner loops with NEON, of ARMv8 and, with -mfpu=neon, of ARMv7; without it, this file is empty. */
#include "soft.h"

#if defined(__ARM_NEON) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__

#include "lanes_neon.h"

#include "kernels.h"

const nacre_soft_kernels nacre_soft_neon = KERNELS;

#endif
