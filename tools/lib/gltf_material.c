/* SPDX-License-Identifier: MIT */
#include "gltf_material.h"

#include <assimp/cimport.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "apart.h"
#include "pixels.h"

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#include <stb_image.h>

enum { BASE, METAL_ROUGH, NORMAL, PICTURES, MOST_EMBEDDED = 64 << 20 };

/* What the loader's process answers; embedded pictures follow it. */
typedef struct reply {
    int code;
    char text[400];
    float base[4], metal, rough, normal_scale;
    char file[PICTURES][512]; /* as the file has it; empty: none, or embedded */
    unsigned embedded[PICTURES];
} reply;

/* ---- in the loader's process ------------------------------------------------------------------------- */

static void find_picture(const struct aiScene *scene, const struct aiMaterial *m, enum aiTextureType type, int which,
                         reply *r, const struct aiTexture **embedded)
{
    struct aiString path;
    if (aiGetMaterialTexture(m, type, 0, &path, NULL, NULL, NULL, NULL, NULL, NULL) != aiReturn_SUCCESS) return;
    unsigned index = path.data[0] == '*' ? (unsigned)atoi(path.data + 1) : scene->mNumTextures;
    if (path.data[0] != '*') {
        snprintf(r->file[which], sizeof r->file[which], "%.511s", path.data);
        return;
    }
    if (index >= scene->mNumTextures || scene->mTextures[index]->mHeight) return;
    embedded[which] = scene->mTextures[index];
    r->embedded[which] = embedded[which]->mWidth;
}

static void read_factors(const struct aiMaterial *m, reply *r)
{
    struct aiColor4D base = {1, 1, 1, 1};
    ai_real value;
    aiGetMaterialColor(m, AI_MATKEY_BASE_COLOR, &base);
    r->base[0] = base.r;
    r->base[1] = base.g;
    r->base[2] = base.b;
    r->base[3] = base.a;
    r->metal = r->rough = r->normal_scale = 1;
    if (aiGetMaterialFloat(m, AI_MATKEY_METALLIC_FACTOR, &value) == aiReturn_SUCCESS) r->metal = value;
    if (aiGetMaterialFloat(m, AI_MATKEY_ROUGHNESS_FACTOR, &value) == aiReturn_SUCCESS) r->rough = value;
    if (aiGetMaterialFloat(m, "$tex.scale", aiTextureType_NORMALS, 0, &value) == aiReturn_SUCCESS)
        r->normal_scale = value;
}

static const char *wanted_material; /* handed to the loader's process, which is a copy of this one */

/* The importer has materials in the order in which meshes use them. */
static int find_material(const struct aiScene *scene)
{
    struct aiString name;
    for (unsigned i = 0; i < scene->mNumMaterials; i++) {
        if (!wanted_material) return (int)i;
        if (aiGetMaterialString(scene->mMaterials[i], AI_MATKEY_NAME, &name) == aiReturn_SUCCESS &&
            !strcmp(name.data, wanted_material))
            return (int)i;
    }
    return -1;
}

static int reply_with_material(int fd, const char *path)
{
    const struct aiTexture *embedded[PICTURES] = {NULL, NULL, NULL};
    reply r = {0};
    const struct aiScene *scene = aiImportFile(path, 0);
    if (!scene) {
        r.code = FAIL_INVALID;
        snprintf(r.text, sizeof r.text, "not a glTF file that can be read: %.300s", aiGetErrorString());
        for (char *c = r.text; *c; c++)
            if ((unsigned char)*c < ' ') *c = ' ';
    } else if (find_material(scene) < 0) {
        r.code = FAIL_INVALID;
        snprintf(r.text, sizeof r.text, "found %u materials, none named %.200s", scene->mNumMaterials, wanted_material);
    } else {
        const struct aiMaterial *m = scene->mMaterials[find_material(scene)];
        read_factors(m, &r);
        find_picture(scene, m, aiTextureType_BASE_COLOR, BASE, &r, embedded);
        if (!r.file[BASE][0] && !embedded[BASE]) find_picture(scene, m, aiTextureType_DIFFUSE, BASE, &r, embedded);
        find_picture(scene, m, aiTextureType_UNKNOWN, METAL_ROUGH, &r, embedded);
        find_picture(scene, m, aiTextureType_NORMALS, NORMAL, &r, embedded);
    }
    int bad = apart_write(fd, &r, sizeof r);
    for (int k = 0; k < PICTURES && !bad; k++)
        if (embedded[k]) bad = apart_write(fd, embedded[k]->pcData, embedded[k]->mWidth);
    return bad;
}

/* ---- pictures ---------------------------------------------------------------------------------------- */

typedef struct material {
    reply r;
    image_u8 picture[PICTURES];
} material;

static int decode(image_u8 *out, const uint8_t *data, size_t size, const char *name, failure *f)
{
    int width, height, channels;
    uint8_t *texels =
        size <= MOST_EMBEDDED ? stbi_load_from_memory(data, (int)size, &width, &height, &channels, 4) : NULL;
    if (!texels)
        return fail(f, FAIL_INVALID, "%s: not a picture that can be read: %s", name,
                    size > MOST_EMBEDDED ? "too large" : stbi_failure_reason());
    *out = image_u8_make(width, height, 4);
    memcpy(out->texel, texels, (size_t)width * (size_t)height * 4);
    stbi_image_free(texels);
    return FAIL_NONE;
}

static int open_file(material *m, int which, const char *path, sbrdf_sources *sources, failure *f)
{
    char name[1400];
    bytes file = {0};
    const char *slash = strrchr(path, '/');
    snprintf(name, sizeof name, "%.*s%s", slash && m->r.file[which][0] != '/' ? (int)(slash - path + 1) : 0, path,
             m->r.file[which]);
    int code = file_read(&file, name, f);
    if (!code) code = decode(&m->picture[which], file.data, file.size, name, f);
    if (!code) sbrdf_sources_add(sources, name);
    bytes_free(&file);
    return code;
}

static int open_embedded(material *m, int which, int fd, const char *path, failure *f)
{
    size_t size = m->r.embedded[which];
    uint8_t *data = need_memory(size, 1);
    int code = apart_read(fd, data, size) ? fail(f, FAIL_INTERNAL, "%s: glTF loader: short reply", path)
                                          : decode(&m->picture[which], data, size, path, f);
    free(data);
    return code;
}

static int open_material(material *m, const char *path, const char *name, sbrdf_sources *sources, failure *f)
{
    int fd;
    wanted_material = name;
    int code = apart_run(reply_with_material, path, "glTF file", &fd, f);
    if (code) return code;
    if (apart_read(fd, &m->r, sizeof m->r)) code = fail(f, FAIL_INTERNAL, "%s: glTF loader: short reply", path);
    if (!code && m->r.code) code = fail(f, m->r.code, "%s: %s", path, m->r.text);
    for (int k = 0; k < PICTURES && !code; k++)
        if (m->r.embedded[k]) code = open_embedded(m, k, fd, path, f);
    close(fd);
    for (int k = 0; k < PICTURES && !code; k++)
        if (m->r.file[k][0]) code = open_file(m, k, path, sources, f);
    return code;
}

static void close_material(material *m)
{
    for (int k = 0; k < PICTURES; k++) image_u8_free(&m->picture[k]);
}

/* ---- fitting ----------------------------------------------------------------------------------------- */

/* What one texel is made of: linear base colour, metallic, roughness. */
typedef struct surface {
    double base[3], alpha, metal, rough;
} surface;

static surface surface_at(const material *m, long i)
{
    const image_u8 *base = &m->picture[BASE], *other = &m->picture[METAL_ROUGH];
    surface s = {.alpha = m->r.base[3], .metal = m->r.metal, .rough = m->r.rough};
    for (int c = 0; c < 3; c++)
        s.base[c] = m->r.base[c] * (base->texel ? srgb_decode(base->texel[4 * i + c] / 255.0) : 1);
    if (base->texel) s.alpha *= base->texel[4 * i + 3] / 255.0;
    if (other->texel) {
        s.rough *= other->texel[4 * i + 1] / 255.0;
        s.metal *= other->texel[4 * i + 2] / 255.0;
    }
    s.rough = fmin(fmax(s.rough, 0.05), 1);
    s.metal = fmin(fmax(s.metal, 0), 1);
    return s;
}

/* Shapes are fitted per kind: roughness, metal and the base's lightness in steps; albedos per texel. */
enum { ROUGH_STEPS = 64, METAL_STEPS = 8, LIGHT_STEPS = 8, KINDS = ROUGH_STEPS * METAL_STEPS * LIGHT_STEPS };

static int step_of(double x, int steps)
{
    return (int)fmin(floor(x * steps), steps - 1);
}

static int kind_of(const surface *s)
{
    double light = sqrt(fmin(fmax(fmax(s->base[0], s->base[1]), s->base[2]), 1));
    return (step_of(s->rough, ROUGH_STEPS) * METAL_STEPS + step_of(s->metal, METAL_STEPS)) * LIGHT_STEPS +
           step_of(light, LIGHT_STEPS);
}

/* f_r over the pairs: models.c's ggx, which is glTF's appendix B with correlated shadowing. */
static int evaluate(const surface *s, lafortune_pairs *p, failure *f)
{
    char text[200];
    brdf *b;
    snprintf(text, sizeof text, "ggx:rough=%.6f,f0=.04,metal=%.6f,albedo=%.6f/%.6f/%.6f", s->rough, s->metal,
             fmin(s->base[0], 1), fmin(s->base[1], 1), fmin(s->base[2], 1));
    int code = brdf_open(&b, text, f);
    if (code) return code;
    for (int i = 0; i < p->samples.count; i++) b->eval(b, p->direction[i], p->direction[i] + 3, p->value + 3 * i);
    brdf_close(b);
    return FAIL_NONE;
}

typedef struct kind {
    int seen;
    surface first; /* the first texel of the kind stands for it */
    lafortune_shared fit;
    double error;
} kind;

typedef struct worker {
    lafortune_pairs pairs;
    lafortune_problem *problem;
    failure f;
} worker;

static void worker_make(worker *w, int lobes)
{
    const lafortune_options options = {.n_min = SBRDF_EXPONENT_LEAST,
                                       .n_max = SBRDF_EXPONENT_MOST,
                                       .grazing_max = SBRDF_GRAZING_MAX,
                                       .tolerance = 1e-5,
                                       .starts = 3,
                                       .evaluations = 60};
    w->pairs = lafortune_pairs_make(LAFORTUNE_COARSE, 0);
    w->problem = lafortune_problem_make(&w->pairs.samples, 3, lobes, &options);
    w->f = (failure){0};
}

static void worker_free(worker *w)
{
    lafortune_problem_free(w->problem);
    lafortune_pairs_free(&w->pairs);
}

/* From n = .70 / alpha^2 in the mirror direction (for a further lobe, half and twice that), and from the solver's grid. */
static void fit_kind(worker *w, int lobes, kind *k)
{
    lafortune_shared start = {.lobes = lobes};
    double alpha = k->first.rough * k->first.rough, n = 0.70 / (alpha * alpha);
    evaluate(&k->first, &w->pairs, &w->f);
    for (int j = 0; j < lobes; j++)
        start.lobe[j] = (lafortune_shared_lobe){{-1, -1, 1}, fmin(n * pow(3, 1 - j), 255), {1, 1, 1}};
    k->error = lafortune_refine(w->problem, w->pairs.value, &start);
    k->fit = start;
    double error = lafortune_solve(w->problem, w->pairs.value, lobes, &start, NULL);
    if (!(error < k->error)) return;
    k->error = error;
    k->fit = start;
}

static void fit_texel(worker *w, const material *m, const kind *kinds, long i, sbrdf_texel *out)
{
    surface s = surface_at(m, i);
    evaluate(&s, &w->pairs, &w->f);
    out->brdf = kinds[kind_of(&s)].fit;
    lafortune_albedos(w->problem, w->pairs.value, &out->brdf);
    out->alpha = fmin(fmax(s.alpha, 0), 1);
}

static void find_kinds(const material *m, const sbrdf_field *out, kind *kinds)
{
    for (long i = 0; i < (long)out->width * out->height; i++) {
        surface s = surface_at(m, i);
        kind *k = &kinds[kind_of(&s)];
        if (!k->seen) k->first = s;
        k->seen = 1;
    }
}

static void report_kinds(const kind *kinds, gltf_report *report)
{
    double sum = 0;
    for (int k = 0; k < KINDS; k++) {
        if (!kinds[k].seen) continue;
        report->kinds++;
        sum += kinds[k].error * kinds[k].error;
        report->worst_error = fmax(report->worst_error, kinds[k].error);
    }
    report->mean_error = report->kinds ? sqrt(sum / report->kinds) : 0;
}

static void fit_all(const material *m, int lobes, sbrdf_field *out, gltf_report *report, progress *meter)
{
    kind *kinds = need_memory(KINDS, sizeof *kinds);
    memset(kinds, 0, KINDS * sizeof *kinds);
    find_kinds(m, out, kinds);
    progress_begin(meter, "rows", out->height);
#pragma omp parallel
    {
        worker w;
        worker_make(&w, lobes);
#pragma omp for schedule(dynamic, 1)
        for (int k = 0; k < KINDS; k++)
            if (kinds[k].seen) fit_kind(&w, lobes, &kinds[k]);
#pragma omp for schedule(dynamic, 1)
        for (int y = 0; y < out->height; y++) {
            for (long i = (long)y * out->width; i < (long)(y + 1) * out->width; i++)
                fit_texel(&w, m, kinds, i, &out->texel[i]);
            progress_add(meter, 1);
        }
        worker_free(&w);
    }
    progress_end(meter);
    report_kinds(kinds, report);
    free(kinds);
}

/* The pictures' common size; 1 x 1 without any. */
static int common_size(const material *m, const char *path, int *width, int *height, failure *f)
{
    const image_u8 *base = &m->picture[BASE], *other = &m->picture[METAL_ROUGH];
    const image_u8 *one = base->texel ? base : other;
    *width = one->texel ? one->width : 1;
    *height = one->texel ? one->height : 1;
    if (!base->texel || !other->texel || (base->width == other->width && base->height == other->height))
        return FAIL_NONE;
    return fail(f, FAIL_INVALID, "%s: metallic-roughness: found %d x %d texels, expected %d x %d as the base colour's",
                path, other->width, other->height, base->width, base->height);
}

int gltf_material_read(sbrdf_field *out, const char *path, const char *name, int lobes, sbrdf_sources *sources,
                       gltf_report *report, progress *meter, failure *f)
{
    material m = {0};
    int width, height, code = open_material(&m, path, name, sources, f);
    memset(report, 0, sizeof *report);
    if (!code) code = common_size(&m, path, &width, &height, f);
    if (!code) {
        report->normal_map = m.picture[NORMAL];
        report->normal_scale = m.r.normal_scale;
        m.picture[NORMAL] = (image_u8){0};
        *out = sbrdf_field_make(width, height, lobes, 0);
        fit_all(&m, lobes, out, report, meter);
    }
    close_material(&m);
    return code;
}
