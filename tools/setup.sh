# Sourced by the scripts beside it: installs what Clearway needs on Debian 12, where it is missing.

clearway_packages=(
  cmake g++ ninja-build
  libhdf5-dev libeigen3-dev libtbb-dev libspdlog-dev libcli11-dev nlohmann-json3-dev libxxhash-dev
  libpugixml-dev libproj-dev libsqlite3-dev zlib1g-dev libnanoflann-dev catch2
  pybind11-dev python3-dev python3-numpy
  hdf5-tools python3-h5py python3-matplotlib python3-pil libcgal-dev
)

install_missing_packages() {
  local missing=() package
  for package in "${clearway_packages[@]}"; do
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

# One folder for the demo and the tests, with the same options: what one has built, the other keeps.
# Kernels are compiled for the GPU that is here. Where there is none they become PTX, which the
# driver of any GPU since the H100 translates when the program starts there; that takes half the time.
configure_release() {
  local architecture=90-virtual
  if nvidia-smi >/dev/null 2>&1; then architecture=native; fi
  cmake --preset release -DCLEARWAY_WERROR=ON "-DCMAKE_CUDA_ARCHITECTURES=$architecture" >/dev/null
}
