#!/usr/bin/env bash
# Installs the packages of tools/package.sh into fresh systems and asks each the question of the demo.
#   tools/test_package.sh [--library] [PACKAGE...]
# PACKAGE: a .deb, which is installed in a fresh Debian of this release; a .tar.gz, which is unpacked in
# a Debian of this release and in later ones, without any package; a .whl, which is installed in a
# fresh virtual environment. Without one, all three are made and tested.
# --library: also builds a C++ program against the .deb.
# It takes some minutes and 1 GB below TMPDIR, and removes that. Where root, debootstrap or a mirror is
# missing it says so and ends with 77. CLEARWAY_TEST_DATA=FOLDER asks the .deb about the street, too.
set -euo pipefail
source_folder=$(cd "$(dirname "$0")/.." && pwd)
name=test_package
source "$source_folder/tools/chroot.sh"
own_mounts "$0" "$@"

library=no packages=()
for word in "$@"; do
  case $word in
    --library) library=yes ;;
    *.deb | *.tar.gz | *.whl) packages+=("$(realpath "$word")") ;;
    *) echo "usage: tools/test_package.sh [--library] [PACKAGE...]" >&2; exit 2 ;;
  esac
done
find_mirror
if [ ${#packages[@]} -eq 0 ]; then
  "$source_folder/tools/package.sh"
  packages=("$source_folder"/dist/clearway*)
fi

# check_code BINARY: every kernel has machine code for every GPU of the preset `package`, and PTX of
# the last; or there is no CUDA at all.
check_code() {
  local wanted architecture code expected
  code=$("$source_folder/tools/packaging/gpu_code.py" "$1")
  if [ -z "$code" ]; then
    echo "$name: ${1##*/} was made without CUDA"
    return
  fi
  wanted=$(sed -n 's/.*"package".*"CMAKE_CUDA_ARCHITECTURES": "\([^"]*\)".*/\1/p' \
    "$source_folder/CMakePresets.json" | tr ';' ' ')
  expected=$(for architecture in $wanted; do
    echo "sm_${architecture%-real}.cubin"
    [ "$architecture" != "${architecture%-real}" ] || echo "sm_$architecture.ptx"
  done | sort)
  [ "$(awk '{ print $1 }' <<<"$code" | sort)" = "$expected" ] &&
    [ "$(awk '{ print $2 }' <<<"$code" | sort -u | wc -l)" = 1 ] ||
    fail "${1##*/} has the code" $code ", expected" $expected
  echo "$name: the kernels of ${1##*/} have" $expected
}

# What the user of the chroot writes lies in /tmp/asked. The places need the data of PROJ.
make_workplace() {
  mkdir -m 1777 "$root/tmp/asked"
  cat >"$root/tmp/asked/places.csv" <<'END'
latitude,longitude,height,roll_deg,pitch_deg,heading_deg
48,9,0,0,0,0
48.001,9,0,0,0,0
END
}

# check_road FOLDER: the conflicts of a check are those that the demo finds.
check_road() {
  local found
  found=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "points") column = i }
    NR > 1 { print $column }' "$root$1/conflicts.csv" | sort -n | xargs)
  [ "$found" = "83 6045" ] || fail "the conflicts of the road have $found points, not 83 and 6045"
  echo "$name: the road has the demo's conflicts, of $found points"
}

# ask_road PROGRAM: the demo's question, and the distance of the places.
ask_road() {
  as_user env program="$1" sh -ec 'cd /tmp/asked
    $program scene road --points 2000000 -o road 2>/dev/null
    $program check road/environment.las --model road/model.ply --trajectory road/trajectory.txt \
      --radius 0.1 -o road/site 2>/dev/null >road/check.txt
    $program trajectory info places.csv --trajectory-crs EPSG:25832 2>/dev/null |
      grep "^length  *111.146 m"' || fail "the program fails"
  check_road /tmp/asked/road/site
}

# The .deb, in a Debian of this release.
test_deb() {
  local package=$1 suggested left file
  make_root "$release"
  cp "$package" "$root/tmp/clearway.deb"
  chmod 644 "$root/tmp/clearway.deb"
  install_in_chroot /tmp/clearway.deb
  echo "$name: installed with $(as_root dpkg-query -W -f '${Status} ${Version}' clearway)"
  check_code "$root/usr/bin/clearway"
  make_workplace
  ask_road clearway
  ask_scans
  for file in share/man/man1/clearway-run.1.gz share/bash-completion/completions/clearway \
    share/zsh/vendor-completions/_clearway \
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
  echo "$name: removed without a trace"
}

# ask_scans: small scenes, read and asked again in Python; with real data the street, too.
ask_scans() {
  cat >"$root/tmp/asked/read.py" <<'END'
import sys
import clearway
result = clearway.Result(sys.argv[1])
poses = clearway.read_trajectory(sys.argv[2])
query = clearway.Query(clearway.read_model(sys.argv[3]), poses, 0.1)
report = clearway.search(clearway.Store(sys.argv[4]), query, "/tmp/asked/python.h5", overwrite=True)
assert (result.source() == clearway.Result("/tmp/asked/python.h5").source()).all()
assert result.xyz().shape == (len(result), 3)
print(f"clearway {clearway.__version__} of {clearway.__file__}: {len(result)} points")
END
  mkdir -m 1777 "$root/tmp/asked/hall"
  as_user clearway scene hall --points 200000 -o /tmp/asked/hall 2>/dev/null
  ask_scan /tmp/asked/hall environment.las model.ply trajectory.txt
  if [ -n "${CLEARWAY_TEST_DATA:-}" ]; then
    mkdir -m 1777 "$root/tmp/asked/street"
    cp "$CLEARWAY_TEST_DATA"/street/{street.las,beetle.ply,trajectory.txt} "$root/tmp/asked/street"
    ask_scan /tmp/asked/street street.las beetle.ply trajectory.txt
    grep -q ': 78439 points$' "$root/tmp/asked/street/read.txt" || fail "the street has 78439 points"
  fi
}

# ask_scan FOLDER SCAN MODEL TRAJECTORY: with the program, read and asked again in Python.
ask_scan() {
  as_user sh -ec 'cd "$1"
    clearway convert "$2" -o site.h5 2>/dev/null
    clearway run --env site.h5 --model "$3" --trajectory "$4" --radius 0.1 -o out.h5 2>/dev/null
    python3 /tmp/asked/read.py out.h5 "$4" "$3" site.h5 | tee read.txt' sh "$@"
}

# The .tar.gz, in bare systems of this release of Debian and of later ones.
test_tar() {
  local package=$1 tested folder
  for tested in bookworm trixie; do
    [ "$tested" != bookworm ] || [ "$release" = bookworm ] || continue
    make_root "$tested"
    make_workplace
    tar -C "$root/tmp" -xzf "$package"
    folder=/tmp/$(basename "$package" .tar.gz)
    check_code "$root$folder/bin/clearway"
    ask_road "$folder/bin/clearway"
  done
}

# The .whl, in a fresh virtual environment. NumPy comes from where pip finds it, or where it finds
# nothing from Debian.
test_wheel() {
  local package=$1 folder=$scratch/program python
  make_root "$release"
  install_in_chroot python3-venv ca-certificates
  make_workplace
  cp "$package" "$root/tmp"
  as_user sh -ec 'mkdir -p /tmp/asked && cd /tmp/asked && python3 -m venv venv
    venv/bin/pip install --quiet --disable-pip-version-check --no-cache-dir --retries 0 "$1"' \
    sh "/tmp/${package##*/}" 2>"$scratch/pip.log" || {
    echo "$name: pip finds no NumPy: $(tail -1 "$scratch/pip.log")"
    install_in_chroot python3-numpy
    as_user sh -ec 'cd /tmp/asked && python3 -m venv --clear --system-site-packages venv
      venv/bin/pip install --quiet --no-index "$1"' sh "/tmp/${package##*/}" ||
      fail "pip does not install the wheel"
  }
  check_code "$root"/tmp/asked/venv/lib/python3*/site-packages/clearway/_clearway*.so

  # The question, with the path that check makes of the demo's.
  mkdir "$folder" "$root/tmp/asked/road"
  tar -C "$folder" -xzf "${package%/*}"/clearway-*-linux-*.tar.gz --strip-components 1 ||
    fail "no .tar.gz beside the wheel, whose program makes the road"
  "$folder/bin/clearway" scene road --points 2000000 -o "$scratch/road" 2>/dev/null
  cp "$scratch"/road/* "$root/tmp/asked/road"
  chmod -R a+rwX "$root/tmp/asked/road"
  cp "$source_folder/tools/packaging/ask_wheel.py" "$root/tmp/asked"
  as_user sh -ec 'cd /tmp/asked/road && ../venv/bin/python ../ask_wheel.py' ||
    fail "the wheel's module fails"
  check_road /tmp/asked/road
}

for package in "${packages[@]}"; do
  echo "$name: ${package##*/}, $(stat -c %s "$package") bytes"
  case $package in
    *.deb) test_deb "$package" ;;
    *.tar.gz) test_tar "$package" ;;
    *.whl) test_wheel "$package" ;;
  esac
done
