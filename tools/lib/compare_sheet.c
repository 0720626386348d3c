/* SPDX-License-Identifier: MIT */
/* The sheet of a comparison: reference, assets and differences side by side. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "compare_report.h"
#include "sheet.h"

enum { COLUMNS = 7, TIMES = 2, CELL = TIMES * METRIC_SIZE, MAGNIFY = 8, LABEL = 330 };

/* Light angles shown: 0, 25, 50, .. 150 degrees. */
static int frame_of(int column)
{
    return 5 * column;
}

/* TIMES x TIMES pixels for one; what lies outside the disc is transparent. */
static void enlarge(image_u8 *out, const image_u8 *frame)
{
    double normal[3];
    *out = image_u8_make(CELL, CELL, 4);
    for (int i = 0; i < CELL * CELL; i++) {
        int x = i % CELL / TIMES, y = i / CELL / TIMES;
        if (!metric_normal(x, y, METRIC_SIZE, normal)) continue;
        memcpy(out->texel + 4 * i, frame->texel + 3 * (y * METRIC_SIZE + x), 3);
        out->texel[4 * i + 3] = 255;
    }
}

void report_difference(image_u8 *out, const image_u8 *truth, const image_u8 *drawn, int *largest)
{
    *out = image_u8_make(truth->width, truth->height, 3);
    *largest = 0;
    for (int i = 0; i < truth->width * truth->height * 3; i++) {
        int d = abs(drawn->texel[i] - truth->texel[i]);
        if (d > *largest) *largest = d;
        out->texel[i] = (uint8_t)(d * MAGNIFY < 255 ? d * MAGNIFY : 255);
    }
}

static void place(sheet *s, int column, int row, const image_u8 *frame, const char *caption)
{
    image_u8 picture;
    enlarge(&picture, frame);
    sheet_place(s, column, row, &picture);
    sheet_caption(s, column, row, caption);
    image_u8_free(&picture);
}

static void reference_row(sheet *s, const compare_report *r)
{
    char text[64];
    snprintf(text, sizeof text, "reference\nin double precision\nexposure %.3g", r->truth->exposure);
    sheet_row_label(s, 0, text);
    for (int c = 0; c < COLUMNS; c++) {
        snprintf(text, sizeof text, "light at %g deg", METRIC_STEP_DEG * frame_of(c));
        sheet_head(s, c, text);
        place(s, c, 0, &r->truth->frames.shown[METRIC_FULL][frame_of(c)], "");
    }
}

static void entry_rows(sheet *s, const compare_report *r, int index)
{
    const compare_entry *e = &r->entry[index];
    const metric_result *m = &e->result.full;
    int row = 1 + 2 * index;
    char text[160], size[48] = "", label[64];
    report_shorten(label, sizeof label, e->label, 26); /* what fits beside the frames */
    if (e->asset.texture_bytes)
        snprintf(size, sizeof size, "\n%lld bytes, %d fetch%s", e->asset.texture_bytes, e->asset.fetches,
                 e->asset.fetches == 1 ? "" : "es");
    snprintf(text, sizeof text, "%s\n%.2f dB in all%s", label, m->pooled_psnr_db, size);
    sheet_row_label(s, row, text);
    snprintf(text, sizeof text, "difference x%d\nworst frame %.2f dB,\nlight at %g deg", MAGNIFY, m->worst_frame_db,
             m->worst_frame_deg);
    sheet_row_label(s, row + 1, text);
    for (int c = 0; c < COLUMNS; c++) {
        int k = frame_of(c), largest;
        const image_u8 *drawn = &e->frames.shown[METRIC_FULL][k];
        image_u8 difference;
        report_difference(&difference, &r->truth->frames.shown[METRIC_FULL][k], drawn, &largest);
        snprintf(text, sizeof text, m->frame_db[k] < 99 ? "%.1f dB" : "equal", m->frame_db[k]);
        place(s, c, row, drawn, text);
        snprintf(text, sizeof text, "up to %d code%s", largest, largest == 1 ? "" : "s");
        place(s, c, row + 1, &difference, text);
        image_u8_free(&difference);
    }
}

/* What the grey of a difference stands for. */
static void legend(sheet *s)
{
    static const char *const label[] = {"0", "8", "16", "24", "32 or more"};
    image_u8 bar = image_u8_make(512, 22, 3);
    for (int i = 0; i < bar.width * bar.height; i++) memset(bar.texel + 3 * i, i % bar.width * 256 / bar.width, 3);
    sheet_legend(s, "differences per channel in codes of 255, drawn x8: black is equal", &bar, label, 5);
    image_u8_free(&bar);
}

void report_sheet(const compare_report *r, image_u8 *out)
{
    char title[400];
    snprintf(title, sizeof title, "%.200s   -   drawn by %.150s", report_label(r->truth->b->name), r->renderer);
    const sheet_layout layout = {.title = title,
                                 .columns = COLUMNS,
                                 .rows = 1 + 2 * r->count,
                                 .cell_width = CELL,
                                 .cell_height = CELL,
                                 .row_label_width = LABEL,
                                 .has_captions = 1,
                                 .has_heads = 1,
                                 .has_legend = 1};
    sheet s = sheet_begin(&layout);
    reference_row(&s, r);
    for (int i = 0; i < r->count; i++) entry_rows(&s, r, i);
    legend(&s);
    *out = s.picture;
}
