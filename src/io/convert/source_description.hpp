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

/// Describes the inputs on a thread of its own, while they are counted; gives up when it goes.
class SourceDescription {
 public:
  SourceDescription(std::vector<std::filesystem::path> files, const Progress& progress)
      : sources_(std::async(std::launch::async,
                            [files = std::move(files), &progress, stop = stop_.get_token()] {
                              std::vector<SourceFile> sources;
                              for (const auto& file : files)
                                sources.push_back(describe(file, stop, progress));
                              return sources;
                            })) {}
  ~SourceDescription() { stop_.request_stop(); }

  std::vector<SourceFile> get() { return sources_.get(); }

 private:
  std::stop_source stop_;
  std::future<std::vector<SourceFile>> sources_;
};

/// "adaptive" or "regular:SIZE".
std::string layout_name(const std::optional<double>& regular_size);

}  // namespace clearway
