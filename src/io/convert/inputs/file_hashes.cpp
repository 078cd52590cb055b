#include "io/convert/inputs/file_hashes.hpp"

#include <algorithm>
#include <cstddef>

namespace clearway {

void FileHashes::add(std::size_t file, const PieceBytes& piece) {
  if (!wanted_[file]) return;
  if (file_ && number_ != file) end_file();
  if (!file_) {
    file_ = File::open_for_reading(files_[file]);
    number_ = file;
    position_ = 0;
    hash_.emplace();
  }
  read_until(piece.first);
  hash_->update(piece.span());
  position_ += piece.count;
}

std::vector<std::optional<SourceFile>> FileHashes::finish() {
  if (file_) end_file();
  return std::move(found_);
}

void FileHashes::read_until(std::uint64_t position) {
  constexpr std::uint64_t kStep = 1 << 20;
  std::vector<std::byte> buffer;
  while (position_ < position) {
    buffer.resize(std::min(kStep, position - position_));
    file_->read_at(position_, buffer);
    hash_->update(buffer);
    position_ += buffer.size();
  }
}

void FileHashes::end_file() {
  read_until(file_->size_bytes());
  found_[number_] = {files_[number_].filename().string(), position_, hash_->digest()};
  file_.reset();
}

}  // namespace clearway
