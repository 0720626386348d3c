/* SPDX-License-Identifier: MIT */
#include "power_file.h"

#include <math.h>

#include "ktx2_write.h"
#include "nacre_asset.h"
#include "shade.h"

static unsigned texel(const power_file *p, int column, int row)
{
    unsigned value = shade_power_texel((unsigned)column, (unsigned)row, (unsigned)p->width, (unsigned)p->height);
    return (value * 255 + 32767) / 65535;
}

void power_file_write(const power_file *p, bytes *out)
{
    ktx2_image k = {.format = NACRE_FORMAT_R8, .width = p->width, .height = p->height, .faces = 1, .levels = 1};
    for (int row = 0; row < p->height; row++)
        for (int column = 0; column < p->width; column++) {
            const uint8_t code = (uint8_t)texel(p, column, row);
            bytes_append(&k.level[0], &code, 1);
        }
    ktx2_key_text(&k, NACRE_KEY_ROLE, "power");
    ktx2_key_text(&k, NACRE_KEY_TRANSFER, "root");
    ktx2_write(&k, out);
    ktx2_free(&k);
}

static int within(int i, int count)
{
    return i < 0 ? 0 : i < count ? i : count - 1;
}

/* x^(n/2), as filtered. */
static double sample_root(const power_file *p, double x, double n)
{
    double column = x * x * (p->width - 0.5) - 0.5, row = sqrt(n / NACRE_EXPONENT_MOST) * p->height - 0.5, sum = 0;
    for (int corner = 0; corner < 4; corner++) {
        int i = (int)floor(column) + (corner & 1), j = (int)floor(row) + (corner >> 1);
        double a = column - floor(column), b = row - floor(row);
        sum +=
            (corner & 1 ? a : 1 - a) * (corner >> 1 ? b : 1 - b) * texel(p, within(i, p->width), within(j, p->height));
    }
    return sum / 255;
}

double power_file_sample(const power_file *p, double x, double n)
{
    const double root = sample_root(p, x, n);
    return root * root;
}

double power_file_error(const power_file *p, double n)
{
    double worst = 0;
    for (int i = 0; i <= 4000; i++) {
        double x = 0.5 + i / 8000.0;
        worst = fmax(worst, fabs(power_file_sample(p, x, n) - pow(x, n)));
    }
    return worst;
}

double power_file_root_error(const power_file *p, double n)
{
    double worst = 0;
    for (int i = 0; i <= 8000; i++) {
        double x = i / 8000.0;
        worst = fmax(worst, fabs(sample_root(p, x, n) - pow(x, n / 2)));
    }
    return worst;
}
