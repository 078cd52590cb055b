#include "io/store/convert/input_files.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include "clearway/error.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/store/convert/source_description.hpp"

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
  found_[file] = {name_in_store(files_[file]), bytes, Xxh64Stream().digest()};
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
  found_[number_] = {name_in_store(files_[number_]), position_, hash_->digest()};
  file_.reset();
  hash_.reset();
}

namespace {

/// The warning on files that were left out; nullopt where there are none.
std::optional<Message> warning_on_skipped(std::span<const std::string> reasons) {
  constexpr std::size_t kMostNamed = 10;
  if (reasons.empty()) return std::nullopt;
  std::string text = format_count(reasons.size()) +
                     (reasons.size() == 1 ? " file is left out" : " files are left out");
  for (std::size_t i = 0; i < reasons.size() && i < kMostNamed; ++i) text += "; " + reasons[i];
  if (reasons.size() > kMostNamed)
    text += "; and " + std::to_string(reasons.size() - kMostNamed) + " more";
  return warning("skipped-files", text, {{"files", reasons.size()}});
}

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

ReadableInputs readable_inputs(std::span<const std::filesystem::path> files,
                               const PointReadOptions& how_to_read, Progress& progress) {
  ReadableInputs out;
  PointBatch batch;
  progress.begin("check", 0, "points");
  for (std::size_t i = 0; i < files.size(); ++i) {
    try {
      const auto reader = open_point_file(files[i], how_to_read);
      while (reader->read(batch)) {
        throw_if_stopped(progress);
        progress.advance(batch.size());
      }
      out.numbers.push_back(i);
    } catch (const InputError& error) {
      out.skipped.emplace_back(error.what());
    }
  }
  progress.end();
  if (out.numbers.empty() && !out.skipped.empty()) {
    throw InputError("none of the " + format_count(files.size()) +
                     " files can be read, expected one at least; the first: " + out.skipped[0]);
  }
  return out;
}

std::vector<std::filesystem::path> files_of(const std::vector<std::filesystem::path>& all,
                                            const std::vector<std::uint64_t>& numbers) {
  std::vector<std::filesystem::path> out;
  for (const std::uint64_t number : numbers) {
    if (number >= all.size()) throw InputError("the journal names an input that is not there");
    out.push_back(all[number]);
  }
  return out;
}

InputFiles::InputFiles(const ConversionOptions& options, const PointReadOptions& how_to_read,
                       Progress& progress, const ReadableInputs* readable)
    : is_stream_(std::ranges::find(options.inputs, "-") != options.inputs.end()) {
  if (is_stream_ && options.inputs.size() > 1) {
    throw UsageError("standard input (-) cannot be combined with other inputs");
  }
  if (is_stream_) {
    files_ = read_files_ = {"-"};
    return;
  }
  files_ = list_point_files(options.inputs, &folder_remarks_);
  std::ranges::for_each(files_, refuse_pipe);
  if (options.skip_unreadable) {
    readable_ = readable != nullptr ? *readable : readable_inputs(files_, how_to_read, progress);
    files_ = files_of(files_, readable_.numbers);
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
