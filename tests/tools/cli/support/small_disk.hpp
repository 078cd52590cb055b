#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "support/result_fixture.hpp"

namespace clearway::test {

/// Lets this process mount file systems, which only it and its children see and which end with it.
/// False where the system does not permit that. To be called before there are threads.
bool may_mount();

/// A file system in memory with room for a few bytes. Only where may_mount() allows it.
class SmallDisk {
 public:
  explicit SmallDisk(std::uint64_t bytes);
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk();

  std::filesystem::path path() const { return folder_ / "disk"; }
  std::filesystem::path operator/(const std::string& name) const { return path() / name; }

  void resize(std::uint64_t bytes);
  void make_read_only(std::uint64_t bytes);

  std::vector<std::string> files() const;

 private:
  void remount(unsigned long flags, std::uint64_t bytes);

  ScratchFolder folder_;
};

}  // namespace clearway::test
