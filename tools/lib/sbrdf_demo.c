/* SPDX-License-Identifier: MIT */
#include "sbrdf_demo.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "output.h"
#include "png_io.h"

#define PI 3.14159265358979323846
enum { SIDE = SBRDF_DEMO_SIDE };

/* ---- patterns over x, y in 0..1, which repeat ---------------------------------------------------------- */

static double lattice(int x, int y, uint32_t seed)
{
    uint32_t h = (uint32_t)x * 374761393u + (uint32_t)y * 668265263u + seed * 2246822519u;
    h = (h ^ h >> 13) * 1274126177u;
    return (h ^ h >> 16) / 4294967295.0;
}

static double smooth(double x)
{
    return x * x * (3 - 2 * x);
}

/* 0..1, with so many cells each way. */
static double noise(double x, double y, int across, int down, uint32_t seed)
{
    double u = x * across, v = y * down, a = smooth(u - floor(u)), b = smooth(v - floor(v));
    int i = (int)floor(u), j = (int)floor(v);
    double corner[4];
    for (int k = 0; k < 4; k++)
        corner[k] = lattice(((i + (k & 1)) % across + across) % across, ((j + (k >> 1)) % down + down) % down, seed);
    return (corner[0] * (1 - a) + corner[1] * a) * (1 - b) + (corner[2] * (1 - a) + corner[3] * a) * b;
}

static double clouds(double x, double y, int across, int down, uint32_t seed)
{
    double sum = 0, part = 0.5;
    for (int k = 0; k < 4; k++, part /= 2) sum += part * noise(x, y, across << k, down << k, seed + (uint32_t)k);
    return sum / 0.9375;
}

/* 0 below, 1 above, a ramp of the given width between. */
static double edge(double x, double width)
{
    double t = x / width + 0.5;
    return t <= 0 ? 0 : t >= 1 ? 1 : smooth(t);
}

static double nearest(double x) /* distance to the nearest whole number, signed */
{
    return x - floor(x + 0.5);
}

/* ---- pictures ------------------------------------------------------------------------------------------ */

typedef void pattern(double x, double y, double *out);

static int write_picture(const char *directory, const char *name, int channels, pattern *draw, failure *f)
{
    char path[1200];
    image_u8 picture = image_u8_make(SIDE, SIDE, channels);
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++) {
            double value[3];
            draw((i + 0.5) / SIDE, (j + 0.5) / SIDE, value);
            for (int c = 0; c < channels; c++) picture.texel[(j * SIDE + i) * channels + c] = unorm8(value[c]);
        }
    snprintf(path, sizeof path, "%s/%s.png", directory, name);
    int code = png_write(path, &picture, f);
    image_u8_free(&picture);
    return code;
}

/* ---- gilded wallpaper ---------------------------------------------------------------------------------- */

/* Damask: an ogee net with a flower in every mesh, two across, staggered. */
static void damask(double x, double y, double *out)
{
    double u = 2 * x, v = 2 * y;
    double wave = 0.25 * cos(2 * PI * v);
    double net = fmin(fabs(nearest(u - 0.25 - wave)), fabs(nearest(u + 0.25 + wave)));
    double line = edge(0.035 - fabs(net - 0.012), 0.02) * (0.7 + 0.3 * edge(sin(16 * PI * v), 0.6));
    double flower = 0;
    for (int k = 0; k < 2; k++) {
        double a = nearest(u - 0.5 * k), b = nearest(v - 0.5 * k) * 1.05;
        double r = hypot(a, b), turn = atan2(a, b);
        double petals = 0.20 * (0.72 + 0.28 * cos(6 * turn)), heart = 0.05, ring = 0.085;
        flower = fmax(flower, edge(petals - r, 0.02) * (1 - edge(ring - r, 0.015)) + edge(heart - r, 0.015));
        for (int s = -1; s <= 1; s += 2) { /* leaves above and below */
            double p = a * 1.0, q = b - 0.29 * s, leaf = hypot(p * 2.6 + 0.15 * sin(12 * q), q);
            flower = fmax(flower, edge(0.085 - leaf, 0.02) * (1 - edge(0.012 - fabs(p), 0.01)));
        }
    }
    out[0] = fmin(fmax(line, flower), 1);
}

static void paper_grain(double x, double y, double *out)
{
    double shade = 0.82 + 0.18 * clouds(x, y, 24, 24, 3) + 0.06 * (edge(sin(2 * PI * 64 * x), 1) - 0.5);
    for (int c = 0; c < 3; c++) out[c] = shade;
}

/* ---- cherry wood --------------------------------------------------------------------------------------- */

/* Where in its yearly rings a place is, 0..1, and how much of a pore it is. */
static double rings(double x, double y)
{
    double bend = 0.16 * clouds(x, y, 2, 1, 11) + 0.03 * sin(2 * PI * y);
    double ring = 9 * (x + bend);
    return ring - floor(ring);
}

static void pores(double x, double y, double *out)
{
    double streak = noise(x + 0.02 * sin(2 * PI * y), y, 90, 6, 21), late = rings(x, y);
    out[0] = edge(streak - 0.9 + 0.2 * late, 0.15) * edge(noise(x, y, 60, 10, 5) - 0.3, 0.3);
}

static void cherry(double x, double y, double *out)
{
    static const double light[3] = {0.80, 0.50, 0.31}, dark[3] = {0.62, 0.32, 0.18};
    double late = rings(x, y), t = late * late * late * edge(0.95 - late, 0.1), fine = noise(x, y, 128, 8, 2) - 0.5,
           pore;
    pores(x, y, &pore);
    for (int c = 0; c < 3; c++) out[c] = (light[c] + (dark[c] - light[c]) * t) * (1 + 0.12 * fine) * (1 - 0.45 * pore);
}

/* ---- gift wrap ----------------------------------------------------------------------------------------- */

static double star(double a, double b, double size, double turned)
{
    double r = hypot(a, b), turn = atan2(b, a) + turned, sector = 2 * PI / 5;
    double t = fabs(nearest(turn / sector)) * sector; /* 0 at a point, sector/2 between two */
    double inner = 0.42, at = inner * sin(sector / 2), to = inner * cos(sector / 2);
    /* the straight line from the point (1, 0) to (to, at), in polar coordinates */
    return edge(size * at / (at * cos(t) + (1 - to) * sin(t)) - r, 0.01);
}

static void stars(double x, double y, double *out)
{
    out[0] = 0;
    for (int k = 0; k < 8; k++) {
        double at_x = (k % 2 * 2 + 1 + (k / 2) % 2) / 4.0, at_y = (k / 2 + 0.5) / 4.0;
        out[0] = fmax(out[0], star(nearest(x - at_x), nearest(y - at_y), 0.105, 0.4 + 0.35 * k));
    }
    for (int k = 0; k < 40; k++) {
        double a = nearest(x - lattice(k, 1, 9)), b = nearest(y - lattice(k, 2, 9));
        out[0] = fmax(out[0], edge(0.012 + 0.006 * lattice(k, 3, 9) - hypot(a, b), 0.008));
    }
}

static void ribbons(double x, double y, double *out)
{
    double d = fabs(nearest(2 * (x + y)));
    out[0] = fmax(edge(0.05 - d, 0.02), edge(0.012 - fabs(d - 0.09), 0.012));
}

/* ---- composite ------------------------------------------------------------------------------------------ */

enum { COMPOSITE = 12, CELLS = 5 };

/* Irregular tiles: the cell of the nearest point, and the distance to the next cell's. */
static int tile(double x, double y, double *gap)
{
    double first = 9, second = 9;
    int cell = 0;
    for (int k = 0; k < CELLS * CELLS; k++) {
        int i = k % CELLS, j = k / CELLS;
        double a = nearest(x - (i + 0.5 + 0.7 * (lattice(i, j, 31) - 0.5)) / CELLS);
        double b = nearest(y - (j + 0.5 + 0.7 * (lattice(i, j, 32) - 0.5)) / CELLS), d = hypot(a, b);
        if (d < first) {
            second = first;
            first = d;
            cell = k;
        } else if (d < second) {
            second = d;
        }
    }
    *gap = second - first;
    return cell;
}

static int composite_wanted; /* set before its picture is drawn: this program draws one after the other */

static void tiles_of(double x, double y, double *out)
{
    double gap;
    int cell = tile(x, y, &gap);
    out[0] = cell * 7 % COMPOSITE == composite_wanted ? edge(gap - 0.014, 0.01) : 0;
}

/* ---- upholstery ----------------------------------------------------------------------------------------- */

/* Leaves on a ground: where the silk is on top. */
static void leaves(double x, double y, double *out)
{
    out[0] = 0;
    for (int k = 0; k < 4; k++) {
        double turn = (k % 2 ? 1 : -1) * 0.7 + 0.3 * k, a = nearest(x - (k % 2) * 0.5 - 0.1 * (k / 2) - 0.2);
        double b = nearest(y - (k / 2) * 0.5 - 0.25), p = a * cos(turn) + b * sin(turn),
               q = b * cos(turn) - a * sin(turn);
        double width = 0.11 * (1 - 16 * p * p) * (1 + 0.35 * sin(40 * p));
        double leaf = edge(width - fabs(q), 0.02) * edge(0.25 - fabs(p), 0.02);
        leaf *= 1 - edge(0.008 - fabs(q - 0.02 * sin(12 * p)), 0.006);
        out[0] = fmax(out[0], leaf);
    }
}

/* Silk runs along x in floats of five, cotton along y (a satin weave): which thread is up at a place. */
static void silk(double x, double y, double *out)
{
    enum { THREADS = 64 };
    double up, u = x * THREADS, v = y * THREADS;
    int column = (int)floor(u), row = (int)floor(v);
    leaves(x, y, &up);
    int bound = (column + 2 * row) % 5 == 0; /* the one in five that goes under */
    double thread = (up > 0.5) != bound;
    out[0] = thread;
}

static void threads(double x, double y, double *out)
{
    enum { THREADS = 64 };
    double up, u = x * THREADS, v = y * THREADS;
    silk(x, y, &up);
    double across = fabs(2 * (up > 0.5 ? v - floor(v) : u - floor(u)) - 1); /* 0 on the thread's ridge */
    double shade = (1 - 0.45 * across * across) * (0.92 + 0.16 * (noise(x, y, 128, 128, 8) - 0.5));
    for (int c = 0; c < 3; c++) out[c] = shade;
}

/* ---- brushed metal -------------------------------------------------------------------------------------- */

/* 5 x 7 letters, a byte a column, lowest bit on top. */
static const uint8_t letters[5][5] = {
    {0x7C, 0x08, 0x04, 0x04, 0x78}, /* n */
    {0x20, 0x54, 0x54, 0x54, 0x78}, /* a */
    {0x38, 0x44, 0x44, 0x44, 0x20}, /* c */
    {0x7C, 0x08, 0x04, 0x04, 0x08}, /* r */
    {0x38, 0x54, 0x54, 0x54, 0x18}, /* e */
};

static double letter_dot(int column, int row)
{
    int letter = column / 6, within = column % 6;
    if (column < 0 || row < 0 || row > 6 || letter > 4 || within > 4) return 0;
    return letters[letter][within] >> row & 1;
}

/* The dots of the letters, rounded by filtering and cutting at a half. */
static void lettering(double x, double y, double *out)
{
    double u = (x - 0.5) * 36 + 14.5, v = (y - 0.5) * 36 + 4, a = u - 0.5 - floor(u - 0.5),
           b = v - 0.5 - floor(v - 0.5);
    int i = (int)floor(u - 0.5), j = (int)floor(v - 0.5);
    double value = (letter_dot(i, j) * (1 - a) + letter_dot(i + 1, j) * a) * (1 - b) +
                   (letter_dot(i, j + 1) * (1 - a) + letter_dot(i + 1, j + 1) * a) * b;
    out[0] = edge(value - 0.45, 0.25);
}

static void weave(double x, double y, double *out)
{
    double shade = 0.85 + 0.15 * sin(2 * PI * 64 * x) * sin(2 * PI * 64 * y);
    for (int c = 0; c < 3; c++) out[c] = shade;
}

/* Straight brush strokes, and discs that were turned on a lathe. The nearest disc's radius, and the place from its middle. */
enum { DISCS = 2 };
static const double disc_radius = 0.17;
static double from_disc(double x, double y, double *a, double *b)
{
    *a = nearest(DISCS * x - 0.5) / DISCS;
    *b = nearest(DISCS * y - 0.5) / DISCS;
    return hypot(*a, *b);
}

static void strokes(double x, double y, double *out)
{
    double a, b, r = from_disc(x, y, &a, &b), turn = 0.06 * (noise(x, y, 4, 96, 4) - 0.5);
    if (r < disc_radius) turn = atan2(b, a) + PI / 2;
    out[0] = (128 + 127 * cos(turn)) / 255;
    out[1] = (128 - 127 * sin(turn)) / 255; /* pictures run down, textures up */
    out[2] = 0;
}

static void scratches(double x, double y, double *out)
{
    double a, b, r = from_disc(x, y, &a, &b), shade = 0.72 + 0.28 * noise(x, y, 5, 128, 6);
    if (r < disc_radius) shade = 0.72 + 0.28 * noise(r, atan2(b, a) / (2 * PI), 192, 3, 7);
    shade *= edge(fabs(r - disc_radius) - 0.004, 0.006); /* a groove around */
    for (int c = 0; c < 3; c++) out[c] = shade;
}

/* ---- the six --------------------------------------------------------------------------------------------- */

typedef struct picture {
    const char *name;
    int channels;
    pattern *draw;
} picture;

typedef struct demo {
    const char *name, *text;
    picture picture[4];
} demo;

static const demo demos[SBRDF_DEMO_COUNT] = {
    {"wallpaper",
     "size 256 256\n"
     "material paper ggx:rough=.75,f0=.04,albedo=.24/.025/.04\n"
     "material gold sgd:gold-metallic-paint\n"
     "fill paper tint=wallpaper-grain.png\n"
     "paint gold wallpaper-gold.png\n",
     {{"wallpaper-grain", 3, paper_grain}, {"wallpaper-gold", 1, damask}}},
    {"cherry-wood",
     "size 256 256\n"
     "# varnish: increasingly reflective at grazing angles; pores are matter\n"
     "material wood lafortune:kd=.8,cx=-1,cz=.95,n=110,ks=1.6\n"
     "material pore lafortune:kd=.8,cx=-1,cz=.9,n=10,ks=.06\n"
     "fill wood tint=cherry-wood-colour.png\n"
     "paint pore cherry-wood-pores.png tint=cherry-wood-colour.png\n",
     {{"cherry-wood-colour", 3, cherry}, {"cherry-wood-pores", 1, pores}}},
    {"gift-wrap",
     "size 256 256\n"
     "material red lafortune:kd=.34/.012/.02,cx=-1,cz=.96,n=45,ks=1.1/.3/.28\n"
     "material silver sgd:silver-metallic-paint2\n"
     "material gold sgd:gold-metallic-paint2\n"
     "fill red\n"
     "paint gold gift-wrap-ribbons.png\n"
     "paint silver gift-wrap-stars.png\n",
     {{"gift-wrap-ribbons", 1, ribbons}, {"gift-wrap-stars", 1, stars}}},
    {"composite",
     "size 256 256\n"
     "material grout lambert:albedo=.05\n"
     "material m0 sgd:alum-bronze\n"
     "material m1 sgd:red-fabric\n"
     "material m2 sgd:blue-acrylic\n"
     "material m3 sgd:green-metallic-paint\n"
     "material m4 sgd:yellow-plastic\n"
     "material m5 sgd:pink-felt\n"
     "material m6 sgd:two-layer-gold\n"
     "material m7 sgd:white-marble\n"
     "material m8 lafortune:blue-paint\n"
     "material m9 lafortune:clay\n"
     "material m10 ggx:rough=.35,f0=.04,albedo=.25/.03/.35\n"
     "material m11 sgd:color-changing-paint1\n"
     "fill grout\n",
     {{NULL, 0, NULL}}},
    {"upholstery",
     "size 256 256\n"
     "lobes 2\n"
     "# threads mirror along themselves and not across: a sharp lobe and a broad one\n"
     "material silk lafortune:kd=.13/.09/.03,cx=-1,cy=.94,cz=.97,n=26,ks=.62/.50/.24,"
     "cx=-.8,cy=.5,cz=.85,n=3,ks=.16/.12/.05\n"
     "material cotton lafortune:kd=.03/.06/.14,cx=-1,cy=.94,cz=.97,n=16,ks=.16/.22/.36,"
     "cx=-.8,cy=.5,cz=.85,n=2,ks=.03/.05/.09\n"
     "fill cotton tint=upholstery-threads.png shine=upholstery-threads.png turn=90\n"
     "paint silk upholstery-silk.png tint=upholstery-threads.png shine=upholstery-threads.png\n",
     {{"upholstery-threads", 3, threads}, {"upholstery-silk", 1, silk}}},
    {"brushed-metal",
     "size 256 256\n"
     "lobes 3\n"
     "# broad, narrow and fine strokes: each mirrors along itself\n"
     "material metal lafortune:kd=.05/.052/.056,cx=-1,cy=.55,cz=.97,n=18,ks=1/1.01/1.03,"
     "cx=-1,cy=.9,cz=.99,n=56,ks=1/1.02/1.05,cx=-1,cy=.98,cz=.998,n=184,ks=1.4/1.42/1.45\n"
     "material cloth sgd:white-fabric\n"
     "fill metal direction=brushed-metal-strokes.png shine=brushed-metal-scratches.png\n"
     "paint cloth brushed-metal-letters.png tint=brushed-metal-weave.png\n",
     {{"brushed-metal-strokes", 3, strokes},
      {"brushed-metal-scratches", 3, scratches},
      {"brushed-metal-letters", 1, lettering},
      {"brushed-metal-weave", 3, weave}}},
};

const char *sbrdf_demo_name(int index)
{
    return demos[index].name;
}

/* The composite's masks, and the statements that use them. */
static int write_composite(const char *directory, bytes *text, failure *f)
{
    int code = FAIL_NONE;
    for (int k = 0; k < COMPOSITE && !code; k++) {
        char name[64];
        snprintf(name, sizeof name, "composite-m%d", k);
        composite_wanted = k;
        code = write_picture(directory, name, 1, tiles_of, f);
        bytes_printf(text, "paint m%d %s.png\n", k, name);
    }
    return code;
}

int sbrdf_demo_write(int index, const char *directory, failure *f)
{
    const demo *d = &demos[index];
    bytes text = {0};
    char path[1200];
    int code = FAIL_NONE;
    bytes_printf(&text, "%s", d->text);
    if (!d->picture[0].name) code = write_composite(directory, &text, f);
    for (int k = 0; k < 4 && d->picture[k].name && !code; k++)
        code = write_picture(directory, d->picture[k].name, d->picture[k].channels, d->picture[k].draw, f);
    snprintf(path, sizeof path, "%s/%s.txt", directory, d->name);
    if (!code) code = output_write_raw(path, &text, f);
    bytes_free(&text);
    return code;
}
