#!/bin/sh
# SPDX-License-Identifier: MIT
# check_symbols.sh BUILD: what the runtime may call. Cortex-M0 objects of the integer rooms: memory functions and the
# compiler's integer helpers, no float, and division in set-up files only. The whole runtime: no heap, no stdio, no libm,
# no writable statics.
set -u
build=$1
status=0
complain() {
    echo "symbols: $*" >&2
    status=1
}

if [ -d "$build/m0" ]; then
    allowed='^(memcpy|memset|memcmp|__aeabi_(memcpy|memset|memclr)[48]?|__aeabi_(lmul|llsl|llsr|lasr)|__clz[sd]i2|__gnu_thumb1_case_.*)$'
    division='^__aeabi_(u?i|u?l)div(mod)?$'
    own=$(arm-none-eabi-nm --defined-only "$build"/m0/*/*.o | awk 'NF == 3 { print $3 }' | sort -u)
    for o in "$build"/m0/fx/*.o "$build"/m0/asset/*.o "$build"/m0/shade/*.o "$build"/m0/soft/*.o; do
        for s in $(arm-none-eabi-nm -u "$o" | awk '{ print $2 }'); do
            echo "$own" | grep -qx "$s" && continue
            echo "$s" | grep -Eq "$allowed" && continue
            case $o in
            */fx_div.o | */setup.o | */shade/material.o | */transform.o | */soft/prepare.o | */soft/context.o) echo "$s" | grep -Eq "$division" && continue ;;
            esac
            complain "$o calls $s"
        done
    done
else
    complain "$build/m0 is missing: no Cortex-M0 compiler was found"
fi

for s in $(nm -u "$build"/release/libnacre.a | awk '$1 == "U" { print $2 }' | sort -u); do
    case $s in
    memcpy | memset | memcmp | _GLOBAL_OFFSET_TABLE_ | __stack_chk_fail) ;;
    nacre_* | fx_* | asset_* | shade_* | soft_* | gles_* | embedded_*) ;;
    *) complain "the runtime calls $s" ;;
    esac
done
# In position-independent code constant pointers are relocated data, so statics are looked for where none is: Cortex-M0.
writable=$(arm-none-eabi-nm "$build"/m0/*/*.o | awk 'NF == 3 && $2 ~ /^[dDbBcC]$/ { print $3 }')
[ -z "$writable" ] || complain "writable statics: $writable"
[ $status = 0 ] && echo "symbols: the runtime calls only what it may"
exit $status
