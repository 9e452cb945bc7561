#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Does what a page of the documentation says, in a fresh folder that has docs/tutorial, with an
# installed Suture: runs the blocks "```sh" line by line, writes the files of the blocks
# "```LANGUAGE FILE", and requires of "```LANGUAGE in FILE" that the file has these lines.
# usage: follow.sh PAGE FOLDER PREFIX
set -euo pipefail
page=$(readlink -f "${1:?}") prefix=${3:?}
tutorial=$(dirname "$(readlink -f "$0")")/../../docs/tutorial
rm -rf "${2:?}" && mkdir -p "$2/docs" && cp -r "$tutorial" "$2/docs" && cd "$2"
export PATH=$prefix/bin:$PATH CMAKE_PREFIX_PATH=$prefix MPLBACKEND=Agg CMAKE_GENERATOR=Ninja
# A law takes ten seconds for each instruction set; outside/ builds all of them.
echo 'set(SUTURE_INSTRUCTION_SETS base)' >base.cmake
export CMAKE_TOOLCHAIN_FILE=$PWD/base.cmake
# The only steps that need more than the program does: Matplotlib, and the installed Python module.
left_out='^$'
python3 -c 'import matplotlib' 2>/dev/null || left_out='^(python3 (plot|tension).py$|suture plot )'
[ -n "$(find "$prefix" -name '_suture*.so')" ] || left_out+='|^suture (plot|compare) '
{
  cat <<'FUNCTIONS'
has_lines() {
  python3 -c 'import sys; sys.exit(sys.stdin.read() not in open(sys.argv[1], encoding="utf-8").read())' "$1" ||
    { echo "$1 does not have the lines that the page shows of it"; exit 1; }
}
FUNCTIONS
  awk -v left_out="$left_out" '
    /^```/ && inside { if (file) print "END_OF_FILE"; inside = 0; next }
    /^```/ { inside = 1; shell = $1 == "```sh"; file = $2 == "in" ? $3 : $2
             if (file) printf "%s %s <<\"END_OF_FILE\"\n", $2 == "in" ? "has_lines" : "cat >", file
             next }
    inside && (file || (shell && $0 !~ left_out)) { print }' "$page"
} > steps.sh
grep -q '^suture run ' steps.sh || { echo "$page: no step is found"; exit 1; }
# `! command` does not end a shell: say so.
sed -i -E 's/^! (.*)/if \1; then echo "expected to fail: \1"; exit 1; fi/' steps.sh
bash -eu steps.sh
