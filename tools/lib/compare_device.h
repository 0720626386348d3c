/* SPDX-License-Identifier: MIT */
/* Inside of compare: what it asks of a renderer. */
#ifndef COMPARE_DEVICE_H
#define COMPARE_DEVICE_H

#include "compare.h"

int compare_device_is_double(const compare_device *device); /* so is NULL */

/* All frames of an asset by a device that is not double; the linear ones stay empty. */
int compare_device_draw(metric_frames *out, const compare_device *device, const compare_asset *asset, double exposure,
                        double fov_deg, failure *f);

#endif
