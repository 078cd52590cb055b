# Sourced by tools/test_package.sh and tools/test_releases.sh: fresh Debian systems to test in, in
# folders (chroots). They need root, debootstrap and the mirror that apt of this machine uses.
# The script that sources it sets `name`, which begins its messages, and calls own_mounts first.

skip() { echo "$name: skipped: $*"; exit 77; }
fail() { echo "$name: $*" >&2; exit 1; }

# own_mounts SCRIPT ARGUMENT...: starts the script again where what it mounts is seen by nobody else
# and is gone when it ends.
own_mounts() {
  [ "$(id -u)" -eq 0 ] || skip "only root can make a chroot"
  [ -n "${CLEARWAY_OWN_MOUNTS:-}" ] || CLEARWAY_OWN_MOUNTS=yes exec unshare --mount "$@"
  unset CLEARWAY_OWN_MOUNTS
}

# Sets `release`, the Debian release of this machine, `mirror`, and `scratch`, a folder that is
# removed at the end.
find_mirror() {
  local site
  [ "$(. /etc/os-release && echo "$ID")" = debian ] || skip "this is not Debian"
  release=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
  PATH=$PATH:/usr/sbin:/sbin
  command -v debootstrap >/dev/null || skip "debootstrap is not installed"
  mirror=$(apt-get indextargets --format '$(SITE) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' |
    awk -v release="$release" '$2 == release && $3 == "main" { print $1; exit }')
  [ -n "$mirror" ] || skip "apt has no mirror of $release"
  scratch=$(mktemp -d)
  trap remove_scratch EXIT
}

remove_scratch() {
  local folder
  awk -v scratch="$scratch/" 'index($2, scratch) == 1 { print $2 }' /proc/mounts | sort -r |
    while read -r folder; do umount "$folder"; done
  rm -rf --one-file-system "$scratch"
}

# make_root RELEASE: makes `root`, a new and minimal system of that release.
make_root() {
  local base=$scratch/$1
  [ -d "$base" ] || debootstrap --variant=minbase "$1" "$base" "$mirror" \
    >"$scratch/debootstrap.log" 2>&1 || {
    tail -5 "$scratch/debootstrap.log" >&2
    grep -qE "mknod|noexec|nodev|Couldn't download|Failed getting release file|No such script" \
      "$scratch/debootstrap.log" && skip "debootstrap cannot make $1 here"
    fail "debootstrap failed"
  }
  root=$(mktemp -d "$scratch/root.XXX")
  chmod 755 "$root"
  cp -a "$base/." "$root"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  mount -t proc proc "$root/proc"
  mount --bind /dev "$root/dev"
  mount -t devpts devpts "$root/dev/pts" -o newinstance,ptmxmode=0666,mode=620,gid=5
  mount --bind "$root/dev/pts/ptmx" "$root/dev/ptmx"
  mount -t tmpfs tmpfs "$root/dev/shm"
  echo "$name: a fresh $1 from apt's mirror"
}

# TMPDIR names a folder of this machine, which the system does not have.
as_root() {
  env -u TMPDIR DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/root chroot "$root" "$@"
}
as_user() {
  env -u TMPDIR LC_ALL=C.UTF-8 HOME=/tmp/asked chroot --userspec=nobody:nogroup "$root" "$@"
}

install_in_chroot() {
  { as_root apt-get update -qq &&
    as_root apt-get install -y -qq --no-install-recommends "$@"; } >"$scratch/apt.log" 2>&1 || {
    tail -20 "$scratch/apt.log" >&2
    fail "apt-get install $* failed"
  }
}
