#include "io/scans/laz/chunk_decoder.hpp"

#include "io/files/bytes.hpp"
#include "io/scans/las/las_header.hpp"

namespace clearway::laz {

std::unique_ptr<ChunkDecoder> make_chunk_decoder(const Scheme& scheme) {
  return scheme.chunks == Scheme::Chunks::kLayered ? make_layered_decoder(scheme)
                                                   : make_pointwise_decoder(scheme);
}

void ChunkDecoder::take_first(const std::byte* record, unsigned point_format) {
  quanta_ = load<Quanta>(record);
  class_ = las_class_field(point_format).of(record);
  flags_ = las_flags_of(record, point_format);
  const auto time_byte = las_time_byte(point_format);
  time_ = time_byte ? load<double>(record + *time_byte) : 0;
  is_first_ = true;
}

void ChunkDecoder::decode(PointRoom points) {
  if (is_first_ && points.count > 0) {
    points.quanta[0] = quanta_;
    points.classes[0] = class_;
    if (points.flags) points.flags[0] = flags_;
    if (points.times) points.times[0] = time_;
    points = points.behind(1);
    is_first_ = false;
  }
  if (!decode_others(points)) throw DamagedChunk{"holds bits that no encoder writes"};
}

DamagedChunk unused_bytes(std::uint64_t bytes) {
  return {"has " + std::to_string(bytes) + " bytes behind its last point"};
}

}  // namespace clearway::laz
