#pragma once

#include <filesystem>
#include <vector>

#include "io/system/file.hpp"

namespace clearway {

/// The name a file has until it is complete, and its publication under the final one. The file is
/// created and locked at once, so that an output that cannot be written, or that another process
/// is writing, is refused before the work. The destructor removes an unpublished file.
class PendingFile {
 public:
  /// Throws UsageError when `path` is empty, is not a name for a regular file, or exists and not
  /// `overwrite`; ResourceError when the file cannot be created or another process writes it.
  PendingFile(std::filesystem::path path, bool overwrite);
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile();

  /// Where to write: the final name with ".partial" appended.
  const std::filesystem::path& partial() const { return partial_; }

  /// From now on an existing file is not overwritten. Throws UsageError where there is one.
  void refuse_existing();

  /// Waits until the disk has the file, so that publish() does not.
  void sync() const;

  /// fsync, rename to the final name, fsync of the folder. Writers must have closed the file.
  void publish();

 private:
  std::filesystem::path final_;
  std::filesystem::path partial_;
  bool overwrite_;
  File lock_;
  bool published_ = false;
};

/// Throws UsageError when `output`, or the name it has until it is complete, is one of `inputs`.
void refuse_overwriting(const std::filesystem::path& output,
                        const std::vector<std::filesystem::path>& inputs);

}  // namespace clearway
