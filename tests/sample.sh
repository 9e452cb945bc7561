#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs every COUNTth case of a GoogleTest program from the one with number PART, in one process, but
# for those whose name (program.suite.case) matches the pattern in SUTURE_LEAVES_OUT.
# usage: sample.sh PROGRAM PART COUNT
set -euo pipefail
program=$1 part=$2 count=$3
cases=$("$program" --gtest_list_tests | awk -v name="${program##*/}" '
  /^[^ ]/ { suite = $1 }
  /^  / { print name "." suite $1 }' |
  grep -Ev "${SUTURE_LEAVES_OUT:-^\$}" | awk -v part="$part" -v count="$count" 'NR % count == part' || true)
[ -n "$cases" ] || exit 0
flags=$(mktemp)
trap 'rm "$flags"' EXIT
printf -- '--gtest_filter=%s\n' "$(sed "s/^${program##*/}\.//" <<<"$cases" | paste -sd:)" >"$flags"
"$program" --gtest_flagfile="$flags" --gtest_brief=1
