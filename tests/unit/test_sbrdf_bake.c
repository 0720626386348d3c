/* SPDX-License-Identifier: MIT */
/* nacre bake sbrdf and nacre bake power from outside: every source, and every mistake. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "nacre_asset.h"
#include "output.h"
#include "pfm_io.h"
#include "png_io.h"
#include "sbrdf_map.h"
#include "shell.h"

#include <cmocka.h> /* last: it makes fail a macro */

static const double pi = 3.14159265358979323846;

/* ---- inputs -------------------------------------------------------------------------------------------------------- */

static void write_png(const char *name, int width, int height, int channels, const int *rgba)
{
    image_u8 picture = image_u8_make(width, height, channels);
    failure f = {0};
    for (int i = 0; i < width * height * channels; i++) picture.texel[i] = (uint8_t)rgba[i % channels];
    assert_int_equal(png_write(shell_path(name), &picture, &f), 0);
    image_u8_free(&picture);
}

static void write_pfm(const char *name, int width, int height, int channels, const double *value)
{
    image_f32 picture = image_f32_make(width, height, channels);
    failure f = {0};
    for (int i = 0; i < width * height * channels; i++) picture.texel[i] = (float)value[i % channels];
    assert_int_equal(pfm_write(shell_path(name), &picture, &f), 0);
    image_f32_free(&picture);
}

static void write_text(const char *name, const char *text)
{
    shell_write(name, text, strlen(text));
}

static void make_inputs(void)
{
    write_png("albedo.png", 8, 8, 4, (int[]){100, 50, 25, 200});
    write_png("ks.png", 8, 8, 3, (int[]){200, 100, 50});
    write_png("shape.png", 8, 8, 4, (int[]){1, 1, 255, 128});  /* -1 -1 1, n = 64.25 */
    write_png("direction.png", 8, 8, 3, (int[]){128, 255, 0}); /* along y */
    write_png("wide.png", 16, 8, 3, (int[]){1, 2, 3});
    write_png("odd.png", 6, 8, 3, (int[]){100, 50, 25});
    write_png("odd-shape.png", 6, 8, 4, (int[]){1, 1, 255, 128});
    write_png("half.png", 8, 8, 1, (int[]){255});
    write_pfm("albedo.pfm", 8, 8, 3, (double[]){0.25, 0.5, 0.125});
    write_pfm("ks.pfm", 8, 8, 3, (double[]){2.5, 1.25, 0.5});
    write_pfm("c.pfm", 8, 8, 3, (double[]){-1.02, -1.02, 0.9});
    write_pfm("n.pfm", 8, 8, 1, (double[]){40});
    write_pfm("sharp.pfm", 8, 8, 1, (double[]){900});
    write_pfm("nan.pfm", 8, 8, 1, (double[]){NAN});
    write_pfm("steep.pfm", 8, 8, 3, (double[]){-1, -1, -2.5});
    write_text("not.pfm", "PF\n8 8\n-1.0\nshort");
    write_text("paint.txt", "size 8 8\nmaterial red lambert:albedo=.5/.1/.1\nfill red\n");
    write_text("empty.txt", "# nothing\n");
    write_text("few.txt", "stack\nimage ks.pfm 0 0 1 0 0 1\n");
    write_text("below.txt", "stack\nimage ks.pfm 0 0 -1 0 0 1\n");
    write_text("bad-image.txt", "stack\nimage ks.pfm 0 0 1\n");
    write_text("no-material.txt", "size 8 8\nfill red\n");
    write_text("no-mask.txt", "size 8 8\nmaterial a lambert:\nfill a\npaint a missing.png\n");
    write_text("size-mask.txt", "size 8 8\nmaterial a lambert:\nfill a\npaint a wide.png\n");
    write_text("four.txt", "lobes 4\nsize 8 8\n");
    write_text("word.txt", "size 8 8\nmaterial a lambert:\nfill a tnit=x.png\n");
    write_text("first-paint.txt", "size 8 8\nmaterial a lambert:\npaint a half.png\n");
    write_text("unknown.txt", "size 8 8\nvarnish a\n");
    write_text("brdf.txt", "size 8 8\nmaterial a sgd:golld-paint\nfill a\n");
    write_text("broken.gltf", "{\"asset\":");
}

static int begin(void **state)
{
    int failed = shell_begin(state);
    if (!failed) make_inputs();
    return failed;
}

static sbrdf_map open_map(const char *albedo, const char *lobes)
{
    bytes file[2] = {{0}, {0}};
    nacre_image image[2];
    sbrdf_map map;
    failure f = {0};
    const char *name[2] = {albedo, lobes};
    for (int i = 0; i < 2; i++) {
        if (file_read(&file[i], shell_path(name[i]), &f)) fail_msg("%s", f.text);
        assert_int_equal(nacre_image_open(&image[i], file[i].data, file[i].size), 0);
    }
    if (sbrdf_map_read(&map, &image[0], albedo, &image[1], lobes, &f)) fail_msg("%s", f.text);
    bytes_free(&file[0]);
    bytes_free(&file[1]);
    return map;
}

static void must_run(const char *command)
{
    shell_outcome o = shell_run("%s", command);
    if (o.code) fail_msg("%s\n%s", command, o.text);
}

/* ---- sources ------------------------------------------------------------------------------------------------------- */

static void check_value(double found, double expected, double relative)
{
    if (!(fabs(found - expected) <= relative * fabs(expected))) fail_msg("found %.6g, expected %.6g", found, expected);
}

/* Codes given are values given: what comes out reflects the same within half a code of albedo. */
static void png_maps_come_through(void **state)
{
    (void)state;
    must_run("nacre bake sbrdf --albedo albedo.png --lobe ks.png,shape.png --lobe-max 3 -o m.ktx2 --quiet");
    sbrdf_map m = open_map("m-albedo.ktx2", "m-lobes.ktx2");
    sbrdf_texel t;
    const double head_on[3] = {0, 0, 1};
    double f_r[3];
    assert_int_equal(m.levels, 4);
    sbrdf_map_texel(&m, 0, 3, 5, &t);
    check_value(t.brdf.kd[0], 100 / 255.0, 0.003);
    check_value(t.alpha, 200 / 255.0, 0.003);
    check_value(t.brdf.lobe[0].n, 255 * (128 / 255.0) * (128 / 255.0), 1e-9);
    sbrdf_texel_eval(&t, head_on, head_on, f_r);
    check_value(pi * f_r[1], 50 / 255.0 + 3 * 100 / 255.0, 0.01);
    sbrdf_map_free(&m);
}

static void srgb_codes_are_decoded(void **state)
{
    (void)state;
    must_run("nacre bake sbrdf --albedo albedo.png --srgb --lobe ks.png,shape.png -o g.ktx2 --quiet");
    sbrdf_map m = open_map("g-albedo.ktx2", "g-lobes.ktx2");
    sbrdf_texel t;
    sbrdf_map_texel(&m, 0, 0, 0, &t);
    check_value(t.brdf.kd[0], pow((100 / 255.0 + 0.055) / 1.055, 2.4), 0.005);
    sbrdf_map_free(&m);
}

/* Floats: C above 1 as given, so that the sum exceeds 1 at grazing angles. */
static void float_maps_come_through(void **state)
{
    (void)state;
    must_run(
        "nacre bake sbrdf --albedo albedo.pfm --lobe ks.pfm,c.pfm,n.pfm --direction direction.png -o f.ktx2 --quiet");
    sbrdf_map m = open_map("f-albedo.ktx2", "f-lobes.ktx2");
    sbrdf_texel t;
    assert_int_equal(m.layers, 3);
    sbrdf_map_texel(&m, 0, 7, 7, &t);
    check_value(t.direction[1], 1, 1e-3);
    for (int degrees = 30; degrees <= 80; degrees += 25) {
        double s = sin(degrees * pi / 180), c = cos(degrees * pi / 180), f_r[3];
        double l[3] = {s, 0, c}, v[3] = {-s, 0, c}, sum = 1.02 * s * s + 0.9 * c * c;
        sbrdf_texel_eval(&t, l, v, f_r);
        check_value(pi * f_r[0], 0.25 + 2.5 * pow(sum, 40), 0.04);
    }
    sbrdf_map_free(&m);
}

static void paintings_come_through(void **state)
{
    (void)state;
    must_run("nacre bake sbrdf paint.txt -o p.ktx2 --quiet --json p.json --depfile p.d");
    sbrdf_map m = open_map("p-albedo.ktx2", "p-lobes.ktx2");
    sbrdf_texel t;
    sbrdf_map_texel(&m, 0, 2, 2, &t);
    check_value(t.brdf.kd[0], 0.5, 0.01);
    check_value(t.brdf.kd[1], 0.1, 0.02);
    check_value(m.white_sky[0], 0.5, 0.01);
    assert_int_equal(shell_run("grep -q '^p-albedo.ktx2: paint.txt$' p.d && grep -q '\"error\"' p.json").code, 0);
    assert_int_equal(shell_run("nacre info p-albedo.ktx2 && nacre info p-lobes.ktx2").code, 0);
    sbrdf_map_free(&m);
}

/* Half of one, half of the other: albedos mix. */
static void masks_mix(void **state)
{
    (void)state;
    write_png("mask.png", 8, 8, 1, (int[]){51}); /* a fifth */
    write_text("mix.txt",
               "size 8 8\nmaterial a lambert:albedo=.5\nmaterial b lambert:albedo=.1\nfill a\npaint b mask.png\n");
    must_run("nacre bake sbrdf mix.txt -o x.ktx2 --quiet");
    sbrdf_map m = open_map("x-albedo.ktx2", "x-lobes.ktx2");
    sbrdf_texel t;
    sbrdf_map_texel(&m, 0, 4, 4, &t);
    check_value(t.brdf.kd[0], 0.8 * 0.5 + 0.2 * 0.1, 0.01);
    sbrdf_map_free(&m);
}

static void gltf_materials_come_through(void **state)
{
    (void)state;
    static const char gltf[] =
        "{\"asset\":{\"version\":\"2.0\"},\"materials\":[{\"name\":\"other\"},{\"name\":\"brass\","
        "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.9,0.6,0."
        "3,1],"
        "\"metallicFactor\":1,\"roughnessFactor\":0.5}}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
        "\"material\":1}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0,\"accessors\":[{"
        "\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}],\"bufferViews\":[{"
        "\"buffer\":0,"
        "\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}";
    write_text("metal.gltf", gltf);
    must_run("nacre bake sbrdf metal.gltf --material brass --lobes 2 -o metal.ktx2 --quiet --json metal.json");
    sbrdf_map m = open_map("metal-albedo.ktx2", "metal-lobes.ktx2");
    sbrdf_texel t;
    sbrdf_map_texel(&m, 0, 0, 0, &t);
    const double head_on[3] = {0, 0, 1};
    double f_r[3];
    sbrdf_texel_eval(&t, head_on, head_on, f_r);
    check_value(f_r[2] / f_r[0], 0.3 / 0.9, 0.1);      /* a metal reflects its base colour */
    check_value(f_r[0], 0.9 / (4 * pi * 0.0625), 0.3); /* F D / 4, D = 1 / (pi alpha^2) */
    char *figures = shell_read("metal.json"), *at = strstr(figures, "\"fit_error\": ");
    if (!at) at = strstr(figures, "\"fit_error\":");
    assert_non_null(at);
    double error = strtod(strchr(at, ':') + 1, NULL);
    print_message("metal, roughness .5: %.1f %% by two lobes\n", 100 * error);
    assert_true(error > 0 && error < 0.245); /* 24.5: two lobes for this distribution, views of 0..75 degrees */
    free(figures);
    sbrdf_map_free(&m);
}

/* Its normals become a file of their own: x and y times the texture's scale, unit length again, in every level. */
static void gltf_normals_come_through(void **state)
{
    (void)state;
    static const char gltf[] =
        "{\"asset\":{\"version\":\"2.0\"},\"materials\":[{\"name\":\"bumpy\",\"normalTexture\":{\"index\":0,\"scale\":"
        "0.5},"
        "\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0.7}}],\"textures\":[{\"source\":0}],"
        "\"images\":[{\"uri\":\"bumps.png\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
        "\"material\":0}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0,\"accessors\":[{"
        "\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":"
        "\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}";
    bytes file = {0};
    failure f = {0};
    nacre_image image;
    double n[3] = {2 * 218 / 255.0 - 1, 2 * 60 / 255.0 - 1, 2 * 200 / 255.0 - 1};
    write_png("bumps.png", 8, 4, 3, (int[]){218, 60, 200});
    write_text("bumpy.gltf", gltf);
    must_run("nacre bake sbrdf bumpy.gltf -o bumpy.ktx2 --quiet");
    must_run("nacre info bumpy-normal.ktx2");
    assert_int_equal(file_read(&file, shell_path("bumpy-normal.ktx2"), &f), 0);
    assert_int_equal(nacre_image_open(&image, file.data, file.size), NACRE_OK);
    assert_true(image.width == 8 && image.height == 4 && image.levels == 4 && image.format == NACRE_FORMAT_RGB8);
    n[0] *= 0.5;
    n[1] *= 0.5;
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (unsigned level = 0; level < 4; level++)
        for (int c = 0; c < 3; c++)
            check_value(nacre_image_texels(&image, level, 0, 0, NULL)[c] / 255.0, 0.5 + 0.5 * n[c] / length, 0.005);
    bytes_free(&file);
    must_run("nacre shot --mesh plane --size 16 --backend double --light 30,40 -o bumpy.png "
             "--material albedo=bumpy-albedo.ktx2,lobes=bumpy-lobes.ktx2,normal=bumpy-normal.ktx2");
}

/* Seen by the reference renderer: a sheet of painted red is as bright as the BRDF by itself. */
static void shots_draw_them(void **state)
{
    (void)state;
    must_run("nacre bake sbrdf paint.txt -o p.ktx2 --quiet");
    must_run("nacre shot --mesh plane --ortho --material albedo=p-albedo.ktx2,lobes=p-lobes.ktx2 --light 30,0,2,2,2 "
             "--backend double --size 32x32 -o a.png --quiet");
    must_run("nacre shot --mesh plane --ortho --material lambert:albedo=.5/.1/.1 --light 30,0,2,2,2 --backend double "
             "--size 32x32 -o b.png --quiet");
    image_u8 a, b;
    failure f = {0};
    assert_int_equal(png_read(&a, shell_path("a.png"), 3, &f), 0);
    assert_int_equal(png_read(&b, shell_path("b.png"), 3, &f), 0);
    assert_true(a.texel[3 * (16 * 32 + 16)] > 100);
    for (int i = 0; i < 32 * 32 * 3; i++) assert_true(abs(a.texel[i] - b.texel[i]) <= 1);
    image_u8_free(&a);
    image_u8_free(&b);
}

static void threads_do_not_change_bytes(void **state)
{
    (void)state;
    write_text("two.txt",
               "size 16 16\nmaterial a sgd:gold-paint\nmaterial b sgd:red-fabric\nfill a\npaint b ramp.png\n");
    image_u8 ramp = image_u8_make(16, 16, 1);
    failure f = {0};
    for (int i = 0; i < 256; i++) ramp.texel[i] = (uint8_t)i;
    assert_int_equal(png_write(shell_path("ramp.png"), &ramp, &f), 0);
    image_u8_free(&ramp);
    must_run(
        "nacre bake sbrdf two.txt --threads 1 -o one.ktx2 --quiet && nacre bake sbrdf two.txt --threads 3 -o two.ktx2 "
        "--quiet && cmp one-albedo.ktx2 two-albedo.ktx2 && cmp one-lobes.ktx2 two-lobes.ktx2");
}

static void power_tables_are_baked(void **state)
{
    (void)state;
    must_run("nacre bake power -o power.ktx2 --quiet && nacre info power.ktx2");
    must_run("nacre bake power --size 128x64 -o small.ktx2 --quiet && test $(stat -c %s small.ktx2) -gt 8192 && "
             "test $(stat -c %s small.ktx2) -lt 8700");
}

/* ---- mistakes ------------------------------------------------------------------------------------------------------ */

static void clamping_is_counted_and_strict_refuses(void **state)
{
    (void)state;
    static const shell_mistake strict[] = {
        {"nacre bake sbrdf --strict --albedo albedo.pfm --lobe ks.pfm,c.pfm,sharp.pfm -o x1.ktx2", 3,
         "64 exponents outside 0..255"},
        {"nacre bake sbrdf --strict --albedo albedo.pfm --lobe ks.pfm,steep.pfm,n.pfm -o x1.ktx2", 3,
         "64 shapes with |C|"},
        {"nacre bake sbrdf --strict --albedo odd.png --lobe odd.png,odd-shape.png -o x1.ktx2", 3, "6 x 8 texels"},
    };
    CHECK(strict);
    shell_outcome o = shell_run("nacre bake sbrdf --albedo albedo.pfm --lobe ks.pfm,c.pfm,sharp.pfm -o y.ktx2");
    assert_int_equal(o.code, 0);
    assert_int_equal(o.lines, 1);
    assert_non_null(strstr(o.text, "warning: --lobe: 64 exponents outside 0..255, clamped"));
    sbrdf_map m = open_map("y-albedo.ktx2", "y-lobes.ktx2");
    sbrdf_texel t;
    sbrdf_map_texel(&m, 0, 0, 0, &t);
    assert_true(t.brdf.lobe[0].n == 255);
    sbrdf_map_free(&m);
    o = shell_run("nacre bake sbrdf --albedo odd.png --lobe odd.png,odd-shape.png -o z.ktx2");
    assert_int_equal(o.code, 0);
    assert_non_null(strstr(o.text, "no powers of two"));
    m = open_map("z-albedo.ktx2", "z-lobes.ktx2");
    assert_int_equal(m.levels, 1);
    sbrdf_map_free(&m);
}

static void mistakes_are_one_line(void **state)
{
    (void)state;
    static const shell_mistake list[] = {
        {"nacre bake sbrdf -o x1.ktx2", 1, "no input"},
        {"nacre bake sbrdf paint.txt", 1, "-o FILE is missing"},
        {"nacre bake sbrdf --albedo albedo.png -o x1.ktx2", 1, "--lobe: found 0, expected 1 to 3"},
        {"nacre bake sbrdf --albedo albedo.png --lobe a,b --lobe a,b --lobe a,b --lobe a,b -o x1.ktx2", 1,
         "--lobe: found 4"},
        {"nacre bake sbrdf --albedo albedo.png --lobe ks.png -o x1.ktx2", 1, "--lobe ks.png: expected"},
        {"nacre bake sbrdf --albedo albedo.png --lobe ks.png,shape.png,n.pfm,n.pfm -o x1.ktx2", 1,
         "expected ALBEDO,SHAPE"},
        {"nacre bake sbrdf --albedo missing.png --lobe ks.png,shape.png -o x1.ktx2", 2, "missing.png"},
        {"nacre bake sbrdf --albedo albedo.png --lobe missing.png,shape.png -o x1.ktx2", 2, "missing.png"},
        {"nacre bake sbrdf --albedo albedo.png --lobe wide.png,shape.png -o x1.ktx2", 3,
         "wide.png: found 16 x 8 texels, expected 8 x 8 as in albedo.png"},
        {"nacre bake sbrdf --albedo albedo.png --lobe ks.pfm,c.pfm -o x1.ktx2", 3, "c.pfm: found no exponents"},
        {"nacre bake sbrdf --albedo albedo.png --lobe ks.pfm,c.pfm,nan.pfm -o x1.ktx2", 3,
         "nan.pfm: texel (0, 0): found a value"},
        {"nacre bake sbrdf --albedo not.pfm --lobe ks.pfm,c.pfm,n.pfm -o x1.ktx2", 3, "not.pfm: found"},
        {"nacre bake sbrdf paint.txt --range 3 -o x1.ktx2", 1, "--range"},
        {"nacre bake sbrdf paint.txt --range 1.5 -o x1.ktx2", 1, "--range 1.5: expected 1 or 2"},
        {"nacre bake sbrdf metal.gltf --lobes 4 -o x1.ktx2", 1, "--lobes"},
        {"nacre bake sbrdf metal.gltf --lobes 0 -o x1.ktx2", 1, "--lobes"},
        {"nacre bake sbrdf four.txt -o x1.ktx2", 3, "line 1: lobes: found 4, expected 1, 2 or 3"},
        {"nacre bake sbrdf empty.txt -o x1.ktx2", 3, "empty.txt: found no fill"},
        {"nacre bake sbrdf unknown.txt -o x1.ktx2", 3, "unknown.txt: line 2: varnish: expected size"},
        {"nacre bake sbrdf no-material.txt -o x1.ktx2", 3, "line 2: fill red: no such material"},
        {"nacre bake sbrdf no-mask.txt -o x1.ktx2", 2, "missing.png"},
        {"nacre bake sbrdf size-mask.txt -o x1.ktx2", 3, "wide.png: found 16 x 8 texels, expected 8 x 8"},
        {"nacre bake sbrdf word.txt -o x1.ktx2", 3, "line 3: tnit=x.png: expected tint="},
        {"nacre bake sbrdf first-paint.txt -o x1.ktx2", 3, "paint: found before a fill"},
        {"nacre bake sbrdf brdf.txt -o x1.ktx2", 1, "near: gold-paint"},
        {"nacre bake sbrdf few.txt -o x1.ktx2", 3, "found 1 images, expected at least 8"},
        {"nacre bake sbrdf below.txt -o x1.ktx2", 3, "below.txt: line 2: found a direction below the sample"},
        {"nacre bake sbrdf bad-image.txt -o x1.ktx2", 3, "line 2: expected image FILE"},
        {"nacre bake sbrdf broken.gltf -o x1.ktx2", 3, "broken.gltf: not a glTF file that can be read"},
        {"nacre bake sbrdf metal.gltf --material steel -o x1.ktx2", 3, "found 2 materials, none named steel"},
        {"nacre bake sbrdf missing.txt -o x1.ktx2", 2, "missing.txt"},
        {"nacre bake sbrdf paint.txt -o nowhere/x1.ktx2", 2, "nowhere/x1-albedo.ktx2"},
        {"nacre bake power", 1, "-o FILE is missing"},
        {"nacre bake power --size 1x8 -o x1.ktx2", 1, "--size 1x8"},
        {"nacre fit", 1, "argument"},
        {"nacre fit sgd:brass --lobes 4", 1, "--lobes"},
        {"nacre fit sgd:brass --model phong", 1, "--model phong: expected lafortune"},
        {"nacre fit sgd:brass -o a.json --json b.json", 1, "found both"},
        {"nacre shot --mesh plane --material albedo=p-albedo.ktx2 --light 30,0 -o x1.png", 1, "lobes=FILE is missing"},
        {"nacre shot --mesh plane --material lobes=p-lobes.ktx2 --light 30,0 -o x1.png", 1, "albedo=FILE is missing"},
        {"nacre shot --mesh plane --material albedo=p-lobes.ktx2,lobes=p-lobes.ktx2 --light 30,0 -o x1.png", 3,
         "found \"lobes\", expected \"albedo\""},
        {"nacre shot --mesh plane --material albedo=z-albedo.ktx2,lobes=p-lobes.ktx2 --light 30,0 -o x1.png", 3,
         "lobes=: found 8 x 8 texels, 4 levels, expected 6 x 8, 1 levels as in albedo="},
    };
    CHECK(list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(png_maps_come_through),
        cmocka_unit_test(srgb_codes_are_decoded),
        cmocka_unit_test(float_maps_come_through),
        cmocka_unit_test(paintings_come_through),
        cmocka_unit_test(masks_mix),
        cmocka_unit_test(gltf_materials_come_through),
        cmocka_unit_test(gltf_normals_come_through),
        cmocka_unit_test(shots_draw_them),
        cmocka_unit_test(threads_do_not_change_bytes),
        cmocka_unit_test(power_tables_are_baked),
        cmocka_unit_test(clamping_is_counted_and_strict_refuses),
        cmocka_unit_test(mistakes_are_one_line),
    };
    return cmocka_run_group_tests(tests, begin, shell_end);
}
