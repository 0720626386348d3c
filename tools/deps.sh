#!/bin/sh
# SPDX-License-Identifier: MIT
# deps.sh demo|test|check-long [BUILD]: install what drawing (demo), the tests or the long checks need and this machine
# lacks. With everything present nothing is contacted. Probes look for the thing itself, so other systems than Debian
# pass too.
set -u
what=$1
build=${2:-build}

missing=
command_in() { command -v "$2" >/dev/null 2>&1 || missing="$missing $1"; }           # PACKAGE COMMAND
header_in() { echo "#include <$2>" | cc -E - >/dev/null 2>&1 || missing="$missing $1"; } # PACKAGE HEADER
file_in() { # PACKAGE GLOB...
    package=$1
    shift
    for f in "$@"; do [ -e "$f" ] && return; done
    missing="$missing $package"
}

probe() {
    missing=
    command_in gcc cc
    if [ -z "$missing" ]; then
        header_in libc6-dev stdlib.h
        header_in libpng-dev png.h
        header_in libassimp-dev assimp/cimport.h
        header_in libcjson-dev cjson/cJSON.h
        header_in libxxhash-dev xxhash.h
        header_in libegl-dev EGL/egl.h
        header_in libcminpack-dev cminpack-1/cminpack.h
    else
        missing="$missing libc6-dev libpng-dev libassimp-dev libcjson-dev libxxhash-dev libegl-dev libcminpack-dev"
    fi
    file_in libegl1 /usr/lib/*/libEGL.so.1 /usr/lib/libEGL.so.1 /usr/lib64/libEGL.so.1
    file_in libegl-mesa0 /usr/lib/*/libEGL_mesa.so.0 /usr/lib/libEGL_mesa.so.0 /usr/lib64/libEGL_mesa.so.0
    file_in libgl1-mesa-dri /usr/lib/*/dri/swrast_dri.so /usr/lib/dri/swrast_dri.so /usr/lib64/dri/swrast_dri.so \
        /usr/lib/*/libgallium*.so
    [ "$what" = demo ] && return
    header_in libcmocka-dev "stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h"
    header_in libgles-dev GLES3/gl32.h
    command_in g++ c++
    command_in binutils nm
    file_in libosmesa6 /usr/lib/*/libOSMesa.so.8 /usr/lib/libOSMesa.so.8 /usr/lib64/libOSMesa.so.8
    command_in glslang-tools glslangValidator
    command_in etc1tool etc1tool
    command_in clang clang
    file_in libomp-dev /usr/lib/llvm-*/lib/clang/*/include/omp.h /usr/lib/clang/*/include/omp.h
    command_in clang-format clang-format
    command_in cppcheck cppcheck
    command_in gcc-arm-none-eabi arm-none-eabi-gcc
    file_in libnewlib-arm-none-eabi /usr/lib/arm-none-eabi/include/string.h /usr/arm-none-eabi/include/string.h
    [ "$what" = test ] && return
    command_in qemu-user qemu-aarch64
    command_in qemu-system-arm qemu-system-arm
    command_in gcc-aarch64-linux-gnu aarch64-linux-gnu-gcc
    command_in gcc-arm-linux-gnueabihf arm-linux-gnueabihf-gcc
    command_in gcc-riscv64-linux-gnu riscv64-linux-gnu-gcc
    command_in gcc-s390x-linux-gnu s390x-linux-gnu-gcc
    file_in libclang-rt-14-dev /usr/lib/llvm-*/lib/clang/*/lib/*/libclang_rt.fuzzer*.a
}

# OSMesa left Mesa with 25.1: where no package has it, the tests run on EGL alone and say so.
drop_unobtainable() {
    case " $missing " in *" libosmesa6 "*) ;; *) return 0 ;; esac
    apt-cache show libosmesa6 >/dev/null 2>&1 && return 0
    echo "note: libosmesa6 is not to be had on this system; its tests will be skipped" >&2
    missing=$(echo " $missing " | sed 's/ libosmesa6 / /')
}

install_packages() {
    as_root=
    [ "$(id -u)" = 0 ] || as_root="sudo -n"
    export DEBIAN_FRONTEND=noninteractive
    command -v apt-get >/dev/null 2>&1 || return 1
    [ -z "$as_root" ] || sudo -n true >/dev/null 2>&1 || return 1
    echo "installing:$missing"
    log=$(mktemp)
    $as_root apt-get update -q >"$log" 2>&1 && drop_unobtainable &&
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $missing >>"$log" 2>&1
    status=$?
    [ $status = 0 ] || tail -5 "$log" >&2
    rm -f "$log"
    return $status
}

# The second, independent KTX2 reader; without npm or its registry the tests' own one stands alone, and they say so.
install_ktx_parse() {
    [ "$what" = test ] || return
    [ -d "$build/npm/node_modules/ktx-parse" ] && return
    command -v npm >/dev/null 2>&1 || return
    mkdir -p "$build/npm"
    npm install --silent --no-audit --no-fund --prefix "$build/npm" ktx-parse@2.0.0 >/dev/null 2>&1 ||
        echo "note: npm package ktx-parse 2.0.0 can't be fetched; its test will be skipped" >&2
}

refuse_if_missing() {
    drop_unobtainable
    [ -z "$(echo $missing)" ] && return
    echo "missing: $(echo $missing); run: apt-get install $(echo $missing)" >&2
    exit 2
}

probe
if [ -n "$missing" ]; then
    install_packages || refuse_if_missing
    probe
    refuse_if_missing
fi
install_ktx_parse
exit 0
