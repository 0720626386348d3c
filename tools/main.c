/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "nacre.h"
#include "options.h"

typedef struct command {
    const char *name;
    int (*run)(int argc, char **argv, failure *f);
    const char *help;
} command;

static const command commands[] = {
    {"bake", cmd_bake, "table, spheres, mesh, ...: measured reflectance and shapes into small files"},
    {"batch", cmd_batch, "bake and compare a list of materials"},
    {"fit", cmd_fit, "Lafortune lobes to a BRDF, by least squares"},
    {"shot", cmd_shot, "draw a mesh in a material to a PNG, by the GLES shaders or in double precision"},
    {"compare", cmd_compare, "how close files come to the material they stand for: figures, pictures, a gate"},
    {"info", cmd_info, "what a file holds; --brdfs lists the built-in materials"},
    {"bench", cmd_bench, "milliseconds per frame of the shaders on this machine"},
};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static void print_usage(FILE *out)
{
    fprintf(out, "usage: nacre COMMAND ...   (nacre COMMAND --help for its options)\n");
    for (int i = 0; i < COMMAND_COUNT; i++) fprintf(out, "  %-8s %s\n", commands[i].name, commands[i].help);
    fprintf(out, "exit codes: 0 ok, 1 usage, 2 input/output, 3 invalid file, 4 not supported here,\n"
                 "            5 difference above the limit, 70 internal error\n");
}

static int unknown_command(const char *word)
{
    const char *names[COMMAND_COUNT];
    for (int i = 0; i < COMMAND_COUNT; i++) names[i] = commands[i].name;
    char near[128];
    nearest_names(word, names, COMMAND_COUNT, near, sizeof near);
    fprintf(stderr, "nacre: %s: unknown command%s%s (nacre --help lists them)\n", word, near[0] ? "; near: " : "",
            near);
    return FAIL_USAGE;
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        print_usage(stderr);
        return FAIL_USAGE;
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || !strcmp(argv[1], "help")) {
        print_usage(stdout);
        return FAIL_NONE;
    }
    if (!strcmp(argv[1], "--version")) {
        printf("nacre %d.%d.%d\n", NACRE_VERSION_MAJOR, NACRE_VERSION_MINOR, NACRE_VERSION_PATCH);
        return FAIL_NONE;
    }
    for (int i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(argv[1], commands[i].name)) continue;
        failure f = {0};
        int code = commands[i].run(argc - 1, argv + 1, &f);
        if (code && f.text[0]) fprintf(stderr, "nacre %s: %s\n", argv[1], f.text);
        return code;
    }
    return unknown_command(argv[1]);
}
