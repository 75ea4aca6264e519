#!/usr/bin/env bash
# Runs the given GoogleTest programs from the project's top folder and sums up.
# Usage: tests/run.sh FILTER PROGRAM...     (FILTER as for --gtest_filter)
set -uo pipefail
filter=$1
shift
passed=0 failed=0 skipped=0
for program in "$@"; do
  log=$(mktemp)
  start=$SECONDS
  "$program" --gtest_filter="$filter" --gtest_color=no >"$log" 2>&1
  code=$?
  ok=$(grep -c '^\[       OK \]' "$log")
  bad=$(grep -cE '^\[  FAILED  \] [A-Za-z0-9_/]+\.[A-Za-z0-9_/]+ \(|^\[  FAILED  \] [^ ]+, where .* \([0-9]+ ms\)' "$log")
  skip=$(grep -cE '^\[  SKIPPED \] .* \([0-9]+ ms\)' "$log")
  if [ "$code" != 0 ] || [ "$bad" != 0 ]; then
    [ "$bad" = 0 ] && bad=1 # the program itself died
    cat "$log"
  fi
  grep -E '^Skipped: ' "$log" | sort -u
  printf '%-28s %4d passed %3d failed %3d skipped %5d s\n' "$(basename "$program")" "$ok" "$bad" "$skip" $((SECONDS - start))
  passed=$((passed + ok)) failed=$((failed + bad)) skipped=$((skipped + skip))
  rm -f "$log"
done
[ "$passed" = 0 ] && echo "no test ran" && exit 1
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
