#include "tools/cli/support/small_disk.hpp"

#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

namespace clearway::test {
namespace {

std::string size_option(std::uint64_t bytes) { return "size=" + std::to_string(bytes); }

}  // namespace

bool may_mount() {
  static const bool may = [] {
    const std::string user = "0 " + std::to_string(::getuid()) + " 1";
    const std::string group = "0 " + std::to_string(::getgid()) + " 1";
    if (::unshare(CLONE_NEWNS) != 0) {
      if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
      put_bytes("/proc/self/setgroups", "deny");
      put_bytes("/proc/self/uid_map", user);
      put_bytes("/proc/self/gid_map", group);
    }
    return ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
  }();
  return may;
}

SmallDisk::SmallDisk(std::uint64_t bytes) {
  std::filesystem::create_directory(path());
  if (::mount("none", path().c_str(), "tmpfs", 0, size_option(bytes).c_str()) != 0) {
    throw std::runtime_error("cannot mount a file system in memory");
  }
}

SmallDisk::~SmallDisk() { ::umount2(path().c_str(), MNT_DETACH); }

void SmallDisk::resize(std::uint64_t bytes) { remount(0, bytes); }

void SmallDisk::make_read_only(std::uint64_t bytes) { remount(MS_RDONLY, bytes); }

std::vector<std::string> SmallDisk::files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path())) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void SmallDisk::remount(unsigned long flags, std::uint64_t bytes) {
  if (::mount(nullptr, path().c_str(), nullptr, MS_REMOUNT | flags, size_option(bytes).c_str()) !=
      0) {
    throw std::runtime_error("cannot change the file system in memory");
  }
}

}  // namespace clearway::test
