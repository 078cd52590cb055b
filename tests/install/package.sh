#!/usr/bin/env bash
# Makes the Debian package of a build folder and looks into it: package.sh BUILD
# tools/test_package.sh installs it into a fresh system.
set -euo pipefail
build=$1
scratch=$build/package
fail() { echo "package: $*" >&2; exit 1; }

for program in dpkg-deb dpkg-shlibdeps file; do
  command -v "$program" >/dev/null || { echo "package: skipped: $program is not installed"; exit 77; }
done
rm -rf "$scratch" && mkdir -p "$scratch"
# Not compressed: that takes ten times as long as all the rest, and is the work of dpkg-deb.
cpack --config "$build/CPackConfig.cmake" -B "$scratch" -D CPACK_DEBIAN_COMPRESSION_TYPE=none \
  >"$scratch/cpack.log" 2>&1 ||
  { cat "$scratch/cpack.log" >&2; fail "cpack failed"; }
packages=("$scratch"/clearway_*.deb)
[ ${#packages[@]} -eq 1 ] && [ -f "${packages[0]}" ] || fail "expected one package, found ${packages[*]}"
package=${packages[0]}
dpkg-deb -x "$package" "$scratch/root"

has() { [ -s "$scratch/root/usr/$1" ] || fail "no /usr/$1"; }
has bin/clearway
has include/clearway/clearway.hpp
has share/bash-completion/completions/clearway
has share/zsh/vendor-completions/_clearway
has share/doc/clearway/copyright
has share/doc/clearway/changelog.gz
for command in clearway clearway-run clearway-convert; do has "share/man/man1/$command.1.gz"; done
find "$scratch/root" -name libclearway.a | grep -q . || fail "no library"
find "$scratch/root" -name ClearwayConfig.cmake | grep -q . || fail "no CMake package"

field() { dpkg-deb -f "$package" "$1"; }
for library in libhdf5 libtbb libproj libc6; do
  field Depends | grep -q "$library" || fail "it does not depend on $library: $(field Depends)"
done
version=$("$scratch/root/usr/bin/clearway" --version)
[ "$(field Version)" = "$version" ] || fail "version $(field Version), the program says $version"
outside=$(cd "$scratch/root" && find . -type f -not -path './usr/*')
[ -z "$outside" ] || fail "a file outside /usr: $outside"

if [ -d "$build/python" ]; then
  field Depends | grep -q python3-numpy || fail "it does not depend on python3-numpy"
  found=$(cd / && PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$scratch/root/usr/lib/python3/dist-packages \
    /usr/bin/python3 -c 'import clearway; print(clearway.__version__, clearway.__file__)')
  [[ $found == "$version $scratch/root/"* ]] || fail "Python finds $found"
fi
echo "package: ${package##*/}, $(stat -c %s "$package") bytes"
