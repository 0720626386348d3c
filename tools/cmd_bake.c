/* SPDX-License-Identifier: MIT */
/* nacre bake table|spheres|mesh: one input, one output file. */
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "commands.h"
#include "json.h"
#include "mesh.h"
#include "nacre_asset.h"
#include "options.h"
#include "sphere_bake.h"
#include "table_bake.h"

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

/* A BRDF name's file, for depfiles: what follows "merl:" or "rgl:", or the name itself if such a file exists. */
static const char *input_file(const char *name)
{
    struct stat status;
    if (!strncmp(name, "merl:", 5)) return name + 5;
    if (!strncmp(name, "rgl:", 4)) return name + 4;
    return stat(name, &status) == 0 ? name : NULL;
}

static int check_common(const bake_common *c, const char *kind, const char *input, failure *f)
{
    if (!c->output) return fail(f, FAIL_USAGE, "%s: -o FILE is missing", kind);
    if (c->threads) omp_set_num_threads(c->threads);
    return output_apart(c->output, input_file(input), f);
}

/* What goes with the output: the make fragment and the figures. Neither is left if one of them fails. */
static int write_side_outputs(const bake_common *c, const char *input, json *figures, failure *f)
{
    int code = FAIL_NONE;
    if (c->depfile) {
        const char *inputs[1] = {input_file(input)};
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

/* ---- table -------------------------------------------------------------------------------------- */

static int parse_tier(const char *text, table_tier *tier, failure *f)
{
    static const char *const names[] = {"default", "fine", "rgb"};
    for (int i = 0; i < 3; i++) {
        if (strcmp(text, names[i])) continue;
        *tier = (table_tier)i;
        return FAIL_NONE;
    }
    return fail(f, FAIL_USAGE, "--tier %s: expected default, fine or rgb", text);
}

static json table_figures(const table_asset *t, const char *path, size_t size)
{
    json j = {0};
    json_begin(&j, NULL, '{');
    json_text(&j, "file", path);
    json_text(&j, "brdf", t->name);
    json_int(&j, "width", t->width);
    json_int(&j, "height", t->height);
    json_int(&j, "layers", t->layers);
    json_int(&j, "texel_bytes", (long long)t->width * t->height * t->layers * 4);
    json_int(&j, "file_bytes", (long long)size);
    json_real(&j, "power", t->p);
    json_real(&j, "exposure", t->e);
    json_begin(&j, "albedo", '[');
    for (int i = 0; i < 3; i++) json_real(&j, NULL, t->albedo[i]);
    json_end(&j, ']');
    json_end(&j, '}');
    return j;
}

static int bake_table(int argc, char **argv, failure *f)
{
    bake_common c = {0};
    const char *size = NULL, *tier = "default", *brdf_name = NULL;
    progress meter = {0};
    table_options options = {.power = 4.8, .progress = &meter};
    const option table[] = {
        COMMON_OPTIONS(c),
        {"--size", OPTION_TEXT, &size, 0, 0, "WxH", "texels, 4..128 (24x21; fine 32x21)"},
        {"--tier", OPTION_TEXT, &tier, 0, 0, "TIER", "default (one fetch), fine (two), rgb (no phi_d term)"},
        {"--power", OPTION_REAL, &options.power, 4, 4.8, "P",
         "4.8 (default, for sRGB output) or 4 (for square-root output)"},
    };
    int operands;
    int code = options_parse(argc, argv, "nacre bake table BRDF -o F.ktx2 [options]", table, COUNT(table), &brdf_name,
                             &operands, 1, 1, f);
    if (code || (code = check_common(&c, "bake table", brdf_name, f)) || (code = parse_tier(tier, &options.tier, f)))
        return code;
    if (size && (code = parse_size(size, "--size", 128, &options.width, &options.height, f))) return code;
    if (size && (options.width < 4 || options.height < 4))
        return fail(f, FAIL_USAGE, "--size %s: expected WxH, each 4..128", size);
    if (options.power != 4 && options.power != 4.8)
        return fail(f, FAIL_USAGE, "--power %g: expected 4.8 or 4", options.power);

    brdf *b;
    if ((code = brdf_open(&b, brdf_name, f))) return code;
    table_asset t;
    meter.quiet = c.quiet;
    code = table_bake(&t, b, &options, f);
    brdf_close(b);
    if (code) return code;

    bytes file = {0};
    table_write(&t, &file);
    json figures = table_figures(&t, c.output, file.size);
    code = write_outputs(&c, &file, brdf_name, &figures, f);
    if (!code && prints_text(&c))
        printf("%s: %s, %d x %d x %d, %d bytes of texels, %zu in the file\n", c.output, t.name, t.width, t.height,
               t.layers, t.width * t.height * t.layers * 4, file.size);
    bytes_free(&file);
    table_free(&t);
    return code;
}

/* ---- spheres ------------------------------------------------------------------------------------ */

static int parse_sphere_texts(const char *polar, const char *mode, const char *format, sphere_options *options,
                              failure *f)
{
    if (polar) {
        int code = parse_reals(polar, "--polar", options->polar, 1, 64, &options->polar_count, f);
        if (code) return code;
    }
    if (!strcmp(mode, "paper"))
        options->mode = SPHERE_PAPER;
    else if (strcmp(mode, "cosine-free"))
        return fail(f, FAIL_USAGE, "--mode %s: expected cosine-free or paper", mode);
    if (!strcmp(format, "rgba8"))
        options->format = NACRE_FORMAT_RGBA8;
    else if (!strcmp(format, "rgb565"))
        options->format = NACRE_FORMAT_RGB565;
    else if (!strcmp(format, "etc1"))
        options->format = NACRE_FORMAT_ETC2_RGB8;
    else
        return fail(f, FAIL_USAGE, "--format %s: expected rgba8, rgb565 or etc1", format);
    return FAIL_NONE;
}

static json sphere_figures(const sphere_asset *s, const char *path, size_t texel_bytes, size_t size)
{
    json j = {0};
    json_begin(&j, NULL, '{');
    json_text(&j, "file", path);
    json_text(&j, "brdf", s->name);
    json_text(&j, "mode", s->mode == SPHERE_PAPER ? "paper" : "cosine-free");
    json_int(&j, "size", s->size);
    json_int(&j, "levels", s->levels);
    json_begin(&j, "polar", '[');
    for (int i = 0; i < s->layers; i++) json_real(&j, NULL, s->polar[i]);
    json_end(&j, ']');
    json_int(&j, "texel_bytes", (long long)texel_bytes);
    json_int(&j, "file_bytes", (long long)size);
    json_end(&j, '}');
    return j;
}

static int bake_spheres(int argc, char **argv, failure *f)
{
    bake_common c = {0};
    const char *polar = NULL, *mode = "cosine-free", *format = "rgba8", *brdf_name = NULL;
    progress meter = {0};
    sphere_options options = {.progress = &meter};
    const option table[] = {
        COMMON_OPTIONS(c),
        {"--polar", OPTION_TEXT, &polar, 0, 0, "A,B,...", "light polar angles in degrees, rising (0,45,90,135)"},
        {"--size", OPTION_INT, &options.size, 8, 2048, "N", "texels a side (256; paper 512)"},
        {"--mode", OPTION_TEXT, &mode, 0, 0, "MODE",
         "cosine-free (default), or paper: Mihalik & Durikovic 2015 exactly"},
        {"--format", OPTION_TEXT, &format, 0, 0, "FORMAT", "rgba8 (default), rgb565 or etc1"},
        {"--no-pad", OPTION_FLAG, &options.no_pad, 0, 0, NULL, "let the sphere touch the image's edge"},
    };
    int operands;
    int code = options_parse(argc, argv, "nacre bake spheres BRDF -o F.ktx2 [options]", table, COUNT(table), &brdf_name,
                             &operands, 1, 1, f);
    if (code || (code = check_common(&c, "bake spheres", brdf_name, f))) return code;
    if ((code = parse_sphere_texts(polar, mode, format, &options, f))) return code;

    brdf *b;
    if ((code = brdf_open(&b, brdf_name, f))) return code;
    sphere_asset s;
    meter.quiet = c.quiet;
    code = sphere_bake(&s, b, &options, f);
    brdf_close(b);
    if (code) return code;

    size_t texel_bytes = 0;
    for (int i = 0; i < s.levels; i++) texel_bytes += s.level[i].size;
    bytes file = {0};
    sphere_write(&s, &file);
    json figures = sphere_figures(&s, c.output, texel_bytes, file.size);
    code = write_outputs(&c, &file, brdf_name, &figures, f);
    if (!code && prints_text(&c))
        printf("%s: %s, %d images of %d x %d, %d levels, %zu bytes of texels, %zu in the file\n", c.output, s.name,
               s.layers, s.size, s.size, s.levels, texel_bytes, file.size);
    bytes_free(&file);
    sphere_free(&s);
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

int cmd_bake(int argc, char **argv, failure *f)
{
    static const char *const names[] = {"table", "spheres", "mesh"};
    static int (*const run[])(int, char **, failure *) = {bake_table, bake_spheres, bake_mesh};
    if (argc < 2) return fail(f, FAIL_USAGE, "expected what to bake: table, spheres or mesh");
    for (int i = 0; i < 3; i++)
        if (!strcmp(argv[1], names[i])) return run[i](argc - 1, argv + 1, f);
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
        printf("usage: nacre bake table|spheres|mesh INPUT -o FILE [options]   (nacre bake KIND --help)\n");
        return FAIL_NONE;
    }
    return fail(f, FAIL_USAGE, "%s: expected table, spheres or mesh", argv[1]);
}
