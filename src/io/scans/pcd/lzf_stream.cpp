#include "io/scans/pcd/lzf_stream.hpp"

#include <algorithm>
#include <string>

#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

constexpr std::size_t kInputBytes = std::size_t{1} << 16;
constexpr std::size_t kReach = std::size_t{1} << 13;  // greatest distance of a match
// Bytes decoded ahead, exceeded by one token at most.
constexpr std::size_t kDecodeAhead = std::size_t{1} << 16;
constexpr std::size_t kLongestToken = 7 + 255 + 2;

}  // namespace

LzfStream::LzfStream(const File& file, std::uint64_t begin, std::uint64_t end,
                     std::uint64_t decoded_bytes)
    : file_(&file),
      input_end_(end),
      input_position_(begin),
      promised_(decoded_bytes),
      window_(kReach + kDecodeAhead + kLongestToken) {}

void LzfStream::read(std::span<std::byte> out) {
  while (!out.empty()) {
    if (next_ == end_) decode();
    const std::size_t count = std::min(out.size(), end_ - next_);
    std::copy_n(window_.begin() + static_cast<std::ptrdiff_t>(next_), count, out.begin());
    next_ += count;
    out = out.subspan(count);
  }
}

void LzfStream::skip(std::uint64_t count) {
  while (count > 0) {
    if (next_ == end_) decode();
    const std::size_t step = std::min<std::uint64_t>(count, end_ - next_);
    next_ += step;
    count -= step;
  }
}

void LzfStream::check_end() {
  if (at_end()) return;
  refuse_byte(file_->name(), input_position_ - input_.size() + input_next_,
              "more compressed data than the {} bytes of points need; expected its end", promised_);
}

unsigned LzfStream::input_byte() {
  if (input_next_ == input_.size()) {
    const std::uint64_t left = input_end_ - input_position_;
    if (left == 0) {
      refuse_byte(file_->name(), input_end_,
                  "the compressed data ends after " + std::to_string(decoded_) +
                      " bytes of points; expected " + std::to_string(promised_));
    }
    input_.resize(std::min<std::uint64_t>(left, kInputBytes));
    file_->read_at(input_position_, input_);
    input_position_ += input_.size();
    input_next_ = 0;
  }
  return std::to_integer<unsigned>(input_[input_next_++]);
}

/// Decodes at least one more byte.
void LzfStream::decode() {
  const std::size_t kept = std::min(end_, kReach);
  std::copy_n(window_.begin() + static_cast<std::ptrdiff_t>(end_ - kept), kept, window_.begin());
  next_ = end_ = kept;
  do {
    decode_token();
  } while (end_ - kept < kDecodeAhead && decoded_ < promised_);
}

void LzfStream::decode_token() {
  const unsigned control = input_byte();
  const std::size_t before = end_;
  if (control < 32) {
    for (unsigned i = 0; i <= control; ++i) window_[end_++] = static_cast<std::byte>(input_byte());
  } else {
    std::size_t length = control >> 5;
    if (length == 7) length += input_byte();
    const std::size_t distance = ((control & 31U) << 8 | input_byte()) + 1;
    copy_match(distance, length + 2);
  }
  decoded_ += end_ - before;
  if (decoded_ > promised_) {
    refuse_byte(file_->name(), input_position_ - input_.size() + input_next_,
                "the compressed data holds more than the " + std::to_string(promised_) +
                    " bytes of points that the header declares");
  }
}

/// Copies byte by byte, because a match may overlap with its own copy.
void LzfStream::copy_match(std::size_t distance, std::size_t length) {
  if (distance > end_) {
    refuse_byte(file_->name(), input_position_ - input_.size() + input_next_,
                "damaged compressed data: a match " + std::to_string(distance) + " bytes back, " +
                    std::to_string(decoded_) + " bytes from the start");
  }
  for (std::size_t i = 0; i < length; ++i, ++end_) window_[end_] = window_[end_ - distance];
}

}  // namespace clearway
