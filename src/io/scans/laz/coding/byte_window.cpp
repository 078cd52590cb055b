#include "io/scans/laz/coding/byte_window.hpp"

#include <algorithm>
#include <cstring>

namespace clearway::laz {

const std::byte* ByteWindow::open(const InputBuffer& input, std::uint64_t begin, std::uint64_t end,
                                  std::ptrdiff_t most) {
  if (begin > end) throw DamagedChunk{"ends before its first byte"};
  input_ = &input;
  next_ = begin;
  end_ = end;
  most_ = most;
  load(0);
  return buffer_.data();
}

/// Loads the next piece after the first `kept` bytes of the buffer.
void ByteWindow::load(std::size_t kept) {
  const auto padding = static_cast<std::size_t>(most_);
  const std::size_t more = std::min<std::uint64_t>(std::max(kPiece, padding), end_ - next_);
  if (buffer_.size() < kept + more + padding) buffer_.resize(kept + more + padding);
  input_->read_at(next_, {buffer_.data() + kept, more});
  next_ += more;
  loaded_ = buffer_.data() + kept + more;
  if (next_ == end_) std::fill_n(buffer_.data() + kept + more, padding, std::byte{0});
}

const std::byte* ByteWindow::refill(const std::byte* cursor) {
  if (next_ == end_) {
    if (cursor > loaded_) throw DamagedChunk{"its bytes end before its points"};
    return cursor;
  }
  const auto kept = static_cast<std::size_t>(loaded_ - cursor);
  std::memmove(buffer_.data(), cursor, kept);
  load(kept);
  return buffer_.data();
}

std::span<const std::byte> ByteWindow::take(const std::byte*& cursor, std::size_t count) {
  cursor = ahead(cursor);
  if (static_cast<std::size_t>(loaded_ - cursor) < count) {
    throw DamagedChunk{"its bytes end before its first point"};
  }
  const std::byte* taken = cursor;
  cursor += count;
  return {taken, count};
}

}  // namespace clearway::laz
