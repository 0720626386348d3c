/* SPDX-License-Identifier: MIT */
/* The figures of a comparison as text and as JSON. */
#include <stdio.h>
#include <string.h>

#include "compare_report.h"

static int is_parameters(const char *text)
{
    return strchr(text, ':') && strchr(text, '=');
}

const char *report_label(const char *text)
{
    const char *slash = is_parameters(text) ? NULL : strrchr(text, '/');
    return slash && slash[1] ? slash + 1 : text;
}

void report_shorten(char *out, size_t size, const char *label, int most)
{
    int length = (int)strlen(label);
    if (length <= most)
        snprintf(out, size, "%s", label);
    else if (is_parameters(label))
        snprintf(out, size, "%.*s..", most - 2, label);
    else
        snprintf(out, size, "..%s", label + length - (most - 2));
}

/* 5592400 -> 5,592,400 */
static void grouped(char out[32], long long value)
{
    char digits[24];
    int length = snprintf(digits, sizeof digits, "%lld", value), used = 0;
    for (int i = 0; i < length; i++) {
        if (i && (length - i) % 3 == 0) out[used++] = ',';
        out[used++] = digits[i];
    }
    out[used] = 0;
}

enum { MOST_LABEL = 44 };

static int label_width(const compare_report *r)
{
    int width = 18; /* of the baselines */
    for (int i = 0; i < r->count; i++) {
        int length = (int)strlen(r->entry[i].label);
        if (length > width) width = length;
    }
    return width < MOST_LABEL ? width : MOST_LABEL;
}

static void table_row(bytes *out, const compare_entry *e, int width)
{
    const compare_result *r = &e->result;
    char size[32] = "-", fetches[12] = "-", label[64];
    report_shorten(label, sizeof label, e->label, MOST_LABEL);
    if (e->asset.texture_bytes) {
        grouped(size, e->asset.texture_bytes);
        snprintf(fetches, sizeof fetches, "%d", e->asset.fetches);
    }
    bytes_printf(out, "%-*s %10s %7s %7.2f %7.2f at %3.0f %7.2f %7.2f %7.4f %8.2f %% %7.2f %% at %2.0f\n", width, label,
                 size, fetches, r->full.pooled_psnr_db, r->full.worst_frame_db, r->full.worst_frame_deg,
                 r->dim.pooled_psnr_db, r->dim.worst_frame_db, r->ssim, 100 * r->relative_rms, 100 * r->albedo_error,
                 r->albedo_error_deg);
}

void report_table(const compare_report *r, bytes *out)
{
    const compare_truth *t = r->truth;
    int width = label_width(r), in_baselines = 0;
    bytes_printf(out, "%s: %s\n", t->b->name, t->b->description);
    bytes_printf(out, "sphere of %d x %d, %d light angles, exposure %.4g, %s; drawn by %s\n", METRIC_SIZE, METRIC_SIZE,
                 METRIC_FRAMES, t->exposure, t->fov_deg > 0 ? "near eye" : "orthographic", r->renderer);
    bytes_printf(out, "%-*s %10s %7s %7s %14s %15s %7s %10s %15s\n", width, "", "texture", "fetches", "PSNR",
                 "worst frame", "2 stops down", "SSIM", "relative", "largest error");
    bytes_printf(out, "%-*s %10s %7s %7s %14s %15s %7s %10s %15s\n", width, "", "bytes", "a light", "dB", "dB, degrees",
                 "dB, worst", "", "RMS", "of albedo, view");
    for (int i = 0; i < r->count; i++) {
        if (r->entry[i].is_baseline && !in_baselines) bytes_printf(out, "for comparison\n");
        in_baselines = r->entry[i].is_baseline;
        table_row(out, &r->entry[i], width);
    }
}

static void json_albedo(json *j, const char *key, const double albedo[COMPARE_VIEWS][3])
{
    json_begin(j, key, '[');
    for (int i = 0; i < COMPARE_VIEWS; i++) {
        json_begin(j, NULL, '[');
        for (int c = 0; c < 3; c++) json_real(j, NULL, albedo[i][c]);
        json_end(j, ']');
    }
    json_end(j, ']');
}

static void json_frames(json *j, const char *key, const metric_result *m)
{
    json_begin(j, key, '[');
    for (int k = 0; k < METRIC_FRAMES; k++) json_real(j, NULL, m->frame_db[k]);
    json_end(j, ']');
}

void report_json_figures(json *j, const compare_result *r, const compare_asset *asset)
{
    json_real(j, "pooled_psnr_db", r->full.pooled_psnr_db);
    json_real(j, "worst_frame_db", r->full.worst_frame_db);
    json_real(j, "worst_frame_deg", r->full.worst_frame_deg);
    json_real(j, "dim_pooled_psnr_db", r->dim.pooled_psnr_db);
    json_real(j, "dim_worst_frame_db", r->dim.worst_frame_db);
    json_real(j, "dim_worst_frame_deg", r->dim.worst_frame_deg);
    json_real(j, "ssim", r->ssim);
    json_real(j, "relative_rms", r->relative_rms);
    json_real(j, "albedo_error", r->albedo_error);
    json_real(j, "albedo_error_deg", r->albedo_error_deg);
    json_int(j, "bytes", asset->texture_bytes);
    json_int(j, "fetches", asset->fetches);
}

static void json_entry(json *j, const compare_entry *e)
{
    json_begin(j, NULL, '{');
    json_text(j, e->is_baseline ? "name" : "file", e->asset.name);
    json_text(j, "description", e->asset.description);
    report_json_figures(j, &e->result, &e->asset);
    json_frames(j, "frame_db", &e->result.full);
    json_frames(j, "dim_frame_db", &e->result.dim);
    json_albedo(j, "albedo", e->result.albedo);
    json_end(j, '}');
}

static void json_entries(json *j, const char *key, const compare_report *r, int baselines)
{
    json_begin(j, key, '[');
    for (int i = 0; i < r->count; i++)
        if (r->entry[i].is_baseline == baselines) json_entry(j, &r->entry[i]);
    json_end(j, ']');
}

void report_json(const compare_report *r, json *j)
{
    int baselines = r->count && r->entry[r->count - 1].is_baseline;
    json_begin(j, NULL, '{');
    json_text(j, "brdf", r->truth->b->name);
    json_text(j, "description", r->truth->b->description);
    json_text(j, "backend", r->backend);
    json_text(j, "renderer", r->renderer);
    json_real(j, "exposure", r->truth->exposure);
    json_real(j, "perspective_deg", r->truth->fov_deg);
    json_begin(j, "light_polar_deg", '[');
    for (int k = 0; k < METRIC_FRAMES; k++) json_real(j, NULL, METRIC_STEP_DEG * k);
    json_end(j, ']');
    json_begin(j, "view_polar_deg", '[');
    for (int i = 0; i < COMPARE_VIEWS; i++) json_real(j, NULL, COMPARE_VIEW_DEG * i);
    json_end(j, ']');
    json_albedo(j, "albedo", r->truth->albedo);
    json_entries(j, "assets", r, 0);
    if (baselines) json_entries(j, "baselines", r, 1);
    json_end(j, '}');
}
