/* SPDX-License-Identifier: MIT */
#include "turntable.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apng.h"
#include "png_io.h"

/* Where the number stands: *at of the '%', *end behind the 'd'; *width digits at least. 0: there is no '%' at all, -1:
   another one than %d, %Nd, %0Nd, or a second one. */
static int find_number(const char *path, size_t *at, size_t *end, int *width)
{
    const char *percent = strchr(path, '%'), *c;

    if (!percent) return 0;
    *width = 0;
    for (c = percent + 1; isdigit((unsigned char)*c) && *width < 20; c++) *width = 10 * *width + (*c - '0');
    if (*c != 'd' || *width > 20 || strchr(c, '%')) return -1;
    *at = (size_t)(percent - path);
    *end = (size_t)(c + 1 - path);
    return 1;
}

int turntable_check(const turntable *t, failure *f)
{
    size_t at, end;
    int width;

    if (find_number(t->path, &at, &end, &width) >= 0) return FAIL_NONE;
    return fail(f, FAIL_USAGE,
                "-o %s: expected one number like %%03d for a file per frame, or none for an animated PNG", t->path);
}

void turntable_free(turntable *t)
{
    for (int i = 0; i < t->kept_count; i++) image_u8_free(&t->kept[i]);
    free(t->kept);
    t->kept = NULL;
    t->kept_count = 0;
}

static int write_numbered(const turntable *t, int frame, size_t at, size_t end, int width, const image_u8 *picture,
                          failure *f)
{
    char path[1000];
    const int length = snprintf(path, sizeof path, "%.*s%0*d%s", (int)at, t->path, width, frame, t->path + end);

    if (length < 0 || (size_t)length >= sizeof path)
        return fail(f, FAIL_USAGE, "-o %.40s...: found a name of %d characters, expected fewer than %zu", t->path,
                    length, sizeof path);
    return png_write(path, picture, f);
}

int turntable_add(turntable *t, int frame, image_u8 *picture, failure *f)
{
    size_t at, end;
    int width, code = FAIL_NONE;

    if (find_number(t->path, &at, &end, &width) > 0) {
        code = write_numbered(t, frame, at, end, width, picture, f);
        image_u8_free(picture);
        return code;
    }
    if (!t->kept) t->kept = need_memory((size_t)t->frames, sizeof *t->kept);
    t->kept[t->kept_count++] = *picture;
    *picture = (image_u8){0};
    if (t->kept_count == t->frames) code = apng_write(t->path, t->kept, t->frames, t->per_second, f);
    return code;
}
