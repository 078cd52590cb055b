#pragma once

#include <filesystem>

#include "io/files/file.hpp"
#include "io/files/pending_file.hpp"

namespace clearway::bench {

/// Has write(const File&) fill a file that replaces `out` once it is complete. Throws UsageError
/// where `out` is `in`, and what PendingFile, File and `write` throw; `out` then stays as it was.
template <typename Write>
void publish(const std::filesystem::path& in, const std::filesystem::path& out, Write write) {
  refuse_overwriting(out, {in});
  PendingFile pending(out, true);
  write(File::create(pending.partial()));
  pending.publish();
}

}  // namespace clearway::bench
