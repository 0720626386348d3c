#!/bin/sh
# SPDX-License-Identifier: MIT
# run.sh BUILD [OPTIMISATION]: draw the example on the host and on emulated Cortex-M3, M4 and M7; frames must be equal.
set -eu
build=$1
level=${2:--O2}
here=tests/bare_metal
out=$build/bare_metal
include="-Iinclude -Isrc/fx -Isrc/asset -Isrc/shade -Isrc/soft -I$here"
runtime="src/fx/*.c src/asset/*.c src/shade/*.c src/soft/*.c"
mkdir -p "$out/host"
"$build/release/bare_metal_scene" "$out/scene.c"
# shellcheck disable=SC2086
cc -O2 -std=c99 $include -o "$out/host/main" $here/main.c "$out/scene.c" $runtime
(cd "$out/host" && ./main)
for target in "cortex-m3 mps2-an385 portable" "cortex-m4 mps2-an386 portable" "cortex-m4 mps2-an386 dsp" \
    "cortex-m7 mps2-an500 dsp"; do
    # shellcheck disable=SC2086
    set -- $target
    cpu=$1 board=$2 kernels=$3
    mkdir -p "$out/$cpu"
    # shellcheck disable=SC2086
    arm-none-eabi-gcc "$level" -mcpu="$cpu" -mthumb -std=gnu99 -ffunction-sections -fdata-sections \
        -DEXAMPLE_KERNELS=nacre_soft_"$kernels" $include -nostartfiles \
        -Wl,--gc-sections -T $here/link.ld -o "$out/$cpu/main.elf" $here/main.c "$out/scene.c" $runtime
    echo "== $cpu $level $kernels"
    (cd "$out/$cpu" && rm -f frame.rgb565 && timeout 300 qemu-system-arm -M "$board" -nographic \
        -semihosting-config enable=on,target=native -icount shift=0 -kernel main.elf)
    cmp "$out/host/frame.rgb565" "$out/$cpu/frame.rgb565"
    arm-none-eabi-size "$out/$cpu/main.elf" | tail -1
done
