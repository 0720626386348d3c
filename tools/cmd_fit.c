/* SPDX-License-Identifier: MIT */
/* nacre fit BRDF: parameters of a model that come nearest. */
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "lafortune_fit.h"
#include "options.h"

typedef struct fit_request {
    const char *brdf, *model, *json, *output;
    int threads, quiet;
    lafortune_fit_options options;
} fit_request;

static int parse(fit_request *r, int argc, char **argv, failure *f)
{
    const option table[] = {
        {"--model", OPTION_TEXT, &r->model, 0, 0, "MODEL", "lafortune (the default)"},
        {"--lobes", OPTION_INT, &r->options.lobes, 1, LAFORTUNE_MAX_LOBES, "N", "1, 2 or 3 (3)"},
        {"--per-channel", OPTION_FLAG, &r->options.per_channel, 0, 0, NULL,
         "shapes and exponents of their own for R, G and B (shared)"},
        {"--display", OPTION_FLAG, &r->options.display, 0, 0, NULL,
         "weigh errors as they are seen: in sRGB codes, not in radiance"},
        {"--max-exponent", OPTION_REAL, &r->options.n_max, 1, 1e6, "N",
         "largest exponent (100000; 8-bit maps hold 255)"},
        {"-o", OPTION_TEXT, &r->output, 0, 0, "FILE", "parameters and errors as JSON (- for standard output)"},
        {"--json", OPTION_TEXT, &r->json, 0, 0, "FILE", "the same as -o"},
        {"--threads", OPTION_INT, &r->threads, 1, 256, "N", "(all cores) the result does not depend on it"},
        {"--quiet", OPTION_FLAG, &r->quiet, 0, 0, NULL, "print nothing but errors"},
    };
    int operands;
    int code = options_parse(argc, argv, "nacre fit BRDF [--model lafortune] [--lobes N] [-o F.json] [options]", table,
                             sizeof table / sizeof *table, &r->brdf, &operands, 1, 1, f);
    if (code) return code;
    if (strcmp(r->model, "lafortune")) return fail(f, FAIL_USAGE, "--model %s: expected lafortune", r->model);
    if (r->options.display && r->options.per_channel)
        return fail(f, FAIL_USAGE, "--display and --per-channel: found both, expected one");
    if (r->json && r->output) return fail(f, FAIL_USAGE, "-o and --json: found both, expected one");
    if (!r->output) r->output = r->json;
    if (r->threads) omp_set_num_threads(r->threads);
    return 0;
}

static void print_fit(const lafortune_fit *fit)
{
    char name[2000];
    lafortune_fit_name(fit, name, sizeof name);
    printf("%s: relative error of f_r cos over views of 0..75 degrees\n", fit->name);
    for (int k = fit->display ? fit->lobes : 0; k <= fit->lobes; k++)
        printf("  %s%.2f %%\n",
               k == 0   ? "Lambert alone "
               : k == 1 ? "1 lobe        "
               : k == 2 ? "2 lobes       "
                        : "3 lobes       ",
               100 * fit->residual[k]);
    printf("%s\n", name);
}

static int write_json(const lafortune_fit *fit, const char *path, failure *f)
{
    json j = {0};
    json_begin(&j, NULL, '{');
    lafortune_fit_json(fit, &j);
    json_end(&j, '}');
    return json_write(&j, path, f);
}

int cmd_fit(int argc, char **argv, failure *f)
{
    fit_request r = {.model = "lafortune"};
    progress meter = {0};
    int code = parse(&r, argc, argv, f);
    if (code) return code;
    brdf *b;
    if ((code = brdf_open(&b, r.brdf, f))) return code;
    meter.quiet = r.quiet;
    r.options.progress = &meter;
    lafortune_fit fit;
    code = lafortune_fit_brdf(&fit, b, &r.options, f);
    brdf_close(b);
    if (!code && r.output) code = write_json(&fit, r.output, f);
    if (!code && !r.quiet && !(r.output && !strcmp(r.output, "-"))) print_fit(&fit);
    return code;
}
