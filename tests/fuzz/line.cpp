// Any bytes, read as a line in CSV or GeoJSON; the first byte chooses the options.
#include "clearway/line.hpp"

#include <cmath>
#include <cstdlib>

#include "memory_file.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

LineOptions options_of(std::uint8_t byte) {
  LineOptions options;
  // Few poses, since their number alone is no finding.
  options.step = 1e6;
  options.reverse = byte % 2 != 0;
  if (byte / 2 % 2 != 0) options.height = 7;
  if (byte / 4 % 2 != 0) options.corner_radius = 3;
  if (byte / 8 % 2 != 0) options.cant = CantLine::kLeftRail;
  if (byte / 16 % 2 != 0) options.unit = FileUnit::named("us-ft");
  if (byte / 32 % 2 != 0) options.environment_unit = kMetresPerFoot;
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const LineOptions options = options_of(data[0]);
  const MemoryFile input({data + 1, size - 1});
  may_refuse([&] {
    std::vector<Message> remarks;
    PoseLabels labels;
    const auto poses = read_line(input.path(), options, &remarks, &labels);
    if (!labels.station.empty() && labels.station.size() != poses.size()) std::abort();
    for (const Pose& pose : poses) {
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
