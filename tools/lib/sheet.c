/* SPDX-License-Identifier: MIT */
#include "sheet.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include "stb_easy_font.h"
#pragma GCC diagnostic pop

enum {
    MARGIN = 28,    /* around the sheet */
    GAP = 14,       /* between pictures */
    GROUP_GAP = 42, /* between groups of columns */
    TEXT_SCALE = 2, /* pixels per unit of the font, whose lines are 12 units high */
    LINE = 12 * TEXT_SCALE,
    LEGEND = 3 * LINE, /* a bar, labels, air */
    TITLE_LINE = 12 * (TEXT_SCALE + 1) + 10,
    GREY = 116, /* sRGB code of the background: 17.5 % of white, so that black and white materials stand out */
    INK = 240
};

static int column_x(const sheet_layout *l, int column)
{
    int groups = l->group ? column / l->group : 0;

    return MARGIN + l->row_label_width + column * (l->cell_width + GAP) + groups * (GROUP_GAP - GAP);
}

static int row_pitch(const sheet_layout *l)
{
    return l->cell_height + GAP + (l->has_captions ? LINE + 4 : 0);
}

static int row_y(const sheet_layout *l, int row)
{
    return MARGIN + (l->title ? TITLE_LINE : 0) + (l->has_heads ? LINE + 4 : 0) + row * row_pitch(l);
}

static void fill(image_u8 *p, int x0, int y0, int x1, int y1)
{
    int x, y;

    for (y = y0 < 0 ? 0 : y0; y < y1 && y < p->height; y++)
        for (x = x0 < 0 ? 0 : x0; x < x1 && x < p->width; x++)
            memset(p->texel + 3 * ((size_t)y * (size_t)p->width + (size_t)x), INK, 3);
}

/* The font gives quads of whole units: corner 0 is the top left, corner 2 the bottom right. */
static void draw_text(image_u8 *p, int x, int y, int scale, const char *text)
{
    typedef struct corner {
        float x, y, z;
        unsigned char color[4];
    } corner;
    static const int most = 1 << 16;
    corner *corners = malloc((size_t)most);
    int i, quads;

    if (!corners) return;
    quads = stb_easy_font_print(0, 0, (char *)(uintptr_t)text, NULL, corners, most);
    for (i = 0; i < quads; i++) {
        const corner *a = &corners[4 * i], *b = a + 2;
        fill(p, x + scale * (int)a->x, y + scale * (int)a->y, x + scale * (int)b->x, y + scale * (int)b->y);
    }
    free(corners);
}

/* Only what the font has, and no more than fits. */
static int fit(char *out, size_t size, const char *text, int scale, int width)
{
    size_t i;

    snprintf(out, size, "%s", text);
    for (i = 0; out[i]; i++)
        if (!isprint((unsigned char)out[i])) out[i] = ' ';
    while (i && scale * stb_easy_font_width(out) > width) out[--i] = 0;
    return scale * stb_easy_font_width(out);
}

static void title(sheet *s)
{
    char line[256];

    if (!s->layout.title) return;
    fit(line, sizeof line, s->layout.title, TEXT_SCALE + 1, s->picture.width - 2 * MARGIN);
    draw_text(&s->picture, MARGIN, MARGIN, TEXT_SCALE + 1, line);
}

sheet sheet_begin(const sheet_layout *layout)
{
    sheet s = {.layout = *layout};
    int width = column_x(layout, layout->columns - 1) + layout->cell_width + MARGIN;
    int height = row_y(layout, layout->rows) - GAP + MARGIN + (layout->has_legend ? LEGEND : 0);

    s.picture = image_u8_make(width, height, 3);
    memset(s.picture.texel, GREY, (size_t)width * (size_t)height * 3);
    title(&s);
    return s;
}

void sheet_free(sheet *s)
{
    image_u8_free(&s->picture);
}

void sheet_place(sheet *s, int column, int row, const image_u8 *picture)
{
    int x0 = column_x(&s->layout, column), y0 = row_y(&s->layout, row), x, y, c;
    double linear[256];

    for (c = 0; c < 256; c++) linear[c] = srgb_decode(c / 255.0);
    for (y = 0; y < picture->height && y0 + y < s->picture.height; y++)
        for (x = 0; x < picture->width && x0 + x < s->picture.width; x++) {
            const uint8_t *from = picture->texel + 4 * ((size_t)y * (size_t)picture->width + (size_t)x);
            uint8_t *to = s->picture.texel + 3 * ((size_t)(y0 + y) * (size_t)s->picture.width + (size_t)(x0 + x));
            double alpha = from[3] / 255.0;
            for (c = 0; c < 3; c++) to[c] = unorm8(srgb_encode(linear[from[c]] * alpha + linear[to[c]] * (1 - alpha)));
        }
}

static void centred(sheet *s, int x, int y, int width, const char *text)
{
    char line[128];
    int used = fit(line, sizeof line, text, TEXT_SCALE, width);

    draw_text(&s->picture, x + (width - used) / 2, y, TEXT_SCALE, line);
}

void sheet_caption(sheet *s, int column, int row, const char *text)
{
    centred(s, column_x(&s->layout, column), row_y(&s->layout, row) + s->layout.cell_height + 4, s->layout.cell_width,
            text);
}

void sheet_head(sheet *s, int column, const char *text)
{
    centred(s, column_x(&s->layout, column), row_y(&s->layout, 0) - LINE - 2, s->layout.cell_width, text);
}

static void label_line(sheet *s, int y, const char *text, size_t length)
{
    char given[128], line[128];

    snprintf(given, sizeof given, "%.*s", (int)length, text);
    fit(line, sizeof line, given, TEXT_SCALE, s->layout.row_label_width - GAP);
    draw_text(&s->picture, MARGIN, y, TEXT_SCALE, line);
}

void sheet_row_label(sheet *s, int row, const char *text)
{
    int lines = 1, y;
    const char *c;

    for (c = text; *c; c++) lines += *c == '\n';
    y = row_y(&s->layout, row) + (s->layout.cell_height - lines * LINE) / 2;
    for (; lines--; y += LINE) {
        size_t length = strcspn(text, "\n");
        label_line(s, y, text, length);
        text += length + (text[length] == '\n');
    }
}

static void copy_rgb(image_u8 *to, int x0, int y0, const image_u8 *from)
{
    int y, width = from->width < to->width - x0 ? from->width : to->width - x0;

    for (y = 0; y < from->height && y0 + y < to->height && width > 0; y++)
        memcpy(to->texel + 3 * ((size_t)(y0 + y) * (size_t)to->width + (size_t)x0),
               from->texel + 3 * (size_t)y * (size_t)from->width, 3 * (size_t)width);
}

void sheet_legend(sheet *s, const char *text, const image_u8 *bar, const char *const *label, int count)
{
    enum { LABEL_WIDTH = 200 };
    int y = row_y(&s->layout, s->layout.rows) + GAP, i;
    int x = s->picture.width - MARGIN - bar->width - LABEL_WIDTH / 2;
    char line[256];

    fit(line, sizeof line, text, TEXT_SCALE, x - MARGIN - GAP);
    draw_text(&s->picture, MARGIN, y, TEXT_SCALE, line);
    copy_rgb(&s->picture, x, y - 4, bar);
    for (i = 0; i < count; i++)
        centred(s, x + bar->width * i / (count - 1) - LABEL_WIDTH / 2, y + LINE, LABEL_WIDTH, label[i]);
}

void sheet_group_caption(sheet *s, int column, int row, int columns, const char *text)
{
    int x = column_x(&s->layout, column), end = column_x(&s->layout, column + columns - 1) + s->layout.cell_width;

    centred(s, x, row_y(&s->layout, row) + s->layout.cell_height + 4, end - x, text);
}
