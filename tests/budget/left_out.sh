#!/bin/sh
# SPDX-License-Identifier: MIT
# left_out.sh BUILD: the runtime with each part left out (NACRE_NO_...), built for this machine and asked for that part.
set -u
status=0
program=$1/left_out
for parts in "" "FINE SBRDF NEAR" "SPHERES MAPS" TABLES; do
    switches=-DNACRE_NO_GLES
    for part in $parts; do switches="$switches -DNACRE_NO_$part"; done
    # shellcheck disable=SC2086 # several switches
    if ! ${CC:-cc} -std=c99 -O0 $switches -Iinclude -Isrc/fx -Isrc/asset -Isrc/shade -Isrc/soft -o "$program" \
        tests/budget/left_out.c src/fx/*.c src/asset/*.c src/shade/*.c src/soft/*.c || ! "$program"; then
        echo "left out: failed without: ${parts:-nothing}" >&2
        status=1
    fi
done
rm -f "$program"
exit $status
