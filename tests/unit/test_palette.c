/* SPDX-License-Identifier: MIT */
/* Palettes: bakes against tables of their own, files against what went in, places in fp16, and every mistake. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asset_cases.h"
#include "ktx2_write.h"
#include "metric.h"
#include "nacre_asset.h"
#include "palette.h"
#include "palette_case.h"
#include "png_io.h"
#include "shade.h"
#include "shell.h"

#include <cmocka.h> /* last: it makes fail a macro */

/* ---- inputs ------------------------------------------------------------------------------------------------------- */

static void write_grey(const char *name, int width, int height, int (*code)(int x, int y))
{
    image_u8 picture = image_u8_make(width, height, 1);
    failure f = {0};
    for (int i = 0; i < width * height; i++) picture.texel[i] = (uint8_t)code(i % width, i / width);
    assert_int_equal(png_write(shell_path(name), &picture, &f), 0);
    image_u8_free(&picture);
}

static int bars(int x, int y)
{
    (void)y;
    return x / 2;
}

static int checks(int x, int y)
{
    return (x + y) % 2 * 255;
}

static int slope(int x, int y)
{
    (void)y;
    return 32 * x + 20;
}

static void write_text(const char *name, const char *text)
{
    shell_write(name, text, strlen(text));
}

static void write_many(void)
{
    bytes text = {0};
    for (int i = 0; i < 257; i++) bytes_printf(&text, "material m%d lambert:albedo=.5\n", i);
    shell_write("many.txt", text.data, text.size);
    bytes_free(&text);
}

static int begin(void **state)
{
    const int code = shell_begin(state);
    write_grey("bars.png", 8, 8, bars);
    write_grey("checks.png", 8, 8, checks);
    write_grey("slope.png", 8, 8, slope);
    write_grey("wide.png", 16, 8, bars);
    write_text("four.txt", "size 8 8\nmaterial a sgd:gold-metallic-paint\nmaterial b sgd:red-fabric\n"
                           "material c sgd:yellow-plastic\nmaterial d ggx:rough=.3,f0=.9/.6/.3\nindex bars.png\n");
    write_text("greys.txt", "size 8 8\nmaterial low lambert:albedo=.1\nmaterial high lambert:albedo=.7\n"
                            "material middle lambert:albedo=.4\nfill low\npaint high checks.png\n");
    write_text("soft.txt", "size 8 8\nmaterial low lambert:albedo=.1\nmaterial high lambert:albedo=.7\n"
                           "fill low\npaint high slope.png\n");
    write_text("beyond.txt", "size 8 8\nmaterial a lambert:albedo=.5\nmaterial b lambert:albedo=.4\nindex bars.png\n");
    write_text("both.txt", "size 8 8\nmaterial a lambert:albedo=.5\nfill a\nindex bars.png\n");
    write_text("size.txt", "size 8 8\nmaterial a lambert:albedo=.5\nindex wide.png\n");
    write_text("tint.txt", "size 8 8\nmaterial a lambert:albedo=.5\nfill a tint=bars.png\n");
    write_text("turn.txt", "size 8 8\nmaterial a lambert:albedo=.5\nfill a turn=30\n");
    write_text("alpha.txt", "size 8 8\nmaterial a lambert:albedo=.5\nfill a\nopacity bars.png\n");
    write_text("wood.txt", "size 8 8\nmaterial a ward:ax=.1,ay=.4,ks=.2,kd=.3\nfill a\n");
    write_text("name.txt", "size 8 8\nmaterial a sgd:golld-paint\nfill a\n");
    write_text("empty.txt", "size 8 8\n");
    write_many();
    return code;
}

static palette baked(const char *name, const palette_options *options)
{
    sbrdf_sources sources = {0};
    palette p;
    failure f = {0};
    if (palette_bake(&p, shell_path(name), options, &sources, &f)) print_error("%s\n", f.text);
    assert_int_equal(f.code, 0);
    sbrdf_sources_free(&sources);
    return p;
}

/* ---- bakes -------------------------------------------------------------------------------------------------------- */

/* Common numbers cost little: against each table baked alone, also with p = 4. The loss is that of one exposure, one range and
   one weight vector for gold, cloth and plastic; what is asked is that the least is still a good table. */
static void tables_stay_near_their_brdfs(void **state)
{
    static const char *const names[] = {"sgd:gold-metallic-paint", "sgd:red-fabric", "sgd:yellow-plastic",
                                        "ggx:rough=.3,f0=.9/.6/.3"};
    palette p = baked("four.txt", &(palette_options){0});
    (void)state;
    assert_int_equal(p.count, 4);
    for (int i = 0; i < 4; i++) {
        failure f = {0};
        metric_result shared, alone;
        table_asset own;
        brdf *b, *drawn = table_brdf(&p.table[i]);
        assert_int_equal(brdf_open(&b, names[i], &f), 0);
        assert_int_equal(table_bake(&own, b, &(table_options){.power = 4}, &f), 0);
        brdf *single = table_brdf(&own);
        metric_compare(b, drawn, 0, &shared);
        metric_compare(b, single, 0, &alone);
        print_message("%s: %.1f dB in a palette, %.1f dB alone\n", names[i], shared.pooled_psnr_db,
                      alone.pooled_psnr_db);
        assert_true(shared.pooled_psnr_db > 44 && shared.pooled_psnr_db > alone.pooled_psnr_db - 8);
        for (int k = 0; k < 3; k++) {
            assert_true(p.table[i].w[k] == p.table[0].w[k]);
            assert_true(fabs(p.table[i].albedo[k] - own.albedo[k]) < 1e-9);
        }
        assert_true(p.table[i].ymax == p.table[0].ymax && p.table[i].e == p.table[0].e &&
                    p.table[i].eps == p.table[0].eps && p.table[i].rows == p.table[0].rows);
        brdf_close(drawn);
        brdf_close(single);
        brdf_close(b);
        table_free(&own);
    }
    palette_free(&p);
}

/* Index pictures are the codes themselves; masks give the material of which most shows: slope is over half from 32 x + 20 >
   127.5 on, which is x >= 4. */
static void maps_have_the_painted_codes(void **state)
{
    palette p = baked("four.txt", &(palette_options){.width = 8, .height = 8}),
            q = baked("soft.txt", &(palette_options){.width = 8, .height = 8, .no_mips = 1});
    (void)state;
    assert_true(p.width == 8 && p.height == 8 && p.levels == 4 && q.levels == 1);
    for (int i = 0; i < 64; i++) {
        assert_int_equal(p.code[0][i], i % 8 / 2);
        assert_int_equal(q.code[0][i], i % 8 >= 4);
    }
    /* bars are two texels wide: level 1 has one of each; further on no material but one of those it covers is nearer */
    for (int i = 0; i < 16; i++) assert_int_equal(p.code[1][i], i % 4);
    palette_free(&p);
    palette_free(&q);
}

/* A chessboard of albedo .1 and .7 is .4 from afar. */
static void smaller_levels_look_like_the_mean(void **state)
{
    palette p = baked("greys.txt", &(palette_options){.width = 8, .height = 8});
    (void)state;
    for (int level = 1; level < p.levels; level++)
        for (int i = 0; i < (8 >> level) * (8 >> level); i++) assert_int_equal(p.code[level][i], 2);
    palette_free(&p);
}

static void threads_do_not_change_bytes(void **state)
{
    (void)state;
    assert_int_equal(shell_run("nacre bake palette four.txt -o t1.ktx2 --size 8x8 --threads 1 --quiet && "
                               "nacre bake palette four.txt -o t2.ktx2 --size 8x8 --threads 2 --quiet && "
                               "cmp t1-palette.ktx2 t2-palette.ktx2 && cmp t1-index.ktx2 t2-index.ktx2")
                         .code,
                     0);
}

/* ---- files -------------------------------------------------------------------------------------------------------- */

typedef struct files {
    bytes file[2];
    nacre_image image[2];
    nacre_material material;
} files;

static void open_files(files *out)
{
    for (int i = 0; i < 2; i++)
        assert_int_equal(nacre_image_open(&out->image[i], out->file[i].data, out->file[i].size), NACRE_OK);
    memset(&out->material, 0, sizeof out->material);
    out->material.model = NACRE_MODEL_PALETTE;
    out->material.image[NACRE_ROLE_PALETTE] = &out->image[0];
    out->material.image[NACRE_ROLE_INDEX] = &out->image[1];
}

/* The made-up palette in files. */
static void open_case(palette *made, int blend, files *out)
{
    *out = (files){0};
    palette_case_make(made, blend);
    palette_write(made, &out->file[0], &out->file[1]);
    open_files(out);
}

static void close_files(files *f)
{
    for (int i = 0; i < 2; i++) bytes_free(&f->file[i]);
}

static void files_keep_everything(void **state)
{
    palette made, read;
    files f;
    failure fail_ = {0};
    (void)state;
    open_case(&made, 1, &f);
    assert_int_equal(palette_read(&read, &f.image[0], "a", &f.image[1], "b", &fail_), 0);
    assert_true(read.count == made.count && read.width == made.width && read.height == made.height && read.blend == 1);
    assert_memory_equal(read.code[0], made.code[0], (size_t)(made.width * made.height));
    for (int i = 0; i < made.count; i++) {
        const table_asset *a = &made.table[i], *b = &read.table[i];
        assert_memory_equal(a->rgba, b->rgba, (size_t)(4 * a->width * a->height));
        assert_true(a->e == b->e && a->ymax == b->ymax && a->w[1] == b->w[1] && a->eps == b->eps && a->rows == b->rows);
        for (int k = 0; k < 3; k++) assert_true(a->albedo[k] == b->albedo[k]);
    }
    palette_free(&made);
    palette_free(&read);
    close_files(&f);
}

/* The file by another way: texels of tile i by the formula of nacre_asset.h, guards and albedo. */
static void tiles_are_where_the_format_says(void **state)
{
    palette made;
    files f;
    (void)state;
    open_case(&made, 0, &f);
    const uint8_t *texels = nacre_image_texels(&f.image[0], 0, 0, 0, NULL);
    const int columns = f.image[0].width / 26;
    for (int i = 0; i < made.count; i++) {
        const uint8_t *tile = texels + 4 * ((i / columns * 25) * f.image[0].width + i % columns * 26);
        for (int y = 0; y < 25; y++)
            for (int x = 0; x < 26; x++) {
                const uint8_t *at = tile + 4 * (y * f.image[0].width + x);
                const int column = x < 1 ? 0 : x > 24 ? 23 : x - 1, row = y < 1 ? 0 : y > 21 ? 20 : y - 1;
                if (y < 23)
                    assert_memory_equal(at, made.table[i].rgba + 4 * (row * 24 + column), 4);
                else
                    assert_true(at[0] == 179 && at[1] == 128 && at[2] == 51 && at[3] == 255);
            }
    }
    palette_free(&made);
    close_files(&f);
}

/* ---- fp16 --------------------------------------------------------------------------------------------------------- */

static double half(double x)
{
    int exponent;
    const double m = frexp(x, &exponent);
    return ldexp(nearbyint(ldexp(m, 11)), exponent - 11);
}

/* Devices without highp: origin and sum rounded to fp16, the filter must stay within half a texel of the table's first and
   last texel centres, where the guards are. How far a place moves at most, for the sizes that users bake. */
static void half_precision_stays_in_its_tile(void **state)
{
    static const int counts[] = {1, 4, 13, 16, 64, 100, 256};
    double worst = 0; /* of columns */
    (void)state;
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        const int count = counts[n], columns = palette_columns(count, 24, 21), rows = (count + columns - 1) / columns;
        const double across = columns * 26.0, down = rows * 25.0;
        double moved[2] = {0};
        for (int i = 0; i < count; i++) {
            const double u0 = (double)(i % columns) / columns, v0 = (double)(i / columns) * half(1.0 / rows);
            for (int k = 0; k <= 230; k++) {
                const double u = half((k / 10.0 + 1.5) / across), v = half((k * 20 / 230.0 + 1.5) / down);
                moved[0] = fmax(moved[0], fabs(half(half(u0) + u) - u0 - u) * across);
                moved[1] = fmax(moved[1], fabs(half(half(v0) + v) - (double)(i / columns) / rows - v) * down);
            }
        }
        print_message("%d tables in %d columns: columns move by %.3f, rows by %.3f texels at most\n", count, columns,
                      moved[0], moved[1]);
        assert_true(moved[0] < 0.5 && moved[1] < 0.5);
        worst = fmax(worst, moved[0]);
    }
    assert_true(worst < 0.07); /* 208 texels: half a step of 2^-11, and the rounding of u */
}

/* ---- mistakes ----------------------------------------------------------------------------------------------------- */

/* The value of a key in a file's bytes, for spoiling it. */
static uint8_t *value_of(files *f, int index, const char *key)
{
    const uint8_t *at = nacre_image_key(&f->image[index], key, NULL);
    assert_non_null(at);
    return f->file[index].data + (at - f->file[index].data);
}

static void runtime_answers(files *f, nacre_result expected)
{
    shade_material m;
    assert_int_equal(shade_material_read(&m, &f->material), expected);
}

static void the_runtime_trusts_nothing(void **state)
{
    static const struct {
        const char *key;
        int file, number;
        uint32_t value;
    } wrong[] = {
        {NACRE_KEY_TILES, 0, 0, 0},       {NACRE_KEY_TILES, 0, 0, 257}, {NACRE_KEY_TILES, 0, 0, 0xFFFFFFFF},
        {NACRE_KEY_TILES, 0, 0, 200},     {NACRE_KEY_TILES, 0, 1, 0},   {NACRE_KEY_TILES, 0, 1, 3},
        {NACRE_KEY_TILES, 0, 1, 32},      {NACRE_KEY_TILES, 0, 1, 4},   {NACRE_KEY_TILES, 0, 2, 3},
        {NACRE_KEY_TILES, 0, 2, 129},     {NACRE_KEY_TILES, 0, 2, 25},  {NACRE_KEY_TILES, 0, 3, 22},
        {NACRE_KEY_TABLE, 0, 0, 0},       {NACRE_KEY_TABLE, 0, 1, 0},   {NACRE_KEY_TABLE, 0, 5, 314573},
        {NACRE_KEY_TABLE, 0, 6, 0x20000}, {NACRE_KEY_TABLE, 0, 6, 0},   {NACRE_KEY_TABLE, 0, 9, 0x20000},
        {NACRE_KEY_BLEND, 1, 0, 2},
    };
    palette made;
    files f;
    (void)state;
    open_case(&made, 0, &f);
    runtime_answers(&f, NACRE_OK);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        uint8_t *at = value_of(&f, wrong[i].file, wrong[i].key) + 4 * wrong[i].number, kept[4];
        memcpy(kept, at, 4);
        for (int k = 0; k < 4; k++) at[k] = (uint8_t)(wrong[i].value >> 8 * k);
        runtime_answers(&f, NACRE_ERR_ASSET);
        memcpy(at, kept, 4);
    }
    for (int i = 0; i < 2; i++) {
        const nacre_role role = i ? NACRE_ROLE_INDEX : NACRE_ROLE_PALETTE;
        f.material.image[role] = NULL;
        runtime_answers(&f, NACRE_ERR_ARGUMENT);
        f.material.image[role] = &f.image[1 - i]; /* the other one */
        runtime_answers(&f, NACRE_ERR_ASSET);
        f.material.image[role] = &f.image[i];
    }
    runtime_answers(&f, NACRE_OK);
    palette_free(&made);
    close_files(&f);
}

/* One code too high, in any level. */
static void codes_name_tables(void **state)
{
    files f = {0};
    palette p = baked("four.txt", &(palette_options){.width = 8, .height = 8});
    failure failed = {0};
    palette read;
    (void)state;
    for (int level = 0; level < p.levels; level++) {
        p.code[level][0] = 4;
        palette_write(&p, &f.file[0], &f.file[1]);
        open_files(&f);
        runtime_answers(&f, NACRE_ERR_ASSET);
        assert_int_equal(palette_read(&read, &f.image[0], "a", &f.image[1], "b", &failed), FAIL_INVALID);
        assert_string_equal(failed.text, "b: found code 4, expected less than the 4 tables of a");
        close_files(&f);
        f = (files){0};
        failed = (failure){0};
        p.code[level][0] = 0;
    }
    palette_free(&p);
}

/* Small files with every byte of their heads changed to every other value, and every code: read or refused, never beyond
   their ends (the sanitizers watch), and what is read is in range. */
static void changed_bytes_are_read_or_refused(void **state)
{
    files f = {0};
    long refused = 0, read = 0;
    (void)state;
    for (int i = 0; i < asset_case_count; i++) {
        const int which = !strcmp(asset_cases[i].name, "palette") ? 0 : !strcmp(asset_cases[i].name, "index") ? 1 : -1;
        ktx2_image k;
        if (which < 0) continue;
        asset_case_make(&asset_cases[i], &k);
        ktx2_write(&k, &f.file[which]);
        ktx2_free(&k);
    }
    open_files(&f);
    runtime_answers(&f, NACRE_OK);
    for (int which = 0; which < 2; which++)
        for (size_t at = 0; at < f.file[which].size; at++) {
            uint8_t *byte = f.file[which].data + at;
            const uint8_t kept = *byte;
            for (int change = 1; change < 256; change++) {
                shade_material m;
                *byte = (uint8_t)(kept ^ change);
                if (nacre_image_open(&f.image[which], f.file[which].data, f.file[which].size) ||
                    shade_material_read(&m, &f.material)) {
                    refused++;
                    continue;
                }
                read++;
                assert_true(m.palette.count >= 1 && m.palette.count <= 256 && m.palette.columns <= 16);
                assert_true(m.palette.columns * m.palette.rows >= m.palette.count);
                assert_true(m.is.table.image_width == m.palette.columns * (m.is.table.width + 2));
                for (unsigned level = 0; level < f.image[1].levels; level++) {
                    uint32_t size;
                    const uint8_t *codes = nacre_image_texels(&f.image[1], level, 0, 0, &size);
                    for (uint32_t i = 0; i < size; i++) assert_true(codes[i] < m.palette.count);
                }
            }
            *byte = kept;
            assert_int_equal(nacre_image_open(&f.image[which], f.file[which].data, f.file[which].size), NACRE_OK);
        }
    print_message("%ld changed bytes refused, %ld read\n", refused, read);
    assert_true(refused > 0 && read > 0);
    close_files(&f);
}

static void mistakes_are_one_line(void **state)
{
    static const shell_mistake list[] = {
        {"nacre bake palette", 1, "argument"},
        {"nacre bake palette four.txt", 1, "-o FILE is missing"},
        {"nacre bake palette missing.txt -o x.ktx2", 2, "missing.txt"},
        {"nacre bake palette beyond.txt -o x.ktx2", 3,
         "index: texel (4, 0): found code 2, expected less than the 2 materials"},
        {"nacre bake palette both.txt -o x.ktx2", 3, "line 3: found fill or paint beside index"},
        {"nacre bake palette size.txt -o x.ktx2", 3, "wide.png: found 16 x 8 texels, expected 8 x 8"},
        {"nacre bake palette tint.txt -o x.ktx2", 4, "line 3: tint=: the tables of a palette are whole"},
        {"nacre bake palette turn.txt -o x.ktx2", 4, "line 3: turn=: the tables of a palette are whole"},
        {"nacre bake palette alpha.txt -o x.ktx2", 4, "opacity: a palette has none"},
        {"nacre bake palette wood.txt -o x.ktx2", 4, "anisotropic"},
        {"nacre bake palette name.txt -o x.ktx2", 1, "near: gold-paint"},
        {"nacre bake palette empty.txt -o x.ktx2", 3, "found no fill"},
        {"nacre bake palette many.txt -o x.ktx2", 3, "line 257: material: found more than 256"},
        {"nacre bake palette four.txt -o x.ktx2 --size 3x8", 1, "--size"},
        {"nacre bake palette four.txt -o x.ktx2 --size 129x8", 1, "--size"},
        {"nacre bake palette four.txt --size 8x8 -o nowhere/x.ktx2", 2, "nowhere/x-palette.ktx2"},
        {"nacre bake sbrdf four.txt -o x.ktx2", 4, "index: found in a painting for Lafortune maps"},
        {"nacre shot --mesh plane --material palette=p-palette.ktx2 --light 30,0 -o x.png", 1, "index=FILE is missing"},
        {"nacre shot --mesh plane --material index=p-index.ktx2 --light 30,0 -o x.png", 1, "palette=FILE is missing"},
        {"nacre shot --mesh plane --material palette=p-index.ktx2,index=p-index.ktx2 --light 30,0 -o x.png", 3,
         "found \"index\", expected \"palette\""},
        {"nacre shot --mesh plane --material palette=p-palette.ktx2,index=p-index.ktx2 --backend soft --light 30,0 -o "
         "x.png",
         4, ""},
    };
    (void)state;
    assert_int_equal(shell_run("nacre bake palette four.txt -o p.ktx2 --size 8x8 --quiet").code, 0);
    assert_int_equal(shell_run("nacre info p-palette.ktx2 p-index.ktx2").code, 0);
    CHECK(list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_stay_near_their_brdfs),
        cmocka_unit_test(maps_have_the_painted_codes),
        cmocka_unit_test(smaller_levels_look_like_the_mean),
        cmocka_unit_test(threads_do_not_change_bytes),
        cmocka_unit_test(files_keep_everything),
        cmocka_unit_test(tiles_are_where_the_format_says),
        cmocka_unit_test(half_precision_stays_in_its_tile),
        cmocka_unit_test(the_runtime_trusts_nothing),
        cmocka_unit_test(codes_name_tables),
        cmocka_unit_test(changed_bytes_are_read_or_refused),
        cmocka_unit_test(mistakes_are_one_line),
    };
    return cmocka_run_group_tests(tests, begin, shell_end);
}
