/* SPDX-License-Identifier: MIT */
/* Every public header alone compiles as C99, C11 and C++11 without a warning; all of them together link from C++. Uses
   the compilers that $CC and $CXX name (cc, c++). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <glob.h>

#include "nacre.h"
#include "nacre_asset.h"
#include "nacre_gles.h"
#include "nacre_soft.h"

#include <cmocka.h>

static const char *from_environment(const char *name, const char *otherwise)
{
    const char *value = getenv(name);
    return value && *value ? value : otherwise;
}

/* Compile `#include "HEADER"` twice over, and nothing else. */
static void compile_alone(const char *compiler, const char *flags)
{
    glob_t found;
    char command[1000];
    assert_int_equal(glob("include/*.h", 0, NULL, &found), 0);
    assert_true(found.gl_pathc >= 3);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        const char *header = strrchr(found.gl_pathv[i], '/') + 1;
        snprintf(command, sizeof command,
                 "printf '#include \"%s\"\\n#include \"%s\"\\nextern int nothing;\\n' | %s %s -pedantic -Wall -Wextra "
                 "-Wundef -Werror -Iinclude -fsyntax-only -",
                 header, header, compiler, flags);
        if (system(command)) fail_msg("%s", command);
    }
    globfree(&found);
}

static void alone_as_c99(void **state)
{
    (void)state;
    compile_alone(from_environment("CC", "cc"), "-x c -std=c99 -Wstrict-prototypes");
}

static void alone_as_c11(void **state)
{
    (void)state;
    compile_alone(from_environment("CC", "cc"), "-x c -std=c11 -Wstrict-prototypes");
}

static void alone_as_cxx11(void **state)
{
    (void)state;
    compile_alone(from_environment("CXX", "c++"), "-x c++ -std=c++11");
}

/* A header that does not compile must be noticed. */
static void a_broken_header_is_noticed(void **state)
{
    (void)state;
    char command[300];
    snprintf(
        command, sizeof command,
        "printf '#include \"nacre.h\"\\nnacre_imag x;\\n' | %s -x c -std=c99 -Iinclude -fsyntax-only - 2>/dev/null",
        from_environment("CC", "cc"));
    assert_int_not_equal(system(command), 0);
}

/* With 32-bit pointers a view takes 76 bytes, a vertex 24 anywhere. */
static void sizes_on_small_targets(void **state)
{
    (void)state;
    static const char source[] = "printf '#include \"nacre.h\"\\nchar view[sizeof(nacre_image) == 76 ? 1 : -1];"
                                 "char vertex[sizeof(nacre_vertex) == 24 ? 1 : -1];\\n' | ";
    static const char *const compilers[] = {"arm-none-eabi-gcc -mcpu=cortex-m0 -mthumb -ffreestanding",
                                            "clang --target=thumbv6m-none-eabi -ffreestanding"};
    char command[500];
    int tried = 0;
    assert_int_equal(sizeof(nacre_vertex), 24);
    for (int i = 0; i < 2; i++) {
        snprintf(command, sizeof command, "command -v %.*s >/dev/null 2>&1", (int)strcspn(compilers[i], " "),
                 compilers[i]);
        if (system(command)) continue;
        tried++;
        snprintf(command, sizeof command, "%s%s -x c -std=c99 -Iinclude -fsyntax-only -", source, compilers[i]);
        assert_int_equal(system(command), 0);
    }
    if (!tried) {
        print_message("SKIPPED: neither arm-none-eabi-gcc nor clang is here\n");
        skip();
    }
}

/* This program is BUILD/CONFIG/tests/unit/test_headers; the library is BUILD/CONFIG/libnacre.a. */
static void a_cxx_program_links(void **state)
{
    (void)state;
    char self[3000], top[3000], command[16000];
    ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
    assert_true(n > 0);
    self[n] = 0;
    strcpy(top, self);
    for (int i = 0; i < 3 && strrchr(top, '/'); i++) *strrchr(top, '/') = 0;
    const char *sanitize = strstr(top, "/sanitize") ? "-fsanitize=address,undefined" : "";
    const char *library = getenv("NACRE_LIB");
    char beside[3100];
    snprintf(beside, sizeof beside, "%s/libnacre.a", top);
    snprintf(
        command, sizeof command,
        "%s -std=c++11 -pedantic -Wall -Wextra -Werror %s -Iinclude tests/unit/test_headers.cc '%s' -o '%s.cxx' && "
        "'%s.cxx'; status=$?; rm -f '%s.cxx'; exit $status",
        from_environment("CXX", "c++"), sanitize, library ? library : beside, self, self, self);
    assert_int_equal(system(command), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(alone_as_c99),           cmocka_unit_test(alone_as_c11),
        cmocka_unit_test(alone_as_cxx11),         cmocka_unit_test(a_broken_header_is_noticed),
        cmocka_unit_test(sizes_on_small_targets), cmocka_unit_test(a_cxx_program_links),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
