#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "io/formats/point_reader.hpp"
#include "io/store/store_metadata.hpp"
#include "io/system/file.hpp"
#include "io/system/xxh64.hpp"

namespace clearway {

/// Describes the files that a pass reads in pieces by name, size and hash, from the bytes of the
/// pieces. Only the bytes before, between and behind the pieces are read for it.
class FileHashes {
 public:
  /// wanted: which of the files to describe; pieces of others are ignored.
  FileHashes(const std::vector<std::filesystem::path>& files, std::vector<bool> wanted)
      : files_(files), wanted_(std::move(wanted)), found_(files.size()) {}

  /// Adds the next piece, in the order of the points.
  void add(std::size_t file, const PieceBytes& piece);
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

}  // namespace clearway
