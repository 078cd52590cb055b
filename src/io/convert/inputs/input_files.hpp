#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "io/convert/inputs/file_state.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// The files of a conversion in the order of its points, and their states when it began.
class InputFiles {
 public:
  /// inputs: files and folders, or "-" alone for standard input. With `skip_unreadable`, all of
  /// them are read once. Throws InputError, UsageError and Interrupted.
  InputFiles(const std::vector<std::filesystem::path>& inputs, bool skip_unreadable,
             const PointReadOptions& how_to_read, Progress& progress);

  bool are_a_stream() const { return is_stream_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }  ///< "-" for a stream
  /// The files, and those with their poses.
  const std::vector<std::filesystem::path>& read_files() const { return read_files_; }
  /// Remarks on contents of folders that are not read, and on files that were left out.
  std::vector<Message> remarks() const;

  /// Throws InputError, which names the file, where a file has changed since the beginning.
  void refuse_changed() const;

 private:
  bool is_stream_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::filesystem::path> read_files_;
  std::vector<std::string> skipped_;  // why files were left out
  std::vector<FileState> states_;     // states of the files at the beginning; empty for a stream
  std::vector<Message> folder_remarks_;
};

}  // namespace clearway
