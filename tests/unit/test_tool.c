/* SPDX-License-Identifier: MIT */
/* The program from outside: every mistake gives one line that names the file or option, the documented exit code, and
   leaves no partial output. Runs $NACRE_TOOL (build/release/nacre). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shell.h"

#include <cmocka.h>

/* A MERL table of n_th x n_td x n_pd samples, all f_r = value before the channel scales, bad at one place. */
static void write_merl(const char *name, int n_th, int n_td, int n_pd, size_t samples, double value, double bad)
{
    int32_t header[3] = {n_th, n_td, n_pd};
    double *table = calloc(samples + 1, sizeof *table);
    unsigned char *file = malloc(sizeof header + samples * sizeof *table);
    for (size_t i = 0; i < samples; i++) table[i] = i == 17 ? bad : value;
    memcpy(file, header, sizeof header);
    memcpy(file + sizeof header, table, samples * sizeof *table);
    shell_write(name, file, sizeof header + samples * sizeof *table);
    free(table);
    free(file);
}

static void bad_command_lines(void **state)
{
    (void)state;
    static const shell_mistake list[] = {
        {"nacre bakee", 1, "near: bake"},
        {"nacre bake", 1, "table, spheres, lights, mesh, sbrdf, palette or power"},
        {"nacre bake tabel lambert: -o x.ktx2", 1, "tabel"},
        {"nacre bake table", 1, "argument"},
        {"nacre bake table lambert:albedo=.5", 1, "-o"},
        {"nacre bake table lambert:albedo=.5 -o", 1, "-o"},
        {"nacre bake table lambert:albedo=.5 -o x.ktx2 --sise 24x21", 1, "--size"},
        {"nacre bake table lambert:albedo=.5 -o x.ktx2 --size 3x21", 1, "4..128"},
        {"nacre bake table lambert:albedo=.5 -o x.ktx2 --size 24x129", 1, "128"},
        {"nacre bake table lambert:albedo=.5 -o x.ktx2 --tier best", 1, "--tier best"},
        {"nacre bake table lambert:albedo=.5 -o x.ktx2 --power 4.5", 1, "--power"},
        {"nacre bake table lambert:albedo=.5 -o x.ktx2 --threads 0", 1, "--threads"},
        {"nacre bake spheres lambert:albedo=.5 -o x.ktx2 --size 100000", 1, "--size"},
        {"nacre bake spheres lambert:albedo=.5 -o x.ktx2 --polar 0,90,45", 1, "--polar"},
        {"nacre bake spheres lambert:albedo=.5 -o x.ktx2 --polar 0,nan", 1, "--polar"},
        {"nacre bake spheres lambert:albedo=.5 -o x.ktx2 --polar 0,200", 1, "--polar"},
        {"nacre bake spheres lambert:albedo=.5 -o x.ktx2 --mode fast", 1, "--mode fast"},
        {"nacre bake spheres lambert:albedo=.5 -o x.ktx2 --format dxt1", 1, "--format dxt1"},
        {"nacre shot --mesh sphere --ortho --material lambert:albedo=.5 --light 30,0 --size 100000 -o x.png", 1,
         "--size"},
        {"nacre shot --mesh sphere --ortho --material lambert:albedo=.5 --light 30,0 --size 0x5 -o x.png", 1, "--size"},
        {"nacre shot --mesh sphere --ortho --material lambert:albedo=.5 --light 30,x -o x.png", 1, "--light"},
        {"nacre shot --mesh sphere --ortho --material lambert:albedo=.5 -o x.png", 1, "light"},
        {"nacre shot --mesh sphere --ortho --material lambert:albedo=.5 --light 30,0 --backend d3d -o x.png", 1, "d3d"},
        {"nacre shot --mesh sphere --ortho --material lambert:albedo=.5 --light 30,0", 1, "-o"},
        {"nacre shot --mesh sphere --ortho --material lambert:albedo=.5 --light 30,0 -o ''", 1, "-o"},
        {"nacre shot --mesh '' --material lambert:albedo=.5 --light 30,0 -o x.png", 1, "--mesh"},
        {"nacre shot --mesh sphere --material tabel=x.ktx2 --light 30,0 -o x.png", 1, "table=FILE"},
        {"nacre shot --mesh sphere --material \"$(printf 'a\\nb')\" --light 30,0 -o x.png", 1, "a?b"},
        {"nacre info ''", 1, "empty"},
        {"nacre shot --mesh sphere --ortho --material lambert:albedo=.5 --point 1,0,2 --point 2,0,2 --point 3,0,2 "
         "--point 4,0,2 "
         "--point 5,0,2 --point 6,0,2 --point 7,0,2 --point 8,0,2 --point 9,0,2 -o x.png",
         1, "at most 8"},
    };
    CHECK(list);
}

static void unknown_materials_name_the_near_ones(void **state)
{
    (void)state;
    static const shell_mistake list[] = {
        {"nacre bake table sgd:gold-metalic-paint -o x.ktx2", 1, "gold-metallic-paint"},
        {"nacre bake table ggxx:rough=.3 -o x.ktx2", 1, "ggx"},
        {"nacre bake table ggx:rugh=.3 -o x.ktx2", 1, "rough"},
        {"nacre bake table ggx:rough=7 -o x.ktx2", 1, "rough"},
        {"nacre bake table ggx:rough=nan -o x.ktx2", 1, "rough"},
        {"nacre bake table lambert:albedo=.5/.5 -o x.ktx2", 1, "albedo"},
        {"nacre bake table merl: -o x.ktx2", 1, "merl:FILE"},
        {"nacre shot --mesh teapott --material lambert:albedo=.5 --light 30,0 -o x.png", 2, "teapott"},
    };
    CHECK(list);
}

static void bad_files(void **state)
{
    (void)state;
    write_merl("short.binary", 9, 9, 18, 9 * 9 * 18 * 3 - 1, 1, 1);
    write_merl("long.binary", 9, 9, 18, 9 * 9 * 18 * 3 + 1, 1, 1);
    write_merl("huge.binary", 1 << 20, 1 << 20, 1 << 20, 100, 1, 1);
    write_merl("zero.binary", 0, 9, 18, 100, 1, 1);
    write_merl("negative.binary", 9, -9, 18, 100, 1, 1);
    write_merl("nan.binary", 9, 9, 18, 9 * 9 * 18 * 3, 1, 0.0 / 0.0);
    write_merl("infinite.binary", 9, 9, 18, 9 * 9 * 18 * 3, 1, 1e300 * 1e300);
    shell_write("tiny.binary", "abc", 3);
    shell_write("empty.ktx2", "", 0);
    shell_write("text.ktx2", "this is no texture, but it is long enough to hold a header of eighty bytes, nearly.", 83);
    shell_write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", 24);
    shell_write("garbage.glb", "glTF garbage", 12);
    assert_int_equal(shell_run("nacre bake table lambert:albedo=.5 -o table.ktx2").code, 0);
    static const shell_mistake list[] = {
        {"nacre bake table missing.binary -o x.ktx2", 2, "missing.binary"},
        {"nacre bake table merl:missing -o x.ktx2", 2, "missing"},
        {"nacre bake table . -o x.ktx2", 1, "."},
        {"nacre bake table merl:. -o x.ktx2", 2, "."},
        {"nacre bake table short.binary -o x.ktx2", 3, "short.binary"},
        {"nacre bake table long.binary -o x.ktx2", 3, "long.binary"},
        {"nacre bake table huge.binary -o x.ktx2", 3, "huge.binary"},
        {"nacre bake table zero.binary -o x.ktx2", 3, "zero.binary"},
        {"nacre bake table negative.binary -o x.ktx2", 3, "negative.binary"},
        {"nacre bake table nan.binary -o x.ktx2", 3, "nan.binary"},
        {"nacre bake table infinite.binary -o x.ktx2", 3, "infinite.binary"},
        {"nacre bake table tiny.binary -o x.ktx2", 3, "tiny.binary"},
        {"nacre bake mesh points.obj -o x.c", 3, "points.obj"},
        {"nacre bake mesh garbage.glb -o x.c", 3, "garbage.glb"},
        {"nacre bake mesh missing.obj -o x.c", 2, "missing.obj"},
        {"nacre bake mesh sphere -o x.txt", 1, "x.txt"},
        {"nacre shot --mesh points.obj --material lambert:albedo=.5 --light 30,0 -o x.png", 3, "points.obj"},
        {"nacre shot --mesh sphere --material empty.ktx2 --light 30,0 -o x.png", 3, "empty.ktx2"},
        {"nacre shot --mesh sphere --material text.ktx2 --light 30,0 -o x.png", 3, "text.ktx2"},
        {"nacre shot --mesh sphere --material missing.ktx2 --light 30,0 -o x.png", 2, "missing.ktx2"},
        {"nacre shot --mesh sphere --material spheres=table.ktx2 --light 30,0 -o x.png", 3,
         "found \"table\", expected \"spheres\""},
        {"nacre info text.ktx2", 3, "text.ktx2"},
        {"nacre info missing.ktx2", 2, "missing.ktx2"},
    };
    CHECK(list);
}

static void outputs_that_cannot_be_written(void **state)
{
    (void)state;
    static const shell_mistake list[] = {
        {"nacre bake table lambert:albedo=.5 -o no/such/place/x.ktx2", 2, "no/such/place/x.ktx2"},
        {"nacre bake table lambert:albedo=.5 -o .", 2, "."},
        {"nacre bake table lambert:albedo=.5 -o /dev/full", 2, "/dev/full"},
        {"nacre bake mesh plane -o no/such/x.bin", 2, "no/such/x.bin"},
        {"nacre shot --mesh plane --material lambert:albedo=.5 --light 30,0 --backend double --size 16 -o "
         "no/such/x.png",
         2, "no/such/x.png"},
    };
    CHECK(list);
}

static void outputs_spare_the_input_and_come_all_or_not_at_all(void **state)
{
    (void)state;
    write_merl("source.binary", 9, 9, 18, 9 * 9 * 18 * 3, 100, 100);
    shell_write("source.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 32);
    static const shell_mistake list[] = {
        {"nacre bake table source.binary -o ./source.binary", 1, "found the input"},
        {"nacre bake mesh source.obj -o source.obj", 1, "found the input"},
        {"nacre shot --mesh source.obj --material lambert:albedo=.5 --light 30,0 -o source.obj", 1, "found the input"},
        {"nacre bake table lambert:albedo=.5 -o y.ktx2 --depfile no/such/d", 2, "no/such/d"},
        {"nacre bake table lambert:albedo=.5 -o y.ktx2 --depfile y.d --json no/such/j", 2, "no/such/j"},
        {"nacre bake table lambert:albedo=.5 -o no/such/y --depfile y.d --json y.json", 2, "no/such/y"},
        {"nacre bake mesh plane -o no/such/y.bin --depfile y.d --json y.json", 2, "no/such/y.bin"},
    };
    CHECK(list);
}

/* A portable float map with one radiance everywhere but at one texel. */
static void write_map(const char *name, int width, int height, float value, float one)
{
    char file[4096];
    int used = snprintf(file, sizeof file, "PF\n%d %d\n-1\n", width, height);
    for (int i = 0; i < 3 * width * height; i++, used += 4) memcpy(file + used, i == 7 ? &one : &value, 4);
    shell_write(name, file, (size_t)used);
}

#define MATT "--mesh sphere --ortho --material lambert:albedo=.5 --size 16"

static void environments(void **state)
{
    (void)state;
    write_map("sky.pfm", 8, 4, 1, 1);
    write_map("night.pfm", 8, 4, 0, 0);
    write_map("square.pfm", 8, 8, 1, 1);
    write_map("sun.pfm", 8, 4, 1, 1e7f);
    write_map("negative.pfm", 8, 4, 1, -1);
    shell_write("empty.hdr", "", 0);
    shell_write("cut.hdr", "#?RADIANCE\n\n-Y 4 +X 8\nabcd", 26);
    shell_write("bad.csv", "90,0,1,1,1\n90,0,1,1\n", 20);
    static const shell_mistake list[] = {
        {"nacre bake lights sky.pfm", 1, "-o"},
        {"nacre bake lights sky.pfm -o x.csv --count 0", 1, "--count 0: expected a whole number 1..1024"},
        {"nacre bake lights sky.pfm -o x.csv --count 10000", 1, "--count 10000"},
        {"nacre bake lights sky.pfm -o x.csv --method best", 1, "median-cut"},
        {"nacre bake lights sky.pfm -o x.csv --turn nan", 1, "--turn"},
        {"nacre bake lights sky.pfm -o sky.pfm", 1, "found the input"},
        {"nacre bake lights missing.hdr -o x.csv", 2, "missing.hdr"},
        {"nacre bake lights sky.pfm -o no/such/x.csv", 2, "no/such/x.csv"},
        {"nacre bake lights empty.hdr -o x.csv", 3, "empty.hdr: the file is empty"},
        {"nacre bake lights cut.hdr -o x.csv", 3, "cut.hdr: offset 26"},
        {"nacre bake lights night.pfm -o x.csv", 3, "black"},
        {"nacre bake lights square.pfm -o x.csv", 3, "8x8"},
        {"nacre bake lights sun.pfm -o x.csv", 4, "--scale"},
        {"nacre bake lights bad.csv -o x.csv", 3, "bad.csv: found '90,0,1,1,1'"},
        {"nacre shot " MATT " --backend double --lights-file bad.csv -o x.png", 3, "bad.csv: line 2"},
        {"nacre shot " MATT " --backend double --lights-file missing.csv -o x.png", 2, "missing.csv"},
        {"nacre shot " MATT " --backend double --lights-file bad.csv -o bad.csv", 1, "found the input"},
        {"nacre shot " MATT " --backend double --env sky.pfm -o sky.pfm", 1, "found the input"},
        {"nacre shot " MATT " --backend double --env night.pfm -o x.png", 3, "black"},
        {"nacre shot " MATT " --backend double --env night.pfm --count all -o x.png", 3, "black"},
        {"nacre shot " MATT " --backend double --env sky.pfm --count 0 -o x.png", 1, "--count 0"},
        {"nacre shot " MATT " --backend double --env sky.pfm --count 10000 -o x.png", 1, "1..1024, or all"},
        {"nacre shot " MATT " --backend double --env sky.pfm --env sky.pfm -o x.png", 1, "--env"},
        {"nacre shot " MATT " --backend double --light 0,0 --count 4 -o x.png", 1, "--env MAP"},
        {"nacre shot " MATT " --env sky.pfm --count all -o x.png", 1, "--backend double"},
        {"nacre shot " MATT " --env sky.pfm --point 0,0,1 -o x.png", 1, "--point"},
        {"nacre shot " MATT " --backend double -o x.png", 1, "--env MAP.hdr"},
        {"nacre shot " MATT " --light 0,0 --turning lights -o x.png", 1, "--turntable"},
        {"nacre shot " MATT " --light 0,0 --turntable 4 --turning eye -o x.png", 1, "mesh or lights"},
        {"nacre shot " MATT " --light 0,0 --point 0,0,1 --turntable 4 --turning lights -o x.png", 1, "--point"},
        {"nacre shot " MATT " --light 0,0 --turntable 0 -o x.png", 1, "1..3600"},
        {"nacre shot " MATT " --light 0,0 --turntable 2 -o 'x%s.png'", 1, "%03d"},
        {"nacre shot " MATT " --light 0,0 --turntable 2 -o 'x%d%d.png'", 1, "%03d"},
        {"nacre shot " MATT " --light 0,0 --turntable 2 -o 'x%n.png'", 1, "%03d"},
        {"nacre shot " MATT " --backend double --light 0,0 --turntable 2 -o 'no/such/%d.png'", 2, "no/such/0.png"},
    };
    CHECK(list);
    /* a warning that counts, and lights all the same */
    shell_outcome o = shell_run("nacre bake lights negative.pfm -o x.csv");
    assert_int_equal(o.code, 0);
    assert_int_equal(o.lines, 1);
    assert_non_null(strstr(o.text, "negative.pfm: 1 texels of negative radiance and 0 of NaN"));
    assert_string_equal(shell_run("nacre bake lights negative.pfm -o x.csv --quiet").text, "");
}

static void lights_and_turns_are_what_they_say(void **state)
{
    (void)state;
    write_map("sky.pfm", 8, 4, 1, 30);
    static const char *const good[] = {
        /* a file of lights is the environment it was made of */
        "nacre bake lights sky.pfm --count 20 --turn 30 -o lights.csv --json j --depfile d && "
        "nacre shot " MATT " --backend double --lights-file lights.csv -o a.png && "
        "nacre shot " MATT " --backend double --env sky.pfm --count 20 --turn-lights 30 -o b.png && cmp a.png b.png",
        "grep -q '\"lights\": 20' j && grep -q '^lights.csv: sky.pfm' d",
        "nacre bake lights sky.pfm -o my-lights.c && cc -I$OLDPWD/include -std=c99 -Wall -Wextra -pedantic -Werror -c "
        "-o l.o my-lights.c && nm l.o | grep -q my_lights_count",
        /* frames are numbered from 0; the first is the picture without a turntable, seen from its own distance */
        "nacre shot " MATT " --backend double --light 60,20 --turntable 3 --turning lights -o 'f%02d.png' && "
        "nacre shot " MATT " --backend double --light 60,20 -o a.png && cmp f00.png a.png && "
        "nacre shot " MATT " --backend double --light 60,20 --turn-lights 240 -o b.png && cmp f02.png b.png && "
        "test ! -e f03.png",
        "nacre shot --mesh torus --material lambert:albedo=.5 --size 16 --backend double --light 60,20 --turntable 4 "
        "-o "
        "t%d.png && ! cmp -s t0.png t1.png && "
        "nacre shot --mesh torus --material lambert:albedo=.5 --size 16 --backend double --light 60,20 --turntable 2 "
        "--turn 180 -o u%d.png && cmp t2.png u0.png && cmp t0.png u1.png",
        "nacre shot " MATT " --backend double --light 60,20 --turntable 3 --turning lights -o spin.png && "
        "grep -aq acTL spin.png && grep -aq fdAT spin.png",
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        shell_outcome o = shell_run("%s", good[i]);
        if (o.code) fail_msg("exit %d: %s\n%s", o.code, good[i], o.text);
    }
    shell_run("rm -f *");
}

static void a_missing_driver(void **state)
{
    (void)state;
    static const shell_mistake list[] = {
        {"LIBGL_DRIVERS_PATH=/nonexistent nacre shot --mesh plane --material lambert:albedo=.5 --light 30,0 --backend "
         "egl2 -o x.png",
         4, "EGL"},
        {"__EGL_VENDOR_LIBRARY_DIRS=/nonexistent nacre shot --mesh plane --material lambert:albedo=.5 --light 30,0 "
         "--backend egl3 -o x.png",
         4, "EGL"},
    };
    CHECK(list);
}

static void json_on_standard_output_stands_alone(void **state)
{
    (void)state;
    assert_int_equal(shell_run("nacre bake mesh plane -o p.bin --json - >p.json && head -c 1 p.json | grep -qx '{' && "
                               "tail -n 1 p.json | grep -qx '}'")
                         .code,
                     0);
    assert_int_equal(shell_run("nacre bake table lambert:albedo=.5 -o a.ktx2 --json - | tail -n 1 | grep -qx '}'").code,
                     0);
}

static void a_full_disk_leaves_the_old_file_and_no_other(void **state)
{
    (void)state;
    assert_int_equal(shell_run("nacre bake table lambert:albedo=.5 -o kept.ktx2").code, 0);
    assert_int_equal(shell_run("cp kept.ktx2 before.ktx2").code, 0);
    int files = shell_files();
    /* A file-size limit of one block of 512 bytes fails the write in the middle, as a full disk does. */
    shell_outcome o = shell_run("trap '' XFSZ; ulimit -f 1; nacre bake table ggx:rough=.3,f0=.04 -o kept.ktx2");
    assert_int_equal(o.code, 2);
    assert_int_equal(o.lines, 1);
    assert_non_null(strstr(o.text, "kept.ktx2"));
    assert_int_equal(shell_files(), files);
    assert_int_equal(shell_run("cmp kept.ktx2 before.ktx2").code, 0);
}

static void the_same_input_gives_the_same_bytes(void **state)
{
    (void)state;
    assert_int_equal(shell_run("nacre bake table ggx:rough=.3,f0=.04,albedo=.2 -o a.ktx2 --threads 1").code, 0);
    assert_int_equal(shell_run("nacre bake table ggx:rough=.3,f0=.04,albedo=.2 -o b.ktx2 --threads 4").code, 0);
    assert_int_equal(shell_run("cmp a.ktx2 b.ktx2").code, 0);
    assert_int_equal(shell_run("nacre bake spheres sgd:gold-metallic-paint --size 64 -o a.ktx2 --threads 1").code, 0);
    assert_int_equal(shell_run("nacre bake spheres sgd:gold-metallic-paint --size 64 -o b.ktx2 --threads 3").code, 0);
    assert_int_equal(shell_run("cmp a.ktx2 b.ktx2").code, 0);
}

static void c_arrays_hold_the_file_and_depfiles_its_inputs(void **state)
{
    (void)state;
    write_merl("small.binary", 9, 9, 18, 9 * 9 * 18 * 3, 100, 100);
    assert_int_equal(shell_run("nacre bake table small.binary -o a.ktx2 --depfile a.d").code, 0);
    assert_int_equal(shell_run("nacre bake table small.binary -o my-table.c").code, 0);
    assert_true(shell_exists("my-table.c"));
    assert_int_equal(shell_run("grep -q '^a.ktx2: small.binary$' a.d").code, 0);
    static const char program[] = "#include <stdio.h>\nextern const unsigned char my_table[];\n"
                                  "extern const unsigned long my_table_size;\n"
                                  "int main(void) { fwrite(my_table, 1, my_table_size, stdout); return 0; }\n";
    shell_write("main.c", program, sizeof program - 1);
    assert_int_equal(
        shell_run("cc -std=c99 -Wall -Wextra -pedantic -Werror -o main main.c my-table.c && ./main >b.ktx2 && "
                  "cmp a.ktx2 b.ktx2")
            .code,
        0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_command_lines),
        cmocka_unit_test(unknown_materials_name_the_near_ones),
        cmocka_unit_test(bad_files),
        cmocka_unit_test(outputs_that_cannot_be_written),
        cmocka_unit_test(outputs_spare_the_input_and_come_all_or_not_at_all),
        cmocka_unit_test(environments),
        cmocka_unit_test(lights_and_turns_are_what_they_say),
        cmocka_unit_test(a_missing_driver),
        cmocka_unit_test(json_on_standard_output_stands_alone),
        cmocka_unit_test(a_full_disk_leaves_the_old_file_and_no_other),
        cmocka_unit_test(the_same_input_gives_the_same_bytes),
        cmocka_unit_test(c_arrays_hold_the_file_and_depfiles_its_inputs),
    };
    return cmocka_run_group_tests(tests, shell_begin, shell_end);
}
