/* SPDX-License-Identifier: MIT */
#include "pfm_io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "png_io.h"

enum { MOST_SIDE = 16384 };

static uint32_t swapped(uint32_t x)
{
    return x >> 24 | (x >> 8 & 0xFF00) | (x << 8 & 0xFF0000) | x << 24;
}

static int is_little_endian(void)
{
    const uint16_t one = 1;
    uint8_t first;
    memcpy(&first, &one, 1);
    return first;
}

int pfm_write(const char *path, const image_f32 *image, failure *f)
{
    bytes file = {0};
    size_t row = (size_t)(image->width * image->channels);
    bytes_printf(&file, "P%c\n%d %d\n%s\n", image->channels == 3 ? 'F' : 'f', image->width, image->height,
                 is_little_endian() ? "-1.0" : "1.0");
    for (int y = image->height - 1; y >= 0; y--)
        bytes_append(&file, image->texel + (size_t)y * row, row * sizeof(float));
    int code = output_write_raw(path, &file, f);
    bytes_free(&file);
    return code;
}

static int read_body(image_f32 *out, const bytes *file, size_t at, int swap, const char *path, failure *f)
{
    size_t row = (size_t)(out->width * out->channels), size = row * (size_t)out->height * sizeof(float);
    if (file->size - at != size)
        return fail(f, FAIL_INVALID, "%s: found %zu bytes of floats, expected %zu for %d x %d x %d", path,
                    file->size - at, size, out->width, out->height, out->channels);
    *out = image_f32_make(out->width, out->height, out->channels);
    for (int y = 0; y < out->height; y++)
        memcpy(out->texel + (size_t)(out->height - 1 - y) * row, file->data + at + (size_t)y * row * sizeof(float),
               row * sizeof(float));
    for (size_t i = 0; swap && i < row * (size_t)out->height; i++) {
        uint32_t bits;
        memcpy(&bits, &out->texel[i], 4);
        bits = swapped(bits);
        memcpy(&out->texel[i], &bits, 4);
    }
    return FAIL_NONE;
}

int pfm_read(image_f32 *out, const char *path, failure *f)
{
    bytes file = {0};
    int code = file_read(&file, path, f), used = 0, width = 0, height = 0;
    char kind = 0, head[128] = "";
    double scale = 0;
    if (code) return code;
    memcpy(head, file.data, file.size < sizeof head - 1 ? file.size : sizeof head - 1);
    if (sscanf(head, "P%c %d %d %lf%n", &kind, &width, &height, &scale, &used) != 4 || (kind != 'F' && kind != 'f') ||
        width < 1 || height < 1 || width > MOST_SIDE || height > MOST_SIDE || scale == 0)
        code =
            fail(f, FAIL_INVALID, "%s: found no header of a portable float map (PF or Pf, width, height, scale)", path);
    if (!code) {
        image_f32 shape = {width, height, kind == 'F' ? 3 : 1, NULL};
        code = read_body(&shape, &file, (size_t)used + 1, (scale < 0) != is_little_endian(), path, f);
        if (!code) *out = shape;
    }
    bytes_free(&file);
    return code;
}

int float_map_read(image_f32 *out, const char *path, int channels, int *is_float, failure *f)
{
    size_t length = strlen(path);
    *is_float = length > 4 && !strcasecmp(path + length - 4, ".pfm");
    if (*is_float) {
        int code = pfm_read(out, path, f);
        if (!code && out->channels > channels) {
            code = fail(f, FAIL_INVALID, "%s: found %d channels, expected %d", path, out->channels, channels);
            image_f32_free(out);
        }
        return code;
    }
    image_u8 picture;
    int code = png_read(&picture, path, channels, f);
    if (code) return code;
    *out = image_f32_make(picture.width, picture.height, channels);
    for (size_t i = 0; i < (size_t)picture.width * (size_t)picture.height * (size_t)channels; i++)
        out->texel[i] = picture.texel[i];
    image_u8_free(&picture);
    return FAIL_NONE;
}
