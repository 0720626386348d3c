/* SPDX-License-Identifier: MIT */
/* PNG through libpng, with our own errors. */
#include "png_io.h"

#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Read: sides and texels beyond these are refused before memory is asked for. */
enum { MAX_SIDE = 1 << 16, MAX_TEXELS = 1 << 28 };

static const int color_types[5] = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                   PNG_COLOR_TYPE_RGB_ALPHA};

typedef struct png_state {
    char reason[200]; /* libpng's, one line */
    bytes file;
    size_t at; /* next byte to read */
    png_bytep *rows;
    uint8_t *texel;
} png_state;

static void on_error(png_structp png, png_const_charp message)
{
    png_state *state = png_get_error_ptr(png);
    snprintf(state->reason, sizeof state->reason, "%s", message);
    for (char *c = state->reason; *c; c++)
        if ((unsigned char)*c < ' ') *c = ' ';
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void append_data(png_structp png, png_bytep data, png_size_t size)
{
    png_state *state = png_get_io_ptr(png);
    bytes_append(&state->file, data, size);
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

static void take_data(png_structp png, png_bytep data, png_size_t size)
{
    png_state *state = png_get_io_ptr(png);
    if (size > state->file.size - state->at) png_error(png, "the file ends too early");
    memcpy(data, state->file.data + state->at, size);
    state->at += size;
}

static void free_state(png_state *state)
{
    bytes_free(&state->file);
    free(state->rows);
    free(state->texel);
}

/* The whole file into state->file; 0 on libpng's error. The level and filters are fixed so that the same picture
   always gives the same bytes. No time stamp, no text. */
static int encode(png_state *state, const image_u8 *image)
{
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, state, on_error, on_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return 0;
    }
    png_set_write_fn(png, state, append_data, flush_nothing);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_compression_level(png, 6);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_ALL_FILTERS);
    png_set_IHDR(png, info, (png_uint_32)image->width, (png_uint_32)image->height, 8, color_types[image->channels],
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    png_write_image(png, state->rows);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return 1;
}

static void make_rows(png_state *state, uint8_t *texel, int height, size_t pitch)
{
    state->rows = need_memory((size_t)height, sizeof *state->rows);
    for (int y = 0; y < height; y++) state->rows[y] = texel + (size_t)y * pitch;
}

int png_encode(bytes *out, const image_u8 *image, const char *name, failure *f)
{
    if (image->width < 1 || image->height < 1 || image->channels < 1 || image->channels > 4)
        return fail(f, FAIL_INTERNAL, "%s: found a picture of %dx%d with %d channels, expected 1x1 or more with 1 to 4",
                    name, image->width, image->height, image->channels);
    png_state state = {0};
    int code = FAIL_NONE;
    make_rows(&state, image->texel, image->height, (size_t)image->width * (size_t)image->channels);
    if (encode(&state, image))
        bytes_append(out, state.file.data, state.file.size);
    else
        code = fail(f, FAIL_INTERNAL, "%s: PNG: %s", name, state.reason);
    free_state(&state);
    return code;
}

int png_write(const char *path, const image_u8 *image, failure *f)
{
    bytes file = {0};
    int code = png_encode(&file, image, path, f);
    if (!code) code = output_write_raw(path, &file, f);
    bytes_free(&file);
    return code;
}

/* Decode state->file to 8 bits and 1 to 4 channels as stored (palettes and small depths expanded). */
static int decode(png_state *state, image_u8 *image)
{
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, state, on_error, on_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_read_struct(&png, &info, NULL);
        return 0;
    }
    png_set_read_fn(png, state, take_data);
    png_set_user_limits(png, MAX_SIDE, MAX_SIDE);
    png_read_info(png, info);
    png_set_expand(png);
    png_set_scale_16(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    image->width = (int)png_get_image_width(png, info);
    image->height = (int)png_get_image_height(png, info);
    image->channels = png_get_channels(png, info);
    if ((int64_t)image->width * image->height > MAX_TEXELS) png_error(png, "more than 2^28 texels");
    size_t pitch = png_get_rowbytes(png, info);
    if (pitch != (size_t)image->width * (size_t)image->channels) png_error(png, "unexpected layout");
    state->texel = need_memory((size_t)image->height, pitch);
    make_rows(state, state->texel, image->height, pitch);
    png_read_image(png, state->rows);
    png_read_end(png, NULL);
    png_destroy_read_struct(&png, &info, NULL);
    return 1;
}

/* Grey to colour repeats, colour to grey takes the luma of BT.709 on the codes, missing alpha is 255. */
static void convert_texel(const uint8_t *from, int from_channels, uint8_t *to, int to_channels)
{
    int is_color = from_channels >= 3;
    uint8_t alpha = from_channels % 2 == 0 ? from[from_channels - 1] : 255;
    if (to_channels >= 3) {
        for (int i = 0; i < 3; i++) to[i] = from[is_color ? i : 0];
    } else {
        to[0] = is_color ? (uint8_t)((2126 * from[0] + 7152 * from[1] + 722 * from[2] + 5000) / 10000) : from[0];
    }
    if (to_channels % 2 == 0) to[to_channels - 1] = alpha;
}

int png_read(image_u8 *out, const char *path, int channels, failure *f)
{
    if (channels < 1 || channels > 4)
        return fail(f, FAIL_INTERNAL, "%s: asked for %d channels, expected 1 to 4", path, channels);
    png_state state = {0};
    int code = file_read(&state.file, path, f);
    if (code) return code;
    image_u8 stored = {0};
    if (state.file.size < 8 || png_sig_cmp(state.file.data, 0, 8)) {
        code = fail(f, FAIL_INVALID, "%s: offset 0: found no PNG signature, expected a PNG picture", path);
    } else if (!decode(&state, &stored)) {
        code = fail(f, FAIL_INVALID, "%s: offset %zu: broken PNG: %s", path, state.at, state.reason);
    } else {
        image_u8 image = image_u8_make(stored.width, stored.height, channels);
        size_t count = (size_t)stored.width * (size_t)stored.height;
        for (size_t i = 0; i < count; i++)
            convert_texel(state.texel + i * (size_t)stored.channels, stored.channels,
                          image.texel + i * (size_t)channels, channels);
        *out = image;
    }
    free_state(&state);
    return code;
}
