/* SPDX-License-Identifier: MIT */
/*
 * The least firmware that draws: what measure.sh links to see what a feature costs. Nothing runs it.
 *
 * Items are drawn by their materials, those that the build has not left out (NACRE_NO_...), or by a lit sphere.
 * FIRMWARE_TABLE: files are opened, and lit spheres made.
 */
#include "nacre_soft.h"

/* The application's: where they are does not matter. */
extern const nacre_soft_desc app_desc;
extern const nacre_view app_view;
extern const nacre_soft_item app_item;
extern const nacre_soft_lit_desc app_lit;
extern nacre_image app_image;
extern uint32_t app_block[], app_scratch[], app_pixels[], app_texels[];
extern const uint32_t app_block_size, app_scratch_size, app_file_size;
extern const uint8_t app_file[];
nacre_soft_ready app_send_band;

int main(void)
{
    nacre_soft *soft;
    int r = 0;

#ifdef FIRMWARE_TABLE
    r |= nacre_image_open(&app_image, app_file, app_file_size);
    r |= nacre_soft_lit_rows(&app_lit, app_texels, 0, 64, app_scratch, app_scratch_size);
#endif
    r |= nacre_soft_init(&soft, app_block, app_block_size, &app_desc);
    r |= nacre_soft_prepare(soft, &app_item, 1, &app_view);
    return r | nacre_soft_bands(soft, app_scratch, app_scratch_size, app_pixels, NULL, 640, app_send_band, NULL);
}
