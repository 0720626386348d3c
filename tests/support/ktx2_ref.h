/* SPDX-License-Identifier: MIT */
/* A second KTX2 reader, written from the KTX 2.0 specification (revision 4) and the Khronos Data Format Specification
   1.4, for files without supercompression. It shares nothing with the runtime's reader or the writer, knows no nacre
   profile, and is as strict as the specification lets it be: order and padding of all parts, padding bytes, sorted and
   unique keys, aligned numbers, and the data format descriptor word by word for the formats it knows. */
#ifndef KTX2_REF_H
#define KTX2_REF_H

#include <stddef.h>
#include <stdint.h>

typedef struct ktx2_ref {
    const uint8_t *bytes; /* borrowed */
    size_t size;
    uint32_t vk_format, type_size, width, height, layer_count, face_count, level_count; /* as in the header */
    uint32_t transfer; /* KHR_DF_TRANSFER_*: 1 linear, 2 sRGB */
    uint32_t block_width, block_bytes;
    uint64_t level_offset[32], level_length[32];
    struct {
        const char *name;
        const uint8_t *value;
        size_t size;
    } key[64];
    int key_count;
} ktx2_ref;

/* 1 if the file is valid; else 0 and why (one line). */
int ktx2_ref_read(ktx2_ref *out, const uint8_t *bytes, size_t size, char *why, size_t why_size);

/* Bytes of one image and where they are. */
const uint8_t *ktx2_ref_part(const ktx2_ref *ref, unsigned level, unsigned layer, unsigned face, size_t *size);

/* Value of a key, NULL if there is none. */
const uint8_t *ktx2_ref_key(const ktx2_ref *ref, const char *name, size_t *size);

#endif
