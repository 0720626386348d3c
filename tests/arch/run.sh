#!/bin/sh
# SPDX-License-Identifier: MIT
# run.sh BUILD: frames of the case table on every processor that this machine can emulate, with two compilers and at two
# levels; the hashes of all must be the same. What is not installed is named and left out.
set -u
build=$1
out=$build/arch
include="-Iinclude -Isrc/fx -Isrc/asset -Isrc/shade -Isrc/soft"
sources="tests/arch/hash_cases.c src/fx/*.c src/asset/*.c src/shade/*.c src/soft/*.c"
status=0
ASAN_OPTIONS=detect_leaks=0
export ASAN_OPTIONS
mkdir -p "$out"
"$build/release/dump_cases" "$out/cases" || exit 1

hashes() { # NAME COMPILER FLAGS [EMULATOR] [KERNELS]
    if ! command -v "$2" >/dev/null || { [ -n "${4:-}" ] && ! command -v "${4%% *}" >/dev/null; }; then
        echo "SKIPPED: $1: no $2 ${4:-} here"
        return
    fi
    # shellcheck disable=SC2086
    if ! $2 $3 -std=c99 $include -o "$out/$1" $sources 2>"$out/$1.log" || ! ${4:-} "$out/$1" "$out/cases" ${5:-} >"$out/$1.txt"; then
        echo "$1: failed"
        tail -3 "$out/$1.log"
        status=1
    elif [ -z "${first:-}" ]; then
        first=$out/$1.txt
        echo "$1: $(grep -c . "$first") frames, $(grep -cv -- - "$first") drawn"
    elif cmp -s "$first" "$out/$1.txt"; then
        echo "$1: the same"
    else
        echo "$1: $(diff "$first" "$out/$1.txt" | grep -c '^>') frames DIFFER"
        status=1
    fi
}

hashes gcc-O3 gcc -O3
hashes gcc-O0 gcc -O0
hashes clang-O0 clang -O0
hashes clang-O3 clang -O3
if grep -qw avx2 /proc/cpuinfo 2>/dev/null; then hashes gcc-avx2 gcc "-O2 -mavx2" "" avx2; fi
if grep -qw sse4_1 /proc/cpuinfo 2>/dev/null; then hashes gcc-sse41 gcc "-O2 -msse4.1" "" sse41; fi
hashes gcc-sanitize gcc "-O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined"
hashes aarch64 aarch64-linux-gnu-gcc "-O2 -static" qemu-aarch64
hashes aarch64-neon aarch64-linux-gnu-gcc "-O2 -static" qemu-aarch64 neon
hashes armhf arm-linux-gnueabihf-gcc "-O2 -static" qemu-arm
hashes armhf-dsp arm-linux-gnueabihf-gcc "-O2 -static -mthumb -march=armv7-a+fp" qemu-arm dsp
hashes armhf-neon arm-linux-gnueabihf-gcc "-O2 -static -mfpu=neon" qemu-arm neon
hashes riscv64 riscv64-linux-gnu-gcc "-O2 -static" qemu-riscv64
hashes s390x s390x-linux-gnu-gcc "-O2 -static" qemu-s390x
exit $status
