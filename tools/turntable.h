/* SPDX-License-Identifier: MIT */
/* Pictures of a whole turn: numbered files, or one animated PNG. */
#ifndef TURNTABLE_H
#define TURNTABLE_H

#include "failure.h"
#include "pixels.h"

#define TURNTABLE_MAX_FRAMES 3600

typedef struct turntable {
    const char *path; /* with one %d or %0Nd: a file per frame, numbered from 0; without a %: an animated PNG */
    int frames;       /* 1..TURNTABLE_MAX_FRAMES */
    int per_second;   /* of the animated PNG, 1..60 */
    image_u8 *kept;   /* frames of the animated PNG */
    int kept_count;
} turntable;

/* FAIL_USAGE: the path has a % that is none of the above. */
int turntable_check(const turntable *t, failure *f);
/* The next frame's picture, which is taken. The animated PNG is written with the last one. */
int turntable_add(turntable *t, int frame, image_u8 *picture, failure *f);
void turntable_free(turntable *t);

#endif
