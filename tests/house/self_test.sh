#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Each law of check.sh, broken once on purpose, must be reported, and a clean
# tree must pass.
set -euo pipefail
check=$(dirname "$(readlink -f "$0")")/check.sh
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

# fresh: a small tree that obeys all laws.
fresh() {
  rm -rf "${tree:?}"/*
  mkdir -p "$tree"/{kernel/mesh,kernel/topology,sdk,plugins,tests,docs/decisions}
  printf '// SPDX-License-Identifier: GPL-3.0-or-later\n#include "kernel/mesh/a.hpp"\n' >"$tree/kernel/topology/b.cpp"
  printf '// SPDX-License-Identifier: GPL-3.0-or-later\nnamespace suture {\nclass A {};\n} // namespace suture\n' >"$tree/kernel/mesh/a.hpp"
  printf '/* SPDX-License-Identifier: MIT\n */\n' >"$tree/sdk/a.h"
  printf '[a](../sdk/a.h) [b](https://example.org)\n' >"$tree/docs/a.md"
  printf '[1](001-a.md)\n' >"$tree/docs/decisions/README.md"
  printf '# 001 A\n' >"$tree/docs/decisions/001-a.md"
  for _ in {1..10}; do echo '- `A` in `kernel/mesh/a.hpp`'; done >"$tree/docs/overview.md"
  touch "$tree/CMakeLists.txt" "$tree/README.md"
}

make_check() { "$check" "$1" "$tree"; }

# must_report CHECK FILE TEXT: with that line the check fails, without it passes.
must_report() {
  fresh
  make_check "$1" >/dev/null || { echo "$1 refuses a clean tree"; failures=1; }
  mkdir -p "$(dirname "$tree/$2")"
  printf '%s\n' "$3" >>"$tree/$2"
  if make_check "$1" >/dev/null 2>&1; then
    echo "$1 does not report '$3' in $2"
    failures=1
  fi
}

must_report machine_paths docs/a.md 'see /'work/notes.md
must_report machine_paths kernel/mesh/a.hpp '#include "/'root/a.h\"
must_report unfinished kernel/mesh/a.hpp '// TO''DO: later'
must_report unfinished tests/a.cpp 'GTEST_''SKIP();'
must_report pipes tests/a.sh 'ls | he''ad -n 1'
must_report include_direction sdk/a.h '#include "kernel/mesh/mesh.hpp"'
must_report include_direction plugins/a.cpp '#include "kernel/mesh/mesh.hpp"'
must_report include_direction plugins/a.cpp '#include "../../kernel/mesh/mesh.hpp"'
must_report include_direction kernel/mesh/a.hpp '#include "kernel/topology/b.hpp"'
must_report include_direction kernel/output/a.hpp '#include "kernel/scene/scene.hpp"'
must_report include_direction kernel/run/a.hpp '#include "apps/suture/cli.hpp"'
must_report include_direction kernel/run/a.cpp '#include <tbb/parallel_for.h>'
must_report licences kernel/base/c.hpp '#pragma once'
must_report licences plugins/c.cpp '// SPDX-License-Identifier: GPL-3.0-or-later'
must_report class_names kernel/topology/c.hpp $'namespace suture {\nstruct A : B {\n};\n}'
must_report headers kernel/topology/c.hpp ''
must_report sizes kernel/mesh/a.hpp "$(seq 700)"
must_report sizes CMakeLists.txt "$(seq 130)"
must_report weight docs/big.dat "$(seq 200000)"
must_report decisions docs/decisions/003-new.md '# 003 New'
must_report links docs/a.md '[c](missing.md)'
must_report trails docs/overview.md '- `B` in `kernel/mesh/a.hpp` calls it'
must_report top_level src/a.txt 'x'
if command -v clang-format >/dev/null; then
  must_report format kernel/mesh/a.hpp 'int   a  ;'
fi
exit $failures
