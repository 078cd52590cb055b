#pragma once

#include <cstdlib>

#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"
#include "memory_file.hpp"

namespace clearway::test {

/// Reads all points twice, as a conversion does, and checks that their number is the same.
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

/// Asks for lines of points and checks that they ascend, at most one for each point.
inline void tell_lines(PointReader& reader) {
  const std::uint64_t points[] = {0, 1, 5};
  const auto lines = reader.lines_of(points);
  if (lines.size() > 3) std::abort();
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i] <= lines[i - 1]) std::abort();
  }
}

}  // namespace clearway::test
