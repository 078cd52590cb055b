#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// Name, size and hash of an input; of standard input ("-") the name alone. Stops early, with what
/// was read so far, when asked to.
SourceFile describe(const std::filesystem::path& path, const std::stop_token& stop,
                    const Progress& progress);

/// Describes inputs on a thread of its own, while they are counted; gives up when it goes.
class SourceDescription {
 public:
  /// known: which of them somebody else describes; may be shorter.
  SourceDescription(std::vector<std::filesystem::path> files, std::vector<bool> known,
                    const Progress& progress);
  ~SourceDescription() { stop_.request_stop(); }

  /// known: those that somebody else described.
  std::vector<SourceFile> get(std::vector<std::optional<SourceFile>> known = {});

 private:
  std::stop_source stop_;
  std::vector<std::filesystem::path> files_;
  const Progress& progress_;
  std::future<std::vector<std::optional<SourceFile>>> sources_;
};

/// "adaptive" or "regular:SIZE".
std::string layout_name(const std::optional<double>& regular_size);

}  // namespace clearway
