/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include "brdf_kit.h"

#include <cmocka.h> /* last: it makes fail a macro */

brdf *open_name(const char *name)
{
    brdf *b = NULL;
    failure f = {0};
    if (brdf_open(&b, name, &f)) fail_msg("%s: %s", name, f.text);
    return b;
}

sphere_asset bake_spheres(const char *name, const sphere_options *options)
{
    brdf *b = open_name(name);
    sphere_asset s;
    failure f = {0};
    if (sphere_bake(&s, b, options, &f)) fail_msg("%s: %s", name, f.text);
    brdf_close(b);
    return s;
}

void assert_spheres_need_no_threads(const char *name, const sphere_options *options)
{
    bytes file[2] = {{0}};
    const int threads = omp_get_max_threads();
    for (int i = 0; i < 2; i++) {
        omp_set_num_threads(i ? 3 : 1);
        sphere_asset s = bake_spheres(name, options);
        sphere_write(&s, &file[i]);
        sphere_free(&s);
    }
    omp_set_num_threads(threads);
    assert_int_equal(file[0].size, file[1].size);
    assert_memory_equal(file[0].data, file[1].data, file[0].size);
    bytes_free(&file[0]);
    bytes_free(&file[1]);
}

double random_unit(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (*state >> 8) / 16777216.0;
}

void random_direction(uint32_t *state, double d[3])
{
    const double pi = 3.14159265358979323846;
    double z = random_unit(state), azimuth = 2 * pi * random_unit(state), across = sqrt(1 - z * z);
    d[0] = across * cos(azimuth);
    d[1] = across * sin(azimuth);
    d[2] = z;
}
