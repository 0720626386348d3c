/* SPDX-License-Identifier: MIT */
/* One light in coordinates of its half vector, for the models that are stored in them. */
#include "shade.h"

static int32_t mul_q28(int64_t a, int64_t b)
{
    return (int32_t)fx_shift(a * b, 28);
}

void shade_own_frame(int32_t turn_q28[][3], int32_t *sin_q28, int32_t *cos_q28, const shade_incoming *in)
{
    const int64_t across[3] = {in->to_light_q28[0], in->to_light_q28[1], 0};
    const int64_t length = fx_isqrt((uint64_t)(across[0] * across[0] + across[1] * across[1]));
    int32_t azimuth[3] = {FX_Q28_ONE, 0, 0};

    *sin_q28 = in->lost ? 0 : (int32_t)fx_div(length * (FX_Q28_ONE / 2), in->l_dot_h_q28);
    *cos_q28 = in->lost ? FX_Q28_ONE : in->l_dot_h_q28;
    fx_normalize_q28(across, azimuth);
    turn_q28[0][0] = mul_q28(azimuth[0], *cos_q28);
    turn_q28[0][1] = mul_q28(azimuth[1], *cos_q28);
    turn_q28[0][2] = -*sin_q28;
    turn_q28[1][0] = -azimuth[1];
    turn_q28[1][1] = azimuth[0];
    turn_q28[1][2] = 0;
    turn_q28[2][0] = mul_q28(azimuth[0], *sin_q28);
    turn_q28[2][1] = mul_q28(azimuth[1], *sin_q28);
    turn_q28[2][2] = *cos_q28;
}

/* (1 - l.v) / (2 (1 + l.h)): no cancellation */
int32_t shade_away(const shade_incoming *in)
{
    if (in->lost) return FX_Q28_ONE;
    return (int32_t)fx_div((FX_Q28_ONE - (int64_t)in->to_light_q28[2]) * FX_Q28_ONE,
                           2 * ((int64_t)FX_Q28_ONE + in->l_dot_h_q28));
}
