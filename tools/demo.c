/* SPDX-License-Identifier: MIT */
/*
 * The pictures of `make demo`, from nothing but what is built in: materials are baked to small files, and the runtime's
 * GLES shaders draw the files.
 *
 *   nacre-demo [DIRECTORY [egl2|egl3|osmesa|double]]       (out, the first of the three that this machine has)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "light_bake.h"
#include "palette.h"
#include "png_io.h"
#include "sbrdf_demo.h"
#include "sbrdf_paint.h"
#include "scene.h"
#include "sheet.h"
#include "sphere_bake.h"
#include "table_bake.h"

enum { SAMPLES = 3, BACKEND_DOUBLE = GL_BACKEND_COUNT, BACKEND_COUNT };
static const char *const backend_names[BACKEND_COUNT] = {"egl2", "egl3", "osmesa", "double"};

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))
#define PI           3.14159265358979323846

/* Irradiance pi: a white matt surface that faces the light is as bright as the paper is white. */
static const double daylight[3] = {PI, PI, PI};

/* ---- drawing one picture of a sheet -------------------------------------------------------------------------- */

typedef struct studio {
    const char *directory;
    int backend;
    scene_gles *gles; /* one context for all pictures of a size */
    int width, height;
} studio;

/* What leads from any error to the end of the program: one line. */
static void need(int code, const failure *f)
{
    if (!code) return;
    fprintf(stderr, "nacre-demo: %s\n", f->text);
    exit(code);
}

static void studio_size(studio *st, int width, int height)
{
    failure f = {0};

    st->width = width;
    st->height = height;
    scene_gles_close(st->gles);
    st->gles = NULL;
    if (st->backend != BACKEND_DOUBLE)
        need(scene_gles_open(&st->gles, (gl_backend)st->backend, width * SAMPLES, height * SAMPLES, &f), &f);
}

/* Draw SAMPLES times as large each way, take the means. */
static image_u8 draw(const studio *st, const scene *s, const scene_material *m)
{
    image_u8 frame, picture;
    failure f = {0};

    if (st->gles)
        need(scene_gles_draw(st->gles, s, &m->material, &frame, &f), &f);
    else
        need(scene_draw_double(s, m->reflectance, m->has_albedo ? m->albedo : NULL, NULL, &frame, &f), &f);
    scene_average(&frame, SAMPLES, s->output, &picture);
    image_u8_free(&frame);
    return picture;
}

static scene empty_scene(const studio *st, const mesh *shape, const scene_camera *camera, double exposure)
{
    failure f = {0};
    scene s;

    scene_begin(&s, shape, st->width * SAMPLES, st->height * SAMPLES);
    s.exposure = exposure;
    need(scene_aim(&s, camera, &f), &f);
    return s;
}

static void place(sheet *sh, int column, int row, image_u8 picture)
{
    sheet_place(sh, column, row, &picture);
    image_u8_free(&picture);
}

static void save(const studio *st, sheet *sh, const char *name)
{
    char path[1000];
    failure f = {0};

    snprintf(path, sizeof path, "%s/%s", st->directory, name);
    need(png_write(path, &sh->picture, &f), &f);
    printf("%s\n", path);
    sheet_free(sh);
}

/* ---- baking -------------------------------------------------------------------------------------------------- */

typedef struct sample { /* a material on the sheets */
    const char *brdf, *label;
} sample;

/* "sgd:gold-paint" and "table": DIRECTORY/assets/gold-paint.table.ktx2 */
static void asset_path(const studio *st, char *path, size_t size, const char *brdf_name, const char *kind)
{
    const char *name = strchr(brdf_name, ':');

    snprintf(path, size, "%s/assets/%s.%s.ktx2", st->directory, name ? name + 1 : brdf_name, kind);
}

static void write_asset(const char *path, bytes *file)
{
    failure f = {0};

    need(output_write(path, file, &f), &f);
    bytes_free(file);
}

/* nacre bake table BRDF -o FILE */
static void bake_table(const studio *st, const char *brdf_name)
{
    table_asset table;
    bytes file = {0};
    brdf *b;
    char path[1000];
    failure f = {0};

    need(brdf_open(&b, brdf_name, &f), &f);
    need(table_bake(&table, b, &(table_options){0}, &f), &f);
    table_write(&table, &file);
    asset_path(st, path, sizeof path, brdf_name, "table");
    write_asset(path, &file);
    table_free(&table);
    brdf_close(b);
}

/* nacre bake spheres BRDF --mode paper --polar 0,45,90,135 -o FILE */
static void bake_paper_spheres(const studio *st, const char *brdf_name, int step_deg, sphere_asset *spheres)
{
    sphere_options options = {.mode = SPHERE_PAPER};
    bytes file = {0};
    brdf *b;
    char path[1000];
    failure f = {0};

    while (step_deg * options.polar_count < 155) {
        options.polar[options.polar_count] = step_deg * options.polar_count;
        options.polar_count++;
    }
    need(brdf_open(&b, brdf_name, &f), &f);
    need(sphere_bake(spheres, b, &options, &f), &f);
    sphere_write(spheres, &file);
    asset_path(st, path, sizeof path, brdf_name, "spheres");
    write_asset(path, &file);
    brdf_close(b);
}

static void open_asset(const studio *st, scene_material *m, const char *brdf_name, const char *kind)
{
    char path[1000];
    failure f = {0};

    asset_path(st, path, sizeof path, brdf_name, kind);
    need(scene_material_open(m, path, st->backend == BACKEND_DOUBLE, &f), &f);
}

/* ---- sheet 1: many materials on spheres ------------------------------------------------------------------------ */

static const sample many[] = {
    {"sgd:gold-metallic-paint", "gold metallic paint"},
    {"sgd:gold-paint", "gold paint"},
    {"sgd:silver-metallic-paint", "silver metallic paint"},
    {"sgd:nickel", "nickel"},
    {"sgd:blue-metallic-paint", "blue metallic paint"},
    {"sgd:color-changing-paint1", "colour-shifting paint"},
    {"sgd:yellow-plastic", "yellow plastic"},
    {"sgd:red-phenolic", "red phenolic"},
    {"sgd:green-plastic", "green plastic"},
    {"sgd:blue-acrylic", "blue acrylic"},
    {"sgd:purple-paint", "purple paint"},
    {"sgd:orange-paint", "orange paint"},
    {"sgd:cherry-235", "cherry wood"},
    {"sgd:red-fabric", "red fabric"},
    {"sgd:white-marble", "white marble"},
    {"sgd:violet-rubber", "violet rubber"},
};

static void spheres_sheet(studio *st, const mesh *sphere)
{
    static const double polar_deg[4] = {0, 30, 60, 110};
    const sheet_layout layout = {.title = "16 materials of 2 KB each, light at four angles",
                                 .columns = 8,
                                 .rows = COUNT(many) / 2,
                                 .cell_width = 128,
                                 .cell_height = 128,
                                 .has_captions = 1,
                                 .has_heads = 1,
                                 .group = 4};
    const scene_camera camera = {.kind = SCENE_CAMERA_ORTHO, .margin = 0.01};
    sheet sh = sheet_begin(&layout);
    int i, k;

    studio_size(st, layout.cell_width, layout.cell_height);
    for (i = 0; i < COUNT(many); i++) {
        int column = 4 * (i % 2), row = i / 2;
        scene_material m;
        open_asset(st, &m, many[i].brdf, "table");
        for (k = 0; k < 4; k++) {
            scene s = empty_scene(st, sphere, &camera, 1.6);
            scene_add_light(&s, polar_deg[k], 30, daylight);
            place(&sh, column + k, row, draw(st, &s, &m));
        }
        sheet_group_caption(&sh, column, row, 4, many[i].label);
        scene_material_close(&m);
    }
    for (k = 0; k < 8; k++) {
        char head[40];
        snprintf(head, sizeof head, "%g deg", polar_deg[k % 4]);
        sheet_head(&sh, k, head);
    }
    save(st, &sh, "materials.png");
}

/* ---- sheets 2 and 3: whole objects ------------------------------------------------------------------------------ */

static const sample six[] = {
    {"sgd:gold-metallic-paint", "gold metallic paint"},
    {"sgd:nickel", "nickel"},
    {"sgd:blue-metallic-paint", "blue metallic paint"},
    {"sgd:yellow-plastic", "yellow plastic"},
    {"sgd:red-phenolic", "red phenolic"},
    {"sgd:white-marble", "white marble"},
};

static void key_light(scene *s)
{
    const double key[3] = {1.25 * PI, 1.22 * PI, 1.15 * PI};

    scene_add_light(s, 42, 130, key);
}

/* Key, a cool fill from the other side, a rim light behind, a warm one from below. */
static void four_lights(scene *s)
{
    const double fill[3] = {0.35 * PI, 0.42 * PI, 0.55 * PI}, rim[3] = {1.3 * PI, 1.3 * PI, 1.4 * PI};
    const double low[3] = {0.4 * PI, 0.3 * PI, 0.2 * PI};

    key_light(s);
    scene_add_light(s, 55, 15, fill);
    scene_add_light(s, 105, 60, rim);
    scene_add_light(s, 70, 240, low);
}

static void object_sheet(studio *st, const char *mesh_name, const scene_camera *camera, int cell_height,
                         const char *title, const char *file)
{
    const sheet_layout layout = {.title = title,
                                 .columns = COUNT(six),
                                 .rows = 2,
                                 .cell_width = 256,
                                 .cell_height = cell_height,
                                 .row_label_width = 140,
                                 .has_heads = 1};
    sheet sh = sheet_begin(&layout);
    mesh shape;
    failure f = {0};
    int i, row;

    need(mesh_open(&shape, mesh_name, &f), &f);
    studio_size(st, layout.cell_width, layout.cell_height);
    for (i = 0; i < COUNT(six); i++) {
        scene_material m;
        open_asset(st, &m, six[i].brdf, "table");
        for (row = 0; row < 2; row++) {
            scene s = empty_scene(st, &shape, camera, 1.4);
            if (row == 0)
                key_light(&s);
            else
                four_lights(&s);
            place(&sh, i, row, draw(st, &s, &m));
        }
        sheet_head(&sh, i, six[i].label);
        scene_material_close(&m);
    }
    sheet_row_label(&sh, 0, "one light");
    sheet_row_label(&sh, 1, "four lights");
    mesh_free(&shape);
    save(st, &sh, file);
}

/* ---- a photographed environment as many lights, through lit spheres ------------------------------------------- */

static void environment_sheet(studio *st, const char *map_path, const scene_camera *camera)
{
    const sheet_layout layout = {.title = "Six materials in a photographed studio: 512 lights, one fetch per pixel",
                                 .columns = COUNT(six),
                                 .rows = 3,
                                 .cell_width = 256,
                                 .cell_height = 160,
                                 .row_label_width = 150,
                                 .has_heads = 1};
    const light_options options = {.count = 512};
    sheet sh = sheet_begin(&layout);
    env_map map;
    light_set lights;
    mesh shape;
    failure f = {0};
    int i, row;

    need(env_map_open(&map, map_path, &f), &f);
    need(light_bake(&lights, NULL, &map, map_path, &options, &f), &f);
    need(mesh_open(&shape, "teapot", &f), &f);
    studio_size(st, layout.cell_width, layout.cell_height);
    for (i = 0; i < COUNT(six); i++) {
        scene_material m;
        open_asset(st, &m, six[i].brdf, "table");
        for (row = 0; row < layout.rows; row++) {
            scene s = empty_scene(st, &shape, camera, 0.8);
            s.distant = &lights;
            s.lit_size = 256;
            place(&sh, i, row, draw(st, &s, &m));
            light_set_turn(&lights, 120); /* three times: as before for the next material */
        }
        sheet_head(&sh, i, six[i].label);
        scene_material_close(&m);
    }
    sheet_row_label(&sh, 0, "as it is");
    sheet_row_label(&sh, 1, "turned by\n120 degrees");
    sheet_row_label(&sh, 2, "turned by\n240 degrees");
    mesh_free(&shape);
    light_set_free(&lights);
    env_map_free(&map);
    save(st, &sh, "environment.png");
}

/* ---- the figures of Mihalik & Durikovic 2015 --------------------------------------------------------------------- */

static scene lone_sphere(const studio *st, const mesh *sphere, double polar_deg, double exposure)
{
    const scene_camera camera = {.kind = SCENE_CAMERA_ORTHO};
    scene s = empty_scene(st, sphere, &camera, exposure);

    scene_add_light(&s, polar_deg, 0, daylight);
    return s;
}

/* Figure 3: the acquired images, drawn at the light angles they were stored for. */
static void figure_3(studio *st, const mesh *sphere, const sample material[2], const sphere_asset spheres[2])
{
    const sheet_layout layout = {.title = "Mihalik & Durikovic 2015, figure 3: acquired spheres",
                                 .columns = 6,
                                 .rows = 2,
                                 .cell_width = 192,
                                 .cell_height = 192,
                                 .row_label_width = 190,
                                 .has_captions = 1};
    sheet sh = sheet_begin(&layout);
    int row, k;

    studio_size(st, layout.cell_width, layout.cell_height);
    for (row = 0; row < 2; row++) {
        scene_material m;
        open_asset(st, &m, material[row].brdf, "spheres");
        for (k = 0; k < spheres[row].layers; k++) {
            scene s = lone_sphere(st, sphere, spheres[row].polar[k], spheres[row].scale[0]);
            char caption[40];
            snprintf(caption, sizeof caption, "%.0f deg", spheres[row].polar[k]);
            place(&sh, k, row, draw(st, &s, &m));
            sheet_caption(&sh, k, row, caption);
        }
        sheet_row_label(&sh, row, material[row].label);
        scene_material_close(&m);
    }
    save(st, &sh, "paper002-figure3.png");
}

/* One sphere of figure 4 by the decoder in double, which knows the variants that the paper rejects. */
static image_u8 rejected(const scene *s, const sphere_asset *spheres, double k, double shrink)
{
    const sphere_decode_options options = {.k = k, .shrink = shrink};
    brdf *b = sphere_brdf(spheres, &options);
    image_u8 frame, picture;
    failure f = {0};

    need(scene_draw_double(s, b, spheres->albedo, NULL, &frame, &f), &f);
    scene_average(&frame, SAMPLES, s->output, &picture);
    image_u8_free(&frame);
    brdf_close(b);
    return picture;
}

/* Figure 4: light at 60 degrees between images of 45 and 90. */
static void figure_4(studio *st, const mesh *sphere, const sample *material, const sphere_asset *spheres)
{
    static const char *const caption[] = {"a: k = 1", "b: k = 1/2", "c: equation 4", "d: no 0.995", "the BRDF itself"};
    const sheet_layout layout = {.title =
                                     "Mihalik & Durikovic 2015, figure 4: light at 60 degrees, images at 45 and 90",
                                 .columns = COUNT(caption),
                                 .rows = 1,
                                 .cell_width = 256,
                                 .cell_height = 256,
                                 .has_captions = 1};
    sheet sh = sheet_begin(&layout);
    scene_material m;
    brdf *exact;
    scene s;
    image_u8 frame, picture;
    failure f = {0};
    int i;

    studio_size(st, layout.cell_width, layout.cell_height);
    open_asset(st, &m, material->brdf, "spheres");
    s = lone_sphere(st, sphere, 60, spheres->scale[0]);
    place(&sh, 0, 0, rejected(&s, spheres, 1, 0));
    place(&sh, 1, 0, rejected(&s, spheres, 0.5, 0));
    place(&sh, 2, 0, draw(st, &s, &m));
    place(&sh, 3, 0, rejected(&s, spheres, 0, 1));
    need(brdf_open(&exact, material->brdf, &f), &f);
    need(scene_draw_double(&s, exact, NULL, NULL, &frame, &f), &f);
    scene_average(&frame, SAMPLES, s.output, &picture);
    place(&sh, 4, 0, picture);
    for (i = 0; i < COUNT(caption); i++) sheet_caption(&sh, i, 0, caption[i]);
    image_u8_free(&frame);
    brdf_close(exact);
    scene_material_close(&m);
    save(st, &sh, "paper002-figure4.png");
}

static void paper_figures(studio *st, const mesh *sphere)
{
    static const sample material[2] = {{"sgd:yellow-plastic", "yellow plastic"},
                                       {"sgd:color-changing-paint1", "colour-shifting\npaint"}};
    sphere_asset spheres[2];

    bake_paper_spheres(st, material[0].brdf, 45, &spheres[0]);
    bake_paper_spheres(st, material[1].brdf, 30, &spheres[1]);
    figure_3(st, sphere, material, spheres);
    figure_4(st, sphere, &material[0], &spheres[0]);
    sphere_free(&spheres[0]);
    sphere_free(&spheres[1]);
}

/* ---- materials that vary, after McAllister et al. 2002 -------------------------------------------------------- */

/* Paint one of the built-in paintings; DIRECTORY/assets/NAME-albedo.ktx2 and NAME-lobes.ktx2. */
static sbrdf_map bake_painting(const studio *st, int index)
{
    char path[1000];
    sbrdf_field level;
    sbrdf_sources sources = {0};
    sbrdf_clamped clamped;
    sbrdf_quantised report;
    sbrdf_map map;
    bytes file[2] = {{0}};
    failure f = {0};
    int i;

    snprintf(path, sizeof path, "%s/assets", st->directory);
    need(sbrdf_demo_write(index, path, &f), &f);
    snprintf(path, sizeof path, "%s/assets/%s.txt", st->directory, sbrdf_demo_name(index));
    need(sbrdf_paint(&level, path, &sources, NULL, &f), &f);
    sbrdf_sources_free(&sources);
    need(sbrdf_field_settle(&level, 1, &clamped, path, &f), &f);
    sbrdf_quantise(&level, 1, sbrdf_demo_name(index), &map, &report); /* pictures show texels larger than life */
    sbrdf_field_free(&level);
    sbrdf_map_write(&map, &file[0], &file[1]);
    for (i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/assets/%s-%s.ktx2", st->directory, sbrdf_demo_name(index),
                 i ? "lobes" : "albedo");
        write_asset(path, &file[i]);
    }
    return map;
}

/* Three channels of a map's codes from the given one on, or one of them as grey. */
static image_u8 codes_picture(const sbrdf_map *m, const uint8_t *codes, int channel)
{
    image_u8 picture = image_u8_make(m->width, m->height, 4);
    size_t i, count = (size_t)m->width * (size_t)m->height;

    for (i = 0; i < 4 * count; i++)
        picture.texel[i] = i % 4 == 3 ? 255 : codes[channel < 0 ? i : i - i % 4 + (size_t)channel];
    return picture;
}

static void sbrdf_figure_1(studio *st, const sbrdf_map *m)
{
    static const char *const heads[] = {"diffuse albedo", "lobe albedo", "lobe shape Cx Cy Cz", "exponent"};
    const sheet_layout layout = {.title = "Parameter maps of twelve materials in one: every texel a BRDF",
                                 .columns = 4,
                                 .rows = 1,
                                 .cell_width = SBRDF_DEMO_SIDE,
                                 .cell_height = SBRDF_DEMO_SIDE,
                                 .has_heads = 1};
    sheet sh = sheet_begin(&layout);
    const size_t layer = 4 * (size_t)m->width * (size_t)m->height;
    int i;

    place(&sh, 0, 0, codes_picture(m, m->albedo[0], -1));
    place(&sh, 1, 0, codes_picture(m, m->lobe[0], -1));
    place(&sh, 2, 0, codes_picture(m, m->lobe[0] + layer, -1));
    place(&sh, 3, 0, codes_picture(m, m->lobe[0] + layer, 3));
    for (i = 0; i < 4; i++) sheet_head(&sh, i, heads[i]);
    save(st, &sh, "paper000-figure1.png");
}

static void open_painting(const studio *st, scene_material *m, const char *name)
{
    char text[2200];
    failure f = {0};

    snprintf(text, sizeof text, "albedo=%s/assets/%s-albedo.ktx2,lobes=%s/assets/%s-lobes.ktx2", st->directory, name,
             st->directory, name);
    need(scene_material_open(m, text, st->backend == BACKEND_DOUBLE, &f), &f);
}

/* nacre bake palette PAINTING.txt --blend -o NAME.ktx2, opened. */
static void open_palette(const studio *st, scene_material *m, const char *name)
{
    static const char *const parts[] = {"palette", "index"};
    sbrdf_sources sources = {0};
    bytes file[2] = {{0}};
    palette p;
    char path[1000], text[2200] = "";
    failure f = {0};
    int i;

    snprintf(path, sizeof path, "%s/assets/%s.txt", st->directory, name);
    need(palette_bake(&p, path, &(palette_options){.blend = 1, .no_mips = 1}, &sources, &f), &f);
    sbrdf_sources_free(&sources);
    palette_write(&p, &file[0], &file[1]);
    palette_free(&p);
    for (i = 0; i < 2; i++) {
        size_t used = strlen(text);
        snprintf(path, sizeof path, "%s/assets/%s-%s.ktx2", st->directory, name, parts[i]);
        write_asset(path, &file[i]);
        snprintf(text + used, sizeof text - used, "%s%s=%s", i ? "," : "", parts[i], path);
    }
    need(scene_material_open(m, text, st->backend == BACKEND_DOUBLE, &f), &f);
}

/* Turn a mesh that faces +z about that axis. */
static void turn_mesh(mesh *m, double degrees)
{
    const float c = (float)cos(degrees * PI / 180), s = (float)sin(degrees * PI / 180);
    int i;

    for (i = 0; i < m->vertex_count; i++) {
        float *const vectors[] = {m->position[i], m->normal[i], m->tangent[i]};
        size_t k;
        for (k = 0; k < COUNT(vectors); k++) {
            const float x = vectors[k][0], y = vectors[k][1];
            vectors[k][0] = c * x - s * y;
            vectors[k][1] = s * x + c * y;
        }
    }
}

/* A sheet of the material lies flat and is turned under one low light that comes towards the eye. */
static void turned_figure(studio *st)
{
    static const char *const names[] = {"upholstery", "brushed-metal"};
    static const char *const labels[] = {"upholstery:\ntwo lobes", "brushed metal:\nthree lobes"};
    static const int turned[] = {0, 30, 60, 90};
    const sheet_layout layout = {.title = "Anisotropic lobes: one sheet, turned under a light that stays",
                                 .columns = COUNT(turned),
                                 .rows = COUNT(names),
                                 .cell_width = 320,
                                 .cell_height = 240,
                                 .row_label_width = 170,
                                 .has_heads = 1};
    const scene_camera camera = {.pitch_deg = -42};
    sheet sh = sheet_begin(&layout);
    failure f = {0};
    int row, i;

    studio_size(st, layout.cell_width, layout.cell_height);
    for (row = 0; row < COUNT(names); row++) {
        scene_material m;
        open_painting(st, &m, names[row]);
        for (i = 0; i < COUNT(turned); i++) {
            static const double power[3] = {3.4, 3.3, 3.1}, fill[3] = {0.5, 0.55, 0.65};
            mesh plane;
            scene s;
            need(mesh_open(&plane, "plane", &f), &f);
            turn_mesh(&plane, turned[i]);
            s = empty_scene(st, &plane, &camera, row ? 0.9 : 1.4);
            scene_add_light(&s, 76, 90, power);
            scene_add_light(&s, 40, 200, fill);
            place(&sh, i, row, draw(st, &s, &m));
            mesh_free(&plane);
        }
        scene_material_close(&m);
        sheet_row_label(&sh, row, labels[row]);
    }
    for (i = 0; i < COUNT(turned); i++) {
        char head[40];
        snprintf(head, sizeof head, turned[i] ? "turned by %d degrees" : "threads and strokes across", turned[i]);
        sheet_head(&sh, i, head);
    }
    save(st, &sh, "paper000-figure5-turned.png");
}

/* One column of figure 5. */
static void sbrdf_column(studio *st, sheet *sh, int column, const char *head, const scene_material *m)
{
    static const char *const shapes[] = {"sphere", "sphere", "torus"};
    failure f = {0};
    int row;

    for (row = 0; row < COUNT(shapes); row++) {
        const scene_camera camera = {.yaw_deg = row == 1 ? 30 : 0, .pitch_deg = row == 2 ? 35 : 12};
        mesh shape;
        scene s;
        need(mesh_open(&shape, shapes[row], &f), &f);
        s = empty_scene(st, &shape, &camera, 1.4);
        if (row < 2)
            key_light(&s);
        else
            four_lights(&s);
        place(sh, column, row, draw(st, &s, m));
        mesh_free(&shape);
    }
    sheet_head(sh, column, head);
}

static void sbrdf_figures(studio *st)
{
    static const char *const labels[] = {"sphere", "turned by\n30 degrees", "torus,\nfour lights"};
    const sheet_layout layout = {.title = "Materials that vary over the surface: Lafortune lobes per texel, 8-bit maps",
                                 .columns = SBRDF_DEMO_COUNT + 1,
                                 .rows = COUNT(labels),
                                 .cell_width = 224,
                                 .cell_height = 224,
                                 .row_label_width = 150,
                                 .has_heads = 1};
    sheet sh = sheet_begin(&layout);
    scene_material m;
    int i, row, column = 0;

    for (i = 0; i < SBRDF_DEMO_COUNT; i++) {
        const char *const name = sbrdf_demo_name(i);
        sbrdf_map map = bake_painting(st, i);
        const int composite = !strcmp(name, "composite");
        if (composite) sbrdf_figure_1(st, &map);
        sbrdf_map_free(&map);
        studio_size(st, layout.cell_width, layout.cell_height);
        open_painting(st, &m, name);
        sbrdf_column(st, &sh, column++, name, &m);
        scene_material_close(&m);
        if (!composite) continue;
        open_palette(st, &m, name);
        sbrdf_column(st, &sh, column++, "the same: palette", &m);
        scene_material_close(&m);
    }
    for (row = 0; row < COUNT(labels); row++) sheet_row_label(&sh, row, labels[row]);
    save(st, &sh, "paper000-figure5.png");
    turned_figure(st);
}

/* ---- the program ------------------------------------------------------------------------------------------------- */

static void make_directory(const char *directory)
{
    char path[1000];

    mkdir(directory, 0777);
    snprintf(path, sizeof path, "%s/assets", directory);
    mkdir(path, 0777);
}

/* The named backend, or the first that this machine has. */
static int pick_backend(const char *name)
{
    failure f = {0};
    int i;

    for (i = 0; i < BACKEND_COUNT; i++) {
        scene_gles *g;
        if (name && strcmp(name, backend_names[i])) continue;
        if (i == BACKEND_DOUBLE && name) return i;
        if (i == BACKEND_DOUBLE) break;
        if (scene_gles_open(&g, (gl_backend)i, 16, 16, &f)) continue;
        printf("drawing with %s: %s\n", backend_names[i], scene_gles_description(g));
        scene_gles_close(g);
        return i;
    }
    if (!f.code) fail(&f, FAIL_USAGE, "%s: unknown backend, expected egl2, egl3, osmesa or double", name ? name : "");
    need(f.code, &f);
    return BACKEND_DOUBLE;
}

int main(int argc, char **argv)
{
    const scene_camera above = {.yaw_deg = 25, .pitch_deg = 22}, front = {.yaw_deg = 0, .pitch_deg = 8};
    const char *const bunny = "fixtures/in/bunny.obj", *const studio_map = "fixtures/in/studio.hdr";
    studio st = {.directory = argc > 1 ? argv[1] : "out"};
    mesh sphere;
    failure f = {0};
    int i;

    st.backend = pick_backend(argc > 2 ? argv[2] : NULL);
    make_directory(st.directory);
    for (i = 0; i < COUNT(many); i++) bake_table(&st, many[i].brdf);
    need(mesh_open(&sphere, "sphere", &f), &f);
    spheres_sheet(&st, &sphere);
    object_sheet(&st, "teapot", &above, 160, "Six materials on the teapot", "teapot.png");
    if (access(bunny, R_OK) == 0)
        object_sheet(&st, bunny, &front, 256, "Six materials on the bunny", "bunny.png");
    else
        object_sheet(&st, "torus", &above, 256, "Six materials on the torus", "torus.png");
    if (access(studio_map, R_OK) == 0) environment_sheet(&st, studio_map, &above);
    paper_figures(&st, &sphere);
    sbrdf_figures(&st);
    scene_gles_close(st.gles);
    mesh_free(&sphere);
    return 0;
}
