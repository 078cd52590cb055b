#!/usr/bin/env bash
# Installs the build folder, builds examples/ against it and compares with the program.
#   installed_library.sh BUILD SOURCE           a small scene; every header alone
#   installed_library.sh BUILD SOURCE --street  the street of CLEARWAY_TEST_DATA, with the same example
set -euo pipefail
build=$1 source=$2
scratch=$build/installed
prefix=$scratch/prefix
warnings=(-Wall -Wextra -Wpedantic -Werror)

fail() { echo "installed_library: $*" >&2; exit 1; }

# Prints the number of colliding points that the example finds.
example() { "$scratch/example/find_collisions" "$@" 2>messages.txt | awk '/points collide/ { print $1 }'; }

# The headers that a header of clearway reads, itself or through others of clearway.
headers_read_by() {
  local found=$1 before=
  while [ "$found" != "$before" ]; do
    before=$found
    # shellcheck disable=SC2086
    found=$(cd "$prefix/include" && { printf '%s\n' $before &&
      grep -hoP '^#include [<"]\K[^>"]+' $(printf '%s\n' $before | grep ^clearway/); } | sort -u)
  done
  echo "$found"
}

# Each alone, as a file that includes no other first; and all in one, as another compiler reads them.
# Reading the standard library takes most of the time, so what most of the headers read of it is
# compiled once. Only a header that reads all of this itself is compiled after it: any other would
# find names there that it has not included.
check_headers() {
  local header foreign all=$scratch/all.cpp shared=$scratch/shared.hpp name first
  local standard=(atomic cmath cstdint filesystem functional string string_view utility vector)
  printf '#include <%s>\n' "${standard[@]}" >"$shared"
  g++ -std=c++20 "${warnings[@]}" -I "$prefix/include" -x c++-header "$shared" -o "$shared.gch"
  for header in "$prefix"/include/clearway/*.hpp; do
    name=clearway/${header##*/} first=()
    [ -n "$(comm -23 <(printf '%s\n' "${standard[@]}" | sort) <(headers_read_by "$name"))" ] ||
      first=(-Winvalid-pch -include "$shared")
    g++ -std=c++20 -fsyntax-only "${warnings[@]}" -I "$prefix/include" "${first[@]}" \
      -include "$header" -x c++ /dev/null || fail "g++ refuses $header"
    echo "#include \"$header\""
  done >"$all"
  rm "$shared.gch"
  if command -v clang++ >/dev/null; then
    clang++ -std=c++20 -fsyntax-only "${warnings[@]}" -I "$prefix/include" "$all" ||
      fail "clang++ refuses a header"
  fi
  foreign=$(g++ -std=c++20 -M -I "$prefix/include" -x c++ "$prefix/include/clearway/clearway.hpp" |
    tr ' ' '\n' | grep -vF "$prefix/" | grep -iE 'hdf5|H5|/proj|tbb|CLI/|cuda|eigen|spdlog|fmt/|nlohmann|xxhash|pugi|omp\.h') || true
  [ -z "$foreign" ] || fail "a public header includes $foreign"
  ! grep -E -- '-W|-f|-O' "$prefix"/lib*/cmake/Clearway/ClearwayTargets*.cmake ||
    fail "a flag reaches the consumer"
}

# Every C++ block of a document is a whole file. Programs are compiled by run_program_of.
check_document() {
  local folder=$scratch/documents/${1##*/} block
  mkdir -p "$folder"
  awk -v folder="$folder" '/^```/ { out = /^```cpp/ ? folder "/" ++n ".cpp" : ""; next }
    out { print > out }' "$source/$1"
  for block in $(grep -L 'int main' "$folder"/*.cpp); do
    g++ -std=c++20 -fsyntax-only "${warnings[@]}" -I "$prefix/include" "$block" ||
      fail "a block of $1 does not compile"
  done
}

# The program among a document's C++ blocks, built with the CMake file that library.md shows, and
# run on the scene. $2: what it is to print. The folder is configured once for all programs.
run_program_of() {
  local folder=$scratch/programs printed
  mkdir -p "$folder"
  cp "$(grep -l 'int main' "$scratch/documents/${1##*/}"/*.cpp)" "$folder/passes.cpp"
  if [ ! -d "$folder/build" ]; then
    awk '/^```/ { out = /^```cmake/; next } out' "$source/docs/guide/library.md" \
      >"$folder/CMakeLists.txt"
    cmake -S "$folder" -B "$folder/build" -DCMAKE_PREFIX_PATH="$prefix" \
      -DCMAKE_CXX_FLAGS="${warnings[*]}" >/dev/null
  fi
  rm -f "$folder/build/passes"
  cmake --build "$folder/build" >/dev/null
  rm -f site.h5 out.h5
  printed=$("$folder/build/passes") || [ $? = 1 ] || fail "the program of $1 fails"
  [ "$printed" = "$2" ] || fail "the program of $1 prints '$printed', expected '$2'"
}

if [ "${3:-}" = --street ]; then
  if [ -z "${CLEARWAY_TEST_DATA:-}" ]; then
    echo "skipped: needs real scans; set CLEARWAY_TEST_DATA to their folder"
    exit 77
  fi
  street=$CLEARWAY_TEST_DATA/street
  mkdir -p "$scratch/street" && cd "$scratch/street" && rm -f ./*
  found=$(example "$street/street.las" "$street/beetle.ply" "$street/trajectory.txt" 0.1)
  [ "$found" = 78439 ] || fail "the street has $found colliding points, expected 78439"
  exit
fi

rm -rf "$scratch" && mkdir -p "$scratch/scene"
cmake --install "$build" --prefix "$prefix" >/dev/null
check_headers
check_document README.md
check_document docs/guide/library.md
( # completion, where it was made
  words=$prefix/share/bash-completion/completions/clearway
  [ -f "$words" ] || exit 0
  source "$words"
  COMP_WORDS=(clearway run --env site.h5 --first) COMP_CWORD=4
  _clearway_complete
  [ "${COMPREPLY[*]}" = --first-pose ] || fail "completion gives '${COMPREPLY[*]}'"
  grep -q '^#compdef clearway' "$prefix/share/zsh/site-functions/_clearway" || fail "none for zsh"
)
cmake -S "$source/examples" -B "$scratch/example" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_CXX_FLAGS="${warnings[*]}" >/dev/null
cmake --build "$scratch/example" >/dev/null
cd "$scratch/scene"
clearway=$prefix/bin/clearway
"$clearway" scene hall -o . --points 50000 --poses 50 2>/dev/null
"$clearway" convert environment.las -o store.h5 2>/dev/null
expected=$("$clearway" run --env store.h5 --model model.ply --trajectory trajectory.txt \
  --radius 0.1 -o result.h5 --json 2>/dev/null | awk -F'[:,]' '/"colliding_points"/ { print $2 + 0 }')
found=$(example environment.las model.ply trajectory.txt 0.1)
[ "$expected" -gt 0 ] && [ "$found" = "$expected" ] || fail "found $found, expected $expected"
module=$prefix/lib/python3/dist-packages
if [ -d "$module" ]; then
  found=$(PYTHONPATH=$module PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c '
import clearway
print(clearway.Result("result.h5").source().size)')
  [ "$found" = "$expected" ] || fail "Python reads $found points, expected $expected"
fi
cmp store.h5 site.h5
cmp result.h5 out.h5
ln -sf environment.las scan.las
ln -sf model.ply car.ply
ln -sf trajectory.txt path.txt
run_program_of README.md "$expected points collide"
run_program_of docs/guide/library.md "$expected of 50000 points collide"
