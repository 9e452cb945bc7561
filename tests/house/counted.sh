#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Instructions per cell, counted by callgrind: catches what makes force loop, step or
# cut slower by half, on any machine and without a clock. valgrind 3.19 does not know
# AVX-512, so the AVX2 path is counted.
# usage: counted.sh SUTURE-BENCH
set -euo pipefail
bench=$1
grep -qw avx2 /proc/cpuinfo || { echo "this processor has no AVX2"; exit 77; }
command -v valgrind >/dev/null || { echo "needs valgrind (./dev install-deps test)"; exit 1; }

# Counted with g++ 12.2 -O3: instructions per element and evaluation or step, or per
# face and cut (map, attributes and loops). A figure that has become better is welcome:
# write it here.
#     figure  work   options
figures='
       554    force  --model tm-faure
       602    step   --model tm-faure
       780    force  --model tm-faure --distorted
       564    force  --model mss-baudet
       612    step   --model mss-baudet
       1179   force  --model mss-baudet --parameter viscosity 1
       2617   cut    --model tm-faure
       5425   cut    --model mss-baudet
'
most=1.5

log=$(mktemp)
trap 'rm "$log"' EXIT
failed=0
while read -r figure work options; do
  [ -n "$figure" ] || continue
  read -ra list <<<"$options"
  cells=$(SUTURE_ISA=avx2 valgrind --tool=callgrind --callgrind-out-file=/dev/null \
    --toggle-collect='*counted_work*' --log-file="$log" \
    "$bench" count --work "$work" "${list[@]}" | tail -n 1)
  instructions=$(sed -n 's/.*Collected : //p' "$log")
  awk -v instructions="$instructions" -v cells="$cells" -v figure="$figure" -v most="$most" \
    -v what="$work $options" 'BEGIN {
      counted = instructions / cells
      good = counted > 0 && counted <= most * figure
      printf "%8.1f counted, %6s in the table: %s%s\n", counted, figure, what, good ? "" : "  FAILS"
      exit !good
    }' || failed=1
done <<<"$figures"
if [ "$failed" = 1 ]; then
  echo "more than $most times the instructions of the table (tests/house/counted.sh)"
  exit 1
fi
