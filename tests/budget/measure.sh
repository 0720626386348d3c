#!/bin/sh
# SPDX-License-Identifier: MIT
# measure.sh BUILD ARM_CC LIB: bytes of text, data and bss of every room, and its deepest single stack frame, for
# Cortex-M4 (-Os) and x86-64 (the release objects, -O2), to BUILD/sizes.csv and standard output; and the same of linked
# firmware (tests/budget/firmware.c) that leaves parts out, with the deepest chain of calls. Also leaves Cortex-M0 objects in
# BUILD/m0 for the symbol check.
set -eu
build=$1
arm=$2
lib=$3
rooms="fx asset shade soft gles"
size=${arm%gcc}size
out=$build/sizes.csv

includes() {
    case $1 in
    fx) echo "-Iinclude -Isrc/fx" ;;
    asset) echo "-Iinclude -Isrc/asset -Isrc/fx" ;;
    shade) echo "-Iinclude -Isrc/shade -Isrc/fx -Isrc/asset" ;;
    soft) echo "-Iinclude -Isrc/soft -Isrc/fx -Isrc/asset -Isrc/shade" ;;
    gles) echo "-Iinclude -Isrc/gles -Isrc/fx -Isrc/asset -Isrc/shade" ;;
    esac
}

compile() { # TARGET CPU FLAGS
    for room in $rooms; do
        mkdir -p "$build/$1/$room"
        for c in src/"$room"/*.c; do
            [ -e "$c" ] || continue
            o=$build/$1/$room/$(basename "$c" .c).o
            # shellcheck disable=SC2046
            $arm -mcpu="$2" -mthumb -Os -std=c99 -DNDEBUG -ffunction-sections -fstack-usage $(includes "$room") -c -o "$o" "$c"
        done
    done
}

deepest() { # DIR: largest stack frame in its .su files
    cat "$1"/*.su 2>/dev/null | awk -F'\t' '$2 > m { m = $2 } END { print m + 0 }'
}

firmware() { # NAME FLAGS: code and constant tables of nacre alone: no libc, no libgcc, not main
    fw=$build/firmware/$1 name=$1
    shift
    rm -rf "$fw" && mkdir -p "$fw"
    for c in tests/budget/firmware.c src/fx/*.c src/asset/*.c src/shade/*.c src/soft/*.c; do
        # shellcheck disable=SC2046
        $arm -mcpu=cortex-m4 -mthumb -Os -std=c99 -DNDEBUG "$@" -ffunction-sections -fdata-sections -fstack-usage $(includes soft) \
            -c -o "$fw/$(echo "${c%.c}" | tr / -).o" "$c"
    done
    # shellcheck disable=SC2046
    $arm -mcpu=cortex-m4 -mthumb -nostdlib -Wl,--gc-sections,--entry=main $(printf -- '-Wl,--defsym=%s=0 ' $outside) \
        -o "$fw/firmware.elf" "$fw"/*.o -lgcc
    "${arm%gcc}objdump" -t "$fw/firmware.elf" >"$fw/symbols.txt"
    "${arm%gcc}objdump" -d --no-show-raw-insn "$fw/firmware.elf" >"$fw/code.txt"
    awk -v kernels="soft_draw shade_normalise shade_table_add shade_table_code shade_encode soft_lit" \
        -f tests/budget/stack.awk "$fw"/*.su "$fw/symbols.txt" "$fw/code.txt" >"$fw/stack.txt"
    others=$("${arm%gcc}nm" -S --radix=d "$fw/firmware.elf" |
        awk 'NF == 4 && $4 ~ /^(main|mem.*|_.*)$/ { sum += $2 } END { print sum + 0 }')
    "$size" "$fw/firmware.elf" | awk -v n="$name" -v o="$others" -v s="$(cut -d' ' -f1 "$fw/stack.txt")" \
        'NR > 1 { printf "cortex-m4,%s,%d,%d,%d,%d\n", n, $1 - o, $2, $3, s }' >>"$out.new"
}

row() { # TARGET ROOM SIZE_TOOL STACK OBJECTS...
    target=$1 room=$2 tool=$3 stack=$4
    shift 4
    [ -e "$1" ] || return 0
    "$tool" "$@" | awk -v t="$target" -v r="$room" -v s="$stack" 'NR > 1 { x += $1; d += $2; b += $3 }
        END { printf "%s,%s,%d,%d,%d,%s\n", t, r, x, d, b, s }' >>"$out.new"
}

: >"$out.new"
echo "target,room,text,data,bss,stack" >>"$out.new"
compile m4 cortex-m4
compile m0 cortex-m0
for room in $rooms; do
    row cortex-m4 "$room" "$size" "$(deepest "$build/m4/$room")" "$build/m4/$room"/*.o
done
outside="memcpy memset memcmp app_desc app_view app_item app_lit app_image app_block app_scratch app_pixels app_texels
app_block_size app_scratch_size app_file_size app_file app_send_band"
lit="-DNACRE_NO_TABLES -DNACRE_NO_SPHERES -DNACRE_NO_MAPS -DNACRE_NO_NEAR -DNACRE_NO_GLES"
table="-DFIRMWARE_TABLE -DNACRE_NO_FINE -DNACRE_NO_SPHERES -DNACRE_NO_MAPS -DNACRE_NO_NEAR -DNACRE_NO_GLES"
models="-DFIRMWARE_TABLE -DNACRE_NO_FINE -DNACRE_NO_NEAR -DNACRE_NO_GLES"
# shellcheck disable=SC2086
{
    firmware lit-firmware $lit
    firmware table-firmware $table
    firmware models-firmware $models
    firmware whole-firmware -DFIRMWARE_TABLE -DNACRE_NO_GLES
}
objects=$(dirname "$lib")
for room in $rooms; do
    row x86-64 "$room" size - "$objects/src/$room"/*.o
done
row any shader-texts size - "$objects"/embedded/*.glsl.o "$objects"/embedded/*.vert.o "$objects"/embedded/*.frag.o
mv "$out.new" "$out"
cat "$out"
