#pragma once

#include <sys/stat.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "io/files/file.hpp"
#include "io/files/xxh64.hpp"
#include "io/scans/point_reader.hpp"
#include "io/store/convert/convert.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// State of a file that differs once it was written to or another file has its name: the size in
/// bytes, and the times of the last change of its contents and of its status, in seconds and
/// nanoseconds. The inode's number is left out, because some network file systems assign a new one
/// to a file that nobody has open.
using FileState = std::array<std::int64_t, 5>;

/// The state of a file; all zero where it cannot be read.
inline FileState state_of(const std::filesystem::path& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec, found.st_ctim.tv_sec,
          found.st_ctim.tv_nsec};
}

/// Describes the files that a pass reads in pieces by name, size and hash, from the bytes of the
/// pieces. Only the bytes before, between and after the pieces are read for it. Pieces that were
/// not read do not enter the hash.
class FileHashes {
 public:
  /// wanted: which of the files to describe; pieces of others are ignored.
  FileHashes(const std::vector<std::filesystem::path>& files, std::vector<bool> wanted)
      : files_(files), wanted_(std::move(wanted)), found_(files.size()) {}

  /// Adds the next piece, in the order of the points.
  void add(std::size_t file, const PieceBytes& piece);
  /// Leaves out a file that is not read at all.
  void pass_over(std::size_t file);
  /// Called after the last piece. Returns a description for each file; nullopt for files without a
  /// piece.
  std::vector<std::optional<SourceFile>> finish();

 private:
  void read_until(std::uint64_t position);
  void end_file();

  const std::vector<std::filesystem::path>& files_;
  std::vector<bool> wanted_;
  std::vector<std::optional<SourceFile>> found_;
  std::optional<File> file_;  // the file that is being hashed
  std::size_t number_ = 0;
  std::uint64_t position_ = 0;  // the file is hashed up to this byte
  std::optional<Xxh64Stream> hash_;
};

/// Which files of a list can be read, and why others are left out.
struct ReadableInputs {
  std::vector<std::uint64_t> numbers;  ///< of the files that can be read, among all, ascending
  std::vector<std::string> skipped;    ///< why files are left out, with their names

  template <typename Values>
  void keep(Values& values) {
    values.add(numbers, skipped);
  }
};

/// Reads every file to its end. Throws InputError where none can be read, and Interrupted.
ReadableInputs readable_inputs(std::span<const std::filesystem::path> files,
                               const PointReadOptions& how_to_read, Progress& progress);

/// The files with these numbers. Throws InputError where there is no such file.
std::vector<std::filesystem::path> files_of(const std::vector<std::filesystem::path>& all,
                                            const std::vector<std::uint64_t>& numbers);

/// The files of a conversion in the order of its points, and their states when it began.
class InputFiles {
 public:
  /// Where unreadable files are to be skipped, all of them are read once. readable: which of them
  /// an earlier process found to be readable, so that none has to be read for it; or null. Throws
  /// InputError, UsageError and Interrupted.
  InputFiles(const ConversionOptions& options, const PointReadOptions& how_to_read,
             Progress& progress, const ReadableInputs* readable = nullptr);

  bool are_a_stream() const { return is_stream_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }  ///< "-" for a stream
  /// The files, and those with their poses.
  const std::vector<std::filesystem::path>& read_files() const { return read_files_; }
  /// Remarks on contents of folders that are not read, and on files that were left out.
  std::vector<Message> remarks() const;
  const ReadableInputs& readable() const { return readable_; }

  /// Throws InputError, which names the file, where a file has changed since the beginning.
  void refuse_changed() const;

 private:
  bool is_stream_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::filesystem::path> read_files_;
  ReadableInputs readable_;
  std::vector<FileState> states_;  // states of the files at the beginning; empty for a stream
  std::vector<Message> folder_remarks_;
};

}  // namespace clearway
