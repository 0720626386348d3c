// SPDX-License-Identifier: MIT
// The public headers together in C++11: they link, and the helpers do what they say. Compiled by test_headers.c.
#include "nacre.h"
#include "nacre_asset.h"
#include "nacre_gles.h"
#include "nacre_soft.h"

#include <cstdio>
#include <cstring>

int main()
{
    nacre_image image;
    if (nacre_version() != NACRE_VERSION) return 1;
    if (nacre_image_open(&image, "", 0) != NACRE_ERR_ASSET) return 2;
    if (!std::strcmp(nacre_result_text(NACRE_OK), nacre_result_text(NACRE_ERR_ASSET))) return 3;
    if (nacre_q16_from_float(-1.5f) != -98304 || nacre_q14_from_float(9) != 32767) return 4;
    const nacre_gles_desc desc = {};
    if (nacre_gles_size(&desc)) return 5; /* no loader: not valid */
    const nacre_soft_desc soft = {};
    if (nacre_soft_size(&soft)) return 6; /* no width: not valid */
    std::puts("C++11 program ran");
    return 0;
}
