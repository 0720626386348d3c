/* SPDX-License-Identifier: MIT */
#include "lafortune_pairs.h"

#include <math.h>
#include <stdlib.h>

#include "failure.h"

static const double pi = 3.14159265358979323846;

/* views by step degrees, at azimuths over turn degrees; half vectors: polar angles x azimuths. */
typedef struct layout {
    int views, azimuths, half, around;
    double step, turn;
} layout;

static const layout layouts[2][2] = {
    {{16, 1, 32, 16, 5, 360}, {6, 12, 24, 24, 15, 360}},
    {{4, 1, 12, 6, 25, 360}, {3, 4, 8, 8, 30, 180}},
};

/* Light directions by their half vectors, close together around the normal: theta_half = 90 degrees x u^4, u in the
   middles of steps; d(light) = 4 l.h d(half). Isotropic materials: azimuths of one side. */
static void add_view(lafortune_pairs *p, const layout *d, double view_polar, double view_azimuth)
{
    double side = d->azimuths > 1 ? 2 * pi : pi;
    double v[3] = {sin(view_polar) * cos(view_azimuth), sin(view_polar) * sin(view_azimuth), cos(view_polar)};
    for (int i = 0; i < d->half * d->around; i++) {
        double u = (i / d->around + 0.5) / d->half, theta = pi / 2 * u * u * u * u;
        double azimuth = view_azimuth + side * (i % d->around + 0.5) / d->around;
        double h[3] = {sin(theta) * cos(azimuth), sin(theta) * sin(azimuth), cos(theta)};
        double v_dot_h = v[0] * h[0] + v[1] * h[1] + v[2] * h[2], l[3];
        for (int k = 0; k < 3; k++) l[k] = 2 * v_dot_h * h[k] - v[k];
        if (!(v_dot_h > 0 && l[2] > 0)) continue;
        int at = p->samples.count++;
        double solid_angle = 4 * v_dot_h * sin(theta) * u * u * u;
        p->samples.weight[at] = sqrt(solid_angle) * l[2];
        for (int k = 0; k < 3; k++) {
            p->samples.product[at][k] = l[k] * v[k];
            p->direction[at][k] = l[k];
            p->direction[at][3 + k] = v[k];
        }
    }
    p->view_end[p->views++] = p->samples.count;
}

lafortune_pairs lafortune_pairs_make(lafortune_density density, int anisotropic)
{
    const layout *d = &layouts[density][anisotropic != 0];
    size_t most = (size_t)(d->views * d->azimuths * d->half * d->around);
    lafortune_pairs p = {.samples = {0, need_memory(most, sizeof(double[3])), need_memory(most, sizeof(double))},
                         .direction = need_memory(most, sizeof(double[6])),
                         .value = need_memory(most, sizeof(double[3]))};
    for (int i = 0; i < d->views * d->azimuths; i++)
        add_view(&p, d, (i / d->azimuths) * d->step * (pi / 180),
                 d->turn * (pi / 180) * (i % d->azimuths) / d->azimuths);
    for (int i = 0; i < p.samples.count && density == LAFORTUNE_COARSE; i++) p.samples.weight[i] *= p.direction[i][5];
    return p;
}

void lafortune_pairs_free(lafortune_pairs *p)
{
    free(p->samples.product);
    free(p->samples.weight);
    free(p->direction);
    free(p->value);
}
