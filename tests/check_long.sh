#!/bin/sh
# SPDX-License-Identifier: MIT
# check_long.sh BUILD: the sweeps that `make test` shortens, over all built-in materials and shader texts, then the readers
# under libFuzzer for NACRE_FUZZ_SECONDS (60) each.
set -eu
build=$1
seconds=${NACRE_FUZZ_SECONDS:-60}

for t in unit/test_paper002 unit/test_compare unit/test_lafortune_fit frame/test_fp16 frame/test_compile; do
    echo "== $t, all materials and texts"
    NACRE_LONG=1 "$build/release/tests/$t"
done

echo "== random meshes, many"
NACRE_LONG=1 "$build/release/tests/fault/test_soft_random"
make --no-print-directory BUILD="$build" same-bits bare-metal

mkdir -p "$build/fuzz"
for target in tests/fault/fuzz_*.c; do
    name=$(basename "$target" .c)
    clang -std=c11 -D_GNU_SOURCE -g -O1 -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined -DNACRE_LIBFUZZER \
        -Iinclude -Isrc/fx -Isrc/asset -Isrc/shade -Itests/support -o "$build/fuzz/$name" "$target" src/asset/*.c
    mkdir -p "$build/fuzz/$name.corpus"
    cp fixtures/asset/*.ktx2 "$build/fuzz/$name.corpus"
    "$build/fuzz/$name" -max_total_time="$seconds" -max_len=65536 "$build/fuzz/$name.corpus"
done
