/* SPDX-License-Identifier: MIT */
/* nacre batch from outside: the same results for any number of jobs and shards, work left out only where content says so,
   a failure that costs one material, and nothing half-made by a killed run. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "brdf.h"
#include "merl.h"
#include "metric.h"
#include "output.h"
#include "shell.h"

#include <cmocka.h> /* last: it makes fail a macro */

/* Eight small bakes of every kind of BRDF: files, fits, models. */
static const char list[] = "a.binary,table,--size 4x4\n"
                           "b.binary,table,--size 4x4\n"
                           "sgd:brass,table,--size 4x4\n"
                           "sgd:brass,spheres,--size 8 --images 2\n"
                           "\"ggx:rough=.5,albedo=.2\",table,--size 4x4\n"
                           "lambert:albedo=.5,table,--tier fine --size 4x4,sub/lambert.ktx2\n"
                           "a.binary,spheres,--size 8 --images 2\n"
                           "blinn-phong:,spheres,--size 8 --images 2\n";
enum { ITEMS = 8 };

static int write_table(const char *name, const char *model)
{
    brdf *b;
    int code = brdf_open(&b, model, NULL);
    if (!code) code = merl_write(shell_path(name), b, 9, 9, 18, NULL);
    if (!code) brdf_close(b);
    return code;
}

static int set_up(void **state)
{
    if (shell_begin(state) || write_table("a.binary", "lambert:albedo=.3") || write_table("b.binary", "blinn-phong:"))
        return 1;
    shell_write("list.csv", list, sizeof list - 1);
    return shell_run("head -c 812 a.binary >short.binary && cp a.binary bad.binary && "
                     "printf '\\377\\377\\377\\377\\377\\377\\377\\377' | dd of=bad.binary bs=4 seek=33 conv=notrunc "
                     "2>/dev/null && "
                     "nacre batch list.csv -o reference --jobs 1 --quiet --json reference.json --csv reference.csv")
        .code;
}

static void ok(const char *command)
{
    shell_outcome o = shell_run("%s", command);
    if (o.code || o.lines) fail_msg("%s\n  gave %d: %s", command, o.code, o.text);
}

/* The last line of a run over the list in a directory begins so. */
static void ends_with_line(const char *directory, const char *expected)
{
    shell_outcome o =
        shell_run("nacre batch list.csv -o %s | tail -n 1 | grep -q '^%s;' || nacre batch list.csv -o %s >&2",
                  directory, expected, directory);
    if (o.lines) fail_msg("expected '%s' of the run in %s", expected, directory);
}

/* Many bakes, and nothing that a sanitizer would see. */
static void not_under_sanitizers(void)
{
#ifdef __SANITIZE_ADDRESS__
    skip();
#endif
}

static void bad_command_lines(void **state)
{
    (void)state;
    ok("echo sgd:brass >one.csv && printf 'sgd:brass\\nsgd:nickel,tabel\\n' >kinds.csv && cat one.csv one.csv "
       ">twice.csv && "
       "printf 'reference/sub/lambert.ktx2,,,x.ktx2\\nsgd:brass,,,sub/lambert.ktx2\\n' >own.csv && mkdir one");
    static const shell_mistake mistakes[] = {
        {"nacre batch", 1, "argument"},
        {"nacre batch list.csv", 1, "-o DIR"},
        {"nacre batch list.csv more.csv -o x", 1, "more.csv"},
        {"nacre batch list.csv -o x --jobs 0", 1, "--jobs"},
        {"nacre batch list.csv -o x --jobs 257", 1, "--jobs"},
        {"nacre batch list.csv -o x --shard 0/2", 1, "--shard 0/2"},
        {"nacre batch list.csv -o x --shard 3/2", 1, "--shard 3/2"},
        {"nacre batch list.csv -o x --shard 2", 1, "I/N"},
        {"nacre batch list.csv -o x --shard 1/2x", 1, "I/N"},
        {"nacre batch list.csv -o x --shard -1/2", 1, "I/N"},
        {"nacre batch list.csv -o x --shard /8", 1, "I/N"},
        {"nacre batch list.csv -o x --backend d3d", 1, "d3d"},
        {"nacre batch list.csv -o x --fail-below 100", 1, "--fail-below"},
        {"nacre batch list.csv -o x --fail-below much", 1, "--fail-below"},
        {"nacre batch list.csv -o x --csv list.csv", 1, "found the input"},
        {"nacre batch list.csv -o x --json ./list.csv", 1, "found the input"},
        {"nacre batch missing.csv -o x", 2, "missing.csv"},
        {"nacre batch . -o x", 2, "directory"},
        {"nacre batch list.csv -o list.csv", 2, "list.csv"},
        {"nacre batch list.csv -o one.csv/x", 2, "one.csv"},
        {"nacre batch kinds.csv -o x", 3, "kinds.csv: line 2, field kind: found \"tabel\""},
        {"nacre batch twice.csv -o x", 3, "line 2, field output"},
        {"nacre batch own.csv -o reference", 3, "own.csv: line 1, field brdf: found the output of line 2"},
        {"nacre batch a.binary -o x", 3, "zero byte"},
        {"nacre batch one.csv -o one --quiet --json no/such.json", 2, "no/such.json"},
        {"nacre batch one.csv -o one --quiet --csv no/such.csv", 2, "no/such.csv"},
        {"nacre batch one.csv -o one --quiet --fail-below 99", 5, "sgd-brass-table.ktx2"},
    };
    CHECK(mistakes);
    ok("nacre batch one.csv -o one --quiet --fail-below 20 && rm -r one");
}

static void results_do_not_depend_on_jobs(void **state)
{
    (void)state;
    static const char *const jobs[] = {"2", "64"};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(shell_run("nacre batch list.csv -o j --jobs %s --quiet --json j.json --csv j.csv && "
                                   "diff -r reference j && cmp reference.json j.json && cmp reference.csv j.csv",
                                   jobs[i])
                             .code,
                         0);
        ok("rm -r j j.json j.csv");
    }
}

static void assets_are_those_of_bake(void **state)
{
    (void)state;
    ok("nacre bake table a.binary --size 4x4 -o bake.ktx2 --quiet && cmp bake.ktx2 reference/a-table-4x4.ktx2");
    ok("nacre bake spheres sgd:brass --size 8 --images 2 -o bake.ktx2 --quiet && "
       "cmp bake.ktx2 reference/sgd-brass-spheres-8-2.ktx2");
}

static void content_decides_what_is_up_to_date(void **state)
{
    (void)state;
    ok("cp -r reference up");
    ends_with_line("up", "0 baked, 8 up to date, 0 failed");
    ok("touch a.binary list.csv up/* up/sub/*");
    ends_with_line("up", "0 baked, 8 up to date, 0 failed");
    ok("diff -r reference up");
    /* A byte of an input: the two materials made of it. And back again. */
    ok("cp a.binary kept && printf '\\1' | dd of=a.binary bs=1 seek=5000 conv=notrunc 2>/dev/null");
    ends_with_line("up", "2 baked, 6 up to date, 0 failed");
    ok("cp kept a.binary");
    ends_with_line("up", "2 baked, 6 up to date, 0 failed");
    ok("diff -r reference up");
    /* Outputs that are gone, changed or cut; records that are gone, cut, or another's. */
    ok("rm up/a-table-4x4.ktx2 && printf x >>up/b-table-4x4.ktx2 && : >up/sub/lambert.ktx2 && rm "
       "up/sgd-brass-table-4x4.ktx2.json");
    ok("head -c 100 up/blinn-phong--spheres-8-2.ktx2.json >part && mv part up/blinn-phong--spheres-8-2.ktx2.json");
    ok("cp up/a-spheres-8-2.ktx2.json up/sgd-brass-spheres-8-2.ktx2.json");
    ends_with_line("up", "6 baked, 2 up to date, 0 failed");
    ok("diff -r reference up");
    /* Other options under the old name; another backend's figures (double by its own name is the same). */
    ok("sed 's/--tier fine --size 4x4/--tier rgb --size 4x4/' list.csv >other.csv && "
       "nacre batch other.csv -o up | grep -q '^1 baked, 7 up to date, 0 failed;'");
    ends_with_line("up", "1 baked, 7 up to date, 0 failed");
    ok("nacre batch list.csv -o up --backend double | grep -q '^0 baked, 8 up to date, 0 failed;'");
    ok("diff -r reference up && rm -r up");
}

static void a_failure_costs_one_material(void **state)
{
    (void)state;
    static const char bad[] = "sgd:brass,table,--size 4x4\nsgd:bras\nbad.binary\nmissing.binary,spheres\nshort.binary\n"
                              "b.binary,table,--size 4x4\n\"ward:ax=.1,ay=.3\"\n";
    shell_write("bad.csv", bad, sizeof bad - 1);
    shell_outcome o = shell_run("nacre batch bad.csv -o bad --json bad.json --csv bad.csv.csv");
    assert_int_equal(o.code, 1); /* of the first one that failed, in the list's order */
    assert_int_equal(o.lines, 5);
    static const char *const says[] = {"nacre batch: bad.csv: line 2: ", "near: brass",
                                       "line 3: bad.binary: ",           "line 4: missing.binary: ",
                                       "line 5: short.binary: ",         "line 7: "};
    for (size_t i = 0; i < sizeof says / sizeof *says; i++)
        if (!strstr(o.text, says[i])) fail_msg("expected '%s' in:\n%s", says[i], o.text);
    ok("ls bad >names; printf 'b-table-4x4.ktx2\\nb-table-4x4.ktx2.json\\nsgd-brass-table-4x4.ktx2\\n"
       "sgd-brass-table-4x4.ktx2.json\\n' | cmp - names");
    ok("cmp bad/b-table-4x4.ktx2 reference/b-table-4x4.ktx2");
    ok("grep -c '\"status\": \"failed\"' bad.json | grep -qx 5 && grep -q '\"error\": \"missing.binary: ' bad.json && "
       "grep -q '^4,.*,failed,,,' bad.csv.csv");
    ok("sed -i 1,2d bad.csv");
    assert_int_equal(shell_run("nacre batch bad.csv -o bad --quiet").code, 3);
    ok("sed -i '1d' bad.csv");
    assert_int_equal(shell_run("nacre batch bad.csv -o bad --quiet").code, 2);
    ok("rm -r bad");
}

static void a_failure_keeps_the_old_files(void **state)
{
    (void)state;
    ok("cp -r reference old && cp a.binary kept && cp bad.binary a.binary");
    shell_outcome o = shell_run("nacre batch list.csv -o old --quiet");
    assert_int_equal(o.code, 3);
    assert_int_equal(o.lines, 2);
    ok("diff -r reference old && cp kept a.binary");
    /* A file-size limit of one block of 512 bytes fails every write in the middle, as a full disk does. */
    ok("rm -r old");
    o = shell_run("trap '' XFSZ; ulimit -f 1; nacre batch list.csv -o old --quiet");
    assert_int_equal(o.code, 2);
    assert_int_equal(o.lines, ITEMS);
    ok("find old -type f | wc -l | grep -qx 0 && rm -r old");
}

static void shards_cover_everything_once(void **state)
{
    (void)state;
    ok("for i in 1 2 3; do nacre batch list.csv -o s$i --shard $i/3 --quiet --csv s$i.csv || exit 1; done");
    ok("cat s1.csv s2.csv s3.csv | grep -v ^line, | sort -n >all && grep -v ^line, reference.csv | cmp - all");
    ok("mkdir s && for i in 1 2 3; do cp -rn s$i/. s; done && diff -r reference s");
    ok("cat s1.csv s2.csv s3.csv | wc -l | grep -qx 11 && find s1 s2 s3 -name '*.ktx2' | wc -l | grep -qx 8");
    ok("nacre batch list.csv -o s --shard 9/9 | grep -q '^0 baked, 0 up to date, 0 failed;'");
    ok("rm -r s s1 s2 s3");
}

static void processes_share_a_directory(void **state)
{
    (void)state;
    not_under_sanitizers();
    /* Shards and whole runs, all at once. */
    ok("for i in 1 2; do nacre batch list.csv -o many --jobs 1 --shard $i/2 --quiet & p=\"$p $!\"; done; "
       "nacre batch list.csv -o many --quiet || exit 1; "
       "for q in $p; do wait $q || exit 1; done; diff -r reference many");
    ends_with_line("many", "0 baked, 8 up to date, 0 failed");
    ok("rm -r many");
}

static void a_killed_run_leaves_nothing_half_made(void **state)
{
    (void)state;
    not_under_sanitizers();
    /* Killed when three assets are there; its workers must end with it. What is there is whole, and nothing else is. */
    shell_outcome o = shell_run("{ \"$tool\" batch list.csv -o cut --jobs 2 --quiet & p=$!; "
                                "while [ $(find cut -name '*.ktx2' | wc -l) -lt 3 ]; do kill -0 $p || break; done; "
                                "kill -KILL $p; wait $p; } 2>/dev/null; sleep .1; "
                                "cd cut && find . -type f | while read f; do cmp $f ../reference/$f >&2; done");
    if (o.lines) fail_msg("left:\n%s", o.text);
    ok("nacre batch list.csv -o cut --quiet && diff -r reference cut && rm -r cut");
}

static void a_stopped_run_says_so(void **state)
{
    (void)state;
    shell_outcome o = shell_run("\"$tool\" batch list.csv -o stop --jobs 1 --quiet & p=$!; "
                                "while [ ! -f stop/a-table-4x4.ktx2 ]; do :; done; kill -TERM $p; { wait $p; } "
                                "2>/dev/null; test $? = 143 && rm -r stop");
    assert_int_equal(o.code, 0);
    assert_int_equal(o.lines, 1);
    assert_non_null(strstr(o.text, "list.csv: stopped by signal 15"));
}

/* ---- figures -------------------------------------------------------------------------------------------------- */

static cJSON *read_json(const char *name)
{
    bytes text = {0};
    assert_int_equal(file_read(&text, shell_path(name), NULL), 0);
    cJSON *json = cJSON_ParseWithLength((const char *)text.data, text.size);
    assert_non_null(json);
    bytes_free(&text);
    return json;
}

static double number(const cJSON *object, const char *name)
{
    const cJSON *value = cJSON_GetObjectItem(object, name);
    assert_true(cJSON_IsNumber(value));
    return value->valuedouble;
}

static const char *text(const cJSON *object, const char *name)
{
    const char *value = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    assert_non_null(value);
    return value;
}

/* Of each asset as it lies there, against its BRDF, by the metric itself. */
static void figures_are_those_of_the_metric(void **state)
{
    (void)state;
    cJSON *json = read_json("reference.json"), *item;
    int checked = 0;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(json, "materials"))
    {
        brdf *truth, *asset;
        char path[300];
        const char *name = text(item, "brdf"), *dot = strstr(name, ".binary");
        snprintf(path, sizeof path, "reference/%s", text(item, "file"));
        assert_int_equal(brdf_open(&truth, dot ? shell_path(name) : name, NULL), 0);
        assert_int_equal(brdf_open(&asset, shell_path(path), NULL), 0);
        metric_result full, dim;
        metric_compare(truth, asset, 0, &full);
        metric_compare(truth, asset, 2, &dim);
        /* the same sums in the same order: equal to the last digits of JSON */
        assert_true(fabs(number(item, "pooled_psnr_db") - full.pooled_psnr_db) < 1e-9);
        assert_true(fabs(number(item, "worst_frame_db") - full.worst_frame_db) < 1e-9);
        assert_true(number(item, "worst_frame_deg") == full.worst_frame_deg);
        assert_true(fabs(number(item, "dim_pooled_psnr_db") - dim.pooled_psnr_db) < 1e-9);
        assert_true(fabs(number(item, "dim_worst_frame_db") - dim.worst_frame_db) < 1e-9);
        brdf_close(truth);
        brdf_close(asset);
        checked++;
    }
    assert_int_equal(checked, ITEMS);
    cJSON_Delete(json);
}

static int of_group(const cJSON *material, const cJSON *group)
{
    return !strcmp(text(material, "kind"), text(group, "kind")) &&
           !strcmp(text(material, "options"), text(group, "options"));
}

/* Mean and worst of every figure of every group, from the materials' own. */
static void groups_sum_up_their_materials(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int larger_is_better;
    } figure[] = {{"bytes", 0},          {"fetches", 0},      {"pooled_psnr_db", 1},
                  {"worst_frame_db", 1}, {"relative_rms", 0}, {"dim_pooled_psnr_db", 1},
                  {"ssim", 1},           {"albedo_error", 0}, {"dim_worst_frame_db", 1}};
    cJSON *json = read_json("reference.json"), *materials = cJSON_GetObjectItem(json, "materials"), *group, *m;
    int counted = 0;
    cJSON_ArrayForEach(group, cJSON_GetObjectItem(json, "groups"))
    {
        for (size_t k = 0; k < sizeof figure / sizeof *figure; k++) {
            double sum = 0, least = INFINITY, most = -INFINITY;
            int count = 0;
            cJSON_ArrayForEach(m, materials)
            {
                if (!of_group(m, group)) continue;
                double value = number(m, figure[k].name);
                sum += value;
                least = fmin(least, value);
                most = fmax(most, value);
                count++;
            }
            double worst = figure[k].larger_is_better ? least : most;
            assert_int_equal(count, (int)number(group, "count"));
            assert_true(fabs(number(cJSON_GetObjectItem(group, "mean"), figure[k].name) - sum / count) <= 1e-9 * sum);
            assert_true(number(cJSON_GetObjectItem(group, "worst"), figure[k].name) == worst);
            const char *file = text(cJSON_GetObjectItem(group, "worst_file"), figure[k].name);
            cJSON_ArrayForEach(m, materials)
            {
                if (!strcmp(text(m, "file"), file)) assert_true(number(m, figure[k].name) == worst);
            }
        }
        counted += (int)number(group, "count");
    }
    assert_int_equal(counted, ITEMS);
    assert_true(number(json, "baked") == ITEMS && number(json, "up_to_date") == 0 && number(json, "failed") == 0);
    cJSON_Delete(json);
}

/* The table for people shows the same, rounded: bytes, fetches, pooled and worst frame of each material and its group. */
static void the_table_shows_the_same(void **state)
{
    (void)state;
    ok("nacre batch list.csv -o reference >table.txt");
    cJSON *json = read_json("reference.json"), *m, *group;
    char expected[300];
    cJSON_ArrayForEach(m, cJSON_GetObjectItem(json, "materials"))
    {
        snprintf(expected, sizeof expected, "grep -q '^  %s  *%.0f  *%.0f  *%.2f  *%.2f ' table.txt", text(m, "file"),
                 number(m, "bytes"), number(m, "fetches"), number(m, "pooled_psnr_db"), number(m, "worst_frame_db"));
        ok(expected);
    }
    cJSON_ArrayForEach(group, cJSON_GetObjectItem(json, "groups"))
    {
        if (number(group, "count") < 2) continue; /* the material's own line is all there is */
        const cJSON *mean = cJSON_GetObjectItem(group, "mean"), *worst = cJSON_GetObjectItem(group, "worst");
        snprintf(expected, sizeof expected, "grep -q '^  mean of %.0f  *%.0f  *%.0f  *%.2f  *%.2f ' table.txt",
                 number(group, "count"), number(mean, "bytes"), number(mean, "fetches"), number(mean, "pooled_psnr_db"),
                 number(mean, "worst_frame_db"));
        ok(expected);
        snprintf(expected, sizeof expected, "grep -q '^  worst  *%.0f  *%.0f  *%.2f  *%.2f ' table.txt",
                 number(worst, "bytes"), number(worst, "fetches"), number(worst, "pooled_psnr_db"),
                 number(worst, "worst_frame_db"));
        ok(expected);
    }
    cJSON_Delete(json);
}

static void json_on_standard_output_stands_alone(void **state)
{
    (void)state;
    ok("nacre batch - -o reference --json - <list.csv >out.json && head -c 1 out.json | grep -qx '{' && "
       "tail -n 1 out.json | grep -qx '}' && sed 's/up to date/baked/' out.json | head -n 100 >a && "
       "head -n 100 reference.json | cmp - a");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_command_lines),
        cmocka_unit_test(results_do_not_depend_on_jobs),
        cmocka_unit_test(assets_are_those_of_bake),
        cmocka_unit_test(content_decides_what_is_up_to_date),
        cmocka_unit_test(a_failure_costs_one_material),
        cmocka_unit_test(a_failure_keeps_the_old_files),
        cmocka_unit_test(shards_cover_everything_once),
        cmocka_unit_test(processes_share_a_directory),
        cmocka_unit_test(a_killed_run_leaves_nothing_half_made),
        cmocka_unit_test(a_stopped_run_says_so),
        cmocka_unit_test(figures_are_those_of_the_metric),
        cmocka_unit_test(groups_sum_up_their_materials),
        cmocka_unit_test(the_table_shows_the_same),
        cmocka_unit_test(json_on_standard_output_stands_alone),
    };
    return cmocka_run_group_tests(tests, set_up, shell_end);
}
