#include "io/files/deflate.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

#include "io/files/parallel_loop.hpp"

namespace clearway {

namespace {

/// One call of deflate.
class Deflation {
 public:
  Deflation(DeflateForm form, int level) {
    constexpr int kWindow = 15, kMemory = 8;
    const int window = form == DeflateForm::kRaw ? -kWindow : kWindow;
    if (deflateInit2(&stream_, level, Z_DEFLATED, window, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  Deflation(const Deflation&) = delete;
  Deflation& operator=(const Deflation&) = delete;
  ~Deflation() { deflateEnd(&stream_); }

  /// The bytes before those that run() is given.
  void set_before(std::string_view bytes) {
    deflateSetDictionary(&stream_, bytes_of(bytes), size_of(bytes));
  }

  std::string run(std::string_view bytes, int flush) {
    constexpr std::size_t kEndOfBlock = 16;  // more than Z_SYNC_FLUSH adds
    std::string out(deflateBound(&stream_, bytes.size()) + kEndOfBlock, '\0');
    stream_.next_in = bytes_of(bytes);
    stream_.avail_in = size_of(bytes);
    stream_.next_out = reinterpret_cast<Bytef*>(out.data());
    stream_.avail_out = static_cast<uInt>(out.size());
    const int code = deflate(&stream_, flush);
    const bool ended = flush == Z_FINISH ? code == Z_STREAM_END : code == Z_OK;
    if (!ended || stream_.avail_in != 0) throw std::logic_error("deflated: no end");
    out.resize(stream_.total_out);
    return out;
  }

  static Bytef* bytes_of(std::string_view bytes) {
    return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  }
  static uInt size_of(std::string_view bytes) {
    if (bytes.size() > std::numeric_limits<uInt>::max() / 2) throw std::length_error("deflated");
    return static_cast<uInt>(bytes.size());
  }

 private:
  z_stream stream_{};
};

struct DeflatedBlock {
  std::string bytes;
  uLong checksum = 0;
};

DeflatedBlock deflated_block(std::string_view all, std::size_t first, int level) {
  constexpr std::size_t kReach = 1 << 15;  // how far back deflate refers
  const std::string_view block = all.substr(first, kDeflateBlock);
  const std::size_t before = std::min(first, kReach);
  const bool is_last = first + block.size() == all.size();
  Deflation deflation(DeflateForm::kRaw, level);
  deflation.set_before(all.substr(first - before, before));
  return {deflation.run(block, is_last ? Z_FINISH : Z_SYNC_FLUSH),
          adler32(1, Deflation::bytes_of(block), Deflation::size_of(block))};
}

}  // namespace

std::string deflated(std::string_view bytes, DeflateForm form, int level) {
  return Deflation(form, level).run(bytes, Z_FINISH);
}

std::string deflated_in_blocks(std::string_view bytes, int level) {
  if (bytes.size() <= kDeflateBlock) return deflated(bytes, DeflateForm::kZlib, level);
  std::vector<DeflatedBlock> blocks((bytes.size() + kDeflateBlock - 1) / kDeflateBlock);
  for_each_parallel(blocks.size(), [&](std::size_t i) {
    blocks[i] = deflated_block(bytes, i * kDeflateBlock, level);
  });
  constexpr std::size_t kHeader = 2;
  std::string out = deflated({}, DeflateForm::kZlib, level).substr(0, kHeader);
  uLong checksum = 1;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    out += blocks[i].bytes;
    const std::size_t length = std::min(kDeflateBlock, bytes.size() - i * kDeflateBlock);
    checksum = adler32_combine(checksum, blocks[i].checksum, static_cast<z_off_t>(length));
  }
  for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(checksum >> shift & 0xff);
  return out;
}

}  // namespace clearway
