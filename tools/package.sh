#!/usr/bin/env bash
# Makes the packages of Clearway in dist/, and prints their sizes:
#   clearway_VERSION_PROCESSOR.deb              for this release of Debian: program, its manual pages, the
#                                               C++ library and the Python module
#   clearway-VERSION-linux-PROCESSOR.tar.gz     the program with all its libraries, for any Linux whose
#                                               C library is as new as the one here or newer
#   clearway-VERSION-PYTHON-SYSTEM.whl          the Python module with all its libraries, for pip
# Where nvcc is, they have code for the GPUs that the preset `package` of CMakePresets.json lists;
# without it they are made without CUDA, and the script says so. Installs missing packages (Debian 12
# or 13). tools/test_package.sh tests what this makes.
# Usage: tools/package.sh
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -eq 0 ] || { echo "usage: tools/package.sh" >&2; exit 2; }
source tools/setup.sh
install_missing_packages "${program_packages[@]}" "${python_packages[@]}" "${packaging_packages[@]}"

configured=$(cmake --preset package "-DCLEARWAY_WERROR=${CLEARWAY_WERROR:-OFF}")
case $configured in
  *"CUDA part: TRUE"*) ;;
  *) echo "nvcc is not here: the packages are made without CUDA" ;;
esac
cmake --build build/package
version=$(build/package/tools/clearway --version)
stage=$PWD/build/package/stage
rm -rf dist "$stage" build/package/clearway_*.deb
mkdir -p dist "$stage"

# stage FOLDER COMPONENT: installs a component below the folder.
stage() { cmake --install build/package --prefix "$stage/$1" --strip --component "$2" >/dev/null; }

(cd build/package && cpack >/dev/null)
mv build/package/clearway_*.deb dist/

program=clearway-$version-linux-$(uname -m)
stage "$program" tools
stage "$program" package
find "$stage/$program" -name 'clearway-bench*' -delete
cp README.md LICENSE "$stage/$program"
tools/packaging/bundle.py "$stage/$program/bin/clearway" "$stage/$program" \
  --notices "$stage/$program/share/doc/clearway/notices"
tar -C "$stage" --owner=0 --group=0 --sort=name -cf - "$program" | gzip -9n >"dist/$program.tar.gz"

# What pybind11 knows of NumPy 2, it knows from version 2.12 on.
numpy='>=1.20'
dpkg --compare-versions "$(dpkg-query -W -f '${Version}' pybind11-dev)" ge 2.12 || numpy+=',<2'
stage python python
stage python package
module=$stage/python/lib/python3/dist-packages
mv "$stage/python/share/doc/clearway/notices" "$module/clearway/notices"
tools/packaging/bundle.py "$module"/clearway/_clearway*.so "$module/clearway" --own-names \
  --notices "$module/clearway/notices"
/usr/bin/python3 tools/packaging/wheel.py "$module" --version "$version" --numpy "$numpy" \
  --licence LICENSE -o dist >/dev/null

for package in dist/*; do
  awk -v name="$package" -v bytes="$(stat -c %s "$package")" \
    'BEGIN { printf "%s: %.1f MB\n", name, bytes / 1e6 }'
done
