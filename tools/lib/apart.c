/* SPDX-License-Identifier: MIT */
#include "apart.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TIME_LIMIT_SECONDS = 10 }; /* and as many as the file has MB */

int apart_write(int fd, const void *data, size_t size)
{
    const uint8_t *at = data;
    while (size) {
        ssize_t n = write(fd, at, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return -1;
        at += n;
        size -= (size_t)n;
    }
    return 0;
}

int apart_read(int fd, void *data, size_t size)
{
    uint8_t *at = data;
    while (size) {
        ssize_t n = read(fd, at, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return -1;
        at += n;
        size -= (size_t)n;
    }
    return 0;
}

static _Noreturn void run_child(int (*job)(int fd, const char *file), const char *file, int fd, unsigned seconds)
{
#ifndef __SANITIZE_ADDRESS__ /* reserves more address space than any limit */
    /* Enough for any mesh or picture there may be, and an end for files that claim to hold more. */
    const struct rlimit limit = {(rlim_t)8 << 30, (rlim_t)8 << 30};
    setrlimit(RLIMIT_AS, &limit);
#endif
    int null = open("/dev/null", O_WRONLY);
    if (null < 0 || dup2(null, STDOUT_FILENO) < 0 || dup2(null, STDERR_FILENO) < 0) _exit(1);
    alarm(seconds);
    _exit(job(fd, file) ? 1 : 0);
}

static int wait_child(pid_t child, const char *file, const char *what, unsigned seconds, failure *f)
{
    int status;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return fail(f, FAIL_INTERNAL, "%s: %s loader: %s", file, what, strerror(errno));
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
        return fail(f, FAIL_INVALID, "%s: not a %s that can be read: the loader was not done after %u seconds", file,
                    what, seconds);
    if (WIFSIGNALED(status))
        return fail(f, FAIL_INVALID, "%s: not a %s that can be read: the loader broke off (signal %d)", file, what,
                    WTERMSIG(status));
    if (WEXITSTATUS(status)) return fail(f, FAIL_INTERNAL, "%s: %s loader: out of memory", file, what);
    return FAIL_NONE;
}

int apart_run(int (*job)(int fd, const char *file), const char *file, const char *what, int *out, failure *f)
{
    int fd = memfd_create("nacre", MFD_CLOEXEC);
    if (fd < 0) return fail(f, FAIL_INTERNAL, "%s: %s loader: %s", file, what, strerror(errno));
    struct stat status;
    unsigned seconds = TIME_LIMIT_SECONDS + (stat(file, &status) ? 0 : (unsigned)(status.st_size >> 20));
    fflush(NULL); /* or the child might print our buffers again */
    pid_t child = fork();
    if (child == 0) run_child(job, file, fd, seconds);
    int code = child < 0 ? fail(f, FAIL_INTERNAL, "%s: %s loader: %s", file, what, strerror(errno))
                         : wait_child(child, file, what, seconds, f);
    if (!code && lseek(fd, 0, SEEK_SET) < 0) code = fail(f, FAIL_INTERNAL, "%s: %s loader: no reply", file, what);
    if (code)
        close(fd);
    else
        *out = fd;
    return code;
}
