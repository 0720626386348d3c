/* SPDX-License-Identifier: MIT */
#include "output.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void bytes_reserve(bytes *b, size_t extra)
{
    if (b->capacity - b->size >= extra) return;
    size_t capacity = b->capacity ? b->capacity : 256;
    while (capacity - b->size < extra) capacity *= 2;
    uint8_t *data = realloc(b->data, capacity);
    if (!data) {
        fprintf(stderr, "nacre: out of memory: %zu bytes\n", capacity);
        exit(FAIL_INTERNAL);
    }
    b->data = data;
    b->capacity = capacity;
}

void bytes_append(bytes *b, const void *data, size_t size)
{
    if (!size) return;
    bytes_reserve(b, size);
    memcpy(b->data + b->size, data, size);
    b->size += size;
}

void bytes_append_u32(bytes *b, uint32_t value)
{
    const uint8_t le[4] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16), (uint8_t)(value >> 24)};
    bytes_append(b, le, 4);
}

void bytes_printf(bytes *b, const char *format, ...)
{
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (length > 0) {
        bytes_reserve(b, (size_t)length + 1);
        vsnprintf((char *)b->data + b->size, (size_t)length + 1, format, again);
        b->size += (size_t)length;
    }
    va_end(again);
}

void bytes_free(bytes *b)
{
    free(b->data);
    memset(b, 0, sizeof *b);
}

int file_read(bytes *out, const char *path, failure *f)
{
    FILE *file = fopen(path, "rb");
    if (!file) return fail(f, FAIL_IO, "%s: %s", path, strerror(errno));
    struct stat status;
    if (fstat(fileno(file), &status) == 0 && S_ISDIR(status.st_mode)) {
        fclose(file);
        return fail(f, FAIL_IO, "%s: is a directory, expected a file", path);
    }
    bytes all = {0};
    if (S_ISREG(status.st_mode)) bytes_reserve(&all, (size_t)status.st_size + 1);
    for (;;) {
        bytes_reserve(&all, 65536);
        size_t got = fread(all.data + all.size, 1, all.capacity - all.size, file);
        all.size += got;
        if (!got) break;
    }
    if (ferror(file)) {
        int code = fail(f, FAIL_IO, "%s: read error after %zu bytes: %s", path, all.size, strerror(errno));
        fclose(file);
        bytes_free(&all);
        return code;
    }
    fclose(file);
    *out = all;
    return FAIL_NONE;
}

static int write_all(int fd, const bytes *b)
{
    size_t done = 0;
    while (done < b->size) {
        ssize_t n = write(fd, b->data + done, b->size - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return -1;
        done += (size_t)n;
    }
    return 0;
}

/* Devices and pipes (/dev/null, /dev/stdout) are written in place: there is nothing to rename over. */
static int write_in_place(const char *path, const bytes *b, failure *f)
{
    int fd = open(path, O_WRONLY);
    if (fd < 0) return fail(f, FAIL_IO, "%s: can't write: %s", path, strerror(errno));
    int bad = write_all(fd, b);
    int error = errno;
    if (close(fd) && !bad) bad = -1, error = errno;
    return bad ? fail(f, FAIL_IO, "%s: can't write %zu bytes: %s", path, b->size, strerror(error)) : FAIL_NONE;
}

/* What will be renamed to a path. Where the system can do that, it has no name until it is whole: a process killed while
   it writes leaves nothing behind. */
struct draft {
    int fd, named;
    char *name; /* malloc'd */
};

enum { DRAFT_SUFFIX = 32 };

static struct draft draft_open(const char *path)
{
    size_t length = strlen(path);
    struct draft d = {-1, 0, need_memory(length + DRAFT_SUFFIX, 1)};
    const char *slash = strrchr(path, '/');
    if (slash)
        snprintf(d.name, length + DRAFT_SUFFIX, "%.*s", slash == path ? 1 : (int)(slash - path), path);
    else
        strcpy(d.name, ".");
    d.fd = access("/proc/self/fd", X_OK) ? -1 : open(d.name, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
    if (d.fd >= 0) return d;
    snprintf(d.name, length + DRAFT_SUFFIX, "%s.XXXXXX", path);
    d.fd = mkstemp(d.name);
    d.named = d.fd >= 0;
    return d;
}

/* Give it a name beside path that no other file has. */
static int draft_name(struct draft *d, const char *path)
{
    char handle[40];
    snprintf(handle, sizeof handle, "/proc/self/fd/%d", d->fd);
    for (int i = 0; !d->named; i++) {
        snprintf(d->name, strlen(path) + DRAFT_SUFFIX, "%s.%d-%d", path, (int)getpid(), i);
        if (!linkat(AT_FDCWD, handle, AT_FDCWD, d->name, AT_SYMLINK_FOLLOW))
            d->named = 1;
        else if (errno != EEXIST)
            return -1;
    }
    return 0;
}

int output_write_raw(const char *path, const bytes *b, failure *f)
{
    struct stat status;
    int exists = stat(path, &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) return fail(f, FAIL_IO, "%s: is a directory, expected a file", path);
    if (exists && !S_ISREG(status.st_mode)) return write_in_place(path, b, f);

    struct draft d = draft_open(path);
    if (d.fd < 0) {
        int code = fail(f, FAIL_IO, "%s: can't write: %s", path, strerror(errno));
        free(d.name);
        return code;
    }
    mode_t mask = umask(0);
    umask(mask);
    mode_t mode = exists ? status.st_mode & 07777 : 0666 & ~mask;
    int bad = write_all(d.fd, b) || fchmod(d.fd, mode) || fsync(d.fd) || draft_name(&d, path);
    int error = errno;
    if (close(d.fd) && !bad) bad = 1, error = errno;
    if (!bad && rename(d.name, path)) bad = 1, error = errno;
    if (bad && d.named) unlink(d.name);
    free(d.name);
    return bad ? fail(f, FAIL_IO, "%s: can't write %zu bytes: %s", path, b->size, strerror(error)) : FAIL_NONE;
}

int output_apart(const char *path, const char *input, failure *f)
{
    struct stat out, in;
    if (!input || stat(path, &out) || stat(input, &in) || !S_ISREG(out.st_mode)) return FAIL_NONE;
    if (out.st_dev != in.st_dev || out.st_ino != in.st_ino) return FAIL_NONE;
    return fail(f, FAIL_USAGE, "-o %s: found the input, expected another file", path);
}

void output_discard(const char *path)
{
    struct stat status;
    if (stat(path, &status) == 0 && S_ISREG(status.st_mode)) unlink(path);
}

void output_identifier(const char *path, char *out, size_t size)
{
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    size_t length = strlen(base), n = 0;
    if (length > 2 && !strcmp(base + length - 2, ".c")) length -= 2;
    if (isdigit((unsigned char)base[0]) && size > 1) out[n++] = '_';
    for (size_t i = 0; i < length && n + 1 < size; i++) out[n++] = isalnum((unsigned char)base[i]) ? base[i] : '_';
    out[n] = 0;
}

int output_write(const char *path, const bytes *b, failure *f)
{
    size_t length = strlen(path);
    if (length < 3 || strcmp(path + length - 2, ".c")) return output_write_raw(path, b, f);
    char name[256];
    output_identifier(path, name, sizeof name);
    bytes text = {0};
    bytes_printf(&text,
                 "/* Written by nacre. %zu bytes. */\n"
                 "#ifdef __GNUC__\n__attribute__((aligned(8)))\n#endif\n"
                 "extern const unsigned char %s[];\nextern const unsigned long %s_size;\n"
                 "const unsigned long %s_size = %zuul;\nconst unsigned char %s[%zu] = {",
                 b->size, name, name, name, b->size, name, b->size);
    for (size_t i = 0; i < b->size; i++) bytes_printf(&text, "%s%u,", i % 20 ? "" : "\n", b->data[i]);
    bytes_printf(&text, "\n};\n");
    int code = output_write_raw(path, &text, f);
    bytes_free(&text);
    return code;
}

static void append_make_name(bytes *text, const char *name)
{
    for (; *name; name++) {
        if (*name == ' ' || *name == '#' || *name == '\\') bytes_append(text, "\\", 1);
        if (*name == '$') bytes_append(text, "$", 1);
        bytes_append(text, name, 1);
    }
}

int output_depfile(const char *path, const char *target, const char *const *inputs, size_t count, failure *f)
{
    bytes text = {0};
    append_make_name(&text, target);
    bytes_append(&text, ":", 1);
    for (size_t i = 0; i < count; i++) {
        bytes_append(&text, " ", 1);
        append_make_name(&text, inputs[i]);
    }
    bytes_append(&text, "\n", 1);
    int code = output_write_raw(path, &text, f);
    bytes_free(&text);
    return code;
}
