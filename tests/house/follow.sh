#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Does what a page of the documentation says, in a fresh folder, with an installed Suture: writes the
# files of its blocks "```LANGUAGE FILE", and runs those of "```sh" line by line.
# usage: follow.sh PAGE FOLDER PREFIX
set -euo pipefail
page=$(readlink -f "${1:?}") prefix=${3:?}
rm -rf "${2:?}" && mkdir -p "$2" && cd "$2"
export PATH=$prefix/bin:$PATH CMAKE_PREFIX_PATH=$prefix MPLBACKEND=Agg CMAKE_GENERATOR=Ninja
# Its law takes ten seconds for each instruction set; outside/ builds all of them.
echo 'set(SUTURE_INSTRUCTION_SETS base)' >base.cmake
export CMAKE_TOOLCHAIN_FILE=$PWD/base.cmake
# The only step that needs more than Suture does.
skipped=$(python3 -c 'import matplotlib' 2>/dev/null || echo 'python3 plot.py')
awk -v skipped="$skipped" '
  /^```/ && inside { if (file) print "END_OF_FILE"; inside = 0; next }
  /^```/ { inside = 1; file = $2; shell = $1 == "```sh"
           if (file) printf "cat > %s <<\"END_OF_FILE\"\n", file; next }
  inside && (file || (shell && $0 != skipped)) { print }' "$page" > steps.sh
grep -q '^suture run ' steps.sh || { echo "$page: no step is found"; exit 1; }
# `! command` does not end a shell: say so.
sed -i -E 's/^! (.*)/if \1; then echo "expected to fail: \1"; exit 1; fi/' steps.sh
bash -eu steps.sh
