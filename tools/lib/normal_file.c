/* SPDX-License-Identifier: MIT */
#include "normal_file.h"

#include <math.h>
#include <stdlib.h>

#include "ktx2_write.h"
#include "mip.h"
#include "nacre_asset.h"

static void unit(float *n)
{
    const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3; c++) n[c] = length > 1e-6f ? n[c] / length : c == 2;
}

static void put_level(bytes *out, const float *normal, size_t count)
{
    for (size_t i = 0; i < 3 * count; i++) {
        const uint8_t code = unorm8(0.5 + 0.5 * normal[i]);
        bytes_append(out, &code, 1);
    }
}

void normal_file_write(const image_u8 *picture, double scale, int no_mips, const char *name, bytes *out)
{
    int width = picture->width, height = picture->height;
    size_t count = (size_t)width * (size_t)height;
    float *normal = need_memory(3 * count, sizeof *normal);
    ktx2_image k = {.format = NACRE_FORMAT_RGB8, .width = width, .height = height, .faces = 1};
    k.levels = no_mips ? 1 : mip_count(width, height);
    for (size_t i = 0; i < count; i++) {
        for (size_t c = 0; c < 3; c++)
            normal[3 * i + c] =
                (float)((2 * picture->texel[(size_t)picture->channels * i + c] / 255.0 - 1) * (c < 2 ? scale : 1));
        unit(normal + 3 * i);
    }
    for (int i = 0; i < k.levels; i++) {
        put_level(&k.level[i], normal, count);
        if (i + 1 == k.levels) break;
        mip_halve(normal, NULL, width, height, 3, normal, NULL);
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
        count = (size_t)width * (size_t)height;
        for (size_t j = 0; j < count; j++) unit(normal + 3 * j);
    }
    free(normal);
    ktx2_key_text(&k, NACRE_KEY_ROLE, "normal");
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "linear");
    ktx2_key_text(&k, NACRE_KEY_NAME, name);
    ktx2_write(&k, out);
    ktx2_free(&k);
}
