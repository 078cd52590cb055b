// Any bytes, read as an alignment in LandXML; the first byte chooses the options.
#include "clearway/alignment.hpp"

#include <cmath>
#include <cstdlib>

#include "memory_file.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

AlignmentOptions options_of(std::uint8_t byte) {
  AlignmentOptions options;
  // Few poses, since their number alone is no finding.
  options.step = 1000;
  options.order = byte % 2 == 0 ? AxisOrder::kNorthingEasting : AxisOrder::kEastingNorthing;
  options.reverse = byte / 2 % 2 != 0;
  if (byte / 4 % 2 != 0) options.height = 7;
  if (byte / 8 % 2 != 0) options.max_gap = 1e9;
  if (byte / 16 % 2 != 0) options.rail_distance = 1.5;
  if (byte / 32 % 2 != 0) options.cant = CantLine::kLeftRail;
  if (byte / 64 % 2 != 0) options.alignment = "a";
  if (byte / 128 % 2 != 0) options.station_from = options.station_to = 1050;
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const AlignmentOptions options = options_of(data[0]);
  const MemoryFile input({data + 1, size - 1});
  may_refuse([&] {
    std::vector<Message> remarks;
    PoseLabels labels;
    const auto poses = read_alignment(input.path(), options, &remarks, &labels);
    if (labels.station.size() != poses.size()) std::abort();
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
