/* SPDX-License-Identifier: MIT */
#include "pixels.h"

#include <math.h>
#include <stdlib.h>

#include "failure.h"

image_u8 image_u8_make(int width, int height, int channels)
{
    image_u8 image = {width, height, channels, need_memory((size_t)width * (size_t)height, (size_t)channels)};
    return image;
}

image_f32 image_f32_make(int width, int height, int channels)
{
    image_f32 image = {width, height, channels,
                       need_memory((size_t)width * (size_t)height, (size_t)channels * sizeof(float))};
    return image;
}

void image_u8_free(image_u8 *image)
{
    free(image->texel);
    *image = (image_u8){0};
}

void image_f32_free(image_f32 *image)
{
    free(image->texel);
    *image = (image_f32){0};
}

double srgb_encode(double linear)
{
    if (!(linear > 0)) return 0;
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

double srgb_decode(double encoded)
{
    if (!(encoded > 0)) return 0;
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

uint8_t unorm8(double x)
{
    if (!(x > 0)) return 0;
    return x >= 1 ? 255 : (uint8_t)(x * 255 + 0.5);
}
