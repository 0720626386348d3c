/* SPDX-License-Identifier: MIT */
/* The subcommands of `nacre`. argv[0] is the subcommand's name; each returns an exit code (failure.h) and, unless it
   is 0, has put one line into f. */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "failure.h"

int cmd_bake(int argc, char **argv, failure *f);
int cmd_batch(int argc, char **argv, failure *f);
int cmd_bench(int argc, char **argv, failure *f);
int cmd_compare(int argc, char **argv, failure *f);
int cmd_fit(int argc, char **argv, failure *f);
int cmd_info(int argc, char **argv, failure *f);
int cmd_shot(int argc, char **argv, failure *f);

#endif
