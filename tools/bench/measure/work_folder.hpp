#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "bench/measure/record.hpp"
#include "io/files/file.hpp"

namespace clearway::bench {

/// Whether two programs with this description may still differ in their source, as its "commit"
/// says.
bool may_have_changed(const Json& program);

/// The folder of an experiment's scenes, stores and results. No other experiment uses it until this
/// object or its process is gone.
class WorkFolder {
 public:
  /// Makes and locks the folder. Throws ResourceError where that fails or another process holds it.
  explicit WorkFolder(std::filesystem::path path);

  /// Notes in the folder which program made its content, unless that is noted already. Throws
  /// UsageError where another program made it, or an unknown one that left answers. Returns what
  /// the user should know: that scenes and stores of an unknown program are used, or that the
  /// program may have changed.
  std::optional<std::string> note_program(const Json& program) const;

  /// The folder of results that others are compared with.
  std::filesystem::path answers() const { return path_ / "answers"; }

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  File lock_;
};

}  // namespace clearway::bench
