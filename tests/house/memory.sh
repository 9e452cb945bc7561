#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Memory per element of a tensor-mass scene without cuts and frames: what the run holds
# after its first step, and at most until then (in the search of the stable step).
# usage: memory.sh SUTURE-BENCH
set -euo pipefail
bench=$1
# Measured: 310 and 382 (302 and 372 with 432,000 elements); 53 of them are the state that the
# step goes back to if it turns out to be unstable (48 B per vertex; a second one comes after 32
# steps), 20 of the peak the rows of four floats of the search. At the peak, 1 MB of freed blocks
# may not have been given back yet: 383 to 394 for bodies of 97,000 to 144,000 elements.
# What this is to notice takes 12 B and more.
most=318
most_peak=398

# The last line: elements, held, peak.
read -r elements held peak < <("$bench" startup --sizes 108000 --models tm-faure --rounds 1 |
  tail -n 1)
echo "$held B per element of at most $most, $peak of $most_peak at the peak ($elements elements)"
awk -v held="$held" -v peak="$peak" -v most="$most" -v most_peak="$most_peak" \
  'BEGIN { exit !(held > 100 && held <= most && peak >= held && peak <= most_peak) }'
