#include "io/formats/ply/ply_reader.hpp"

#include <utility>

namespace clearway {

std::unique_ptr<PointReader> read_ply(InputBuffer input) {
  PlyHeader header = read_ply_header(input);
  return header.format == PlyFormat::kAscii ? read_ascii_ply(std::move(input), std::move(header))
                                            : read_binary_ply(std::move(input), std::move(header));
}

}  // namespace clearway
