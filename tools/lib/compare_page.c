/* SPDX-License-Identifier: MIT */
/* The page of a comparison: one HTML file that loads nothing. Frames are strips of all light angles, so that a slider
   can move the light; without scripts the sheet and the plot say the same. */
#include <stdio.h>
#include <string.h>

#include "compare_report.h"
#include "png_io.h"

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>\n"
    "body{font:16px/1.5 sans-serif;margin:2em auto;max-width:1240px;padding:0 1em;color:#222;background:#fff}\n"
    "h1{font-size:1.6em;margin-bottom:0}h2{font-size:1.2em;margin-top:2em}p.note{color:#555;margin-top:.3em}\n"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums;width:100%}\n"
    "th,td{padding:.35em .6em;text-align:right;border-bottom:1px solid #ddd}td{white-space:nowrap}\n"
    "th{font-weight:600;vertical-align:bottom}\n"
    "th:first-child,td:first-child{text-align:left}tr.baseline td{color:#666}\n"
    ".scroll{overflow-x:auto}.frames{display:flex;flex-wrap:wrap;gap:14px}\n"
    ".frames figure{margin:0;padding:12px;background:#747474;color:#fff;border-radius:6px}\n"
    ".frame{width:192px;height:192px;border-radius:50%;background-size:7104px 192px;image-rendering:pixelated}\n"
    "figcaption{font-size:13px;max-width:400px}.pair{display:flex;gap:8px}\n"
    "input[type=range]{width:min(100%,640px);vertical-align:middle}img,svg{max-width:100%;height:auto}\n"
    "</style>\n";

static const char script[] =
    "<script>\n"
    "const slider=document.getElementById('light'),shown=document.getElementById('angle');\n"
    "function move(){const k=+slider.value;shown.textContent=5*k;\n"
    "for(const f of document.querySelectorAll('.frame'))f.style.backgroundPositionX=(-192*k)+'px';\n"
    "for(const o of document.querySelectorAll('[data-db]'))"
    "{const db=+o.dataset.db.split(' ')[k];o.textContent=db<99?db.toFixed(1)+' dB':'equal';}}\n"
    "slider.addEventListener('input',move);move();\n"
    "</script>\n";

/* RFC 4648, section 4. */
static void base64(bytes *out, const bytes *in)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < in->size; i += 3) {
        size_t left = in->size - i;
        uint32_t bits = (uint32_t)in->data[i] << 16;
        if (left > 1) bits |= (uint32_t)in->data[i + 1] << 8;
        if (left > 2) bits |= in->data[i + 2];
        char four[4] = {digit[bits >> 18], digit[bits >> 12 & 63], left > 1 ? digit[bits >> 6 & 63] : '=',
                        left > 2 ? digit[bits & 63] : '='};
        bytes_append(out, four, 4);
    }
}

static void data_uri(bytes *out, const image_u8 *picture)
{
    bytes png = {0};
    png_encode(&png, picture, "page", NULL);
    bytes_printf(out, "data:image/png;base64,");
    base64(out, &png);
    bytes_free(&png);
}

/* All frames side by side. */
static void strip(bytes *out, const image_u8 frame[METRIC_FRAMES])
{
    image_u8 all = image_u8_make(METRIC_FRAMES * METRIC_SIZE, METRIC_SIZE, 3);
    for (int k = 0; k < METRIC_FRAMES; k++)
        for (int y = 0; y < METRIC_SIZE; y++)
            memcpy(all.texel + 3 * ((y * METRIC_FRAMES + k) * METRIC_SIZE), frame[k].texel + 3 * (y * METRIC_SIZE),
                   3 * METRIC_SIZE);
    data_uri(out, &all);
    image_u8_free(&all);
}

static void strip_of_frames(bytes *out, const image_u8 frame[METRIC_FRAMES])
{
    bytes_printf(out, "<div class=\"frame\" style=\"background-image:url(");
    strip(out, frame);
    bytes_printf(out, ")\"></div>");
}

static void strip_of_differences(bytes *out, const compare_report *r, const compare_entry *e)
{
    image_u8 difference[METRIC_FRAMES];
    int largest;
    for (int k = 0; k < METRIC_FRAMES; k++)
        report_difference(&difference[k], &r->truth->frames.shown[METRIC_FULL][k], &e->frames.shown[METRIC_FULL][k],
                          &largest);
    strip_of_frames(out, difference);
    for (int k = 0; k < METRIC_FRAMES; k++) image_u8_free(&difference[k]);
}

static void viewer(bytes *out, const compare_report *r)
{
    bytes_printf(out, "<h2>Frames</h2>\n<p>Light at <output id=\"angle\">45</output>&#176; "
                      "<input id=\"light\" type=\"range\" min=\"0\" max=\"36\" value=\"9\" aria-label=\"light's polar "
                      "angle\"></p>\n<div class=\"frames\"><figure>");
    strip_of_frames(out, r->truth->frames.shown[METRIC_FULL]);
    bytes_printf(out, "<figcaption>reference<br>&#160;</figcaption></figure>\n");
    for (int i = 0; i < r->count; i++) {
        const compare_entry *e = &r->entry[i];
        bytes_printf(out, "<figure><div class=\"pair\">");
        strip_of_frames(out, e->frames.shown[METRIC_FULL]);
        strip_of_differences(out, r, e);
        bytes_printf(out, "</div><figcaption>");
        report_escape(out, e->label);
        bytes_printf(out, ", and its difference &#215;8<br><span data-db=\"");
        for (int k = 0; k < METRIC_FRAMES; k++) bytes_printf(out, "%s%.1f", k ? " " : "", e->result.full.frame_db[k]);
        bytes_printf(out, "\"></span></figcaption></figure>\n");
    }
    bytes_printf(out, "</div>\n");
}

static void figures_row(bytes *out, const compare_entry *e)
{
    const compare_result *r = &e->result;
    bytes_printf(out, "<tr%s><td title=\"", e->is_baseline ? " class=\"baseline\"" : "");
    report_escape(out, e->asset.description);
    bytes_printf(out, "\">");
    report_escape(out, e->label);
    if (e->asset.texture_bytes)
        bytes_printf(out, "</td><td>%lld</td><td>%d</td>", e->asset.texture_bytes, e->asset.fetches);
    else
        bytes_printf(out, "</td><td>&#8211;</td><td>&#8211;</td>");
    bytes_printf(out,
                 "<td><b>%.2f</b></td><td>%.2f at %g&#176;</td><td>%.2f</td><td>%.2f</td><td>%.4f</td><td>%.2f %%</td>"
                 "<td>%.2f %% at %g&#176;</td></tr>\n",
                 r->full.pooled_psnr_db, r->full.worst_frame_db, r->full.worst_frame_deg, r->dim.pooled_psnr_db,
                 r->dim.worst_frame_db, r->ssim, 100 * r->relative_rms, 100 * r->albedo_error, r->albedo_error_deg);
}

static void figures(bytes *out, const compare_report *r)
{
    bytes_printf(out, "<div class=\"scroll\"><table><tr><th></th><th>texture bytes</th><th>fetches a light</th>"
                      "<th>PSNR, dB</th><th>worst frame, dB</th><th>2 stops down, dB</th><th>its worst frame</th>"
                      "<th>SSIM</th><th>relative RMS, linear</th><th>largest albedo error</th></tr>\n");
    for (int i = 0; i < r->count; i++) figures_row(out, &r->entry[i]);
    bytes_printf(out, "</table></div>\n");
}

static void explanation(bytes *out)
{
    bytes_printf(
        out,
        "<h2>What the figures mean</h2>\n<p>A unit sphere fills frames of %d &#215; %d pixels. One light moves from "
        "the eye "
        "(0&#176;) to behind the sphere (180&#176;) in %d steps. The reference evaluates the BRDF in double precision; "
        "both "
        "are shown with the sRGB curve in 8 bits under one exposure. PSNR is that of the mean squared error over all "
        "frames, disc pixels and channels; the worst frame is the least of the %d; &#8220;2 stops down&#8221; is the "
        "same "
        "file under a quarter of the light. SSIM is the mean structural similarity (Wang et al. 2004). Relative RMS is "
        "taken of linear radiance, without clamping. Albedo is hemispherical, for views of 0&#176; to 75&#176; from "
        "the "
        "normal, compared in luminance.</p>\n",
        METRIC_SIZE, METRIC_SIZE, METRIC_FRAMES, METRIC_FRAMES);
}

void report_page(const compare_report *r, bytes *out)
{
    image_u8 sheet;
    bytes_printf(out, "%s<title>nacre compare ", head);
    report_escape(out, report_label(r->truth->b->name));
    bytes_printf(out, "</title></head><body>\n<h1>");
    report_escape(out, report_label(r->truth->b->name));
    bytes_printf(out, "</h1>\n<p class=\"note\">");
    report_escape(out, r->truth->b->description);
    bytes_printf(out, "; exposure %.4g; drawn by ", r->truth->exposure);
    report_escape(out, r->renderer);
    if (r->truth->fov_deg > 0) bytes_printf(out, "; seen from near, field of view %g&#176;", r->truth->fov_deg);
    bytes_printf(out, "</p>\n");
    figures(out, r);
    viewer(out, r);
    bytes_printf(out, "<h2>PSNR of each frame</h2>\n");
    report_plot(r, out);
    bytes_printf(out, "<h2>Sheet</h2>\n<img alt=\"frames of reference and assets at seven light angles, with "
                      "differences\" src=\"");
    report_sheet(r, &sheet);
    data_uri(out, &sheet);
    image_u8_free(&sheet);
    bytes_printf(out, "\">\n");
    explanation(out);
    bytes_printf(out, "%s</body></html>\n", script);
}
