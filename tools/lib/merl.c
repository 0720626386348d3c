/* SPDX-License-Identifier: MIT */
#include "merl.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "output.h"

/*
 * File: three int32 (theta_half, theta_diff, phi_diff counts), then planes R, G, B of float64, all little-endian;
 * index = phi_diff + phi_diff_count (theta_diff + theta_diff_count theta_half). f_r = value x channel scale; a negative
 * value has no data. Axes: theta_half over 0..90 degrees on a square-root warp (bin i holds theta with
 * floor(count sqrt(theta / 90)) = i), theta_diff over 0..90, phi_diff over 0..180 degrees: by reciprocity phi_diff + 180
 * is the same entry (Matusik et al. 2003, section 3).
 *
 * The database's reader truncates coordinates to bins, so an entry stands for a bin and its best single position is the
 * bin's middle (on the warped axis): sample i lies at (i + 1/2) / count. Between the samples the look-up is trilinear.
 */
static const double channel_scale[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

static const double pi = 3.14159265358979323846;

typedef struct merl {
    brdf base;
    int count[3];  /* theta_half, theta_diff, phi_diff */
    float *sample; /* R G B per entry, f_r in 1/sr; R < 0: no data */
} merl;

/* Two neighbours of a coordinate in 0..1 on an axis of count bin centres: indices and the second one's weight. */
typedef struct span {
    int index[2];
    double weight;
} span;

static span span_clamped(double coordinate, int count)
{
    double x = coordinate * count - 0.5;
    x = x < 0 ? 0 : x > count - 1 ? count - 1 : x;
    int first = (int)x;
    span s = {{first, first + 1 < count ? first + 1 : first}, x - first};
    return s;
}

static span span_periodic(double coordinate, int count)
{
    double x = coordinate * count - 0.5, low = floor(x);
    int first = (int)low;
    span s = {{first < 0 ? count - 1 : first, first + 1 < count ? first + 1 : 0}, x - low};
    return s;
}

/* Rusinkiewicz 1998, section 3, without the loss of acos near 0: the half vector's direction is l + v, the difference
   vector's part across it (l - v) / 2. */
static void to_half_difference(const double l[3], const double v[3], double *theta_half, double *theta_diff,
                               double *phi_diff)
{
    double sx = l[0] + v[0], sy = l[1] + v[1], sz = l[2] + v[2];
    double dx = l[0] - v[0], dy = l[1] - v[1], dz = l[2] - v[2];
    double across = sqrt(sx * sx + sy * sy), length = sqrt(across * across + sz * sz);
    double cos_azimuth = across > 0 ? sx / across : 1, sin_azimuth = across > 0 ? sy / across : 0;
    /* the frame at h: along increasing theta_half, and along increasing azimuth */
    double along_theta = (dx * cos_azimuth + dy * sin_azimuth) * sz / length - dz * across / length;
    double along_azimuth = dy * cos_azimuth - dx * sin_azimuth;
    *theta_half = atan2(across, sz);
    *theta_diff = atan2(sqrt(dx * dx + dy * dy + dz * dz), length);
    *phi_diff = atan2(along_azimuth, along_theta);
}

static inline void add_sample(const float *sample, double weight, double sum[3], double *total)
{
    if (sample[0] < 0) /* no data: the other corners share its weight */
        return;
    *total += weight;
    for (int c = 0; c < 3; c++) sum[c] += weight * (double)sample[c];
}

static int merl_eval(const brdf *b, const double to_light[3], const double to_eye[3], double f_r[3])
{
    const merl *m = (const merl *)b;
    f_r[0] = f_r[1] = f_r[2] = 0;
    if (!(to_light[2] > 0 && to_eye[2] > 0)) return 0;
    double theta_half, theta_diff, phi_diff;
    to_half_difference(to_light, to_eye, &theta_half, &theta_diff, &phi_diff);
    span h = span_clamped(sqrt(theta_half * (2 / pi)), m->count[0]);
    span d = span_clamped(theta_diff * (2 / pi), m->count[1]);
    double turn = phi_diff * (1 / pi);
    span p = span_periodic(turn - floor(turn), m->count[2]);
    double sum[3] = {0, 0, 0}, total = 0;
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            size_t row = (size_t)h.index[i] * (size_t)m->count[1] + (size_t)d.index[j];
            const float *samples = m->sample + 3 * row * (size_t)m->count[2];
            double weight = (i ? h.weight : 1 - h.weight) * (j ? d.weight : 1 - d.weight);
            add_sample(samples + 3 * p.index[0], weight * (1 - p.weight), sum, &total);
            add_sample(samples + 3 * p.index[1], weight * p.weight, sum, &total);
        }
    }
    if (total <= 0) return 0;
    for (int c = 0; c < 3; c++) f_r[c] = sum[c] / total;
    return 1;
}

static void merl_close(brdf *b)
{
    merl *m = (merl *)b;
    free(m->sample);
    free(m);
}

static uint32_t load_u32(const uint8_t *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static double load_real(const uint8_t *p)
{
    uint64_t bits = load_u32(p) | (uint64_t)load_u32(p + 4) << 32;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int check_header(const uint8_t *data, uint64_t size, int count[3], const char *path, failure *f)
{
    static const char *const axis[3] = {"theta_half", "theta_diff", "phi_diff"};
    static const int most[3] = {MERL_THETA_HALF, MERL_THETA_DIFF, MERL_PHI_DIFF};
    if (size < 12)
        return fail(f, FAIL_INVALID, "%s: offset 0: found %llu bytes, expected a MERL header of 12 bytes", path,
                    (unsigned long long)size);
    for (int i = 0; i < 3; i++) {
        int32_t n = (int32_t)load_u32(data + 4 * i);
        if (n < 1 || n > most[i])
            return fail(f, FAIL_INVALID, "%s: offset %d: found %s count %d, expected 1..%d", path, 4 * i, axis[i],
                        (int)n, most[i]);
        count[i] = n;
    }
    uint64_t expected = 12 + (uint64_t)count[0] * (uint64_t)count[1] * (uint64_t)count[2] * 3 * 8;
    if (size != expected)
        return fail(f, FAIL_INVALID, "%s: found %llu bytes, expected %llu for a table of %d x %d x %d", path,
                    (unsigned long long)size, (unsigned long long)expected, count[0], count[1], count[2]);
    return 0;
}

static int load_samples(merl *m, const uint8_t *data, const char *path, failure *f)
{
    size_t entries = (size_t)m->count[0] * (size_t)m->count[1] * (size_t)m->count[2];
    m->sample = need_memory(entries, 3 * sizeof *m->sample);
    const uint8_t *plane[3] = {data + 12, data + 12 + 8 * entries, data + 12 + 16 * entries};
    for (size_t i = 0; i < entries; i++) {
        double value[3];
        int valid = 1;
        for (int c = 0; c < 3; c++) {
            value[c] = load_real(plane[c] + 8 * i);
            /* an infinite or huge entry would be infinite as float */
            if (!(fabs(value[c]) <= 1e30))
                return fail(f, FAIL_INVALID, "%s: offset %zu: found %g, expected a finite reflectance", path,
                            (size_t)(plane[c] - data) + 8 * i, value[c]);
            valid &= value[c] >= 0;
        }
        for (int c = 0; c < 3; c++) m->sample[3 * i + (size_t)c] = valid ? (float)(value[c] * channel_scale[c]) : -1.0F;
    }
    return 0;
}

static int parse(brdf **out, const uint8_t *data, uint64_t size, const char *path, failure *f)
{
    int count[3];
    int code = check_header(data, size, count, path, f);
    if (code) return code;
    merl *m = need_memory(1, sizeof *m);
    memcpy(m->count, count, sizeof count);
    m->base.eval = merl_eval;
    m->base.close = merl_close;
    code = load_samples(m, data, path, f);
    if (code) {
        merl_close(&m->base);
        return code;
    }
    snprintf(m->base.description, sizeof m->base.description,
             "measured table, %d x %d x %d (theta_half x theta_diff x"
             " phi_diff), MERL layout",
             count[0], count[1], count[2]);
    *out = &m->base;
    return 0;
}

int merl_open(brdf **out, const char *path, failure *f)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe must not block before it is refused */
    struct stat status;
    if (fd < 0 || fstat(fd, &status)) {
        int reason = errno;
        if (fd >= 0) close(fd);
        return fail(f, FAIL_IO, "%s: %s", path, strerror(reason));
    }
    if (!S_ISREG(status.st_mode)) {
        close(fd);
        return fail(f, FAIL_IO, "%s: found no regular file, expected a MERL table", path);
    }
    uint64_t size = (uint64_t)status.st_size;
    static const uint8_t nothing[1] = {0};
    /* mapped, not read: half the time for 33 MB, and no second copy */
    void *map = size ? mmap(NULL, size, PROT_READ, MAP_PRIVATE, fd, 0) : NULL;
    int reason = errno;
    close(fd);
    if (map == MAP_FAILED) return fail(f, FAIL_IO, "%s: %s", path, strerror(reason));
    int code = parse(out, map ? map : nothing, size, path, f);
    if (map) munmap(map, size);
    return code;
}

static void store_real(uint8_t *p, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 8; i++) p[i] = (uint8_t)(bits >> 8 * i);
}

int merl_write(const char *path, const brdf *b, int theta_half_count, int theta_diff_count, int phi_diff_count,
               failure *f)
{
    const int count[3] = {theta_half_count, theta_diff_count, phi_diff_count};
    const int most[3] = {MERL_THETA_HALF, MERL_THETA_DIFF, MERL_PHI_DIFF};
    for (int i = 0; i < 3; i++) {
        if (count[i] < 1 || count[i] > most[i])
            return fail(f, FAIL_USAGE, "%s: found a table of %d x %d x %d, expected 1..90 x 1..90 x 1..180", path,
                        count[0], count[1], count[2]);
    }
    size_t entries = (size_t)count[0] * (size_t)count[1] * (size_t)count[2];
    bytes file = {need_memory(12 + 24 * entries, 1), 12 + 24 * entries, 12 + 24 * entries};
    for (int i = 0; i < 3; i++) file.data[4 * i] = (uint8_t)count[i];
    for (size_t i = 0; i < entries; i++) {
        int k = (int)(i % (size_t)count[2]), j = (int)(i / (size_t)count[2] % (size_t)count[1]);
        double warped = ((double)(i / (size_t)count[2] / (size_t)count[1]) + 0.5) / count[0];
        double l[3], v[3], f_r[3];
        half_to_directions(warped * warped * pi / 2, (j + 0.5) / count[1] * pi / 2, (k + 0.5) / count[2] * pi, l, v);
        int valid = l[2] > 0 && v[2] > 0 && b->eval(b, l, v, f_r);
        for (size_t c = 0; c < 3; c++)
            store_real(file.data + 12 + 8 * (c * entries + i), valid ? f_r[c] / channel_scale[c] : -1);
    }
    int code = output_write_raw(path, &file, f);
    bytes_free(&file);
    return code;
}
