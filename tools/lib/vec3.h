/* SPDX-License-Identifier: MIT */
/* Vectors of three doubles. */
#ifndef VEC3_H
#define VEC3_H

#include <math.h>

static inline double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out may be neither a nor b. */
static inline void cross3(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Returns v's length before; v of length 0 is left alone. */
static inline double normalise3(double v[3])
{
    double length = sqrt(dot3(v, v));
    for (int i = 0; i < 3 && length > 0; i++) v[i] /= length;
    return length;
}

#endif
