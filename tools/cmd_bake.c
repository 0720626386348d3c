/* SPDX-License-Identifier: MIT */
/* nacre bake KIND: one input, one output file. */
#include <stdio.h>
#include <string.h>

#include "bake.h"
#include "bake_common.h"
#include "commands.h"
#include "json.h"
#include "mesh.h"
#include "options.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* ---- BRDFs -------------------------------------------------------------------------------------- */

static int bake_brdf(int argc, char **argv, failure *f)
{
    bake_common c = {0};
    bake_request request;
    char what[40];
    const option common[] = {BAKE_OPTIONS(c)};
    int code = bake_parse(&request, argc, argv, common, COUNT(common), f);
    snprintf(what, sizeof what, "bake %s", argv[0]);
    if (code || (code = bake_check(&c, what, request.brdf, f))) return code;

    brdf *b;
    if ((code = brdf_open(&b, request.brdf, f))) return code;
    progress meter = {.quiet = c.quiet};
    bake_result result;
    code = bake_run(&request, b, c.output, &meter, &result, f);
    brdf_close(b);
    if (code) return code;

    code = bake_write_outputs(&c, &result.file, request.brdf, &result.figures, f);
    if (!code && bake_prints(&c))
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
    if (code || (code = bake_check(&c, "bake mesh", name, f))) return code;
    mesh m;
    if ((code = mesh_open(&m, name, f))) return code;
    json figures = mesh_figures(&m, c.output);
    const char *inputs[1] = {bake_input(name)};
    code = bake_write_side_outputs(&c, inputs, inputs[0] != NULL, &figures, f);
    bytes_free(&figures.out);
    if (!code && (code = mesh_write(&m, c.output, f))) bake_discard_side_outputs(&c);
    if (!code && bake_prints(&c))
        printf("%s: %s, %d vertices, %d triangles\n", c.output, m.name, m.vertex_count, m.index_count / 3);
    mesh_free(&m);
    return code;
}

/* Kinds that are not made of a BRDF alone. */
static const struct {
    const char *name;
    int (*run)(int argc, char **argv, failure *f);
    const char *help;
} others[] = {
    {"lights", bake_lights, "an environment map as directional lights"},
    {"mesh", bake_mesh, "shapes for firmware: vertices and indices as C source or as bytes"},
    {"sbrdf", bake_sbrdf,
     "materials that vary over the surface, from maps, a painting's text, glTF or a measured stack"},
    {"palette", bake_palette, "materials that vary over the surface: every texel one of up to 256 half-vector tables"},
    {"power", bake_power, "x^n as a table, for materials that vary over the surface"},
};

static void print_kinds(void)
{
    size_t count;
    const bake_kind *kinds = bake_kinds(&count);
    printf("usage: nacre bake KIND INPUT -o FILE [options]   (nacre bake KIND --help)\n");
    for (size_t i = 0; i < count; i++) printf("  %-8s %s\n", kinds[i].name, kinds[i].help);
    for (size_t i = 0; i < COUNT(others); i++) printf("  %-8s %s\n", others[i].name, others[i].help);
}

/* "table, spheres, mesh or power" */
static void list_kinds(char *text, size_t size)
{
    bake_kind_names(text, size);
    for (size_t i = 0; i < COUNT(others); i++) {
        size_t used = strlen(text);
        snprintf(text + used, size - used, "%s%s", i + 1 < COUNT(others) ? ", " : " or ", others[i].name);
    }
}

int cmd_bake(int argc, char **argv, failure *f)
{
    char names[200];
    list_kinds(names, sizeof names);
    if (argc < 2) return fail(f, FAIL_USAGE, "expected what to bake: %s", names);
    if (bake_find(argv[1])) return bake_brdf(argc - 1, argv + 1, f);
    for (size_t i = 0; i < COUNT(others); i++)
        if (!strcmp(argv[1], others[i].name)) return others[i].run(argc - 1, argv + 1, f);
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
        print_kinds();
        return FAIL_NONE;
    }
    return fail(f, FAIL_USAGE, "%s: expected %s", argv[1], names);
}
