#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/files/file.hpp"
#include "io/scans/input_buffer.hpp"

/// Binary files that a program copied as text, as FTP does in ASCII mode.
namespace clearway {

/// Counts the line feeds of a binary file.
class LineFeeds {
 public:
  /// Adds the next bytes of the file.
  void add(std::span<const std::byte> bytes);
  /// Whether each line feed follows a carriage return, although others are as frequent in binary
  /// data as any byte.
  bool are_all_pairs() const { return pairs_ > 0 && alone_ == 0; }
  bool has_lone() const { return alone_ > 0; }

 private:
  std::uint64_t pairs_ = 0, alone_ = 0;
  std::byte last_{};
};

/// Throws InputError "name: was copied as text" with what to do instead.
[[noreturn]] void refuse_text_copy(const std::string& name);

/// Throws InputError where all line feeds of a binary file that cannot be read follow a carriage
/// return, because a program that copied it as text put these in. Reads up to the first that does
/// not, from byte `from` on.
void refuse_if_copied_as_text(const File& file, std::uint64_t from = 0);

/// The same for what is left of an input after the lines of its header, where these end with CR LF.
void refuse_if_copied_as_text(const InputBuffer& input);

/// Throws InputError where the next bytes of a binary input, of which there must be many, lack
/// their highest bit, which some programs cut off when they copy text. Consumes nothing.
void refuse_seven_bits(InputBuffer& input);

}  // namespace clearway
