/* SPDX-License-Identifier: MIT */
#include "drivers.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* llvmpipe lowers mediump to fp16 where the CPU converts it (F16C); held to SSE 4.1 it computes in fp32. */
#define FP32 "GALLIUM_OVERRIDE_CPU_CAPS=sse4.1"
#define LLVM "GALLIUM_DRIVER=llvmpipe"

const driver drivers[] = {
    {"osmesa, fp32", GL_BACKEND_OSMESA, {LLVM, FP32}, 0, 96},
    {"egl gles 2, fp32", GL_BACKEND_EGL2, {LLVM, FP32, "MESA_GLES_VERSION_OVERRIDE=2.0"}, 0, 96},
    {"egl gles 3, fp32", GL_BACKEND_EGL3, {LLVM, FP32}, 0, 96},
    {"softpipe gles 2", GL_BACKEND_EGL2, {"GALLIUM_DRIVER=softpipe", "MESA_GLES_VERSION_OVERRIDE=2.0"}, 0, 48},
    {"osmesa, fp16", GL_BACKEND_OSMESA, {LLVM}, 1, 96},
    {"egl gles 2, fp16", GL_BACKEND_EGL2, {LLVM, "MESA_GLES_VERSION_OVERRIDE=2.0"}, 1, 96},
    {"egl gles 3, fp16", GL_BACKEND_EGL3, {LLVM}, 1, 96},
};
const int driver_count = sizeof drivers / sizeof *drivers;

int driver_run(int index, const char *argument)
{
    char number[12];
    int status;
    pid_t child;

    snprintf(number, sizeof number, "%d", index);
    fflush(stdout);
    child = fork();
    if (child == 0) {
        int i;
        unsetenv("GALLIUM_OVERRIDE_CPU_CAPS");
        unsetenv("MESA_GLES_VERSION_OVERRIDE");
        setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
        for (i = 0; i < 4 && drivers[index].environment[i]; i++) {
            /* putenv keeps the pointer; these strings live as long as the program */
            char *setting = strdup(drivers[index].environment[i]);
            if (setting) putenv(setting);
        }
        execl("/proc/self/exe", "/proc/self/exe", "--driver", number, argument, (char *)NULL);
        perror("exec");
        _exit(70);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0) {
        perror("fork");
        return 70;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 70;
}

int driver_of_arguments(int argc, char **argv, const char **argument)
{
    int index = argc == 4 && !strcmp(argv[1], "--driver") ? atoi(argv[2]) : -1;

    *argument = argc == 4 ? argv[3] : NULL;
    return index >= 0 && index < driver_count ? index : -1;
}

void driver_remove_directory(const char *path)
{
    DIR *d = opendir(path);
    struct dirent *e;

    while (d && (e = readdir(d))) {
        char name[600];
        snprintf(name, sizeof name, "%s/%s", path, e->d_name);
        if (e->d_name[0] != '.') unlink(name);
    }
    if (d) closedir(d);
    rmdir(path);
}
