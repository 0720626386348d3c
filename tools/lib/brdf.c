/* SPDX-License-Identifier: MIT */
#include "brdf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ktx2_write.h"
#include "merl.h"
#include "models.h"
#include "nacre.h"
#include "nacre_asset.h"
#include "options.h"
#include "output.h"
#include "published.h"
#include "rgl.h"
#include "sphere_bake.h"
#include "table_bake.h"

static const double pi = 3.14159265358979323846;

/* ---- opening ------------------------------------------------------------------------------------------------------ */

static int ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end);
    return n > m && strcmp(text + n - m, end) == 0;
}

int brdf_open_image(brdf **out, const nacre_image *image, const char *path, failure *f)
{
    char role[32];
    ktx2_role(image, role, sizeof role);
    int code;
    if (strcmp(role, "table") == 0) {
        table_asset table = {0};
        code = table_read(&table, image, path, f);
        if (code) return code;
        *out = table_brdf(&table);
        snprintf((*out)->description, sizeof(*out)->description, "table %d x %d, %d layer%s, of %.180s", table.width,
                 table.height, table.layers, table.layers == 1 ? "" : "s", table.name);
        table_free(&table);
        return 0;
    }
    if (strcmp(role, "spheres") == 0) {
        sphere_asset spheres = {0};
        code = sphere_read(&spheres, image, path, f);
        if (code) return code;
        *out = sphere_brdf(&spheres, NULL);
        snprintf((*out)->description, sizeof(*out)->description, "%d sphere images %d x %d (%s), of %.180s",
                 spheres.layers, spheres.size, spheres.size, sphere_mode_names[spheres.mode], spheres.name);
        sphere_free(&spheres);
        return 0;
    }
    return fail(f, FAIL_UNSUPPORTED, "%s: key %s: found \"%s\", expected \"table\" or \"spheres\"", path,
                NACRE_KEY_ROLE, role);
}

static int open_asset(brdf **out, const char *path, failure *f)
{
    bytes file = {0};
    int code = file_read(&file, path, f);
    if (code) return code;
    nacre_image image;
    nacre_result result = nacre_image_open(&image, file.data, file.size);
    if (result)
        code = fail(f, result == NACRE_ERR_UNSUPPORTED ? FAIL_UNSUPPORTED : FAIL_INVALID,
                    "%s: found %zu bytes that are no nacre asset (%s), expected a KTX2 file of nacre's profile", path,
                    file.size, nacre_result_text(result));
    else
        code = brdf_open_image(out, &image, path, f);
    bytes_free(&file);
    return code;
}

static int open_file(brdf **out, const char *path, failure *f)
{
    if (ends_with(path, ".bsdf")) return rgl_open(out, path, f);
    if (ends_with(path, ".ktx2")) return open_asset(out, path, f);
    return merl_open(out, path, f);
}

static int is_published_set(const char *prefix)
{
    for (size_t i = 0; published_set(i); i++) {
        if (strcmp(prefix, published_set(i)) == 0) return 1;
    }
    return 0;
}

static int is_model(const char *prefix)
{
    for (size_t i = 0; model_name(i); i++) {
        if (strcmp(prefix, model_name(i)) == 0) return 1;
    }
    return 0;
}

static int open_prefixed(brdf **out, const char *prefix, const char *rest, failure *f)
{
    int is_file = strcmp(prefix, "merl") == 0 || strcmp(prefix, "rgl") == 0;
    if (is_file && !*rest) return fail(f, FAIL_USAGE, "BRDF: found \"%s:\", expected %s:FILE", prefix, prefix);
    if (strcmp(prefix, "merl") == 0) return merl_open(out, rest, f);
    if (strcmp(prefix, "rgl") == 0) return rgl_open(out, rest, f);
    if (strcmp(prefix, "schlick") == 0)
        return fail(
            f, FAIL_UNSUPPORTED,
            "BRDF: found \"schlick:%.200s\", a model that is not supported, expected ggx:, cook-torrance: or ward:",
            rest);
    if (is_published_set(prefix) && !(is_model(prefix) && strchr(rest, '=')))
        return published_open(out, prefix, rest, f);
    return model_open(out, prefix, rest, f);
}

/* Names near to one that means nothing: the same material in the published sets first, then by edit distance. */
static int fail_unknown(const char *name, failure *f)
{
    size_t count;
    const char *const *names = published_names(&count);
    const char *word = strchr(name, ':') ? strchr(name, ':') + 1 : name;
    char near[600] = "";
    for (size_t i = 0; i < count; i++) {
        if (strcmp(strchr(names[i], ':') + 1, word) == 0 && strlen(near) + strlen(names[i]) + 3 < sizeof near)
            snprintf(near + strlen(near), sizeof near - strlen(near), "%s%s", *near ? ", " : "", names[i]);
    }
    if (!*near) nearest_names(name, names, count, near, sizeof near);
    return fail(
        f, FAIL_USAGE,
        "BRDF: found \"%.200s\", expected FILE.binary, FILE.bsdf, FILE.ktx2, or merl:, rgl:, sgd:, "
        "ngan-lafortune:, ngan-cook-torrance:, lafortune:, lambert:, blinn-phong:, ward:, cook-torrance:, ggx:%s%s",
        name, *near ? "; near: " : "", near);
}

int brdf_open(brdf **out, const char *name, failure *f)
{
    if (strlen(name) >= sizeof(*out)->name)
        return fail(f, FAIL_USAGE, "BRDF: found a name of %zu characters, expected at most %zu", strlen(name),
                    sizeof(*out)->name - 1);
    static const char *const plain[] = {"merl", "rgl", "schlick"};
    char prefix[32] = {0};
    size_t length = strcspn(name, ":");
    if (length < sizeof prefix) memcpy(prefix, name, length); /* zero-filled: stays terminated */
    int known = is_published_set(prefix) || is_model(prefix);
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++) known |= strcmp(prefix, plain[i]) == 0;
    brdf *b = NULL;
    int code;
    if (known)
        code = open_prefixed(&b, prefix, name[length] ? name + length + 1 : "", f);
    else if (ends_with(name, ".binary") || ends_with(name, ".bsdf") || ends_with(name, ".ktx2"))
        code = open_file(&b, name, f);
    else
        return fail_unknown(name, f);
    if (code) return code;
    snprintf(b->name, sizeof b->name, "%s", name);
    *out = b;
    return 0;
}

void brdf_close(brdf *b)
{
    if (b) b->close(b);
}

const char *const *brdf_names(size_t *count)
{
    return published_names(count);
}

/* ---- evaluation ---------------------------------------------------------------------------------------------------- */

int brdf_eval_cosine(const brdf *b, const double to_light[3], const double to_eye[3], double out[3])
{
    out[0] = out[1] = out[2] = 0;
    /* black by definition, not for want of data */
    if (!(to_eye[2] > 0 && (to_light[2] > 0 || b->lit_past_terminator))) return 1;
    if (b->eval_cosine) return b->eval_cosine(b, to_light, to_eye, out);
    int valid = b->eval(b, to_light, to_eye, out);
    for (int c = 0; c < 3; c++) out[c] *= to_light[2];
    return valid;
}

void half_to_directions(double theta_half, double theta_diff, double phi_diff, double to_light[3], double to_eye[3])
{
    double x = sin(theta_diff) * cos(phi_diff), y = sin(theta_diff) * sin(phi_diff), z = cos(theta_diff);
    double c = cos(theta_half), s = sin(theta_half);
    /* the difference vector (x, y, z) and its mirror image (-x, -y, z) about the half vector, turned by theta_half */
    to_light[0] = x * c + z * s;
    to_light[1] = y;
    to_light[2] = z * c - x * s;
    to_eye[0] = -x * c + z * s;
    to_eye[1] = -y;
    to_eye[2] = z * c + x * s;
}

static void turn_azimuth(double v[3], double c, double s)
{
    double x = v[0];
    v[0] = x * c - v[1] * s;
    v[1] = x * s + v[1] * c;
}

/* Midpoint rule in half-vector coordinates, where lobes lie along the axes: d(light) d(eye) = 4 cos(theta_diff) d(half)
   d(difference) in solid angles. theta_half = 90 degrees x u^4 puts enough samples into lobes of a tenth of a degree.
   Divided by the same sum for f_r = 1/pi, so that a constant comes out exactly; pairs without data count in neither. */
void brdf_albedo(const brdf *b, double albedo[3])
{
    enum { HALF = 64, DIFF = 24, PHI = 24 };
    int azimuths = b->anisotropic ? 24 : 1;
    double sum[3] = {0, 0, 0}, total = 0;
    for (long i = 0; i < (long)HALF * DIFF * PHI * azimuths; i++) {
        double u = ((double)(i / (DIFF * PHI) % HALF) + 0.5) / HALF, theta_half = pi / 2 * u * u * u * u;
        double theta_diff = pi / 2 * ((double)(i / PHI % DIFF) + 0.5) / DIFF;
        double phi_diff = 2 * pi * ((double)(i % PHI) + 0.5) / PHI;
        double azimuth = 2 * pi * (double)(i / ((long)HALF * DIFF * PHI)) / azimuths;
        double l[3], v[3], f[3];
        half_to_directions(theta_half, theta_diff, phi_diff, l, v);
        if (l[2] <= 0 || v[2] <= 0) continue;
        turn_azimuth(l, cos(azimuth), sin(azimuth));
        turn_azimuth(v, cos(azimuth), sin(azimuth));
        if (!brdf_eval_cosine(b, l, v, f)) continue;
        double weight = v[2] * cos(theta_diff) * sin(theta_diff) * sin(theta_half) * u * u * u;
        total += weight * l[2];
        for (int c = 0; c < 3; c++) sum[c] += weight * f[c];
    }
    for (int c = 0; c < 3; c++) albedo[c] = total > 0 ? pi * sum[c] / total : 0;
}

/* Midpoint rule over half vectors, theta_half warped as above: d(light) = 4 l.h d(half). */
void brdf_view_albedo(const brdf *b, const brdf *where, double view_polar_deg, double albedo[3])
{
    enum { HALF = 128, AZIMUTH = 64 };
    double polar = view_polar_deg * (pi / 180), v[3] = {sin(polar), 0, cos(polar)};
    double sum[3] = {0, 0, 0}, total = 0;
    for (int i = 0; i < HALF * AZIMUTH; i++) {
        double u = ((double)(i / AZIMUTH) + 0.5) / HALF, theta = pi / 2 * u * u * u * u;
        double phi = 2 * pi * ((double)(i % AZIMUTH) + 0.5) / AZIMUTH;
        double h[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        double v_dot_h = v[0] * h[0] + v[2] * h[2], l[3], f[3];
        for (int c = 0; c < 3; c++) l[c] = 2 * v_dot_h * h[c] - v[c];
        if (v_dot_h <= 0 || l[2] <= 0 || (where && !brdf_eval_cosine(where, l, v, f))) continue;
        if (!brdf_eval_cosine(b, l, v, f) && !where) continue;
        double weight = v_dot_h * sin(theta) * u * u * u;
        total += weight * l[2];
        for (int c = 0; c < 3; c++) sum[c] += weight * f[c];
    }
    for (int c = 0; c < 3; c++) albedo[c] = total > 0 ? pi * sum[c] / total : 0;
}

static int compare_reals(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double brdf_exposure(const brdf *b)
{
    enum { SIZE = 64 };
    static const double rec709[3] = {0.2126, 0.7152, 0.0722};
    const double light_x = sin(pi / 4), light_z = cos(pi / 4);
    double *lit = need_memory(SIZE * SIZE, sizeof *lit);
    size_t count = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        double x = (2.0 * (i % SIZE) + 1) / SIZE - 1, y = 1 - (2.0 * (double)(i / SIZE) + 1) / SIZE;
        double z2 = 1 - x * x - y * y;
        if (z2 <= 0) continue;
        double z = sqrt(z2), across = sqrt(x * x + z2), n_dot_l = x * light_x + z * light_z;
        if (n_dot_l <= 0.05) continue;
        /* tangent (z, 0, -x) / across, bitangent = normal x tangent */
        double l[3] = {(z * light_x - x * light_z) / across, -y * (x * light_x + z * light_z) / across, n_dot_l};
        double v[3] = {-x / across, -y * z / across, z};
        double f[3];
        brdf_eval_cosine(b, l, v, f);
        lit[count++] = pi * (rec709[0] * f[0] + rec709[1] * f[1] + rec709[2] * f[2]);
    }
    qsort(lit, count, sizeof *lit, compare_reals);
    double median = (lit[(count - 1) / 2] + lit[count / 2]) / 2;
    free(lit);
    double exposure = 0.35 / median;
    return exposure >= 0.5 ? (exposure <= 8 ? exposure : 8) : exposure < 0.5 ? 0.5 : 8;
}
