/* SPDX-License-Identifier: MIT */
/* One light at one pixel with directions of its own: what every model asks of it. */
#ifndef SHADE_EVAL_PERSP_INNER_H
#define SHADE_EVAL_PERSP_INNER_H

#include "eval_inner.h"
#include "eval_persp.h"

#define LOG2_CODE_Q12 61417       /* log2(32640): code 255 x 128 */
#define MOST_LOG2     (18 * 4096) /* four times white, q16 */

typedef struct shade_arriving {
    eval_surface l;      /* unit */
    int32_t log2_square; /* of the distance, q12; 0 for directional lights */
} shade_arriving;

typedef struct shade_halfway {
    eval_surface h;
    int32_t l_dot_h; /* q14, at least 2^-6 */
    int32_t s, away; /* sqrt(1 - l.h) and its square, q15 */
} shade_halfway;

shade_arriving shade_arriving_of(const shade_persp_light *light, const shade_seen *seen, int i);
shade_halfway shade_halfway_of(const eval_surface *l, const eval_surface *v);

/* q28 */
EVAL_INLINE int32_t eval_dot_of(const eval_surface *a, const eval_surface *b)
{
    return a->x * b->x + a->y * b->y + a->z * b->z;
}

#endif
