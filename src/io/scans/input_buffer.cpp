#include "io/scans/input_buffer.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/text_lines.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

/// Whether a line such as "sep=;" begins here. first: its first six bytes, or fewer.
bool is_separator_line(std::string_view first) {
  return first.size() == 6 && (first.starts_with("sep=") || first.starts_with("SEP=")) &&
         is_line_end(first[5]);
}

}  // namespace

std::optional<std::endian> byte_order_of_utf16(std::string_view text) {
  const auto has_zeros = [&](std::size_t from) {
    return text.size() >= 4 && text[from] == 0 && text[from + 2] == 0 && text[1 - from] != 0 &&
           text[3 - from] != 0;
  };
  if (text.starts_with("\xFE\xFF") || has_zeros(0)) return std::endian::big;
  if (text.starts_with("\xFF\xFE") || has_zeros(1)) return std::endian::little;
  return std::nullopt;
}

InputBuffer::InputBuffer(File file, Access access)
    : file_(std::move(file)), buffer_(std::make_unique<std::byte[]>(kCapacity)) {
  if (access == Access::kSeek) size_ = file_.size_bytes();
}

InputBuffer InputBuffer::open(const std::filesystem::path& path) {
  File file = File::open_for_reading(path);
  const Access access = file.is_regular() ? Access::kSeek : Access::kStream;
  return {std::move(file), access};
}

InputBuffer InputBuffer::open_regular(const std::filesystem::path& path) {
  return {File::open_regular(path), Access::kSeek};
}

/// Loads more bytes after those that are not consumed yet. Returns false at the end of the file.
bool InputBuffer::fill() {
  if (begin_ > 0) {
    std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  std::span<std::byte> room(buffer_.get() + end_, kCapacity - end_);
  if (size_) {
    room = room.first(std::min<std::uint64_t>(room.size(), *size_ - loaded_));
    file_.read_at(loaded_, room);
  } else {
    room = room.first(file_.read_some(room));
  }
  end_ += room.size();
  loaded_ += room.size();
  return !room.empty();
}

std::span<const std::byte> InputBuffer::take(std::size_t count) {
  while (end_ - begin_ < count) {
    if (!fill()) return {};
  }
  const std::byte* bytes = buffer_.get() + begin_;
  begin_ += count;
  return {bytes, count};
}

std::span<const std::byte> InputBuffer::take_some() {
  if (begin_ == end_ && !fill()) return {};
  return take(end_ - begin_);
}

std::span<const std::byte> InputBuffer::peek(std::size_t count) {
  while (end_ - begin_ < count && fill()) continue;
  return {buffer_.get() + begin_, std::min(count, end_ - begin_)};
}

bool InputBuffer::skip(std::uint64_t count) {
  const std::size_t buffered = std::min<std::uint64_t>(count, end_ - begin_);
  begin_ += buffered;
  count -= buffered;
  if (size_ && count > 0) {
    const bool there = count <= *size_ - loaded_;
    loaded_ += there ? count : *size_ - loaded_;
    return there;
  }
  while (count > 0) {
    if (!fill()) return false;
    const std::size_t step = std::min<std::uint64_t>(count, end_ - begin_);
    begin_ += step;
    count -= step;
  }
  return true;
}

bool InputBuffer::next_line(std::string_view& line) {
  const auto loaded = [this] {
    return std::string_view(reinterpret_cast<const char*>(buffer_.get() + begin_), end_ - begin_);
  };
  std::string_view text = loaded();
  std::size_t length = 0;
  for (;;) {
    const char* const end = text.data() + text.size();
    length = static_cast<std::size_t>(find_line_end(text.data() + length, end) - text.data());
    // A CR at the end of what is loaded may be the first half of a CR LF.
    const bool is_whole =
        length + 1 < text.size() || (length + 1 == text.size() && text[length] == '\n');
    if (is_whole || length > kLongestLine) break;
    const bool is_more = fill();
    text = loaded();  // which fill() moves in any case
    if (!is_more) break;
  }
  if (text.empty()) return false;
  ++line_;
  if (length > kLongestLine) {
    refuse_line(name(), line_, "is longer than 65536 bytes; expected lines of text");
  }
  break_bytes_ = line_break_bytes(text.data() + length, text.data() + text.size());
  lone_cr_ = lone_cr_ || (break_bytes_ == 1 && text[length] == '\r');
  begin_ += length + break_bytes_;
  line = text.substr(0, length);
  return true;
}

void InputBuffer::end_text() {
  if (lone_cr_ && break_bytes_ == 2) --begin_;
}

void InputBuffer::begin_text() {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  const auto peek_text = [this](std::size_t count) {
    const auto bytes = peek(count);
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  const std::string_view first = peek_text(16);
  refuse_foreign(name(), first);
  if (byte_order_of_utf16(first)) {
    refuse(name(),
           "is text in UTF-16, which some programs call Unicode; expected UTF-8. Save it as UTF-8 "
           "or as CSV");
  }
  if (first.starts_with(kMark)) take(kMark.size());
  if (is_separator_line(peek_text(6))) {
    std::string_view line;
    next_line(line);
  }
}

void InputBuffer::return_to(const Mark& mark) {
  if (!can_seek()) {
    throw ResourceError(name() + ": cannot be read a second time, as it is not a regular file");
  }
  begin_ = end_ = 0;
  loaded_ = mark.position;
  line_ = mark.line;
  break_bytes_ = 1;
}

}  // namespace clearway
