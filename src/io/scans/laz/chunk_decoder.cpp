#include "io/scans/laz/chunk_decoder.hpp"

namespace clearway::laz {

std::unique_ptr<ChunkDecoder> make_chunk_decoder(const Scheme& scheme) {
  return scheme.chunks == Scheme::Chunks::kLayered ? make_layered_decoder(scheme)
                                                   : make_pointwise_decoder(scheme);
}

DamagedChunk unused_bytes(std::uint64_t bytes) {
  return {"has " + std::to_string(bytes) + " bytes behind its last point"};
}

}  // namespace clearway::laz
