#!/bin/sh
# SPDX-License-Identifier: MIT
# run.sh BUILD: run every test program; the sanitized ones first. Ends with the lines of the last program; fails if any
# failed, naming them.
set -u
build=$1
export LSAN_OPTIONS="suppressions=$(cd "$(dirname "$0")" && pwd)/lsan.supp print_suppressions=0"
export ASAN_OPTIONS=detect_leaks=1
failed=
run() {
    echo "== $1"
    "$@" || failed="$failed $1"
}
for t in "$build"/sanitize/tests/unit/test_* "$build"/sanitize/tests/fault/test_*; do
    case $t in *.o | *.d) continue ;; esac
    NACRE_TOOL=$build/sanitize/nacre run "$t"
done
export NACRE_TOOL=$build/release/nacre
run sh tests/budget/check_symbols.sh "$build"
run sh tests/budget/left_out.sh "$build"
for t in "$build"/release/tests/fault/test_* "$build"/release/tests/frame/test_* "$build"/release/tests/budget/test_* \
    "$build"/release/tests/unit/test_*; do
    case $t in *.o | *.d) continue ;; esac
    run "$t"
done
if [ -n "$failed" ]; then
    echo "failed:$failed" >&2
    exit 1
fi
