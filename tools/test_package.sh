#!/usr/bin/env bash
# Installs the Debian package into a fresh chroot of this Debian release and asks it a question there.
#   tools/test_package.sh [--library] [PACKAGE]
# PACKAGE: a .deb; without one it is built. --library: also builds a C++ program against it.
# It takes two minutes and 1 GB below TMPDIR, and removes that. The mirror is the one that apt of
# this machine uses. Where root, debootstrap or a mirror is missing it says so and ends with 77.
# CLEARWAY_TEST_DATA=FOLDER asks the question of the street, too.
set -euo pipefail
source_folder=$(cd "$(dirname "$0")/.." && pwd)
library=no package=
for word in "$@"; do
  case $word in
    --library) library=yes ;;
    -*) echo "usage: tools/test_package.sh [--library] [PACKAGE]" >&2; exit 2 ;;
    *) package=$(realpath "$word") ;;
  esac
done

skip() { echo "package_chroot: skipped: $*"; exit 77; }
fail() { echo "package_chroot: $*" >&2; exit 1; }

release=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
[ "$(. /etc/os-release && echo "$ID")" = debian ] || skip "this is not Debian"
[ "$(id -u)" -eq 0 ] || skip "only root can make a chroot"
PATH=$PATH:/usr/sbin:/sbin
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
mirror=$(apt-get indextargets --format '$(SITE) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' |
  awk -v release="$release" '$2 == release && $3 == "main" { print $1; exit }')
[ -n "$mirror" ] || skip "apt has no mirror of $release"

if [ -z "$package" ]; then
  cd "$source_folder"
  source tools/setup.sh
  install_missing_packages
  configure_release
  cmake --build build/release
  (cd build/release && cpack >/dev/null)
  package=$(ls -t "$source_folder"/build/release/clearway_*.deb | head -1)
fi
echo "package_chroot: ${package##*/}, $(stat -c %s "$package") bytes"

scratch=$(mktemp -d)
root=$scratch/root
trap 'rm -rf --one-file-system "$scratch"' EXIT
debootstrap --variant=minbase "$release" "$root" "$mirror" >"$scratch/debootstrap.log" 2>&1 || {
  tail -5 "$scratch/debootstrap.log" >&2
  grep -qE "mknod|noexec|nodev|Couldn't download|Failed getting release file" \
    "$scratch/debootstrap.log" && skip "debootstrap cannot work here"
  fail "debootstrap failed"
}
echo "package_chroot: a fresh $release from apt's mirror"
cp /etc/resolv.conf "$root/etc/resolv.conf"

as_root() { DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 chroot "$root" "$@"; }
as_user() { LC_ALL=C.UTF-8 HOME=/tmp/asked chroot --userspec=nobody:nogroup "$root" "$@"; }
install_in_chroot() {
  as_root apt-get install -y -qq --no-install-recommends "$@" >>"$scratch/apt.log" 2>&1 || {
    tail -20 "$scratch/apt.log" >&2
    fail "apt-get install $* failed"
  }
}

cp "$package" "$root/tmp/clearway.deb"
chmod 644 "$root/tmp/clearway.deb"
as_root apt-get update -qq >"$scratch/apt.log" 2>&1
install_in_chroot /tmp/clearway.deb
echo "package_chroot: installed with $(as_root dpkg-query -W -f '${Status} ${Version}' clearway)"

mkdir -m 1777 "$root/tmp/asked"
as_user clearway --version
cat >"$root/tmp/asked/read.py" <<'EOF'
import sys
import clearway
result = clearway.Result(sys.argv[1])
poses = clearway.read_trajectory(sys.argv[2])
query = clearway.Query(clearway.read_model(sys.argv[3]), poses, 0.1)
report = clearway.search(clearway.Store(sys.argv[4]), query, "/tmp/asked/python.h5", overwrite=True)
assert (result.source() == clearway.Result("/tmp/asked/python.h5").source()).all()
assert result.xyz().shape == (len(result), 3)
print(f"clearway {clearway.__version__} of {clearway.__file__}: {len(result)} points")
EOF

# ask FOLDER SCAN MODEL TRAJECTORY: with the program, read and asked again in Python.
ask() {
  as_user sh -ec 'cd "$1"
    clearway convert "$2" -o site.h5 2>/dev/null
    clearway run --env site.h5 --model "$3" --trajectory "$4" --radius 0.1 -o out.h5 2>/dev/null
    python3 /tmp/asked/read.py out.h5 "$4" "$3" site.h5 | tee read.txt' sh "$@"
}
mkdir -m 1777 "$root/tmp/asked/hall"
as_user clearway scene hall --points 200000 -o /tmp/asked/hall 2>/dev/null
ask /tmp/asked/hall environment.las model.ply trajectory.txt
if [ -n "${CLEARWAY_TEST_DATA:-}" ]; then
  mkdir -m 1777 "$root/tmp/asked/street"
  cp "$CLEARWAY_TEST_DATA"/street/{street.las,beetle.ply,trajectory.txt} "$root/tmp/asked/street"
  ask /tmp/asked/street street.las beetle.ply trajectory.txt
  grep -q ': 78439 points$' "$root/tmp/asked/street/read.txt" || fail "the street has 78439 points"
fi

for file in share/man/man1/clearway-run.1.gz share/bash-completion/completions/clearway \
  share/doc/clearway/copyright lib/libclearway.a include/clearway/clearway.hpp; do
  [ -e "$root/usr/$file" ] || fail "no /usr/$file"
done

if [ "$library" = yes ]; then
  suggested=$(as_root dpkg-query -W -f '${Suggests}' clearway | tr -d ,)
  install_in_chroot make $suggested
  cp -r "$source_folder/examples" "$root/tmp/asked/examples"
  chmod -R a+rwX "$root/tmp/asked/examples"
  as_user sh -ec 'cd /tmp/asked/hall && cmake -S ../examples -B ../build >/dev/null
    cmake --build ../build >/dev/null && rm site.h5 out.h5
    ../build/find_collisions environment.las model.ply trajectory.txt 0.1 2>/dev/null'
fi

as_root apt-get remove -y -qq clearway >>"$scratch/apt.log" 2>&1
left=$(cd "$root" && find usr -ipath '*clearway*')
[ -z "$left" ] || fail "removing the package leaves $left"
echo "package_chroot: removed without a trace"
