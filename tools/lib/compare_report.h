/* SPDX-License-Identifier: MIT */
/* What a comparison shows: a table, JSON, a sheet of frames, a plot, and a page with all of it. Nothing here draws
   materials or opens files; each function turns a finished report into text or a picture. */
#ifndef COMPARE_REPORT_H
#define COMPARE_REPORT_H

#include "compare.h"
#include "json.h"

typedef struct compare_entry {
    compare_asset asset;
    compare_result result;
    metric_frames frames; /* drawn; empty where no picture is wanted */
    int is_baseline;
    const char *label; /* short: a file's name without its directories */
} compare_entry;

typedef struct compare_report {
    const compare_truth *truth;
    const char *renderer; /* compare_device_description */
    const char *backend;
    compare_entry *entry;
    int count;
} compare_report;

/* The part of a path behind its last '/'; a BRDF's name whole. */
const char *report_label(const char *text);
/* At most most characters of a label: of a file's name the end, which tells it from its neighbours. */
void report_shorten(char *out, size_t size, const char *label, int most);

/* Aligned columns for a terminal. */
void report_table(const compare_report *r, bytes *out);

/* One asset's figures, as members of the JSON object that is open. */
void report_json_figures(json *j, const compare_result *result, const compare_asset *asset);
void report_json(const compare_report *r, json *out);

/* Rows: the reference, then each entry and its difference x8; columns: light angles. RGB. */
void report_sheet(const compare_report *r, image_u8 *out);

/* SVG: PSNR of each frame against the light's polar angle. */
void report_plot(const compare_report *r, bytes *out);

/* HTML, self-contained: figures, plot and sheet. */
void report_page(const compare_report *r, bytes *out);

/* Parts that several of them use: |drawn - truth| of two RGB frames, x8 and clamped, with the largest of all channels; a
   text inside XML. */
void report_difference(image_u8 *out, const image_u8 *truth, const image_u8 *drawn, int *largest);
void report_escape(bytes *out, const char *text);

#endif
