/* SPDX-License-Identifier: MIT */
#include "palette_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "metric.h"
#include "sbrdf_paint.h"
#include "scene.h"
#include "sheet.h"

static const double pi = 3.14159265358979323846;

enum { SIDE = 192, FRAMES = 12, SHOWN = 3 };
static const double step_deg = 15;
static const int shown_frame[SHOWN] = {1, 4, 7}; /* 15, 60 and 105 degrees */

const char *const palette_way_names[PALETTE_WAYS] = {"nearest", "blended", "1 lobe", "2 lobes", "3 lobes"};

/* ---- the painting's own BRDFs --------------------------------------------------------------------------- */

typedef struct painting_source {
    brdf base;
    painting *p;
    brdf *material[PAINTING_MATERIALS];
} painting_source;

static long repeated(double i, int count)
{
    const double j = fmod(i, count);
    return (long)(j < 0 ? j + count : j);
}

/* Add weight x f_r of the texel. */
static void add_texel(const painting_source *s, long texel, double weight, const double to_light[3],
                      const double to_eye[3], double f_r[3])
{
    int coat[PAINTING_COATS], count = 0;
    double share[PAINTING_COATS], own[3];
    if (!(weight > 0)) return;
    if (!s->p->index.texel) count = painting_visible(s->p, texel, coat, share);
    for (int k = 0; k < (s->p->index.texel ? 1 : count); k++) {
        const int m = s->p->index.texel ? s->p->index.texel[texel] : s->p->coat[coat[k]].material;
        if (!s->material[m]->eval(s->material[m], to_light, to_eye, own)) continue;
        for (int c = 0; c < 3; c++) f_r[c] += weight * (s->p->index.texel ? 1 : share[k]) * own[c];
    }
}

static void eval_at(const brdf *b, const double uv[2], const double to_light[3], const double to_eye[3], double f_r[3])
{
    const painting_source *s = (const painting_source *)b;
    const double x = uv[0] * s->p->width - 0.5, y = (1 - uv[1]) * s->p->height - 0.5, right = x - floor(x),
                 down = y - floor(y);
    f_r[0] = f_r[1] = f_r[2] = 0;
    if (to_light[2] <= 0 || to_eye[2] <= 0) return;
    for (int i = 0; i < 4; i++)
        add_texel(s,
                  repeated(floor(y) + (i >> 1), s->p->height) * s->p->width + repeated(floor(x) + (i & 1), s->p->width),
                  (i & 1 ? right : 1 - right) * (i >> 1 ? down : 1 - down), to_light, to_eye, f_r);
}

/* The one material of a texel; -1: several. */
static int alone(const painting *p, long texel)
{
    int coat[PAINTING_COATS];
    double share[PAINTING_COATS];
    if (p->index.texel) return p->index.texel[texel];
    return painting_visible(p, texel, coat, share) == 1 ? p->coat[coat[0]].material : -1;
}

/* White between four texels of one material, else black: tells where there are no edges. */
static void eval_inside(const brdf *b, const double uv[2], const double to_light[3], const double to_eye[3],
                        double f_r[3])
{
    const painting *p = ((const painting_source *)b)->p;
    const double x = floor(uv[0] * p->width - 0.5), y = floor((1 - uv[1]) * p->height - 0.5);
    int material[4], same = 1;
    (void)to_light;
    (void)to_eye;
    for (int i = 0; i < 4; i++)
        material[i] = alone(p, repeated(y + (i >> 1), p->height) * p->width + repeated(x + (i & 1), p->width));
    for (int i = 0; i < 4; i++) same &= material[i] >= 0 && material[i] == material[0];
    f_r[0] = f_r[1] = f_r[2] = same;
}

static void close_source(brdf *b)
{
    painting_source *s = (painting_source *)b;
    for (int i = 0; i < s->p->material_count; i++) brdf_close(s->material[i]);
    painting_close(s->p);
    free(s->p);
    free(s);
}

int painting_brdf(brdf **out, painting *p, failure *f)
{
    painting_source *s = need_memory(1, sizeof *s);
    int code = FAIL_NONE;
    memset(s, 0, sizeof *s);
    s->p = p;
    s->base.eval_at = eval_at;
    s->base.close = close_source;
    snprintf(s->base.name, sizeof s->base.name, "%.200s", p->path);
    for (int i = 0; i < p->material_count && !code; i++) code = brdf_open(&s->material[i], p->material[i].brdf, f);
    if (code)
        close_source(&s->base);
    else
        *out = &s->base;
    return code;
}

static int open_truth(brdf **out, const char *path, failure *f)
{
    sbrdf_sources sources = {0};
    painting *p = need_memory(1, sizeof *p);
    int code = painting_open(p, path, &sources, f);
    sbrdf_sources_free(&sources);
    if (!code) return painting_brdf(out, p, f);
    painting_close(p);
    free(p);
    return code;
}

/* ---- the ways ------------------------------------------------------------------------------------------- */

static void *copied(const void *from, size_t size)
{
    return memcpy(need_memory(size, 1), from, size);
}

static brdf *palette_way(const palette *p, int blend)
{
    palette copy = *p;
    copy.blend = blend;
    copy.levels = 1;
    memset(copy.code, 0, sizeof copy.code);
    copy.code[0] = copied(p->code[0], (size_t)p->width * (size_t)p->height);
    copy.table = copied(p->table, (size_t)p->count * sizeof *p->table);
    for (int i = 0; i < p->count; i++)
        copy.table[i].rgba = copied(p->table[i].rgba, 4 * (size_t)(p->table[i].width * p->table[i].height));
    return palette_brdf(&copy);
}

/* The same painting in Lafortune maps of so many lobes, whatever it says itself. */
static int lobes_way(brdf **out, const char *path, int lobes, failure *f)
{
    sbrdf_field level;
    sbrdf_sources sources = {0};
    sbrdf_clamped clamped;
    sbrdf_quantised report;
    sbrdf_map map;
    int code = sbrdf_paint_lobes(&level, path, lobes, &sources, NULL, f);
    sbrdf_sources_free(&sources);
    if (code) return code;
    if (!(code = sbrdf_field_settle(&level, 1, &clamped, path, f))) {
        sbrdf_quantise(&level, 1, path, &map, &report);
        *out = sbrdf_map_brdf(&map);
    }
    sbrdf_field_free(&level);
    return code;
}

/* NULL without a failure: Lafortune maps can't be painted from index pictures. */
static int open_way(brdf **out, const palette *p, const char *path, int way, failure *f)
{
    *out = NULL;
    if (way < 2) {
        *out = palette_way(p, way);
        return FAIL_NONE;
    }
    int code = lobes_way(out, path, way - 1, f);
    if (code == FAIL_UNSUPPORTED) {
        f->code = FAIL_NONE;
        code = FAIL_NONE;
    }
    return code;
}

/* ---- pictures ------------------------------------------------------------------------------------------- */

static int draw(const brdf *b, const mesh *sphere, const palette *p, int frame, image_u8 *out, failure *f)
{
    const scene_camera camera = {.kind = SCENE_CAMERA_ORTHO};
    scene s;
    scene_begin(&s, sphere, SIDE, SIDE);
    s.exact_sphere = 1;
    s.exposure = pi * p->table[0].e;
    scene_add_light(&s, frame * step_deg, 0, NULL);
    int code = scene_aim(&s, &camera, f);
    return code ? code : scene_draw_double(&s, b, NULL, NULL, out, f);
}

/* Mean over covered pixels, and where inside (may be NULL) is not black. */
static double squared_error(const image_u8 *a, const image_u8 *b, const image_u8 *inside)
{
    double sum = 0, count = 0;
    for (size_t i = 0; i < 4 * (size_t)a->width * (size_t)a->height; i += 4) {
        if (!a->texel[i + 3] || (inside && !inside->texel[i])) continue;
        for (int c = 0; c < 3; c++) sum += pow(a->texel[i + (size_t)c] - b->texel[i + (size_t)c], 2);
        count += 3;
    }
    return count > 0 ? sum / count : 0;
}

static int draw_all(const brdf *b, const mesh *sphere, const palette *p, image_u8 picture[FRAMES], progress *meter,
                    failure *f)
{
    int code = FAIL_NONE;
    for (int i = 0; i < FRAMES && !code; i++) {
        code = draw(b, sphere, p, i, &picture[i], f);
        progress_add(meter, 1);
    }
    return code;
}

static void put_column(sheet *sh, int column, const image_u8 picture[FRAMES], const char *head)
{
    for (int i = 0; i < SHOWN; i++) sheet_place(sh, column, i, &picture[shown_frame[i]]);
    sheet_head(sh, column, head);
}

static void free_all(image_u8 picture[FRAMES])
{
    for (int i = 0; i < FRAMES; i++) image_u8_free(&picture[i]);
}

/* The painting's own pictures, and where they show no edges. */
typedef struct reference {
    image_u8 picture[FRAMES], inside;
} reference;

static palette_score score_of(const reference *truth, const image_u8 drawn[FRAMES])
{
    double sum = 0, inside = 0, worst = 0;
    for (int i = 0; i < FRAMES; i++) {
        const double error = squared_error(&truth->picture[i], &drawn[i], NULL);
        sum += error / FRAMES;
        inside += squared_error(&truth->picture[i], &drawn[i], &truth->inside) / FRAMES;
        worst = fmax(worst, error);
    }
    return (palette_score){metric_psnr(inside), metric_psnr(sum), metric_psnr(worst)};
}

static int draw_reference(reference *out, const char *path, const mesh *sphere, const palette *p, progress *meter,
                          failure *f)
{
    brdf *b;
    int code = open_truth(&b, path, f);
    if (code) return code;
    code = draw_all(b, sphere, p, out->picture, meter, f);
    b->eval_at = eval_inside;
    if (!code) code = draw(b, sphere, p, 0, &out->inside, f);
    brdf_close(b);
    return code;
}

/* One way: its pictures into the sheet and its score. */
static int judge(const palette *p, const char *path, int way, const mesh *sphere, const reference *truth,
                 palette_score *score, sheet *sh, progress *meter, failure *f)
{
    image_u8 drawn[FRAMES] = {{0}};
    brdf *b;
    int code = open_way(&b, p, path, way, f);
    if (code || !b) return code;
    code = draw_all(b, sphere, p, drawn, meter, f);
    if (!code) {
        char head[80];
        *score = score_of(truth, drawn);
        snprintf(head, sizeof head, "%s: %.1f dB", palette_way_names[way], score->inside_db);
        put_column(sh, 1 + way, drawn, head);
    }
    free_all(drawn);
    brdf_close(b);
    return code;
}

int palette_view(const palette *p, const char *path, palette_score score[PALETTE_WAYS], image_u8 *out, progress *meter,
                 failure *f)
{
    const sheet_layout layout = {.title = "A painting's own BRDFs, its palette of tables, and Lafortune maps",
                                 .columns = 1 + PALETTE_WAYS,
                                 .rows = SHOWN,
                                 .cell_width = SIDE,
                                 .cell_height = SIDE,
                                 .row_label_width = 110,
                                 .has_heads = 1};
    reference truth = {0};
    mesh sphere;
    int code = mesh_open(&sphere, "sphere", f);
    memset(score, 0, PALETTE_WAYS * sizeof *score);
    if (code) return code;
    sheet sh = sheet_begin(&layout);
    progress_begin(meter, "pictures", FRAMES * (1 + PALETTE_WAYS));
    code = draw_reference(&truth, path, &sphere, p, meter, f);
    if (!code) put_column(&sh, 0, truth.picture, "the BRDFs");
    for (int way = 0; way < PALETTE_WAYS && !code; way++)
        code = judge(p, path, way, &sphere, &truth, &score[way], &sh, meter, f);
    progress_end(meter);
    for (int i = 0; i < SHOWN; i++) {
        char label[40];
        snprintf(label, sizeof label, "light at\n%g deg", shown_frame[i] * step_deg);
        sheet_row_label(&sh, i, label);
    }
    free_all(truth.picture);
    image_u8_free(&truth.inside);
    mesh_free(&sphere);
    if (code) {
        sheet_free(&sh);
        return code;
    }
    *out = sh.picture;
    return FAIL_NONE;
}
