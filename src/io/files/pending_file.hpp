#pragma once

#include <filesystem>
#include <vector>

#include "io/files/file.hpp"

namespace clearway {

/// An output under a partial name until it is complete, and its publication under the final one.
/// The file is created and locked at once, so that an output that cannot be written, or that
/// another process is writing, is refused before the work begins. The destructor removes an
/// unpublished file.
class PendingFile {
 public:
  /// Creates and locks the partial file. Throws UsageError when `path` is empty, is not a name for
  /// a regular file, or exists without `overwrite`; ResourceError when the file cannot be created
  /// or another process writes it.
  PendingFile(std::filesystem::path path, bool overwrite);
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile();

  /// The path to write to: the final name with ".partial" appended.
  const std::filesystem::path& partial() const { return partial_; }

  /// Revokes `overwrite`. Throws UsageError where the output exists.
  void refuse_existing();

  /// Whether the destructor leaves an unpublished file for a later process.
  void keep(bool kept) { kept_ = kept; }

  /// Waits until the file is on the disk, so that publish() need not.
  void sync() const;

  /// Syncs the file, renames it to the final name and syncs the folder. Writers must have closed
  /// the file.
  void publish();

 private:
  std::filesystem::path final_;
  std::filesystem::path partial_;
  bool overwrite_;
  File lock_;
  bool published_ = false;
  bool kept_ = false;
};

/// Throws UsageError when `output` or its partial name is one of `inputs`.
void refuse_overwriting(const std::filesystem::path& output,
                        const std::vector<std::filesystem::path>& inputs);

}  // namespace clearway
