/* SPDX-License-Identifier: MIT */
/* ETC1 blocks: 4 x 4 texels in 8 bytes, two halves with a 4-bit or 5-bit base colour and one of eight intensity tables
   each (Strom & Akenine-Moller 2005, "iPACKMAN"; Khronos Data Format Specification 1.3, section 21). */
#ifndef ETC1_H
#define ETC1_H

#include <stddef.h>
#include <stdint.h>

/* Bytes of an image: 8 for each started block of 4 x 4 texels. */
size_t etc1_size(int width, int height);

/* Encode RGB texels (rows from the top, tight); blocks run along rows. Texels beyond the edge repeat the last. The
   result depends on the texels alone. Never makes a block that ETC2 would read in another mode. */
void etc1_encode(const uint8_t *rgb, int width, int height, uint8_t *out);

/* Decode to RGB. */
void etc1_decode(const uint8_t *blocks, int width, int height, uint8_t *rgb);

/* 1 if the block uses an ETC1 mode: individual, or differential without overflow. */
int etc1_block_valid(const uint8_t block[8]);

/* For etc2.c: a block as a number, big-endian; one block, texel (x, y) at 4 x + y; images block by block. */
uint64_t etc_load_block(const uint8_t block[8]);
void etc1_encode_block(const int texel[16][3], uint8_t out[8]);
void etc1_decode_block(const uint8_t block[8], uint8_t texel[16][3]);
void etc_encode_blocks(const uint8_t *rgb, int width, int height,
                       void (*encode)(const int texel[16][3], uint8_t out[8]), uint8_t *out);
void etc_decode_blocks(const uint8_t *blocks, int width, int height,
                       void (*decode)(const uint8_t block[8], uint8_t texel[16][3]), uint8_t *rgb);

#endif
