/* SPDX-License-Identifier: MIT */
/*
 * The least firmware that draws: what measure.sh links to see what a feature costs. Nothing runs it.
 *
 * FIRMWARE_LIT: one mesh by a lit sphere that lies in flash. FIRMWARE_TABLE: and by a table, which the lit sphere is made of
 * too. Everything else that the build has not left out (NACRE_NO_...) comes with the material.
 */
#include "nacre_soft.h"

extern const nacre_soft_desc desc;
extern const nacre_mesh mesh;
extern const nacre_view view;
extern const nacre_soft_item item;
extern nacre_soft_lit_desc lit;
extern nacre_image image;
extern uint32_t block[], scratch[], pixels[], texels[];
extern uint32_t block_size, scratch_size, file_size;
extern const uint8_t file[];
nacre_soft_ready send_band;

int main(void)
{
    nacre_soft *soft;
    int r = 0;

#ifdef FIRMWARE_TABLE
    r |= nacre_image_open(&image, file, file_size);
    r |= nacre_soft_lit_rows(&lit, texels, 0, 64, scratch, scratch_size);
#endif
    r |= nacre_soft_init(&soft, block, block_size, &desc);
    r |= nacre_soft_prepare(soft, &item, 1, &view);
    return r | nacre_soft_bands(soft, scratch, scratch_size, pixels, NULL, 640, send_band, NULL);
}
