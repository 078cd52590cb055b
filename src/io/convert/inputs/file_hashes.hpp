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

/// Names, sizes and hashes of the files that a pass reads in pieces, from the bytes of the pieces.
/// Only what lies before, between and behind them is read for it.
class FileHashes {
 public:
  /// wanted: which of the files; pieces of others are passed over.
  FileHashes(const std::vector<std::filesystem::path>& files, std::vector<bool> wanted)
      : files_(files), wanted_(std::move(wanted)), found_(files.size()) {}

  /// The next piece, in the order of the points.
  void add(std::size_t file, const PieceBytes& piece);
  /// After the last piece: by file; none of files without a piece.
  std::vector<std::optional<SourceFile>> finish();

 private:
  void read_until(std::uint64_t position);
  void end_file();

  const std::vector<std::filesystem::path>& files_;
  std::vector<bool> wanted_;
  std::vector<std::optional<SourceFile>> found_;
  std::optional<File> file_;  // the one that is hashed now
  std::size_t number_ = 0;
  std::uint64_t position_ = 0;  // hashed up to here
  std::optional<Xxh64Stream> hash_;
};

}  // namespace clearway
