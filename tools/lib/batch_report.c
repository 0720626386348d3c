/* SPDX-License-Identifier: MIT */
#include "batch_report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const status_names[] = {"baked", "up to date", "failed"};

batch_counts batch_count(const batch *b)
{
    int count[3] = {0};
    for (int i = 0; i < b->count; i++) count[b->result[i].status]++;
    return (batch_counts){count[BATCH_BAKED], count[BATCH_UP_TO_DATE], count[BATCH_FAILED]};
}

/* ---- groups --------------------------------------------------------------------------------------- */

typedef struct group {
    const manifest_item *first; /* whose kind and options all have */
    int count;                  /* without failed ones */
    double mean[BATCH_FIGURES], worst[BATCH_FIGURES];
    const char *worst_file[BATCH_FIGURES];
} group;

static int same_group(const manifest_item *a, const manifest_item *b)
{
    return !strcmp(a->kind, b->kind) && !strcmp(a->options, b->options);
}

/* 1 if no earlier material is of the same group. */
static int begins_group(const batch *b, int index)
{
    for (int i = 0; i < index; i++)
        if (same_group(b->result[i].item, b->result[index].item)) return 0;
    return 1;
}

static void add_figures(group *g, const batch_result *r)
{
    for (int k = 0; k < BATCH_FIGURES; k++) {
        double value = r->figure[k];
        g->mean[k] += value;
        if (g->worst_file[k] && batch_figures[k].better * value >= batch_figures[k].better * g->worst[k]) continue;
        g->worst[k] = value;
        g->worst_file[k] = r->item->output;
    }
    g->count++;
}

static group collect(const batch *b, int first)
{
    group g = {.first = b->result[first].item};
    for (int i = first; i < b->count; i++)
        if (b->result[i].status != BATCH_FAILED && same_group(g.first, b->result[i].item))
            add_figures(&g, &b->result[i]);
    for (int k = 0; k < BATCH_FIGURES && g.count; k++) g.mean[k] /= g.count;
    return g;
}

/* ---- for people ----------------------------------------------------------------------------------- */

/* Columns a text takes on a terminal: bytes that do not go on with a UTF-8 character. */
static int width_of(const char *text)
{
    int width = 0;
    for (; *text; text++) width += ((unsigned char)*text & 0xc0) != 0x80;
    return width;
}

static void print_name(FILE *out, const char *name, int width)
{
    fprintf(out, "  %s%*s", name, width - width_of(name), "");
}

static int column_width(int k)
{
    int width = width_of(batch_figures[k].heading);
    return (width > 7 ? width : 7) + 2;
}

static void print_figures(FILE *out, const double *figure, int summary)
{
    for (int k = 0; k < BATCH_FIGURES; k++) {
        if (summary && !batch_figures[k].better)
            fprintf(out, "%*s", column_width(k), "");
        else
            fprintf(out, "%*.*f", column_width(k), batch_figures[k].decimals, figure[k] / batch_figures[k].unit);
    }
    fprintf(out, "\n");
}

static void print_group(const batch *b, int first, int width, FILE *out)
{
    group g = collect(b, first);
    fprintf(out, "%s%s%s\n", g.first->kind, *g.first->options ? " " : "", g.first->options);
    print_name(out, "", width);
    for (int k = 0; k < BATCH_FIGURES; k++) fprintf(out, "%*s", column_width(k), batch_figures[k].heading);
    fprintf(out, "\n");
    for (int i = first; i < b->count; i++) {
        const batch_result *r = &b->result[i];
        if (!same_group(g.first, r->item)) continue;
        print_name(out, r->item->output, width);
        if (r->status == BATCH_FAILED)
            fprintf(out, "  failed: %s\n", r->error.text);
        else
            print_figures(out, r->figure, 0);
    }
    if (g.count < 2) return; /* its line has said it all */
    char title[40];
    snprintf(title, sizeof title, "mean of %d", g.count);
    print_name(out, title, width);
    print_figures(out, g.mean, 1);
    print_name(out, "worst", width);
    print_figures(out, g.worst, 1);
}

void batch_print(const batch *b, FILE *out)
{
    int width = 0;
    for (int i = 0; i < b->count; i++) {
        int own = width_of(b->result[i].item->output);
        if (own > width) width = own;
    }
    for (int i = 0; i < b->count; i++)
        if (begins_group(b, i)) print_group(b, i, width, out);
}

/* ---- for programs --------------------------------------------------------------------------------- */

static void json_result(json *j, const batch_result *r)
{
    json_begin(j, NULL, '{');
    json_int(j, "line", r->item->line);
    json_text(j, "file", r->item->output);
    json_text(j, "brdf", r->item->brdf);
    json_text(j, "kind", r->item->kind);
    json_text(j, "options", r->item->options);
    json_text(j, "status", status_names[r->status]);
    if (r->status == BATCH_FAILED) {
        json_int(j, "code", r->error.code);
        json_text(j, "error", r->error.text);
    } else {
        for (int k = 0; k < BATCH_FIGURES; k++) json_real(j, batch_figures[k].key, r->figure[k]);
    }
    json_end(j, '}');
}

static void json_group(json *j, const group *g)
{
    json_begin(j, NULL, '{');
    json_text(j, "kind", g->first->kind);
    json_text(j, "options", g->first->options);
    json_int(j, "count", g->count);
    json_begin(j, "mean", '{');
    for (int k = 0; k < BATCH_FIGURES && g->count; k++)
        if (batch_figures[k].better) json_real(j, batch_figures[k].key, g->mean[k]);
    json_end(j, '}');
    json_begin(j, "worst", '{');
    for (int k = 0; k < BATCH_FIGURES && g->count; k++)
        if (batch_figures[k].better) json_real(j, batch_figures[k].key, g->worst[k]);
    json_end(j, '}');
    json_begin(j, "worst_file", '{');
    for (int k = 0; k < BATCH_FIGURES && g->count; k++)
        if (batch_figures[k].better) json_text(j, batch_figures[k].key, g->worst_file[k]);
    json_end(j, '}');
    json_end(j, '}');
}

json batch_json(const batch *b)
{
    json j = {0};
    batch_counts counts = batch_count(b);
    json_begin(&j, NULL, '{');
    json_begin(&j, "materials", '[');
    for (int i = 0; i < b->count; i++) json_result(&j, &b->result[i]);
    json_end(&j, ']');
    json_begin(&j, "groups", '[');
    for (int i = 0; i < b->count; i++) {
        if (!begins_group(b, i)) continue;
        group g = collect(b, i);
        json_group(&j, &g);
    }
    json_end(&j, ']');
    json_int(&j, "baked", counts.baked);
    json_int(&j, "up_to_date", counts.up_to_date);
    json_int(&j, "failed", counts.failed);
    json_end(&j, '}');
    return j;
}

static void csv_text(bytes *out, const char *text)
{
    bytes_append(out, "\"", 1);
    for (; *text; text++) bytes_printf(out, *text == '"' ? "\"\"" : "%c", *text);
    bytes_append(out, "\",", 2);
}

int batch_csv(const batch *b, const char *path, failure *f)
{
    bytes out = {0};
    bytes_printf(&out, "line,file,brdf,kind,options,status");
    for (int k = 0; k < BATCH_FIGURES; k++) bytes_printf(&out, ",%s", batch_figures[k].key);
    bytes_printf(&out, "\n");
    for (int i = 0; i < b->count; i++) {
        const batch_result *r = &b->result[i];
        bytes_printf(&out, "%d,", r->item->line);
        csv_text(&out, r->item->output);
        csv_text(&out, r->item->brdf);
        csv_text(&out, r->item->kind);
        csv_text(&out, r->item->options);
        bytes_printf(&out, "%s", status_names[r->status]);
        for (int k = 0; k < BATCH_FIGURES; k++) {
            if (r->status == BATCH_FAILED || !isfinite(r->figure[k]))
                bytes_printf(&out, ",");
            else
                bytes_printf(&out, ",%.17g", r->figure[k]);
        }
        bytes_printf(&out, "\n");
    }
    int code = output_write_raw(path, &out, f);
    bytes_free(&out);
    return code;
}
