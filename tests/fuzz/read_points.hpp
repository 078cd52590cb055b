#pragma once

#include <cstdlib>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"
#include "memory_file.hpp"

namespace clearway::test {

/// Reads all points twice, as a conversion does; the same number must come.
inline void read_twice(PointReader& reader) {
  PointBatch batch;
  std::uint64_t counts[2] = {0, 0};
  for (std::uint64_t& count : counts) {
    while (reader.read(batch)) {
      if (batch.size() == 0 || batch.size() > PointReader::kBatchPoints) std::abort();
      count += batch.size();
    }
    reader.rewind();
  }
  if (counts[0] != counts[1]) std::abort();
}

}  // namespace clearway::test
