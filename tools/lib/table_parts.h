/* SPDX-License-Identifier: MIT */
/* Inside of the table bake: samples of a BRDF in table coordinates, and the least-squares problem over texels. */
#ifndef TABLE_PARTS_H
#define TABLE_PARTS_H

#include <stddef.h>

#include "table_bake.h"

/* 0.0031308^(1/2.4): where the sRGB curve's linear toe ends. */
#define TABLE_TOE_END 0.09045

/* Where a pair of directions falls in a table, and the terms of its equations. */
typedef struct table_point {
    double t, s; /* 1 - n.h, sqrt(1 - l.h) */
    double a;    /* n.l - n.v */
    double l_dot_h;
} table_point;

/* 0 where the table defines nothing: a direction at or below the horizon, or l.v < TABLE_MIN_L_DOT_V. */
int table_locate(table_point *out, const double to_light[3], const double to_eye[3]);

/* Bilinear footprint of (u, v): texels first, first + 1, first + width, first + width + 1. */
typedef struct table_footprint {
    int first;
    double weight[4];
} table_footprint;

static inline void table_corners(const table_footprint *at, int width, int texel[4])
{
    texel[0] = at->first;
    texel[1] = at->first + 1;
    texel[2] = at->first + width;
    texel[3] = at->first + width + 1;
}

table_footprint table_filter(const table_asset *t, double one_less_n_dot_h, double s);

/* The largest |n.l - n.v| of directions above the horizon that fall nearer to a texel than its neighbours are. */
double table_reach(const table_asset *t, int column, int row);

/* a^2, |a|, a^4 */
enum { TABLE_BASES = 3 };
void table_bases(double a, double basis[TABLE_BASES]);

typedef struct table_sample {
    table_footprint at;
    double t, s; /* of table_point */
    int frame;   /* 0..TABLE_FRAMES - 1, or -1 */
    double basis[TABLE_BASES];
    double factor24;   /* (n.l / l.h)^(1/2.4): radiance^(1/2.4) = factor24 x root^(p/2.4) */
    double root[3];    /* of pi E f_r l.h, the value to store, at most TABLE_MAX_ROOTED_TWO^(1/p) */
    double display[3]; /* what that root shows */
    double slope[3];   /* and how fast it changes there */
    double weight;
} table_sample;

#define TABLE_FRAMES 79
#define TABLE_DIM24  0.5612310241546865 /* (1/4)^(1/2.4): 2 stops down */

/* Largest pi E f_r l.h that is kept: six stops above white; in two layers fourteen, so that peaks keep their energy. */
#define TABLE_MAX_ROOTED     64.0
#define TABLE_MAX_ROOTED_TWO 16384.0

typedef struct table_samples {
    table_sample *sample; /* malloc'd */
    size_t count, frames; /* those of sphere frames come first, those of a grid over the columns and rows behind them */
} table_samples;

/* Samples of b for t, of which all but the texels is set. FAIL_INVALID: b is not finite somewhere. */
int table_samples_make(table_samples *out, const brdf *b, const table_asset *t, failure *f);
/* Find their texels again after t's size, eps or row curve changed. */
void table_samples_place(table_samples *s, const table_asset *t);
/* The same, with the grid where the columns are now. */
int table_samples_regrid(table_samples *s, const brdf *b, const table_asset *t, failure *f);
void table_samples_free(table_samples *s);
/* Every step-th sample. */
table_samples table_samples_thin(const table_samples *s, int step);

/* 1 if t, drawn without the linear toe of the sRGB curve, would be visibly further from the samples than with it. */
int table_wants_toe(const table_asset *t, const table_samples *s);

/* Set t's row curve, and eps if asked to, to what suits the samples. */
void table_choose_place(table_asset *t, const table_samples *s, int choose_eps);

/* Display value of a root at a sample, and its slope by the root. The curve is sRGB, continued above 1 by 1 + 0.06 ln of the
   radiance so that highlights keep some weight. Negative roots count as 0. */
double table_show(const table_sample *s, double power, double root, double *slope);

/* y of a table at a point, R G B, not below 0: (Ymax y)^p = pi E f_r l.h. */
void table_y(const table_asset *t, const table_point *point, double y[3]);

/* What a texel holds: three base roots, then coefficients. Coefficient j adds x[3 + j] basis[kind] g[channel]. */
#define TABLE_MAX_COEFFICIENTS 5
#define TABLE_MAX_UNKNOWNS     (3 + TABLE_MAX_COEFFICIENTS)
typedef struct table_model {
    int width, height;
    double power;
    int coefficients; /* 0..TABLE_MAX_COEFFICIENTS */
    struct {
        int kind; /* index of table_sample.basis */
        double g[3];
    } coefficient[TABLE_MAX_COEFFICIENTS];
} table_model;

static inline int table_unknowns(const table_model *m)
{
    return 3 + m->coefficients;
}

/* Directional albedos of a BRDF at polar angles of the view of 0, 7.5, .. 82.5 degrees, and the points that add up to a
   table's own. */
enum { TABLE_SKY_VIEWS = 12, TABLE_SKY_TERMS = 3 * TABLE_SKY_VIEWS };
typedef struct table_sky_point {
    table_footprint at;
    double t, s; /* of table_point */
    int view;
    double basis[TABLE_BASES];
    double weight; /* of root^p */
} table_sky_point;

typedef struct table_sky {
    table_sky_point *point; /* malloc'd */
    size_t count;
    double albedo[TABLE_SKY_VIEWS][3];
    double scale[TABLE_SKY_VIEWS]; /* from albedo to residual: root of the view's weight over the albedo's luminance */
    double most[3];                /* largest root of a point, at most TABLE_MAX_ROOTED_TWO^(1/p) */
} table_sky;

/* weight: of a relative error of 1, beside display errors of 1. */
table_sky table_sky_make(const brdf *b, const table_asset *t, double weight);
void table_sky_place(table_sky *sky, const table_asset *t);
void table_sky_free(table_sky *sky);

/* How strongly a solution is held back. */
typedef struct table_hold {
    double smooth;      /* weight of second differences along u and v */
    double ridge;       /* weight of the update's square */
    double coefficient; /* both times this for coefficients */
} table_hold;

/* What suits t's size and so many samples; ridge in parts of samples per ten texels. */
#define TABLE_RIDGE_CLOSED 1e-7 /* of table_solve_closed */
table_hold table_hold_of(const table_samples *s, const table_asset *t, double ridge);

/* The least-squares problem of an update dx of x: (H + smooth R + ridge) dx = rhs - smooth R x, R = D^T D for second
   differences D along both axes. A texel's blocks of H: with itself and with its neighbours at (+1, 0), (-1, +1), (0, +1),
   (+1, +1); each block is symmetric, so the opposite neighbours share it. */
enum { TABLE_SELF, TABLE_RIGHT, TABLE_DOWN_LEFT, TABLE_DOWN, TABLE_DOWN_RIGHT, TABLE_STENCIL };

typedef struct table_problem {
    const table_model *model;
    const table_samples *samples;
    const table_sky *sky; /* NULL: albedos do not count */
    int n;                /* unknowns per texel */
    int width, height, texels;
    double smooth[TABLE_MAX_UNKNOWNS], ridge[TABLE_MAX_UNKNOWNS];
    double *block;   /* texels x TABLE_STENCIL x n x n */
    double *rhs;     /* texels x n */
    double *inverse; /* texels x n x n: of the diagonal blocks */
    double *pull;    /* texels x n x TABLE_SKY_TERMS: how albedos, weighted, change with x; NULL without sky */
} table_problem;

table_problem table_problem_make(const table_model *m, const table_samples *s, const table_sky *sky,
                                 const table_hold *hold);
void table_problem_free(table_problem *p);

/* Weighted relative errors of albedos (truth - table), and in *pull (may be NULL) how the table's change with x. */
void table_sky_residuals(const table_problem *p, const double *x, double *pull, double residual[TABLE_SKY_TERMS]);

/* Root the table draws at a sample, per channel. */
void table_drawn_at(const table_problem *p, const table_footprint *at, const double basis[TABLE_BASES], const double *x,
                    double root[3]);
void table_drawn(const table_problem *p, const table_sample *s, const double *x, double root[3]);

/* Add a sample whose drawn roots have the slopes and residuals given (display units, per channel). */
void table_accumulate(table_problem *p, const table_sample *s, const double slope[3], const double residual[3]);

/* Fill H and rhs for small changes of x: residuals and slopes of display values. */
void table_linearize(table_problem *p, const double *x);

/* y += (H + smooth R + ridge) e, e = delta at one unknown of one texel, else 0. */
void table_apply_one(const table_problem *p, int texel, int unknown, double delta, double *y);

/* Sum over albedos of pull at an unknown (texel x n + its number) x sum. */
double table_pulled(const table_problem *p, int index, const double sum[TABLE_SKY_TERMS]);

/* Diagonal of H + smooth R + ridge. */
double table_stiffness(const table_problem *p, int texel, int unknown);

void table_add_smoothing(const table_problem *p, const double *x, double *y); /* y += smooth R x */
void table_apply(const table_problem *p, const double *x, double *y);         /* y = (H + smooth R + ridge) x */
void table_solve(table_problem *p, const double *x, double *dx);

/* Every texel at the mean of the roots, without coefficients. malloc'd. */
double *table_start(const table_model *m, const table_samples *s);

/* x: table_unknowns(m) doubles per texel. Both solvers start from what is in x. */
void table_solve_closed(const table_model *m, const table_samples *s, const table_hold *hold, double *x);
void table_solve_display(const table_model *m, const table_samples *s, const table_sky *sky, const table_hold *hold,
                         int steps, double *x);

/* The codes of t (scales set, texels allocated) for x: the nearest ones first, then one after the other moved to where
   the linearised display error in p is least. Returns that error, comparable between scales of one x and p. */
double table_round(table_asset *t, const table_problem *p, const double *x);

/* Leading eigenvectors of sum over texels H c c^T for a model whose first three coefficients are one per channel and of one
   kind (H: mean diagonal of their block of the closed form's normal matrix), sign so that the sum is positive, largest
   |value| 1. count: 1 or 2. */
void table_weight_vectors(const table_model *m, const table_samples *s, const double *x, int count, double w[2][3]);

#endif
