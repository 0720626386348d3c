/* SPDX-License-Identifier: MIT */
/* What a driver computes with. */
#ifndef GL_PROBE_H
#define GL_PROBE_H

#include "gl_headless.h"

/* fract(4096.5) computed in mediump by the current context: 0 in fp16, 128 in fp32 (codes of 255). */
int gl_probe_mediump(gl_headless *gl);

#endif
