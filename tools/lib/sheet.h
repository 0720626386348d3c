/* SPDX-License-Identifier: MIT */
/* Contact sheets: a title, a grid of pictures on neutral grey, names above columns, beside rows and below pictures. */
#ifndef SHEET_H
#define SHEET_H

#include "pixels.h"

typedef struct sheet_layout {
    const char *title;
    int columns, rows;
    int cell_width, cell_height; /* pixels of each picture */
    int row_label_width;         /* pixels kept free left of the pictures for row names; 0: none */
    int has_captions;            /* 1: a line below each picture */
    int has_heads;               /* 1: a line above the columns */
    int has_legend;              /* 1: a strip below everything */
    int group;                   /* a wider gap after every so many columns; 0: none */
} sheet_layout;

typedef struct sheet {
    sheet_layout layout;
    image_u8 picture; /* RGB */
} sheet;

sheet sheet_begin(const sheet_layout *layout);
/* Blend an RGBA picture (straight alpha, sRGB) of the cell's size over the grey, in linear light. */
void sheet_place(sheet *s, int column, int row, const image_u8 *picture);
/* Printable ASCII; text that is too wide is cut. */
void sheet_caption(sheet *s, int column, int row, const char *text);
/* One caption below several pictures of a row. */
void sheet_group_caption(sheet *s, int column, int row, int columns, const char *text);
void sheet_head(sheet *s, int column, const char *text);
void sheet_row_label(sheet *s, int row, const char *text); /* lines are split at '\n' */
/* In the strip below: a title, a bar (RGB, at most 24 pixels high) right of it, and count (2 or more) labels under the bar, the first
   and the last centred on its ends. */
void sheet_legend(sheet *s, const char *text, const image_u8 *bar, const char *const *label, int count);
void sheet_free(sheet *s);

#endif
