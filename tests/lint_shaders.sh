#!/bin/sh
# SPDX-License-Identifier: MIT
# lint_shaders.sh DIR LIMITS: glslangValidator on every text in DIR, then the counter of uniform vectors, varyings and
# samplers against what ES 2.0 guarantees (glslangValidator passes 40 fragment uniform vectors without a word).
set -u
dir=$1
limits=$2
status=0
count=$(find "$dir" -name '*.vert' -o -name '*.frag' | wc -l)
[ "$count" -gt 0 ] || { echo "$dir: no shader texts" >&2; exit 1; }
find "$dir" -name '*.vert' -o -name '*.frag' | sort | xargs -n 64 -P 2 glslangValidator >"$dir/.lint" 2>&1 || status=1
grep -E 'ERROR|WARNING' "$dir/.lint" && status=1
find "$dir" -name '*.frag' | sort | xargs "$limits" || status=1
[ $status = 0 ] && echo "$count shader texts pass"
exit $status
