// Any bytes, read as a trajectory; the first byte chooses the format.
#include "clearway/trajectory.hpp"

#include <cmath>
#include <cstdlib>

#include "memory_file.hpp"

using namespace clearway;
using namespace clearway::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr TrajectoryFormat kFormats[] = {TrajectoryFormat::kAuto, TrajectoryFormat::kMatrix,
                                           TrajectoryFormat::kTum, TrajectoryFormat::kEuroc,
                                           TrajectoryFormat::kCsv};
  const TrajectoryOptions options{kFormats[data[0] % std::size(kFormats)], data[0] % 2 == 1};
  const MemoryFile input({data + 1, size - 1});
  may_refuse([&] {
    for (const Pose& pose : read_trajectory(input.path(), options)) {
      for (const double number : pose.rotation) {
        if (!std::isfinite(number)) std::abort();
      }
      for (const double number : pose.translation) {
        if (!std::isfinite(number)) std::abort();
      }
    }
  });
  return 0;
}
