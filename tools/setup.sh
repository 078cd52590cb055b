# Sourced by the scripts beside it: installs the packages of Debian 12 or 13 that are missing, and
# configures the build. Both releases give the packages the same names.

# What the program `clearway` needs.
program_packages=(
  cmake g++ ninja-build
  libhdf5-dev libeigen3-dev libtbb-dev libspdlog-dev libcli11-dev nlohmann-json3-dev libxxhash-dev
  libpugixml-dev libproj-dev libsqlite3-dev libfmt-dev zlib1g-dev
)
# What the Python module needs besides, and what makes packages.
python_packages=(pybind11-dev python3-dev python3-numpy)
packaging_packages=(dpkg-dev file patchelf)
# What everything needs: clearway-bench with other libraries, the tests and the charts too.
clearway_packages=(
  "${program_packages[@]}" "${python_packages[@]}" "${packaging_packages[@]}"
  catch2 libcgal-dev libnanoflann-dev hdf5-tools python3-h5py python3-matplotlib
)

# install_missing_packages [PACKAGE...]: without names, what everything needs.
install_missing_packages() {
  local missing=() package
  [ $# -gt 0 ] || set -- "${clearway_packages[@]}"
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
      missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  echo "Installing: ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "Not root and no sudo here; let root run: apt-get install ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${missing[@]}"
}

# One folder for the demo and the tests: what one has built, the other keeps. Warnings are errors
# where CLEARWAY_WERROR=ON, as in .ci/run: those of a newer compiler should not stop anybody else.
# Kernels are compiled for the GPU that is here. Where there is none they become PTX, which the
# driver of any GPU since the H100 translates when the program starts there; that takes half the time.
# CLEARWAY_QUICK_KERNELS=ON, as in .ci/run, compiles such PTX in a third of the time, and makes a program
# that takes no GPU, because kernels that are compiled in this way fail on one.
configure_release() {
  local architecture=90-virtual quick=${CLEARWAY_QUICK_KERNELS:-OFF}
  if nvidia-smi >/dev/null 2>&1; then
    architecture=native
    quick=OFF
  fi
  cmake --preset release "-DCLEARWAY_WERROR=${CLEARWAY_WERROR:-OFF}" \
    "-DCMAKE_CUDA_ARCHITECTURES=$architecture" "-DCLEARWAY_QUICK_KERNELS=$quick" "$@" >/dev/null
}
