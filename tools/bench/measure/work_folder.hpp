#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "bench/measure/record.hpp"
#include "io/system/file.hpp"

namespace clearway::bench {

/// Whether a program of this description, its "commit", may be of another source than one of the
/// same description.
bool may_have_changed(const Json& program);

/// The folder of an experiment's scenes, stores and results. No other experiment uses it until this
/// object or its process is gone.
class WorkFolder {
 public:
  /// Makes the folder. Throws ResourceError where that fails or another process has it.
  explicit WorkFolder(std::filesystem::path path);

  /// Notes in the folder which program made what it holds, where that is not noted yet. Throws
  /// UsageError where it was another one, or one unknown that left answers. Gives back what the
  /// user should know: that there are scenes and stores of an unknown program, which are used, or
  /// that the program may have changed.
  std::optional<std::string> note_program(const Json& program) const;

  /// The folder of results that others are compared with.
  std::filesystem::path answers() const { return path_ / "answers"; }

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  File lock_;
};

}  // namespace clearway::bench
