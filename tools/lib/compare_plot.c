/* SPDX-License-Identifier: MIT */
/* PSNR against the light's angle, as SVG. */
#include <math.h>
#include <stdio.h>

#include "compare_report.h"

enum { WIDTH = 1040, LEFT = 70, TOP = 56, PLOT_WIDTH = 640, PLOT_HEIGHT = 400, LEGEND_X = LEFT + PLOT_WIDTH + 24 };

/* Colours that colour-blind readers tell apart: Okabe and Ito 2008, "Color Universal Design", with grey for its yellow. */
static const char *const colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                      "#e69f00", "#56b4e9", "#000000", "#8a8a8a"};
enum { COLOURS = sizeof colours / sizeof *colours };

void report_escape(bytes *out, const char *text)
{
    for (; *text; text++) {
        const char *as = *text == '&'   ? "&amp;"
                         : *text == '<' ? "&lt;"
                         : *text == '>' ? "&gt;"
                         : *text == '"' ? "&quot;"
                                        : NULL;
        if (as)
            bytes_printf(out, "%s", as);
        else
            bytes_append(out, (unsigned char)*text < 0x20 ? " " : text, 1);
    }
}

typedef struct axes {
    double low, high; /* dB */
} axes;

/* Whole steps of 5 dB about all frames that differ. */
static axes fit_axes(const compare_report *r)
{
    axes a = {HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < r->count; i++)
        for (int k = 0; k < METRIC_FRAMES; k++) {
            double db = r->entry[i].result.full.frame_db[k];
            if (db >= 70) continue; /* a few pixels off by a code: as good as equal, and far from the rest */
            a.low = fmin(a.low, db);
            a.high = fmax(a.high, db);
        }
    if (!(a.low <= a.high)) return (axes){40, 70};
    a.low = 5 * floor(a.low / 5);
    a.high = fmax(5 * ceil(a.high / 5), a.low + 10);
    return a;
}

static double x_of(double polar_deg)
{
    return LEFT + PLOT_WIDTH * polar_deg / 180;
}

static double y_of(const axes *a, double db)
{
    return TOP + PLOT_HEIGHT * (a->high - fmin(db, a->high)) / (a->high - a->low);
}

static void grid(bytes *out, const axes *a)
{
    for (double db = a->low; db <= a->high; db += 5)
        bytes_printf(out,
                     "<line class=\"grid\" x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\"/>"
                     "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n",
                     LEFT, LEFT + PLOT_WIDTH, y_of(a, db), y_of(a, db), LEFT - 8, y_of(a, db) + 5, db);
    for (int deg = 0; deg <= 180; deg += 30)
        bytes_printf(out,
                     "<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%d\" y2=\"%d\"/>"
                     "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%d&#176;</text>\n",
                     x_of(deg), x_of(deg), TOP, TOP + PLOT_HEIGHT, x_of(deg), TOP + PLOT_HEIGHT + 22, deg);
    bytes_printf(out,
                 "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">light's polar angle: 0 from the eye, 180 from behind"
                 "</text>\n<text transform=\"translate(20 %d) rotate(-90)\" text-anchor=\"middle\">PSNR of the frame, "
                 "dB</text>\n",
                 x_of(90), TOP + PLOT_HEIGHT + 48, TOP + PLOT_HEIGHT / 2);
}

static void curve(bytes *out, const axes *a, const compare_entry *e, const char *style)
{
    bytes_printf(out, "<polyline class=\"curve\" %s points=\"", style);
    for (int k = 0; k < METRIC_FRAMES; k++)
        bytes_printf(out, "%.1f,%.1f ", x_of(METRIC_STEP_DEG * k), y_of(a, e->result.full.frame_db[k]));
    bytes_printf(out, "\"/>\n");
}

static void legend(bytes *out, const compare_entry *e, int index, const char *style)
{
    int y = TOP + 12 + 44 * index;
    bytes_printf(out, "<line class=\"curve\" %s x1=\"%d\" x2=\"%d\" y1=\"%d\" y2=\"%d\"/><text x=\"%d\" y=\"%d\">",
                 style, LEGEND_X, LEGEND_X + 30, y, y, LEGEND_X + 38, y + 1);
    char label[64];
    report_shorten(label, sizeof label, e->label, 32); /* what fits beside the plot */
    report_escape(out, label);
    bytes_printf(out, "</text><text class=\"small\" x=\"%d\" y=\"%d\">%.2f dB in all", LEGEND_X + 38, y + 18,
                 e->result.full.pooled_psnr_db);
    if (e->asset.texture_bytes) bytes_printf(out, ", %lld bytes", e->asset.texture_bytes);
    bytes_printf(out, "</text>\n");
}

void report_plot(const compare_report *r, bytes *out)
{
    axes a = fit_axes(r);
    int height = TOP + PLOT_HEIGHT + 64, needed = TOP + 44 * r->count + 20;
    if (needed > height) height = needed;
    bytes_printf(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" "
                 "font-family=\"sans-serif\" font-size=\"14\">\n"
                 "<style>.grid{stroke:#d8d8d8}.curve{fill:none;stroke-width:2.2;stroke-linejoin:round}"
                 ".small{font-size:12px;fill:#555}.title{font-size:18px}</style>\n"
                 "<clipPath id=\"area\"><rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/></clipPath>\n"
                 "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n<text class=\"title\" x=\"%d\" y=\"30\">",
                 WIDTH, height, WIDTH, height, LEFT, TOP - 2, PLOT_WIDTH, PLOT_HEIGHT + 4, LEFT);
    report_escape(out, report_label(r->truth->b->name));
    bytes_printf(out, "</text>\n");
    grid(out, &a);
    for (int i = 0; i < r->count; i++) {
        char style[80];
        snprintf(style, sizeof style, "stroke=\"%s\"%s", colours[i % COLOURS],
                 r->entry[i].is_baseline ? " stroke-dasharray=\"6 5\"" : "");
        bytes_printf(out, "<g clip-path=\"url(#area)\">");
        curve(out, &a, &r->entry[i], style);
        bytes_printf(out, "</g>");
        legend(out, &r->entry[i], i, style);
    }
    bytes_printf(out, "</svg>\n");
}
