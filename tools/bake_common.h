/* SPDX-License-Identifier: MIT */
/* What every kind of bake takes and leaves behind: -o, --depfile, --json, --threads, --quiet. */
#ifndef BAKE_COMMON_H
#define BAKE_COMMON_H

#include "json.h"
#include "options.h"
#include "painting.h"

typedef struct bake_common {
    const char *output, *depfile, *json;
    int threads, quiet;
} bake_common;

#define BAKE_OPTIONS(c)                                                                                                 \
    {"-o", OPTION_TEXT, &(c).output, 0, 0, "FILE", "output: a .ktx2, or a .c for a C array"},                           \
        {"--depfile", OPTION_TEXT, &(c).depfile, 0, 0, "FILE", "write a make fragment: output and what it is made of"}, \
        {"--json", OPTION_TEXT, &(c).json, 0, 0, "FILE", "the figures printed, as JSON (- for standard output)"},       \
        {"--threads", OPTION_INT, &(c).threads, 1, 256, "N", "(all cores) the bytes do not depend on it"},              \
    {                                                                                                                   \
        "--quiet", OPTION_FLAG, &(c).quiet, 0, 0, NULL, "print nothing but errors"                                      \
    }

/* Nothing but the JSON goes to standard output if that is where it goes. */
int bake_prints(const bake_common *c);

/* The output is given and is not the input (a BRDF's name or a file; NULL: there is none); sets the threads. kind is for
   messages: "bake table". */
int bake_check(const bake_common *c, const char *kind, const char *input, failure *f);

/* What goes with the output: the make fragment and the figures. Neither is left if one of them fails. */
int bake_write_side_outputs(const bake_common *c, const char *const *inputs, size_t count, json *figures, failure *f);
void bake_discard_side_outputs(const bake_common *c);

/* The same, and then the output: where it is, all that goes with it is. Frees the figures. input: as for bake_check. */
int bake_write_outputs(const bake_common *c, const bytes *file, const char *input, json *figures, failure *f);

/* Kinds of two files: -o NAME.ktx2 means NAME-PART.ktx2; so do .c and no ending. */
int bake_pair_path(const bake_common *c, const char *part, char *out, size_t size, failure *f);
/* Both files and what goes with them, or nothing. Frees the figures and the bytes. */
int bake_write_pair(const bake_common *c, const sbrdf_sources *sources, json *figures, const char *first_path,
                    bytes *first, const char *second_path, bytes *second, failure *f);

/* ---- kinds with a file of their own: cmd_bake_KIND.c --------------------------------------------- */

int bake_lights(int argc, char **argv, failure *f);
int bake_palette(int argc, char **argv, failure *f);
int bake_power(int argc, char **argv, failure *f);
int bake_sbrdf(int argc, char **argv, failure *f);

#endif
