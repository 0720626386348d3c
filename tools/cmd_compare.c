/* SPDX-License-Identifier: MIT */
/* nacre compare BRDF ASSET...: how close files are to the material they stand for. */
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake.h"
#include "baselines.h"
#include "commands.h"
#include "compare_report.h"
#include "options.h"
#include "png_io.h"

enum { MOST_ASSETS = 32 };

static const char usage[] =
    "nacre compare BRDF ASSET... [options]\n"
    "\n"
    "How close each ASSET comes to the BRDF. An asset is a FILE.ktx2, role=FILE,... as nacre shot takes it, or another "
    "BRDF's\n"
    "name, which draws in double only.\n"
    "\n"
    "A sphere of 96 x 96 pixels is drawn under one light, from the eye (0 degrees) to behind it (180) in 37 steps. "
    "PSNR "
    "is that\n"
    "of all frames together, of 8-bit sRGB under one exposure; 2 stops down, the same under a quarter of the light; "
    "SSIM, "
    "the\n"
    "mean structural similarity; relative RMS, of linear radiance; albedo, the largest error of hemispherical albedo "
    "over views\n"
    "of 0..75 degrees, in luminance. The last two are those of the asset decoded in double, whatever draws.\n"
    "\n"
    "    nacre compare gold.binary gold.ktx2 --baselines --html gold.html\n"
    "    nacre compare gold.binary gold.ktx2 small.ktx2 --fail-below 45 --quiet\n";

typedef struct compare_command {
    const char *operand[1 + MOST_ASSETS]; /* the BRDF, then assets */
    int operands;
    const char *backend_name, *sheet, *plot, *page, *json;
    int baselines, threads;
    double fov_deg, limit_db; /* 0: none, as no PSNR is below it */
    progress meter;
    compare_backend backend;
    compare_device *device;
    compare_truth truth;
    compare_report report;
} compare_command;

/* ---- the command line ---------------------------------------------------------------------------------------------- */

/* No output may replace what is compared, nor another output. */
static int check_outputs(const compare_command *c, failure *f)
{
    const char *const name[] = {"--sheet", "--plot", "--html", "--json"};
    const char *const path[] = {c->sheet, c->plot, c->page, c->json};
    for (int i = 0; i < 4; i++) {
        if (!path[i]) continue;
        for (int k = 0; k < c->operands; k++) {
            const char *input = k ? c->operand[k] : bake_input(c->operand[0]);
            if (output_apart(path[i], input, NULL))
                return fail(f, FAIL_USAGE, "%s %s: found the input, expected another file", name[i], path[i]);
        }
        for (int k = 0; k < i; k++)
            if (path[k] && !strcmp(path[i], path[k]))
                return fail(f, FAIL_USAGE, "%s and %s: both write %s", name[k], name[i], path[i]);
    }
    return FAIL_NONE;
}

static int parse(compare_command *c, int argc, char **argv, failure *f)
{
    const option table[] = {
        {"--backend", OPTION_TEXT, &c->backend_name, 0, 0, "NAME",
         "what draws the assets: double (8-bit codes decoded in double; the default), egl2, egl3, osmesa or soft"},
        {"--baselines", OPTION_FLAG, &c->baselines, 0, 0, NULL,
         "also compare what else there is: GGX, Lafortune lobes, a MatCap, each fitted to the BRDF"},
        {"--perspective", OPTION_REAL, &c->fov_deg, 1, 120, "FOV",
         "a near eye whose vertical field of view, in degrees, the sphere fills (orthographic)"},
        {"--sheet", OPTION_TEXT, &c->sheet, 0, 0, "FILE.png", "frames side by side, with differences"},
        {"--plot", OPTION_TEXT, &c->plot, 0, 0, "FILE.svg", "PSNR against the light's angle"},
        {"--html", OPTION_TEXT, &c->page, 0, 0, "FILE.html", "a page with figures, plot and sheet in one file"},
        {"--json", OPTION_TEXT, &c->json, 0, 0, "FILE", "all figures as JSON (- for standard output)"},
        {"--fail-below", OPTION_REAL, &c->limit_db, 0, 99, "DB",
         "exit with 5 if an asset's PSNR is below so many decibels"},
        {"--threads", OPTION_INT, &c->threads, 1, 256, "N", "(all cores) the figures do not depend on it"},
        {"--quiet", OPTION_FLAG, &c->meter.quiet, 0, 0, NULL, "print nothing but errors"},
    };
    int code = options_parse(argc, argv, usage, table, sizeof table / sizeof *table, c->operand, &c->operands, 2,
                             1 + MOST_ASSETS, f);
    if (!code) code = compare_backend_find(&c->backend, c->backend_name, f);
    return code ? code : check_outputs(c, f);
}

/* ---- the work ------------------------------------------------------------------------------------------------------ */

/* Assets are opened before the reference is drawn: what is wrong with them is said at once. */
static int open_assets(compare_command *c, failure *f)
{
    int assets = c->operands - 1, code = FAIL_NONE;
    compare_report *r = &c->report;
    r->entry = need_memory((size_t)assets + BASELINE_COUNT, sizeof *r->entry);
    for (int i = 0; i < assets && !code; i++) {
        compare_entry *e = &r->entry[i];
        code = compare_asset_open(&e->asset, c->operand[1 + i], f);
        if (code) break;
        e->label = report_label(e->asset.name);
        r->count++;
    }
    return code;
}

static int wants_frames(const compare_command *c)
{
    return c->sheet || c->page;
}

static int run_assets(compare_command *c, failure *f)
{
    compare_report *r = &c->report;
    for (int i = 0; i < c->operands - 1; i++) {
        compare_entry *e = &r->entry[i];
        int code = compare_run(&e->result, wants_frames(c) ? &e->frames : NULL, &c->truth, &e->asset, c->device, f);
        if (code) return code;
        progress_add(&c->meter, 1);
    }
    return FAIL_NONE;
}

/* Fits run side by side, each on one thread. */
static void run_baselines(compare_command *c)
{
    compare_entry *first = c->report.entry + c->report.count;
#pragma omp parallel for schedule(dynamic)
    for (int i = 0; i < BASELINE_COUNT; i++) {
        compare_entry *e = &first[i];
        e->is_baseline = 1;
        baseline_make(&e->asset, (baseline)i, &c->truth);
        e->label = e->asset.name;
        compare_run(&e->result, wants_frames(c) ? &e->frames : NULL, &c->truth, &e->asset, NULL, NULL);
        progress_add(&c->meter, 1);
    }
    c->report.count += BASELINE_COUNT;
}

static int check_baselines(const compare_command *c, failure *f)
{
    if (!c->truth.b->anisotropic) return FAIL_NONE;
    return fail(f, FAIL_UNSUPPORTED, "--baselines: %s is anisotropic, expected an isotropic BRDF", c->operand[0]);
}

static int compare_all(compare_command *c, failure *f)
{
    int code = open_assets(c, f);
    if (!code) code = compare_device_open(&c->device, c->backend, f);
    if (code) return code;
    progress_begin(&c->meter, "comparisons", c->operands - 1 + (c->baselines ? BASELINE_COUNT : 0));
    code = compare_truth_open(&c->truth, c->operand[0], c->fov_deg, f);
    if (!code) {
        c->report.truth = &c->truth;
        c->report.renderer = compare_device_description(c->device);
        c->report.backend = compare_backend_names[c->backend];
        code = c->baselines ? check_baselines(c, f) : FAIL_NONE;
        if (!code) code = run_assets(c, f);
    }
    if (!code && c->baselines) run_baselines(c);
    progress_end(&c->meter);
    return code;
}

/* ---- what comes out ------------------------------------------------------------------------------------------------ */

static int write_text(void (*make)(const compare_report *, bytes *), const compare_report *r, const char *path,
                      failure *f)
{
    bytes text = {0};
    make(r, &text);
    int code = output_write_raw(path, &text, f);
    bytes_free(&text);
    return code;
}

static int write_sheet(const compare_report *r, const char *path, failure *f)
{
    image_u8 sheet;
    report_sheet(r, &sheet);
    int code = png_write(path, &sheet, f);
    image_u8_free(&sheet);
    return code;
}

static int write_outputs(const compare_command *c, failure *f)
{
    const compare_report *r = &c->report;
    int code = FAIL_NONE;
    if (c->sheet) code = write_sheet(r, c->sheet, f);
    if (!code && c->plot) code = write_text(report_plot, r, c->plot, f);
    if (!code && c->page) code = write_text(report_page, r, c->page, f);
    if (!code && c->json) {
        json j = {0};
        report_json(r, &j);
        code = json_write(&j, c->json, f);
    }
    return code;
}

static void print_table(const compare_command *c)
{
    bytes text = {0};
    /* Nothing but the JSON goes to standard output if that is where it goes. */
    if (c->meter.quiet || (c->json && !strcmp(c->json, "-"))) return;
    report_table(&c->report, &text);
    fwrite(text.data, 1, text.size, stdout);
    bytes_free(&text);
}

static int gate(const compare_command *c, failure *f)
{
    const compare_entry *worst = NULL;
    int below = 0, assets = c->operands - 1;
    for (int i = 0; i < assets; i++) {
        const compare_entry *e = &c->report.entry[i];
        if (e->result.full.pooled_psnr_db >= c->limit_db) continue;
        below++;
        if (!worst || e->result.full.pooled_psnr_db < worst->result.full.pooled_psnr_db) worst = e;
    }
    if (!below) return FAIL_NONE;
    char more[64] = "";
    if (below > 1) snprintf(more, sizeof more, "; the worst of %d below it", below);
    return fail(f, FAIL_DIFFERENCE, "%s: %.2f dB, expected at least %g dB%s", worst->asset.name,
                worst->result.full.pooled_psnr_db, c->limit_db, more);
}

static void close_all(compare_command *c)
{
    for (int i = 0; i < c->report.count; i++) {
        metric_frames_free(&c->report.entry[i].frames);
        compare_asset_close(&c->report.entry[i].asset);
    }
    free(c->report.entry);
    compare_device_close(c->device);
    if (c->truth.b) compare_truth_close(&c->truth);
}

int cmd_compare(int argc, char **argv, failure *f)
{
    compare_command c = {.backend_name = "double"};
    int code = parse(&c, argc, argv, f);
    if (code) return code;
    if (c.threads) omp_set_num_threads(c.threads);
    code = compare_all(&c, f);
    if (!code) {
        print_table(&c);
        code = write_outputs(&c, f);
    }
    if (!code) code = gate(&c, f);
    close_all(&c);
    return code;
}
