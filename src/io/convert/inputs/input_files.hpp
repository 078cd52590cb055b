#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "io/convert/inputs/file_state.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// The files of a conversion in the order of its points, and how they were when it began.
class InputFiles {
 public:
  /// inputs: files and folders, or "-" alone for standard input. Where `skip_unreadable`, reads all
  /// of them once. Throws InputError, UsageError and Interrupted.
  InputFiles(const std::vector<std::filesystem::path>& inputs, bool skip_unreadable,
             const PointReadOptions& how_to_read, Progress& progress);

  bool are_a_stream() const { return is_stream_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }  ///< "-": stream
  /// The files, and those that hold their poses.
  const std::vector<std::filesystem::path>& read_files() const { return read_files_; }
  /// On what a folder holds that is not read, and on the files left out.
  std::vector<Message> remarks() const;

  /// Throws InputError, naming it, where a file is not as it was at first.
  void refuse_changed() const;

 private:
  bool is_stream_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::filesystem::path> read_files_;
  std::vector<std::string> skipped_;  // why, of the files left out
  std::vector<FileState> states_;     // of the files read, at first; none of a stream
  std::vector<Message> folder_remarks_;
};

}  // namespace clearway
