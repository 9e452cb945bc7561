#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The SDK with clang: its headers compile alone, and a plugin that clang builds, for a processor that
# is none of the three of suture_add_plugin(), works in this program.
# usage: clang.sh SUTURE SOURCES FOLDER
set -euo pipefail
suture=${1:?} sources=${2:?} folder=${3:?}
command -v clang >/dev/null && command -v clang++ >/dev/null || { echo "no clang here"; exit 77; }
flags=(-I"$sources/sdk/include" -Wall -Wextra -Wpedantic -Werror -fsyntax-only)
# alone LANGUAGE STANDARD HEADER...
alone() {
  for header in "${@:3}"; do
    echo "#include \"suture/${header##*/}\"" | clang -std="$2" "${flags[@]}" -x "$1" -
  done
}
headers=("$sources"/sdk/include/suture/*.h) layers=("$sources"/sdk/include/suture/*.hpp)
alone c c11 "${headers[@]}"
for standard in c++17 c++20; do alone c++ $standard "${headers[@]}" "${layers[@]}"; done
march=$([ "$(uname -m)" = x86_64 ] && echo -march=x86-64-v2 || true)
rm -rf "$folder" && mkdir -p "$folder"
clang++ -std=c++17 -O2 -fPIC -shared -fvisibility=hidden $march -I"$sources/sdk/include" \
  "$sources/tests/sdk/anchor.cpp" -o "$folder/anchor.so"
"$suture" check-model --output "$folder" "$folder/anchor.so"
