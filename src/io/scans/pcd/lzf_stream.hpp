#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/files/file.hpp"

namespace clearway {

/// Decodes LZF (Marc Lehmann's liblzf, the format of PCD's binary_compressed) front to back in
/// constant memory, since a match reaches back at most 8 KiB. A copy continues from the original's
/// position. Throws InputError for data that is not LZF or does not give the promised bytes.
class LzfStream {
 public:
  /// Decodes the bytes [begin, end) of a file, which must outlive this object. decoded_bytes: the
  /// promised size of the decoded data.
  LzfStream(const File& file, std::uint64_t begin, std::uint64_t end, std::uint64_t decoded_bytes);

  /// Position of the next byte in the decoded data.
  std::uint64_t position() const { return decoded_ - (end_ - next_); }
  /// Decodes the next out.size() bytes, which must lie within the promised ones.
  void read(std::span<std::byte> out);
  /// Decodes and drops the next `count` bytes.
  void skip(std::uint64_t count);
  /// To be called at the end of the promised bytes. Throws InputError where the file's bytes do not
  /// end there too.
  void check_end();

 private:
  bool at_end() const { return input_position_ == input_end_ && input_next_ == input_.size(); }
  unsigned input_byte();
  void decode();
  void decode_token();
  void copy_match(std::size_t distance, std::size_t length);

  const File* file_;
  std::uint64_t input_end_;       // end of the compressed bytes in the file
  std::uint64_t input_position_;  // position in the file after input_
  std::uint64_t promised_;
  std::uint64_t decoded_ = 0;
  std::vector<std::byte> input_;
  std::size_t input_next_ = 0;
  std::vector<std::byte> window_;  // decoded bytes, including the last ones, which matches may copy
  std::size_t next_ = 0;           // index of the next byte to deliver
  std::size_t end_ = 0;
};

}  // namespace clearway
