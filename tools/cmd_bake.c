/* SPDX-License-Identifier: MIT */
/* nacre bake KIND: one input, one output file. */
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "bake.h"
#include "commands.h"
#include "json.h"
#include "mesh.h"
#include "options.h"

/* What every kind of bake takes. */
typedef struct bake_common {
    const char *output, *depfile, *json;
    int threads, quiet;
} bake_common;

#define COMMON_OPTIONS(c)                                                                                               \
    {"-o", OPTION_TEXT, &(c).output, 0, 0, "FILE", "output: a .ktx2, or a .c for a C array"},                           \
        {"--depfile", OPTION_TEXT, &(c).depfile, 0, 0, "FILE", "write a make fragment: output and what it is made of"}, \
        {"--json", OPTION_TEXT, &(c).json, 0, 0, "FILE", "the figures printed, as JSON (- for standard output)"},       \
        {"--threads", OPTION_INT, &(c).threads, 1, 256, "N", "(all cores) the bytes do not depend on it"},              \
    {                                                                                                                   \
        "--quiet", OPTION_FLAG, &(c).quiet, 0, 0, NULL, "print nothing but errors"                                      \
    }

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* Nothing but the JSON goes to standard output if that is where it goes. */
static int prints_text(const bake_common *c)
{
    return !c->quiet && !(c->json && !strcmp(c->json, "-"));
}

static int check_common(const bake_common *c, const char *kind, const char *input, failure *f)
{
    if (!c->output) return fail(f, FAIL_USAGE, "%s: -o FILE is missing", kind);
    if (c->threads) omp_set_num_threads(c->threads);
    return output_apart(c->output, bake_input(input), f);
}

/* What goes with the output: the make fragment and the figures. Neither is left if one of them fails. */
static int write_side_outputs(const bake_common *c, const char *input, json *figures, failure *f)
{
    int code = FAIL_NONE;
    if (c->depfile) {
        const char *inputs[1] = {bake_input(input)};
        code = output_depfile(c->depfile, c->output, inputs, inputs[0] != NULL, f);
    }
    if (code || !c->json) return code;
    code = json_write(figures, c->json, f);
    if (code && c->depfile) output_discard(c->depfile);
    return code;
}

static void discard_side_outputs(const bake_common *c)
{
    if (c->depfile) output_discard(c->depfile);
    if (c->json) output_discard(c->json);
}

/* The output comes last: where it is, all that goes with it is. */
static int write_outputs(const bake_common *c, const bytes *file, const char *input, json *figures, failure *f)
{
    int code = write_side_outputs(c, input, figures, f);
    bytes_free(&figures->out);
    if (code) return code;
    code = output_write(c->output, file, f);
    if (code) discard_side_outputs(c);
    return code;
}

/* ---- BRDFs -------------------------------------------------------------------------------------- */

static int bake_brdf(int argc, char **argv, failure *f)
{
    bake_common c = {0};
    bake_request request;
    char what[40];
    const option common[] = {COMMON_OPTIONS(c)};
    int code = bake_parse(&request, argc, argv, common, COUNT(common), f);
    snprintf(what, sizeof what, "bake %s", argv[0]);
    if (code || (code = check_common(&c, what, request.brdf, f))) return code;

    brdf *b;
    if ((code = brdf_open(&b, request.brdf, f))) return code;
    progress meter = {.quiet = c.quiet};
    bake_result result;
    code = bake_run(&request, b, c.output, &meter, &result, f);
    brdf_close(b);
    if (code) return code;

    code = write_outputs(&c, &result.file, request.brdf, &result.figures, f);
    if (!code && prints_text(&c))
        printf("%s: %s, %s, %zu in the file\n", c.output, request.brdf, result.shape, result.file.size);
    bake_free(&result);
    return code;
}

/* ---- mesh --------------------------------------------------------------------------------------- */

static json mesh_figures(const mesh *m, const char *path)
{
    json j = {0};
    json_begin(&j, NULL, '{');
    json_text(&j, "file", path);
    json_text(&j, "mesh", m->name);
    json_int(&j, "vertices", m->vertex_count);
    json_int(&j, "triangles", m->index_count / 3);
    json_end(&j, '}');
    return j;
}

static int bake_mesh(int argc, char **argv, failure *f)
{
    bake_common c = {0};
    const char *name = NULL;
    int operands;
    const option table[] = {
        {"-o", OPTION_TEXT, &c.output, 0, 0, "FILE", "output: F.c (nacre_mesh as C source) or F.bin"},
        {"--depfile", OPTION_TEXT, &c.depfile, 0, 0, "FILE", "write a make fragment: output and what it is made of"},
        {"--json", OPTION_TEXT, &c.json, 0, 0, "FILE", "the figures printed, as JSON (- for standard output)"},
        {"--quiet", OPTION_FLAG, &c.quiet, 0, 0, NULL, "print nothing but errors"},
    };
    int code = options_parse(argc, argv, "nacre bake mesh MESH -o F.c|F.bin [options]", table, COUNT(table), &name,
                             &operands, 1, 1, f);
    if (code || (code = check_common(&c, "bake mesh", name, f))) return code;
    mesh m;
    if ((code = mesh_open(&m, name, f))) return code;
    json figures = mesh_figures(&m, c.output);
    code = write_side_outputs(&c, name, &figures, f);
    bytes_free(&figures.out);
    if (!code && (code = mesh_write(&m, c.output, f))) discard_side_outputs(&c);
    if (!code && prints_text(&c))
        printf("%s: %s, %d vertices, %d triangles\n", c.output, m.name, m.vertex_count, m.index_count / 3);
    mesh_free(&m);
    return code;
}

static void print_kinds(void)
{
    size_t count;
    const bake_kind *kinds = bake_kinds(&count);
    printf("usage: nacre bake KIND INPUT -o FILE [options]   (nacre bake KIND --help)\n");
    for (size_t i = 0; i < count; i++) printf("  %-8s %s\n", kinds[i].name, kinds[i].help);
    printf("  %-8s %s\n", "mesh", "shapes for firmware: vertices and indices as C source or as bytes");
}

int cmd_bake(int argc, char **argv, failure *f)
{
    char names[100];
    bake_kind_names(names, sizeof names);
    if (argc < 2) return fail(f, FAIL_USAGE, "expected what to bake: %s or mesh", names);
    if (bake_find(argv[1])) return bake_brdf(argc - 1, argv + 1, f);
    if (!strcmp(argv[1], "mesh")) return bake_mesh(argc - 1, argv + 1, f);
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
        print_kinds();
        return FAIL_NONE;
    }
    return fail(f, FAIL_USAGE, "%s: expected %s or mesh", argv[1], names);
}
