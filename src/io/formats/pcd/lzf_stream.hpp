#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/system/file.hpp"

namespace clearway {

/// Decodes LZF (Marc Lehmann's liblzf, the format of PCD's binary_compressed) front to back in
/// constant memory: a match reaches back 8 KiB at most. A copy goes on from where its original
/// stands. Throws InputError for whatever is not LZF, or does not give the bytes promised.
class LzfStream {
 public:
  /// The bytes [begin, end) of a file that outlives this; `decoded_bytes` of them are promised.
  LzfStream(const File& file, std::uint64_t begin, std::uint64_t end, std::uint64_t decoded_bytes);

  /// Of the next decoded byte.
  std::uint64_t position() const { return decoded_ - (end_ - next_); }
  /// The next bytes, out.size() of them, which must be promised still.
  void read(std::span<std::byte> out);
  /// The same, unread.
  void skip(std::uint64_t count);
  /// From the end of the promised bytes on: whether the file's bytes end there too.
  void check_end();

 private:
  bool at_end() const { return input_position_ == input_end_ && input_next_ == input_.size(); }
  unsigned input_byte();
  void decode();
  void decode_token();
  void copy_match(std::size_t distance, std::size_t length);

  const File* file_;
  std::uint64_t input_end_;       // likewise
  std::uint64_t input_position_;  // in the file, behind input_
  std::uint64_t promised_;
  std::uint64_t decoded_ = 0;
  std::vector<std::byte> input_;
  std::size_t input_next_ = 0;
  std::vector<std::byte> window_;  // decoded bytes, the last ones for matches among them
  std::size_t next_ = 0;           // the next to give out
  std::size_t end_ = 0;
};

}  // namespace clearway
