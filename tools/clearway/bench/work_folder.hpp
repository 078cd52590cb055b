#pragma once

#include <filesystem>

#include "io/file.hpp"

namespace clearway::tool {

/// The folder of an experiment's scenes, stores and results. No other experiment uses it until this
/// object or its process is gone.
class WorkFolder {
 public:
  /// Makes the folder. Throws ResourceError where that fails or another process has it.
  explicit WorkFolder(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  File lock_;
};

}  // namespace clearway::tool
