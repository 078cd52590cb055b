#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "io/system/file.hpp"

namespace clearway {

/// Writes a ZIP archive front to back. All members are dated 1980-01-01, the format's first day, so
/// equal contents give equal bytes with the same zlib. Up to 65,534 members and 4 GiB in all.
/// Throws ResourceError, and UsageError beyond these limits. Source: PKWARE, APPNOTE.TXT 6.3.10.
class ZipWriter {
 public:
  /// The caller owns the file.
  explicit ZipWriter(const File& file) : file_(file) {}

  /// Adds a member, compressed where that makes it smaller. name: ASCII.
  void add(const std::string& name, std::string_view bytes);
  /// Writes the directory. Called after the last member.
  void finish();

 private:
  void write(std::string_view bytes);

  const File& file_;
  std::uint64_t written_ = 0;
  std::uint32_t members_ = 0;
  std::string directory_;
};

}  // namespace clearway
