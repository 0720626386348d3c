/* SPDX-License-Identifier: MIT */
/* Structural similarity against closed forms, a direct sum over windows, and scikit-image. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "ssim.h"

#include <cmocka.h>

enum { WIDTH = 48, HEIGHT = 40 };

/* Grey pictures of small formulas. */
static image_u8 picture(int which)
{
    image_u8 p = image_u8_make(WIDTH, HEIGHT, 1);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            int a = (3 * x * x + 7 * x * y + 5 * y * y) % 251, b = (5 * x + 3 * y) % 256;
            int noisy = a + (13 * x + 29 * y) % 17 - 8;
            int value[] = {a, b, noisy < 0 ? 0 : noisy > 255 ? 255 : noisy, b * 3 / 4 + 20};
            p.texel[y * WIDTH + x] = (uint8_t)value[which];
        }
    return p;
}

static void same_as_scikit_image(void **state)
{
    (void)state;
    /* scikit-image 0.26.0: structural_similarity(a, b, gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
       data_range=255) of the pictures above */
    static const struct {
        int a, b;
        double expected;
    } pair[] = {{0, 2, 0.9977289683959011}, {1, 3, 0.9582449168135913}, {0, 1, 0.015111643267433292}};
    for (int i = 0; i < 3; i++) {
        image_u8 a = picture(pair[i].a), b = picture(pair[i].b);
        assert_true(fabs(ssim_mean(&a, &b, NULL) - pair[i].expected) < 1e-10);
        assert_true(fabs(ssim_mean(&b, &a, NULL) - pair[i].expected) < 1e-10);
        assert_true(ssim_mean(&a, &a, NULL) == 1);
        image_u8_free(&a);
        image_u8_free(&b);
    }
}

/* No variance, so that only the first factor is left: (2 a b + C1) / (a^2 + b^2 + C1). */
static void flat_pictures(void **state)
{
    (void)state;
    static const uint8_t pair[3][2] = {{0, 255}, {100, 110}, {0, 5}};
    image_u8 a = image_u8_make(20, 11, 3), b = image_u8_make(20, 11, 3);
    for (int i = 0; i < 3; i++) {
        double x = pair[i][0], y = pair[i][1], c1 = 2.55 * 2.55;
        memset(a.texel, pair[i][0], 20 * 11 * 3);
        memset(b.texel, pair[i][1], 20 * 11 * 3);
        assert_true(fabs(ssim_mean(&a, &b, NULL) - (2 * x * y + c1) / (x * x + y * y + c1)) < 1e-9);
    }
    image_u8_free(&a);
    image_u8_free(&b);
}

/* One window summed as the paper's equations 14 to 16 say, about the only pixel of the mask. */
static void one_window_of_a_mask(void **state)
{
    (void)state;
    image_u8 a = picture(0), b = picture(2);
    uint8_t mask[WIDTH * HEIGHT] = {0};
    const int x0 = 30, y0 = 17;
    double total = 0, mean[2] = {0, 0}, variance[2] = {0, 0}, covariance = 0;
    mask[y0 * WIDTH + x0] = 1;
    mask[2 * WIDTH + 30] = 1; /* its window does not lie inside */
    for (int pass = 0; pass < 3; pass++)
        for (int dy = -5; dy <= 5; dy++)
            for (int dx = -5; dx <= 5; dx++) {
                double w = exp(-(dx * dx + dy * dy) / 4.5), p = a.texel[(y0 + dy) * WIDTH + x0 + dx];
                double q = b.texel[(y0 + dy) * WIDTH + x0 + dx];
                if (pass == 0) {
                    total += w;
                } else if (pass == 1) {
                    mean[0] += w / total * p;
                    mean[1] += w / total * q;
                } else {
                    variance[0] += w / total * (p - mean[0]) * (p - mean[0]);
                    variance[1] += w / total * (q - mean[1]) * (q - mean[1]);
                    covariance += w / total * (p - mean[0]) * (q - mean[1]);
                }
            }
    const double c1 = 6.5025, c2 = 58.5225;
    double expected = (2 * mean[0] * mean[1] + c1) * (2 * covariance + c2) /
                      ((mean[0] * mean[0] + mean[1] * mean[1] + c1) * (variance[0] + variance[1] + c2));
    assert_true(fabs(ssim_mean(&a, &b, mask) - expected) < 1e-10);
    image_u8_free(&a);
    image_u8_free(&b);
}

static void nothing_to_look_at(void **state)
{
    (void)state;
    image_u8 a = picture(0), b = picture(1);
    uint8_t none[WIDTH * HEIGHT] = {0};
    assert_true(ssim_mean(&a, &b, none) == 1);
    image_u8_free(&a);
    image_u8_free(&b);
}

static void channels_are_averaged(void **state)
{
    (void)state;
    image_u8 grey[2][2] = {{picture(0), picture(2)}, {picture(1), picture(3)}};
    image_u8 a = image_u8_make(WIDTH, HEIGHT, 2), b = image_u8_make(WIDTH, HEIGHT, 2);
    double sum = 0;
    for (int c = 0; c < 2; c++) {
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            a.texel[2 * i + c] = grey[c][0].texel[i];
            b.texel[2 * i + c] = grey[c][1].texel[i];
        }
        sum += ssim_mean(&grey[c][0], &grey[c][1], NULL);
        image_u8_free(&grey[c][0]);
        image_u8_free(&grey[c][1]);
    }
    assert_true(fabs(ssim_mean(&a, &b, NULL) - sum / 2) < 1e-12);
    image_u8_free(&a);
    image_u8_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_as_scikit_image),  cmocka_unit_test(flat_pictures),
        cmocka_unit_test(one_window_of_a_mask),  cmocka_unit_test(nothing_to_look_at),
        cmocka_unit_test(channels_are_averaged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
