/* SPDX-License-Identifier: MIT */
/* Lafortune lobes per texel (McAllister et al. 2002): what is constant over a draw. */
#include "shade.h"

#define LOG2_CODES_255  16806414     /* 255 log2(255/127), q16: codes give (code - 128)/255, C is (code - 128)/127 */
#define LOG2_WEIGHT_MAX (15 * 65536) /* fp16 ends at 2^16 */

void shade_sbrdf_light(shade_sbrdf_setup *out, const shade_incoming *in)
{
    int i;

    for (i = 0; i < 3; i++) out->to_light_q28[i] = in->to_light_q28[i];
}

/* K^2 (W - 1/2) / W */
static fx_real column_scale(nacre_q16 shape_most, int width)
{
    const int64_t codes = fx_div((int64_t)255 * 255 * (2 * width - 1) * 65536, (int64_t)127 * 127 * 2 * width);
    const fx_real shape = fx_real_make(shape_most, -16);

    return fx_real_mul(fx_real_make(codes, -16), fx_real_mul(shape, shape));
}

void shade_sbrdf_prepare(shade_sbrdf_draw *out, const shade_sbrdf *sbrdf)
{
    const fx_real none = {0, 0};
    int j;

    for (j = 0; j < NACRE_MAX_LOBES; j++) {
        const int given = j < sbrdf->lobes;
        const int32_t shape = given ? fx_log2_q16(sbrdf->shape_most[j]) : 0;
        const int32_t weight = given ? fx_log2_q16(sbrdf->most[j]) - fx_log2_q16(sbrdf->albedo_most) : FX_LOG2_ZERO;

        out->log2_scale[j] = fx_real_make(LOG2_CODES_255 + 255 * (int64_t)shape, -16);
        out->column_scale[j] =
            given && sbrdf->power_width ? column_scale(sbrdf->shape_most[j], sbrdf->power_width) : none;
        out->log2_weight_q16[j] = weight < LOG2_WEIGHT_MAX ? weight : LOG2_WEIGHT_MAX;
    }
}

int32_t shade_sbrdf_log2(const shade_sbrdf *sbrdf)
{
    return fx_log2_q16(sbrdf->albedo_most) - SHADE_LOG2_PI_Q16;
}
