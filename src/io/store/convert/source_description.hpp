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

/// The name of a file as a store keeps it: the last part of its path, as valid UTF-8.
std::string name_in_store(const std::filesystem::path& path);

/// Name, size and hash of an input; for standard input ("-") the name alone. Stops early when asked
/// to, with what was read so far.
SourceFile describe(const std::filesystem::path& path, const std::stop_token& stop,
                    const Progress& progress);

/// Describes an input by the contents of all files that are read where it is named
/// (files_behind()): its own name, the sum of their sizes and, where they are several, a hash of
/// their names and contents.
SourceFile describe_with_files(const std::filesystem::path& input);

/// Describes inputs on a separate thread while they are counted. The destructor stops it.
class SourceDescription {
 public:
  /// known: which of the files are described elsewhere; may be shorter than `files`.
  SourceDescription(std::vector<std::filesystem::path> files, std::vector<bool> known,
                    const Progress& progress);
  ~SourceDescription() { stop_.request_stop(); }

  /// Waits for the descriptions. known: those of the files that were described elsewhere.
  std::vector<SourceFile> get(std::vector<std::optional<SourceFile>> known = {});

 private:
  std::stop_source stop_;
  std::vector<std::filesystem::path> files_;
  const Progress& progress_;
  std::future<std::vector<std::optional<SourceFile>>> sources_;
};

}  // namespace clearway
