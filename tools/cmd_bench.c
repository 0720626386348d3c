/* SPDX-License-Identifier: MIT */
/* nacre bench: how long frames take on this machine, one table of figures at a time. */
#include <stdio.h>
#include <string.h>

#include "bench.h"
#include "commands.h"
#include "options.h"

typedef struct table_entry {
    const char *name;
    bench_table *run;
    const char *help;
} table_entry;

static const table_entry tables[] = {
    {"models", bench_models, "every model under 1, 2, 4 and 8 lights shaded directly (the default)"},
    {"paper000", bench_paper000,
     "texels that all differ, by lights and lobes, as in tables 1 and 2 of McAllister et al."},
    {"paper002", bench_paper002, "teapot and bunny by lights, as in table I of Mihalik and Durikovic: direct and lit"},
    {"cpu", bench_cpu, "the CPU renderer beside Mesa's, by instruction set, path, mesh and lights"},
};
enum { TABLE_COUNT = sizeof tables / sizeof tables[0] };

static int find_table(const char *name, const table_entry **out, failure *f)
{
    const char *names[TABLE_COUNT];
    char near[128];
    for (int i = 0; i < TABLE_COUNT; i++) {
        names[i] = tables[i].name;
        if (!strcmp(name, tables[i].name)) {
            *out = &tables[i];
            return FAIL_NONE;
        }
    }
    nearest_names(name, names, TABLE_COUNT, near, sizeof near);
    return fail(f, FAIL_USAGE, "--table %s: unknown%s%s (nacre bench --table list)", name, near[0] ? "; near: " : "",
                near);
}

static int find_backend(const char *name, gl_backend *out, failure *f)
{
    static const char *const backends[GL_BACKEND_COUNT] = {"egl2", "egl3", "osmesa"};
    for (int i = 0; i < GL_BACKEND_COUNT; i++) {
        if (strcmp(backends[i], name)) continue;
        *out = (gl_backend)i;
        return FAIL_NONE;
    }
    return fail(f, FAIL_USAGE, "--backend %s: expected egl2, egl3 or osmesa", name);
}

int cmd_bench(int argc, char **argv, failure *f)
{
    const char *table_name = "models", *backend_name = "egl2", *operand[1];
    const table_entry *chosen = NULL;
    bench_settings s = {.size = 512, .budget = 8, .threads = 1};
    int operands;
    const option options[] = {
        {"--table", OPTION_TEXT, &table_name, 0, 0, "NAME", "which figures; list prints the names (models)"},
        {"--mesh", OPTION_TEXT, &s.mesh, 0, 0, "MESH", "what to draw (by the table)"},
        {"--material", OPTION_TEXT, &s.material, 0, 0, "BRDF", "what to bake and draw (by the table)"},
        {"--backend", OPTION_TEXT, &backend_name, 0, 0, "NAME", "egl2 (default), egl3 or osmesa"},
        {"--size", OPTION_INT, &s.size, 16, 4096, "N", "pixels a side (512)"},
        {"--rounds", OPTION_INT, &s.rounds, 1, BENCH_MAX_ROUNDS, "N", "medians of so many (by the table)"},
        {"--frames", OPTION_INT, &s.frames, 1, 1000, "N", "frames a round (by the table)"},
        {"--budget", OPTION_INT, &s.budget, 1, NACRE_MAX_LIT_LIGHTS, "N", "lights a frame of spread updates (8)"},
        {"--threads", OPTION_INT, &s.threads, 1, BENCH_MAX_THREADS, "N", "cpu: also the CPU renderer by N threads (1)"},
        {"--json", OPTION_TEXT, &s.json_path, 0, 0, "FILE", "the figures as JSON (- for standard output)"},
    };
    int code = options_parse(argc, argv, "nacre bench [--table NAME] [options]", options,
                             sizeof options / sizeof options[0], operand, &operands, 0, 0, f);
    if (code) return code;
    if (!strcmp(table_name, "list")) {
        for (int i = 0; i < TABLE_COUNT; i++) printf("%-9s %s\n", tables[i].name, tables[i].help);
        return FAIL_NONE;
    }
    code = find_table(table_name, &chosen, f);
    if (!code) code = find_backend(backend_name, &s.backend, f);
    return code ? code : chosen->run(&s, f);
}
