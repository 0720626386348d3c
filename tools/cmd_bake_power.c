/* SPDX-License-Identifier: MIT */
/* nacre bake power: x^n as a texture (McAllister et al. 2002, section 4.1), and how far off it is. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake_common.h"
#include "ktx2_write.h"
#include "nacre_asset.h"
#include "power_file.h"

static json power_figures(const power_file *p, const char *path, size_t size)
{
    json j = {0};
    json_begin(&j, NULL, '{');
    json_text(&j, "file", path);
    json_int(&j, "width", p->width);
    json_int(&j, "height", p->height);
    json_int(&j, "texel_bytes", (long long)p->width * p->height);
    json_int(&j, "file_bytes", (long long)size);
    json_real(&j, "error_n50", power_file_error(p, 50));
    json_real(&j, "error_n255", power_file_error(p, 255));
    json_real(&j, "root_error_n50", power_file_root_error(p, 50));
    json_real(&j, "root_error_n255", power_file_root_error(p, 255));
    json_end(&j, '}');
    return j;
}

int bake_power(int argc, char **argv, failure *f)
{
    bake_common c = {0};
    power_file p = {.width = 256, .height = 256};
    const char *size = NULL;
    int operands;
    const option table[] = {
        BAKE_OPTIONS(c),
        {"--size", OPTION_TEXT, &size, 0, 0, "WxH", "texels over x' = x^2 and n', 2..4096 (256x256)"},
    };
    int code = options_parse(argc, argv, "nacre bake power -o F.ktx2 [options]", table, sizeof table / sizeof *table,
                             NULL, &operands, 0, 0, f);
    if (code || (code = bake_check(&c, "bake power", NULL, f))) return code;
    if (size && (code = parse_size(size, "--size", NACRE_MAX_TEXELS, &p.width, &p.height, f))) return code;
    if (p.width < 2 || p.height < 2) return fail(f, FAIL_USAGE, "--size %s: expected WxH, each 2..4096", size);

    bytes file = {0};
    power_file_write(&p, &file);
    json figures = power_figures(&p, c.output, file.size);
    code = bake_write_outputs(&c, &file, NULL, &figures, f);
    if (!code && bake_prints(&c))
        printf("%s: x^n, %d x %d, %d bytes of texels; error at n = 50 / 255: %.4f / %.4f of the peak, of roots %.4f / "
               "%.4f\n",
               c.output, p.width, p.height, p.width * p.height, power_file_error(&p, 50), power_file_error(&p, 255),
               power_file_root_error(&p, 50), power_file_root_error(&p, 255));
    bytes_free(&file);
    return code;
}
