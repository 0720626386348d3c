/* SPDX-License-Identifier: MIT */
#include "key.h"

#include <string.h>

/* shaders_gles/ as byte arrays, made by tools/gen/embed. */
extern const unsigned char embedded_common_glsl[], embedded_table_glsl[], embedded_spheres_glsl[],
    embedded_sbrdf_glsl[];
extern const unsigned char embedded_frame_vert[], embedded_frame_frag[], embedded_lit_frag[];
extern const unsigned long embedded_common_glsl_size, embedded_table_glsl_size, embedded_spheres_glsl_size,
    embedded_sbrdf_glsl_size;
extern const unsigned long embedded_frame_vert_size, embedded_frame_frag_size, embedded_lit_frag_size;

/* ES 2.0 minimum. */
#define UNITS SHADE_MAX_UNITS

int gles_key_is_table(const gles_key *key)
{
    return key->model == GLES_KEY_TABLE || key->model == GLES_KEY_FINE || key->model == GLES_KEY_EARLY ||
           key->model == GLES_KEY_PALETTE;
}

static int is_palette(const gles_key *key)
{
    return key->model == GLES_KEY_PALETTE;
}

static int is_sbrdf(const gles_key *key)
{
    return key->model == GLES_KEY_SBRDF;
}

static int is_lit(const gles_key *key)
{
    return key->model == GLES_KEY_LIT;
}

/* ---- small texts --------------------------------------------------------------------------------- */

static char *put(char *out, const char *text)
{
    while (*text) *out++ = *text++;
    *out = 0;
    return out;
}

static char *put_digit(char *out, unsigned digit)
{
    *out++ = (char)('0' + digit);
    *out = 0;
    return out;
}

void gles_key_name(const gles_key *key, char *out)
{
    static const char *const model[] = {"table",   "fine",  "early",   "spheres", "paper",
                                        "quarter", "sbrdf", "palette", "lit"};
    static const char *const output[] = {"_srgb", "_sqrt", "_lin"};
    static const char *const mask[] = {"", "_mask", "_mix"};

    if (key->es3) out = put(out, "es3_");
    if (key->sphere) out = put(out, "sphere_");
    out = put(out, model[key->model]);
    if (is_lit(key)) {
        put(put(out, mask[key->mask]), key->normal_map ? "_nm" : "");
        return;
    }
    if (key->model == GLES_KEY_TABLE && key->phid) out = put(out, "_phid");
    if (key->blend) out = put(out, "_blend");
    if (key->lobes) out = put_digit(put(out, key->power ? "_table_k" : "_pow_k"), key->lobes);
    out = put_digit(put(out, "_l"), key->lights);
    out = put(out, key->persp ? "_persp" : "_dist");
    out = put(out, output[key->output]);
    if (key->normal_map) out = put(out, "_nm");
    if (key->ambient) out = put(out, "_amb");
    if (key->direction) out = put(out, key->direction > 1 ? "_dir2" : "_dir");
    if (key->no_diffuse) out = put(out, "_lobes");
    if (key->layers && key->layers != (key->model == GLES_KEY_QUARTER ? 2 : 4))
        out = put_digit(put(out, "_s"), key->layers);
    if (key->pass) out = put_digit(put(out, "_pass"), key->pass);
    if (key->toe) out = put(out, "_toe");
    if (gles_key_is_table(key) && !is_palette(key) && key->lights && key->power48 == (key->output == NACRE_OUTPUT_SQRT))
        put(out, key->power48 ? "_p48" : "_p4");
}

/* ---- what a key needs ---------------------------------------------------------------------------- */

uint8_t gles_key_layer_class(unsigned layers, unsigned units)
{
    unsigned size = 4;

    while (size < layers && size + 2 <= units && size < SHADE_MAX_UNITS) size += 2;
    return (uint8_t)size;
}

uint8_t gles_key_quarter_class(unsigned images)
{
    return images > 9 ? 4 : images > 5 ? 2 : 1; /* so many ramps of 4 lead from image to image */
}

shade_form gles_key_form(const gles_key *key)
{
    if (key->lights != 1 || key->ambient || key->pass || key->output == NACRE_OUTPUT_LINEAR || is_sbrdf(key))
        return SHADE_LINEAR;
    if (key->model == GLES_KEY_PAPER)
        return key->output == NACRE_OUTPUT_SRGB && !key->persp ? SHADE_SRGB : SHADE_LINEAR;
    return key->output == NACRE_OUTPUT_SRGB && gles_key_is_table(key) && key->power48 ? SHADE_SRGB : SHADE_ROOT;
}

unsigned gles_key_uniform_vectors(const gles_key *key)
{
    const unsigned lights = key->lights, common = (key->ambient ? is_sbrdf(key) ? 2 : 1 : 0) +
                                                  (key->pass == GLES_PASS_SUM && !key->es3 ? 1 : 0) +
                                                  (is_palette(key) ? 1u + key->blend : 0);

    if (!lights) return common;
    if (is_sbrdf(key)) return common + 2 * lights + key->lobes + (key->persp ? 1 : 0);
    if (gles_key_is_table(key)) {
        const unsigned fine = key->model == GLES_KEY_FINE ? 2 : 0;

        if (key->persp) return common + 2 * lights + 3 + key->phid + fine;
        return common + 3 * lights + 1 + fine;
    }
    if (key->model == GLES_KEY_QUARTER) {
        if (key->persp) return common + 2 * lights + 3 + 2 * key->layers;
        return common + (lights == 1 ? 4 : 5 * lights);
    }
    if (key->persp) return common + 2 * lights + 1 + (key->layers > 4 ? 10 : 5);
    return common + 6 * lights;
}

/* Of a model that varies over the surface: where the alphas that hold the direction are read besides. */
static unsigned direction_units(const gles_key *key)
{
    return key->direction > 1 ? 2 : key->direction && key->lobes == 1 ? 1 : 0;
}

static unsigned sbrdf_units(const gles_key *key)
{
    return (key->no_diffuse ? 0 : 1) + 2u * key->lobes + direction_units(key) + key->power;
}

int gles_key_unit_direction(const gles_key *key, int axis)
{
    const int count = (int)direction_units(key), first = (int)(sbrdf_units(key) - key->power) - count;

    return count > 1 - axis ? first + axis + count - 2 : -1;
}

static unsigned model_units(const gles_key *key)
{
    if (is_lit(key)) return key->mask > 1 ? 2 : 1;
    if (is_sbrdf(key)) return sbrdf_units(key);
    if (is_palette(key)) return 2;
    if (!key->lights) return 0;
    if (gles_key_is_table(key)) return key->model == GLES_KEY_TABLE ? 1 : 2;
    if (key->model == GLES_KEY_QUARTER) return 1;
    return key->persp ? key->layers : 2u * key->lights;
}

static int uses_normal_map(const gles_key *key)
{
    return key->normal_map && (key->lights || is_lit(key));
}

unsigned gles_key_units(const gles_key *key)
{
    return model_units(key) + (uses_normal_map(key) ? 1 : 0) + (key->mask ? 1 : 0) + (key->pass ? 2 : 0);
}

int gles_key_unit_normal(const gles_key *key)
{
    return uses_normal_map(key) ? (int)model_units(key) : -1;
}

int gles_key_unit_mask(const gles_key *key)
{
    return key->mask ? (int)gles_key_units(key) - 1 : -1; /* with a mask there are no passes */
}

int gles_key_unit_sum(const gles_key *key)
{
    return key->pass ? (int)gles_key_units(key) - 2 : -1;
}

/* Elsewhere the curve is made otherwise. */
static int may_have_toe(const gles_key *key)
{
    return gles_key_is_table(key) && key->lights && gles_key_form(key) == SHADE_SRGB;
}

/* Passes hold 1, 2 or 4 lights, so that there are fewer texts; those of a sphere also 8. */
static int fits_pass(const gles_key *key)
{
    return key->lights == 1 || key->lights == 2 || key->lights == 4 || (key->lights == 8 && key->sphere);
}

void gles_key_canonical(gles_key *key)
{
    const gles_key given = *key;
    const int sbrdf = is_sbrdf(key), palette = is_palette(key);
    int light;

    if (is_lit(key)) {
        memset(key, 0, sizeof *key);
        key->model = GLES_KEY_LIT;
        key->es3 = given.es3;
        key->normal_map = given.normal_map;
        key->mask = given.mask;
        return;
    }
    if (key->sphere) key->persp = key->normal_map = 0;
    if (key->pass == GLES_PASS_SUM) key->output = key->ambient = 0;
    if (key->pass == GLES_PASS_LAST) key->lights = 0;
    light = key->lights != 0;
    if (!light) key->persp = key->normal_map = 0;
    if (!light && !sbrdf && !(palette && key->ambient)) key->model = GLES_KEY_TABLE;
    key->blend = (uint8_t)(is_palette(key) && key->blend);
    if (!light || !sbrdf) key->lobes = key->power = key->direction = 0;
    key->no_diffuse = (uint8_t)(sbrdf && key->pass == GLES_PASS_SUM && key->no_diffuse);
    key->phid = (uint8_t)(light && gles_key_is_table(key) && (key->phid || key->model != GLES_KEY_TABLE));
    key->power48 = (uint8_t)(light && gles_key_is_table(key) && !palette && key->power48);
    if (gles_key_is_table(key) || sbrdf || !key->persp) key->layers = 0;
    key->toe = (uint8_t)(may_have_toe(key) && (key->toe || key->sphere));
    key->mask = 0;
}

/* Longer programs are refused by compilers of ES 2.0 GPUs, which stop at 256 instructions and few registers. */
static unsigned most_lights(const gles_key *key)
{
    if (key->es3) return NACRE_MAX_LIGHTS;
    if (key->blend) return key->persp ? 2 : 4;
    if (!key->persp && !is_sbrdf(key)) return key->model == GLES_KEY_FINE ? 6 : NACRE_MAX_LIGHTS;
    return gles_key_is_table(key) || is_sbrdf(key) ? 4 : key->model == GLES_KEY_PAPER ? 1 : 2;
}

unsigned gles_key_max_lights(const gles_key *key, unsigned pass, unsigned uniform_vectors, unsigned units)
{
    gles_key k = *key;

    k.pass = (uint8_t)pass;
    for (k.lights = (uint8_t)most_lights(key); k.lights; k.lights--)
        if ((!pass || fits_pass(&k)) && gles_key_uniform_vectors(&k) <= uniform_vectors && gles_key_units(&k) <= units)
            break;
    return k.lights;
}

/* ---- the text ------------------------------------------------------------------------------------ */

static char *define(char *out, const char *name, unsigned value)
{
    out = put(put(put(out, "#define "), name), " ");
    return put(put_digit(out, value), "\n");
}

static char *write_defines(const gles_key *key, int fragment, char *out)
{
    out = put(out, key->es3 ? "#version 300 es\n" : "#version 100\n");
    out = define(out, fragment ? "STAGE_FRAGMENT" : "STAGE_VERTEX", 1);
    out = define(out, "ES3", key->es3);
    out = define(out, "LIGHTS", key->lights);
    out = define(out, "PERSP", key->persp);
    out = define(out, "NORMAL_MAP", (unsigned)uses_normal_map(key));
    out = define(out, "PASS", key->pass);
    out = define(out, "SPHERE", key->sphere);
    out = define(out, "LIT", (unsigned)is_lit(key));
    out = define(out, "MASK", key->mask != 0);
    out = define(out, "SBRDF", (unsigned)is_sbrdf(key));
    out = define(out, "PALETTE", (unsigned)is_palette(key));
    if (!fragment) return out;
    if (is_sbrdf(key)) {
        const int x = gles_key_unit_direction(key, 0), y = gles_key_unit_direction(key, 1);

        out = define(out, "LOBES", key->lobes);
        out = define(out, "DIFFUSE", !key->no_diffuse);
        out = define(out, "POWER_TABLE", key->power);
        out = define(out, "DIRECTION", key->direction != 0);
        out = define(out, "DIRECTION_X", x < 0 ? 0 : (unsigned)x);
        out = define(out, "DIRECTION_Y", y < 0 ? 0 : (unsigned)y);
        out = define(out, "MAPS", model_units(key));
    }
    out = define(out, "MIX", key->mask > 1);
    out = define(out, "FINE", key->model == GLES_KEY_FINE);
    out = define(out, "EARLY", key->model == GLES_KEY_EARLY);
    out = define(out, "PHID", key->phid);
    out = define(out, "BLEND", key->blend);
    out = define(out, "PAPER", key->model == GLES_KEY_PAPER);
    out = define(out, "QUARTER", key->model == GLES_KEY_QUARTER);
    out = define(out, "POWER48", key->power48);
    out = define(out, "TOE", key->toe);
    out = define(out, "AMBIENT", key->ambient);
    out = define(out, "LAYERS", key->layers);
    out = define(out, "FORM", gles_key_form(key));
    out = define(out, "FORM_ROOT", SHADE_ROOT);
    out = define(out, "FORM_SRGB", SHADE_SRGB);
    out = define(out, "OUTPUT", key->output);
    out = define(out, "OUTPUT_SRGB", NACRE_OUTPUT_SRGB);
    out = define(out, "OUTPUT_LINEAR", NACRE_OUTPUT_LINEAR);
    out = define(out, "PASS_SUM", GLES_PASS_SUM);
    return define(out, "PASS_LAST", GLES_PASS_LAST);
}

int gles_text(const gles_key *key, int fragment, const char *part[GLES_TEXT_PARTS], int length[GLES_TEXT_PARTS],
              char *defines)
{
    int n = 0;

#define PART(name) (part[n] = (const char *)embedded_##name, length[n++] = (int)embedded_##name##_size)
    part[n] = defines;
    length[n++] = (int)(write_defines(key, fragment, defines) - defines);
    PART(common_glsl);
    if (!fragment) {
        PART(frame_vert);
        return n;
    }
    if (is_lit(key)) {
        PART(lit_frag);
        return n;
    }
    if (gles_key_is_table(key))
        PART(table_glsl);
    else if (is_sbrdf(key))
        PART(sbrdf_glsl);
    else
        PART(spheres_glsl);
    PART(frame_frag);
#undef PART
    return n;
}

/* ---- every key ----------------------------------------------------------------------------------- */

typedef struct key_list {
    gles_key *out;
    unsigned count, room;
} key_list;

/* Append key if it can be drawn with 8 units. */
static void add(key_list *list, const gles_key *key)
{
    if (gles_key_units(key) > UNITS) return;
    if (list->count < list->room) list->out[list->count] = *key;
    list->count++;
}

static void add_passes(key_list *list, gles_key key)
{
    for (key.ambient = 0; key.ambient < 2; key.ambient++) {
        const int toe = may_have_toe(&key);

        for (key.toe = (uint8_t)(toe && key.sphere); key.toe <= toe; key.toe++) add(list, &key);
        key.toe = 0;
    }
    if (!fits_pass(&key)) return;
    key.ambient = 0;
    key.pass = GLES_PASS_SUM;
    if (!key.output) add(list, &key);
}

static void add_lights(key_list *list, gles_key key)
{
    for (key.lights = 1; key.lights <= most_lights(&key); key.lights++) {
        for (key.normal_map = 0; key.normal_map < 2; key.normal_map++) add_passes(list, key);
        key.normal_map = 0;
        key.sphere = (uint8_t)(!key.persp && !is_palette(&key));
        if (key.sphere) add_passes(list, key);
        key.sphere = 0;
    }
}

static void add_cameras(key_list *list, gles_key key)
{
    for (key.persp = 0; key.persp < 2; key.persp++) {
        if (is_palette(&key)) {
            add_lights(list, key);
        } else if (gles_key_is_table(&key)) {
            for (key.power48 = 0; key.power48 < 2; key.power48++) add_lights(list, key);
            key.power48 = 0;
        } else if (!key.persp) {
            add_lights(list, key);
        } else if (key.model == GLES_KEY_QUARTER) {
            for (key.layers = 1; key.layers <= 4; key.layers = (uint8_t)(2 * key.layers)) add_lights(list, key);
            key.layers = 0;
        } else {
            for (key.layers = 4; key.layers <= UNITS; key.layers = (uint8_t)(key.layers + 2)) add_lights(list, key);
            key.layers = 0;
        }
    }
}

/* Passes of 3 lobes: the first two with the diffuse albedo, then the third. */
static void add_sbrdf_lights(key_list *list, gles_key key)
{
    for (key.lights = 1; key.lights <= most_lights(&key); key.lights++) {
        gles_key sum = key;

        for (key.ambient = 0; key.ambient < 2; key.ambient++) add(list, &key);
        key.ambient = 0;
        sum.pass = GLES_PASS_SUM;
        if (sum.output || !fits_pass(&sum)) continue;
        if (sum.lobes < 3) add(list, &sum);
        if (sum.lobes > 1) continue;
        sum.no_diffuse = 1;
        sum.direction *= 2;
        add(list, &sum);
    }
}

static void add_sbrdf(key_list *list, gles_key key)
{
    key.model = GLES_KEY_SBRDF;
    key.ambient = 1;
    add(list, &key);
    key.pass = GLES_PASS_LAST;
    for (key.ambient = 0; key.ambient < 2; key.ambient++) add(list, &key);
    key.pass = GLES_PASS_NONE;
    key.ambient = 0;
    for (key.power = 0; key.power < 2; key.power++)
        for (key.lobes = 1; key.lobes <= NACRE_MAX_LOBES; key.lobes++)
            for (key.direction = 0; key.direction < 2; key.direction++)
                for (key.persp = 0; key.persp < 2; key.persp++)
                    for (key.normal_map = 0; key.normal_map < 2; key.normal_map++) add_sbrdf_lights(list, key);
}

/* Ambient alone, after the last lights too. */
static void add_palette(key_list *list, gles_key key)
{
    key.model = GLES_KEY_PALETTE;
    for (key.blend = 0; key.blend < 2; key.blend++) {
        key.ambient = 1;
        key.pass = GLES_PASS_NONE;
        key.phid = 0;
        add(list, &key);
        key.pass = GLES_PASS_LAST;
        add(list, &key);
        key.pass = GLES_PASS_NONE;
        key.ambient = 0;
        key.phid = 1;
        add_cameras(list, key);
    }
}

/* Ambient alone, and what follows the last lights: of meshes and of spheres. */
static void add_without_lights(key_list *list, gles_key key)
{
    for (key.sphere = 0; key.sphere < 2; key.sphere++) {
        key.pass = GLES_PASS_NONE;
        key.ambient = 1;
        add(list, &key);
        key.pass = GLES_PASS_LAST;
        for (key.ambient = 0; key.ambient < 2; key.ambient++) add(list, &key);
    }
}

static void add_lit(key_list *list, gles_key key)
{
    key.model = GLES_KEY_LIT;
    for (key.mask = 0; key.mask < 3; key.mask++)
        for (key.normal_map = 0; key.normal_map < 2; key.normal_map++) add(list, &key);
}

unsigned gles_key_list(gles_key *out, unsigned count)
{
    static const struct {
        uint8_t model, phid;
    } kinds[] = {{GLES_KEY_TABLE, 0},   {GLES_KEY_TABLE, 1}, {GLES_KEY_FINE, 1},   {GLES_KEY_EARLY, 1},
                 {GLES_KEY_SPHERES, 0}, {GLES_KEY_PAPER, 0}, {GLES_KEY_QUARTER, 0}};
    static const gles_key zero;
    key_list list = {0, 0, 0};
    gles_key key;
    unsigned i;

    list.out = out;
    list.room = count;
    for (key = zero; key.es3 < 2; key.es3++) {
        key.output = 0;
        add_lit(&list, key);
        for (; key.output <= NACRE_OUTPUT_LINEAR; key.output++) {
            add_without_lights(&list, key);
            add_sbrdf(&list, key);
            add_palette(&list, key);
            for (i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
                key.model = kinds[i].model;
                key.phid = kinds[i].phid;
                add_cameras(&list, key);
            }
            key.model = key.phid = 0;
        }
    }
    return list.count;
}
