#include "io/files/deflate.hpp"

#include <zlib.h>

#include <limits>
#include <new>
#include <stdexcept>

namespace clearway {

std::string deflated(std::string_view bytes, DeflateForm form, int level) {
  constexpr int kWindow = 15, kMemory = 8;
  if (bytes.size() > std::numeric_limits<uInt>::max() / 2) throw std::length_error("deflated");
  z_stream stream{};
  const int window = form == DeflateForm::kRaw ? -kWindow : kWindow;
  if (deflateInit2(&stream, level, Z_DEFLATED, window, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int code = deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (code != Z_STREAM_END) throw std::logic_error("deflated: no end");
  return out;
}

}  // namespace clearway
