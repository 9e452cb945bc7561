#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Laws of the repository that no compiler knows. usage: check.sh CHECK [ROOT]
# Prints each offence as file:line: text; exit code 1 if there is one, 77 if the
# check cannot be made here.
set -uo pipefail
check=${1:?usage: check.sh CHECK [ROOT]}
cd "${2:-$(dirname "$(readlink -f "$0")")/../..}" || exit 2

# Tracked files, or all files of an unpacked archive; filtered by ending.
files() {
  if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    git ls-files --cached --others --exclude-standard
  else
    find . -type f -not -path './build/*' -not -path './.git/*' | sed 's|^\./||'
  fi | { if [ $# -gt 0 ]; then grep -E "$1"; else cat; fi } | while read -r f; do
    [ -f "$f" ] && echo "$f"
  done
}
sources='\.(h|hpp|c|cpp)$'
text='\.(h|hpp|c|cpp|in|cmake|md|json|sh|py|txt|supp)$|^dev$|^\.(ci|clang)'

# offences PATTERN EXPLANATION FILTER [EXCLUDED PATH]: files that match must not be.
offences() {
  local found
  found=$(files "$3" | grep -vE "${4:-^$}" | xargs -r -d '\n' grep -nHE -- "$1" /dev/null)
  [ -z "$found" ] || { echo "$found"; echo "$2"; return 1; }
}

# Absolute paths of somebody's machine, and addresses of a private mirror.
machine_paths() {
  offences '(^|[^A-Za-z0-9_.}$)-])/(work|root|home|Users|tmp/wt)/[A-Za-z]' \
    'paths of one machine: use relative ones' "$text"
}

unfinished() {
  offences 'TO''DO|FIX''ME|GTEST_''SKIP|place''holder' \
    'unfinished work does not land' "$text"
}

# A reader that stops early ends the writer by SIGPIPE, and with it, sometimes, a script that has
# set pipefail.
pipes() {
  offences '\| *(he''ad\b|grep -[A-Za-z]*q)' \
    'under pipefail, read into an array (mapfile) or from a substitution' '\.sh$|^dev$|^\.ci/'
}

# "A <- B": B may include A, never the reverse (docs/overview.md).
include_direction() {
  local bad=0
  offences '#include [<"](kernel|apps|plugins|tests)/' \
    'the SDK and the plugins know nothing of the kernel' '^(sdk|plugins)/.*'"$sources" || bad=1
  offences '#include [<"]\.\.' 'an include names its folder: relative paths hide where it leads' "$sources" || bad=1
  offences '#include [<"](apps|plugins|tests)/' \
    'the kernel knows neither the program nor the plugins' '^kernel/.*'"$sources" || bad=1
  # Stages in the order of the flow: each may include itself and earlier ones.
  local stages=(base plugin_host vtk hdf5 mesh topology geometry images parts attributes forces processes solvers fields contact dynamics spectrum implicit gradients model_check scene build operations output results steps run live)
  local i later
  for i in "${!stages[@]}"; do
    later=$(IFS='|'; echo "${stages[*]:i+1}")
    [ -n "$later" ] || continue
    offences "#include \"kernel/($later)/" "kernel/${stages[i]} includes a later stage" \
      "^kernel/${stages[i]}/.*$sources" || bad=1
  done
  # Leaves, so that their heavy or delicate dependencies stay alone.
  for leaf in output plugin_host; do
    offences "#include \"kernel/(topology|attributes|forces|contact|dynamics|solvers|scene|events)/" \
      "kernel/$leaf may include base and mesh only" "^kernel/$leaf/.*$sources" || bad=1
  done
  # Threads in one place, so that ThreadSanitizer sees what TBB orders.
  offences '#include <(tbb|oneapi/tbb)/(parallel|task|flow|concurrent)' 'threads are kernel/base/parallel.hpp' "$sources" \
    '^kernel/base/parallel.cpp$' || bad=1
  return $bad
}

# spdx_of FILTER LICENCE: the first three lines say it.
spdx_of() {
  local wrong
  wrong=$(files "$1" | xargs -r -d '\n' awk -v licence="SPDX-License-Identifier: $2\$" '
    function end_file() { if (file != "" && !is_good) print file ":1: " }
    FNR == 1 { end_file(); file = FILENAME; is_good = 0 }
    $0 ~ licence { is_good = 1 }
    FNR == 3 { nextfile }
    END { end_file() }')
  [ -z "$wrong" ] || { echo "$wrong"; echo "these want 'SPDX-License-Identifier: $2' on top"; return 1; }
}
licences() {
  local bad=0
  # Models in tests/sdk are examples to copy, under the licence of the SDK.
  spdx_of '^tests/sdk/.*'"$sources" '(MIT|GPL-3.0-or-later)' || bad=1
  spdx_of '^(kernel|apps|tests/([^s]|scene|solvers)[^/]*)/.*\.(h|hpp|c|cpp|sh|py)$' GPL-3.0-or-later || bad=1
  spdx_of '^(sdk|plugins)/.*\.(h|hpp|c|cpp)$' MIT || bad=1
  return $bad
}

# The linker takes two classes of one name for one, where inline functions are not inlined. Of the
# headers of a program: those that begin a line, behind the first namespace of their file.
class_names() {
  local names twice
  names=$(files '^(kernel|apps/suture)/.*\.hpp$' | xargs -r -d '\n' awk '
    FNR == 1 { space = "" }
    /^namespace/ && space == "" { space = $2 == "{" ? FILENAME : $2 }
    /^(class|struct) [A-Za-z_0-9]+( final)?( :.*| \{.*)$/ { print space "::" $2 " " FILENAME }' /dev/null | sort -u)
  twice=$(cut -d' ' -f1 <<<"$names" | uniq -d)
  [ -z "$twice" ] || { grep -F "$twice" <<<"$names"; echo 'classes of one program have names of their own'; return 1; }
}

# The test of a header of these rooms has its name, or is named in the list, which has no other lines.
headers() {
  local bad=0 list=tests/house/tests_of_headers.txt header name elsewhere
  while read -r header; do
    name=$(basename "$header" .hpp)
    elsewhere=$(awk -v header="$header" '$1 == header { print $2 }' "$list" 2>/dev/null)
    if compgen -G "tests/*/${name}_test.cpp" >/dev/null; then
      [ -z "$elsewhere" ] || { echo "$list: $header has a test of its name"; bad=1; }
    elif [ ! -f "${elsewhere:-none}" ]; then
      echo "$header:1: write tests/ROOM/${name}_test.cpp, or name in $list the test that finds its faults"
      bad=1
    fi
  done < <(files '^kernel/(topology|attributes|forces|contact)/[a-z0-9_]*\.hpp$')
  while read -r header elsewhere; do
    [ -f "$header" ] || { echo "$list: $header does not exist"; bad=1; }
  done < <(sed '/^#/d' "$list" 2>/dev/null)
  return $bad
}

# A file that is longer holds two things.
sizes() {
  files "$sources|CMakeLists.txt$" | xargs -r -d '\n' wc -l | awk '
    $2 == "total" { next }
    { limit = 600 }
    $2 ~ /^tests\// { limit = 700 }
    $2 ~ /CMakeLists.txt$/ { limit = $2 ~ /\// ? 60 : 120 }
    $1 > limit { print $2 ": " $1 " lines, at most " limit; is_bad = 1 }
    END { exit is_bad }'
}

# No large or binary file by accident.
weight() {
  files | xargs -r -d '\n' stat -c '%s %n' | awk '
    $1 > 1000000 { print $2 ": " $1 " bytes, at most 1000000"; is_bad = 1 }
    END { exit is_bad }'
}

# Each function that a trail of the overview names stands in the file beside it.
trails() {
  local bad=0 count=0 name file line page=docs/overview.md
  while IFS= read -r line; do
    name=$(sed -E 's/^- `([^`]+)` in `([^`]+)`.*/\1/' <<<"$line")
    file=$(sed -E 's/^- `([^`]+)` in `([^`]+)`.*/\2/' <<<"$line")
    count=$((count + 1))
    grep -qE "(^|[^A-Za-z_])$name\>" "$file" 2>/dev/null || { echo "$page: $file has no $name"; bad=1; }
  done < <(grep -E '^- `[^`]+` in `[^`]+`' "$page")
  [ "$count" -ge 10 ] || { echo "$page:1: the trails are missing: lines '- \`FUNCTION\` in \`FILE\` ...'"; bad=1; }
  return $bad
}

# Each relative link of the documentation leads to a file.
links() {
  local bad=0 file target
  while IFS=: read -r file target; do
    target=${target#](}
    target=${target%)}
    target=${target%%#*}
    case $target in http* | mailto* | "") continue ;; esac
    [ -e "$(dirname "$file")/$target" ] || { echo "$file: broken link to $target"; bad=1; }
  done < <(files '\.md$' | xargs -r -d '\n' grep -oHE '\]\([^) ]+\)')
  return $bad
}

# Each decision has a row in the index.
decisions() {
  local bad=0 page
  while read -r page; do
    grep -qF "]($(basename "$page"))" docs/decisions/README.md ||
      { echo "$page:1: has no row in docs/decisions/README.md"; bad=1; }
  done < <(files '^docs/decisions/[0-9].*\.md$')
  return $bad
}

format() {
  command -v clang-format >/dev/null || { echo "no clang-format here"; exit 77; }
  files "$sources" | xargs -r -d '\n' clang-format --dry-run -Werror
}

# The only top-level entries that the design knows.
top_level() {
  local unknown
  unknown=$(files | cut -d/ -f1 | sort -u | grep -vxE \
    'CMakeLists.txt|CMakePresets.json|CITATION.cff|LICENSE|README.md|dev|kernel|plugins|sdk|apps|tests|docs|\..*')
  [ -z "$unknown" ] || { echo "$unknown"; echo 'belongs in one of kernel plugins sdk apps tests docs'; return 1; }
}

case $check in
  machine_paths | unfinished | pipes | include_direction | licences | class_names | headers | sizes | weight | links | trails | decisions | format | top_level)
    "$check" && echo "$check: good" ;;
  *) echo "check.sh: no check '$check'"; exit 2 ;;
esac
