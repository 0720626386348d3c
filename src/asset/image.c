// SPDX-License-Identifier: MIT
#include "asset.h"

/* KTX2 leaves no freedom where things are: level index, descriptor, keys and levels (smallest first) follow each other
   with the least padding to the alignment asked for. So every offset is computed and the file's must equal it; nothing
   can overlap, and a changed byte in any offset or length is an error. Differences are collected with ^ and |, which
   is smaller than a branch each. */

/* The header as words; numbers are offset / 4. */
enum {
    WORD_FORMAT = 3,
    WORD_TYPE_SIZE,
    WORD_WIDTH,
    WORD_HEIGHT,
    WORD_DEPTH,
    WORD_LAYERS,
    WORD_FACES,
    WORD_LEVELS,
    WORD_SCHEME,
    WORD_DFD_OFFSET,
    WORD_DFD_SIZE,
    WORD_KV_OFFSET,
    WORD_KV_SIZE,
    WORD_SGD,
    HEADER_WORDS = WORD_SGD + 4,
    HEADER_BYTES = 4 * HEADER_WORDS,
    INDEX_WORDS = 6,
    INDEX_BYTES = 4 * INDEX_WORDS
};

static const asset_format formats[] = {
    {NACRE_FORMAT_RGB565, 2, 2, 0}, {NACRE_FORMAT_R8, 1, 1, 0},        {NACRE_FORMAT_RG8, 2, 1, 0},
    {NACRE_FORMAT_RGB8, 3, 1, 0},   {NACRE_FORMAT_RGBA8, 4, 1, 0},     {NACRE_FORMAT_RGBA16F, 8, 2, 0},
    {NACRE_FORMAT_E5BGR9, 4, 4, 0}, {NACRE_FORMAT_ETC2_RGB8, 8, 1, 2},
};

const asset_format *asset_format_find(uint32_t format)
{
    unsigned i;

    for (i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (formats[i].format == format) return &formats[i];
    return 0;
}

static uint32_t blocks(uint32_t texels, unsigned level, unsigned shift)
{
    texels >>= level;
    if (!texels) texels = 1;
    return (texels + (1u << shift) - 1) >> shift;
}

uint32_t asset_part_bytes(const asset_format *format, uint32_t width, uint32_t height, unsigned level)
{
    return blocks(width, level, format->block_shift) * blocks(height, level, format->block_shift) * format->block_bytes;
}

/* Round up to lcm(block_bytes, 4), which is 4, 8 or, for RGB8, 12. */
static uint32_t align_level(uint32_t offset, uint32_t block_bytes)
{
    const uint32_t mask = block_bytes == 8 ? 7 : 3;

    offset = (offset + mask) & ~mask;
    if (block_bytes == 3)
        while (offset * 0xAAAAAAABu > 0x55555555u) offset += 4; /* the product is larger unless 3 divides offset */
    return offset;
}

static void load_words(uint32_t *word, const uint8_t *bytes, unsigned count)
{
    while (count--) word[count] = asset_u32le(bytes + 4 * count);
}

/* Everything of the header that can be judged alone. */
static nacre_result check_header(nacre_image *image, const uint32_t *word)
{
    const uint32_t width = word[WORD_WIDTH], height = word[WORD_HEIGHT], layers = word[WORD_LAYERS];
    const uint32_t faces = word[WORD_FACES], top_level = word[WORD_LEVELS] - 1;
    const asset_format *format = asset_format_find(word[WORD_FORMAT]);

    /* zeros wrap to the largest number */
    if (!format || word[WORD_DEPTH] | word[WORD_SCHEME] | ((width - 1) | (height - 1)) / NACRE_MAX_TEXELS ||
        layers > NACRE_MAX_LAYERS || top_level >= NACRE_MAX_LEVELS)
        return NACRE_ERR_UNSUPPORTED;
    /* a cube's faces are square; half of 1 texel is no further level; without supercompression there are no data of it */
    if ((faces != 1 && (faces != 6 || width != height)) || !((width | height) >> top_level) ||
        (word[WORD_TYPE_SIZE] ^ format->type_bytes) | word[WORD_SGD] | word[WORD_SGD + 1] | word[WORD_SGD + 2] |
            word[WORD_SGD + 3])
        return NACRE_ERR_ASSET;
    image->width = (uint16_t)width;
    image->height = (uint16_t)height;
    image->layers = (uint16_t)(layers ? layers : 1);
    image->faces = (uint8_t)faces;
    image->levels = (uint8_t)(top_level + 1);
    image->format = format->format;
    return NACRE_OK;
}

/* Descriptor and keys; 0 or the offset behind them. */
static uint32_t check_regions(nacre_image *image, const uint32_t *word)
{
    const uint32_t dfd_size = word[WORD_DFD_SIZE], kv_size = word[WORD_KV_SIZE];
    const uint32_t dfd_offset = HEADER_BYTES + INDEX_BYTES * (uint32_t)image->levels;
    uint32_t kv_offset, rest;

    /* the descriptor begins with its size */
    if (image->size < dfd_offset + 4) return 0;
    rest = image->size - dfd_offset;
    if (dfd_size < 4 || dfd_size > rest || kv_size > rest - dfd_size) return 0;
    kv_offset = dfd_offset + dfd_size;
    if ((word[WORD_DFD_OFFSET] ^ dfd_offset) | (word[WORD_KV_OFFSET] ^ (kv_size ? kv_offset : 0)) |
        (asset_u32le(image->bytes + dfd_offset) ^ dfd_size) | (dfd_size & 3))
        return 0;
    image->kv_offset = kv_offset;
    image->kv_size = kv_size;
    return asset_kv_check(image->bytes + kv_offset, kv_size) ? 0 : kv_offset + kv_size;
}

/* Level index and level data, which begin after end; 1 if all is as it must be. */
static int check_levels(nacre_image *image, uint32_t end)
{
    const asset_format *format = asset_format_find(image->format);
    const uint32_t parts = (uint32_t)image->layers * image->faces;
    unsigned level = image->levels;
    uint32_t word[INDEX_WORDS];

    while (level--) {
        const uint64_t length = (uint64_t)asset_part_bytes(format, image->width, image->height, level) * parts;
        const uint32_t offset = align_level(end, format->block_bytes);

        /* end <= size <= NACRE_MAX_FILE_BYTES, so that no sum wraps */
        if (offset + length > image->size) return 0;
        end = offset + (uint32_t)length;
        /* offset, length and length before supercompression, 64 bits each */
        load_words(word, image->bytes + HEADER_BYTES + INDEX_BYTES * level, INDEX_WORDS);
        if ((word[0] ^ offset) | (word[2] ^ (uint32_t)length) | (word[4] ^ word[2]) | word[1] | word[3] | word[5])
            return 0;
        image->level_offset[level] = offset;
    }
    return end == image->size;
}

/* Files without this key are not ours, but may still be images (normal maps). */
static nacre_result check_version(const nacre_image *image)
{
    uint32_t version;

    if (!nacre_image_key(image, NACRE_KEY_VERSION, 0)) return NACRE_OK;
    if (!asset_key_u32(image, NACRE_KEY_VERSION, &version, 1)) return NACRE_ERR_ASSET;
    return version == NACRE_ASSET_VERSION ? NACRE_OK : NACRE_ERR_UNSUPPORTED;
}

nacre_result nacre_image_open(nacre_image *out, const void *bytes, size_t size)
{
    uint32_t word[HEADER_WORDS], end;
    nacre_image image;
    nacre_result result;
    unsigned i;

    if (!out || !bytes) return NACRE_ERR_ARGUMENT;
    if (size < HEADER_BYTES) return NACRE_ERR_ASSET;
    image.bytes = (const uint8_t *)bytes;
    image.size = (uint32_t)size;
    load_words(word, image.bytes, HEADER_WORDS);
    for (i = 0; i < NACRE_MAX_LEVELS; i++) image.level_offset[i] = 0;

    /* AB "KTX 20" BB CR LF 1A LF */
    if ((word[0] ^ 0x58544BABu) | (word[1] ^ 0xBB303220u) | (word[2] ^ 0x0A1A0A0Du)) return NACRE_ERR_ASSET;
    if (size > NACRE_MAX_FILE_BYTES) return NACRE_ERR_UNSUPPORTED;
    result = check_header(&image, word);
    if (result) return result;
    end = check_regions(&image, word);
    if (!end || !check_levels(&image, end)) return NACRE_ERR_ASSET;
    result = check_version(&image);
    if (!result) *out = image;
    return result;
}

const uint8_t *nacre_image_texels(const nacre_image *image, unsigned level, unsigned layer, unsigned face,
                                  uint32_t *size)
{
    const asset_format *format;
    uint32_t part;

    if (!image || level >= image->levels || layer >= image->layers || face >= image->faces) return 0;
    format = asset_format_find(image->format);
    if (!format) return 0;
    part = asset_part_bytes(format, image->width, image->height, level);
    if (size) *size = part;
    return image->bytes + image->level_offset[level] + part * (layer * image->faces + face);
}
