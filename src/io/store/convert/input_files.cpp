#include "io/store/convert/input_files.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/input_error.hpp"
#include "io/store/convert/input_warnings.hpp"

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
  if (piece.bytes) hash_->update(piece.span());
  position_ += piece.count;
}

void FileHashes::pass_over(std::size_t file) {
  const std::uint64_t bytes = std::filesystem::file_size(files_[file]);
  found_[file] = {files_[file].filename().string(), bytes, Xxh64Stream().digest()};
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
  hash_.reset();
}

namespace {

/// Throws for a pipe, which can be read only once.
void refuse_pipe(const std::filesystem::path& file) {
  std::error_code unknown;
  if (std::filesystem::is_regular_file(file, unknown)) return;
  if (!std::filesystem::exists(file, unknown)) {
    throw InputError(file.string() + ": is a link that leads to no file; expected a file");
  }
  throw InputError(file.string() +
                       ": is a pipe or device, expected a file; LAS and LAZ can be "
                       "standard input",
                   Remedy::kStandardInput);
}

}  // namespace

InputFiles::InputFiles(const std::vector<std::filesystem::path>& inputs, bool skip_unreadable,
                       const PointReadOptions& how_to_read, Progress& progress,
                       const ReadableInputs* readable)
    : is_stream_(std::find(inputs.begin(), inputs.end(), "-") != inputs.end()) {
  if (is_stream_ && inputs.size() > 1) {
    throw UsageError("standard input (-) cannot be combined with other inputs");
  }
  if (is_stream_) {
    files_ = read_files_ = {"-"};
    return;
  }
  files_ = list_point_files(inputs, &folder_remarks_);
  std::for_each(files_.begin(), files_.end(), refuse_pipe);
  if (skip_unreadable && readable != nullptr) {
    readable_ = *readable;
    std::vector<std::filesystem::path> kept;
    for (const std::uint64_t number : readable_.numbers) {
      if (number >= files_.size()) throw InputError("the journal names an input that is not there");
      kept.push_back(files_[number]);
    }
    files_ = std::move(kept);
  } else if (skip_unreadable) {
    ReadableFiles found = readable_files(files_, how_to_read, progress);
    auto next = files_.begin();
    for (const std::filesystem::path& file : found.files) {
      next = std::find(next, files_.end(), file);
      readable_.numbers.push_back(static_cast<std::uint64_t>(next++ - files_.begin()));
    }
    files_ = std::move(found.files);
    readable_.skipped = std::move(found.reasons);
  }
  read_files_ = with_pose_files(files_);
  std::transform(read_files_.begin(), read_files_.end(), std::back_inserter(states_), state_of);
}

std::vector<Message> InputFiles::remarks() const {
  std::vector<Message> all = folder_remarks_;
  if (auto skipped = warning_on_skipped(readable_.skipped)) all.push_back(std::move(*skipped));
  return all;
}

void InputFiles::refuse_changed() const {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (state_of(read_files_[i]) == states_[i]) continue;
    refuse(read_files_[i].string(),
           "changed during its conversion, expected the same file in every pass over it");
  }
}

}  // namespace clearway
