/* SPDX-License-Identifier: MIT */
/* ETC2 RGB8 blocks: those of ETC1, and where its differential mode would overflow, the modes T, H and planar (Khronos
   Data Format Specification 1.3, section 22). 8 bytes for 4 x 4 texels; GLES 3 and desktop GL 4.3 read them. */
#ifndef TOOLS_ETC2_H
#define TOOLS_ETC2_H

#include <stdint.h>

/* Encode RGB texels (rows from the top, tight) to etc1_size bytes, each block in the mode with the least squared error. The
   result depends on the texels alone. */
void etc2_encode(const uint8_t *rgb, int width, int height, uint8_t *out);

/* Decode any block to RGB. */
void etc2_decode(const uint8_t *blocks, int width, int height, uint8_t *rgb);

typedef enum etc2_mode {
    ETC2_MODE_INDIVIDUAL,
    ETC2_MODE_DIFFERENTIAL,
    ETC2_MODE_T,
    ETC2_MODE_H,
    ETC2_MODE_PLANAR
} etc2_mode;
etc2_mode etc2_block_mode(const uint8_t block[8]);

#endif
