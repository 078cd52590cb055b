#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/system/file.hpp"

namespace clearway {

/// Reads a file front to back through one buffer, as runs of bytes or as lines. Memory is constant
/// whatever the file says of itself.
class InputBuffer {
 public:
  enum class Access { kSeek, kStream };

  static constexpr std::size_t kCapacity = std::size_t{1} << 18;     ///< bytes; fits in L2
  static constexpr std::size_t kLongestLine = std::size_t{1} << 16;  ///< bytes

  /// A place to come back to.
  struct Mark {
    std::uint64_t position = 0;
    std::uint64_t line = 0;
  };

  /// kSeek needs a regular file and starts at its first byte; kStream starts where the file stands.
  InputBuffer(File file, Access access);

  const std::string& name() const { return file_.name(); }
  /// For readers that need other places of the file at the same time.
  const File& file() const { return file_; }
  bool can_seek() const { return size_.has_value(); }
  /// Size of the file where it can be known in advance.
  std::optional<std::uint64_t> size() const { return size_; }
  /// Of the next byte.
  std::uint64_t position() const { return loaded_ - (end_ - begin_); }

  /// Consumes the next `count` bytes (<= kCapacity); valid until the next call. Empty, and nothing
  /// consumed, when the file ends before them.
  std::span<const std::byte> take(std::size_t count);
  /// Consumes what is loaded, or loads more first; empty at the file's end.
  std::span<const std::byte> take_some();
  /// The next `count` bytes (<= kCapacity) without consuming them; fewer at the file's end. Valid
  /// until the next call.
  std::span<const std::byte> peek(std::size_t count);
  /// Bytes anywhere in an input that can seek, all of them before its end. Consumes nothing, and
  /// may be called from several threads at once.
  void read_at(std::uint64_t position, std::span<std::byte> out) const {
    file_.read_at(position, out);
  }
  /// False when the file ends before.
  bool skip(std::uint64_t count);
  /// The position of the file's end. To be called after take() or skip() has met it.
  std::uint64_t end_position() const { return loaded_; }

  /// Consumes the next line, without its LF or CR LF; valid until the next call. False at the end.
  /// Throws InputError for a line longer than kLongestLine.
  bool next_line(std::string_view& line);
  /// Consumes the mark of UTF-8 that some editors put at a file's start.
  void skip_byte_order_mark();
  /// 1-based number of the line last returned.
  std::uint64_t line() const { return line_; }
  /// Whether a line break followed the line last returned (the last of a file may lack it).
  bool line_terminated() const { return line_terminated_; }

  Mark mark() const { return {position(), line_}; }
  /// Throws ResourceError where the input cannot seek.
  void return_to(const Mark& mark);

 private:
  bool fill();

  File file_;
  std::optional<std::uint64_t> size_;
  std::unique_ptr<std::byte[]> buffer_;
  std::size_t begin_ = 0;     ///< first byte not consumed
  std::size_t end_ = 0;       ///< behind the last byte loaded
  std::uint64_t loaded_ = 0;  ///< position in the file of end_
  std::uint64_t line_ = 0;
  bool line_terminated_ = true;
};

}  // namespace clearway
