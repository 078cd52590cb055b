#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/files/file.hpp"

namespace clearway {

/// The order of the bytes in a text in UTF-16, by its byte order mark or by the zeros of its first
/// two characters; nullopt for other texts.
std::optional<std::endian> byte_order_of_utf16(std::string_view text);

/// Reads a file front to back through one buffer, as runs of bytes or as lines, in constant memory
/// whatever the file declares.
class InputBuffer {
 public:
  enum class Access { kSeek, kStream };

  static constexpr std::size_t kCapacity = std::size_t{1} << 18;     ///< bytes; fits in L2
  static constexpr std::size_t kLongestLine = std::size_t{1} << 16;  ///< bytes

  /// A position to which the reading can return.
  struct Mark {
    std::uint64_t position = 0;
    std::uint64_t line = 0;
  };

  /// kSeek needs a regular file and starts at its first byte; kStream starts at the file's current
  /// position.
  InputBuffer(File file, Access access);
  /// Opens a file: kSeek where it is a regular one, otherwise kStream. Throws ResourceError.
  static InputBuffer open(const std::filesystem::path& path);
  /// Opens a file that has to be a regular one, see File::open_regular(). Throws ResourceError.
  static InputBuffer open_regular(const std::filesystem::path& path);

  const std::string& name() const { return file_.name(); }
  /// The underlying file, for readers that also read at positions other than the buffer's.
  const File& file() const { return file_; }
  bool can_seek() const { return size_.has_value(); }
  /// Size of the file in bytes, where it is known in advance.
  std::optional<std::uint64_t> size() const { return size_; }
  /// Position in the file of the next byte.
  std::uint64_t position() const { return loaded_ - (end_ - begin_); }

  /// Consumes the next `count` bytes (<= kCapacity), which stay valid until the next call. Empty,
  /// and nothing is consumed, when the file ends before them.
  std::span<const std::byte> take(std::size_t count);
  /// Consumes what is loaded, or loads more first. Empty at the end of the file.
  std::span<const std::byte> take_some();
  /// The next `count` bytes (<= kCapacity) without consuming them; fewer at the end of the file.
  /// Valid until the next call.
  std::span<const std::byte> peek(std::size_t count);
  /// Reads bytes at any position of an input that can seek; all of them must lie before its end.
  /// Consumes nothing, and may be called from several threads at once.
  void read_at(std::uint64_t position, std::span<std::byte> out) const {
    file_.read_at(position, out);
  }
  /// Consumes `count` bytes. Returns false when the file ends before them.
  bool skip(std::uint64_t count);
  /// Position of the end of the file. Valid once take() or skip() has met it.
  std::uint64_t end_position() const { return loaded_; }

  /// Consumes the next line, without its LF, CR LF or CR; `line` stays valid until the next call.
  /// Returns false at the end. Throws InputError for a line longer than kLongestLine.
  bool next_line(std::string_view& line);
  /// Consumes what programs put before the first line of a text: the byte order mark of UTF-8, and
  /// the line "sep=;" by which spreadsheets name the separator. Called at the start of the file.
  /// Throws InputError for UTF-16 and for what is no text, as refuse_foreign() does.
  void begin_text();
  /// Called after the last line of a text that binary data follow. Where lines end with CR alone, a
  /// LF behind the CR of the last one is the first byte of the data.
  void end_text();
  /// Number of the last returned line, from 1.
  std::uint64_t line() const { return line_; }
  /// Whether a line break followed the last returned line (the last line of a file may lack it).
  bool line_terminated() const { return break_bytes_ > 0; }

  Mark mark() const { return {position(), line_}; }
  /// Goes back to a mark. Throws ResourceError where the input cannot seek.
  void return_to(const Mark& mark);

 private:
  bool fill();

  File file_;
  std::optional<std::uint64_t> size_;
  std::unique_ptr<std::byte[]> buffer_;
  std::size_t begin_ = 0;     ///< index of the first byte that is not consumed
  std::size_t end_ = 0;       ///< index after the last byte loaded
  std::uint64_t loaded_ = 0;  ///< position of end_ in the file
  std::uint64_t line_ = 0;
  std::size_t break_bytes_ = 1;  ///< length of the line break behind the last returned line
  bool lone_cr_ = false;         ///< whether a line ended with CR alone
};

}  // namespace clearway
