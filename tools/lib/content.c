/* SPDX-License-Identifier: MIT */
#include "content.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

enum { CHUNK = 1 << 20 };

content *content_begin(void)
{
    XXH3_state_t *state = XXH3_createState();
    if (!state) {
        fprintf(stderr, "nacre: out of memory: %zu bytes\n", sizeof *state);
        exit(FAIL_INTERNAL);
    }
    XXH3_128bits_reset(state);
    return (content *)state;
}

void content_add(content *c, const void *data, size_t size)
{
    XXH3_128bits_update((XXH3_state_t *)c, data, size);
}

void content_add_text(content *c, const char *text)
{
    content_add(c, text, strlen(text) + 1);
}

static int add_open_file(content *c, int fd, const char *path, failure *f)
{
    struct stat status;
    if (fstat(fd, &status)) return fail(f, FAIL_IO, "%s: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode)) return fail(f, FAIL_IO, "%s: found no regular file, expected one", path);
    char *chunk = need_memory(CHUNK, 1);
    ssize_t got;
    while ((got = read(fd, chunk, CHUNK)) > 0 || (got < 0 && errno == EINTR))
        if (got > 0) content_add(c, chunk, (size_t)got);
    int code = got < 0 ? fail(f, FAIL_IO, "%s: read error: %s", path, strerror(errno)) : FAIL_NONE;
    free(chunk);
    return code;
}

int content_add_file(content *c, const char *path, failure *f)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe must not block before it is refused */
    if (fd < 0) return fail(f, FAIL_IO, "%s: %s", path, strerror(errno));
    int code = add_open_file(c, fd, path, f);
    close(fd);
    return code;
}

void content_end(content *c, char out[CONTENT_TEXT])
{
    XXH3_state_t *state = (XXH3_state_t *)c;
    XXH128_hash_t hash = XXH3_128bits_digest(state);
    XXH3_freeState(state);
    if (out)
        snprintf(out, CONTENT_TEXT, "%016llx%016llx", (unsigned long long)hash.high64, (unsigned long long)hash.low64);
}

int content_of_file(const char *path, char out[CONTENT_TEXT], failure *f)
{
    content *c = content_begin();
    int code = content_add_file(c, path, f);
    content_end(c, code ? NULL : out);
    return code;
}
