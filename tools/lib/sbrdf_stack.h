/* SPDX-License-Identifier: MIT */
/*
 * Measured stacks: pictures of one flat sample under known lights and views, fitted texel by texel (McAllister et al. 2002,
 * section 3). A text of one statement a line:
 *
 *   stack                                    first
 *   image F.pfm|F.png LX LY LZ VX VY VZ      a picture, and the directions to the light and to the eye over the sample
 *                                            (x along a row, y up the picture, z the normal); any length but 0
 *
 * Pictures are rectified and all of one size. Values are pi f_r n.l: what a white matt sheet that faces the light gives is
 * 1. PFM: linear; PNG: sRGB codes, and 255 in any channel is overexposed and left out. Values that are not finite are left
 * out too. File names are relative to the text's place; # begins a comment.
 */
#ifndef SBRDF_STACK_H
#define SBRDF_STACK_H

#include "sbrdf_paint.h"

typedef struct sbrdf_stack_report {
    int images;
    double error;   /* relative L2 over all texels and pictures */
    double seconds; /* of fitting */
    long underlit;  /* texels with too few values: left black */
} sbrdf_stack_report;

/* 1 if the text at path begins with the statement stack. */
int sbrdf_is_stack(const char *path);
/* FAIL_INVALID names the text's line; so do fewer than 8 pictures. anisotropic: cx and cy of their own. */
int sbrdf_stack_fit(sbrdf_field *out, const char *path, int lobes, int anisotropic, sbrdf_sources *sources,
                    sbrdf_stack_report *report, progress *p, failure *f);

#endif
