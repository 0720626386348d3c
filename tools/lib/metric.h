/* SPDX-License-Identifier: MIT */
/* The common metric: how close frames of a lit unit sphere are to the truth.
   View +z orthographic, light (sin phi, 0, cos phi), phi = 0..180 by 5 degrees, 96 x 96, disc pixels.
   Reference L = pi E f_r max(n.l, 0); display = clamp, sRGB curve, 8 bit.
   Where the truth holds no data its radiance counts as 0; the approximation gets no allowance there. */
#ifndef METRIC_H
#define METRIC_H

#include "brdf.h"
#include "pixels.h"

#define METRIC_FRAMES   37
#define METRIC_SIZE     96
#define METRIC_STEP_DEG 5.0

/* The light of every frame: as defined, and 2 stops (a quarter of the irradiance) down. */
enum { METRIC_FULL, METRIC_DIM, METRIC_LIGHTS };
#define METRIC_DIM_STOPS 2.0

typedef struct metric_result {
    double pooled_psnr_db; /* from the mean squared error over all frames; 99 = equal */
    double worst_frame_db, worst_frame_deg;
    double frame_db[METRIC_FRAMES];
} metric_result;

/* Unit normal of pixel (i, j) of a size x size frame that the sphere fills; 0 outside the disc. */
int metric_normal(int i, int j, int size, double normal[3]);

/* The same for a camera at distance 1 / sin(fov / 2) whose vertical field of view of fov degrees the sphere fills, with
   the unit vector to_eye; fov 0 is the metric's own orthographic view. */
int metric_pixel(int i, int j, int size, double fov_deg, double normal[3], double to_eye[3]);

/* Light at polar phi (degrees) and the eye (+z), turned into the frame of a unit normal: z the normal, x the part of
   the view's +x in the tangent plane (the view's +y where the normal is along x). */
void metric_local(const double normal[3], double phi_deg, double to_light[3], double to_eye[3]);

/* Display frame (RGB, 8 bit; background 0) of b under one light at polar phi (degrees), with light scale: L =
   pi scale f_r cos. */
void metric_frame(const brdf *b, double phi_deg, double scale, int size, image_u8 *out);

/* Mean squared error over disc pixels and RGB, in 8-bit codes, of two square RGB frames of one size. */
double metric_mse(const image_u8 *a, const image_u8 *b);
double metric_psnr(double mse); /* 10 log10(255^2 / mse), at most 99; 99 at 0 */

/* All frames of one source: drawn once, compared as often as wanted. */
typedef struct metric_frames {
    image_u8 shown[METRIC_LIGHTS][METRIC_FRAMES]; /* display codes, RGB, background 0 */
    image_f32 linear[METRIC_FRAMES];              /* pi E f_r max(n.l, 0), RGB; texel NULL where only codes are known */
} metric_frames;

/* Draw b in double under the light scale E (brdf_exposure of the truth); fov_deg: 0, or of a near eye as above. Uses the
   threads of OpenMP; the frames do not depend on them. */
void metric_draw(metric_frames *out, const brdf *b, double exposure, double fov_deg);
void metric_frames_free(metric_frames *frames);

/* Compare the codes of two sets of frames. light: METRIC_FULL or METRIC_DIM. */
void metric_score(metric_result *out, const metric_frames *truth, const metric_frames *other, int light);

/* Root of the sum over all frames, disc pixels and RGB of (other - truth)^2 over that of truth^2, of linear radiance
   without clamping. 0 for two black sets; infinite where only the truth is black. Both need their linear frames. */
double metric_relative_rms(const metric_frames *truth, const metric_frames *other);

/* Compare truth and approximation, both drawn in double under the truth's exposure. stops: light lowered by so many
   stops (0, 2). */
void metric_compare(const brdf *truth, const brdf *approximation, double stops, metric_result *out);

#endif
