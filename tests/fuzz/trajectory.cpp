// Any bytes, read as a trajectory; the first byte chooses the format, the second the options.
#include "clearway/trajectory.hpp"

#include <cmath>
#include <cstdlib>

#include "memory_file.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A CRS that needs no database of PROJ, whose opening would take most of the time.
constexpr const char* kMap = "+proj=utm +zone=32 +ellps=WGS84 +type=crs";
constexpr const char* kGlobe = "+proj=longlat +ellps=WGS84 +type=crs";

TrajectoryOptions options_of(std::uint8_t format, std::uint8_t more) {
  constexpr TrajectoryFormat kFormats[] = {
      TrajectoryFormat::kAuto,          TrajectoryFormat::kMatrix, TrajectoryFormat::kTum,
      TrajectoryFormat::kEuroc,         TrajectoryFormat::kCsv,    TrajectoryFormat::kPoseXyzw,
      TrajectoryFormat::kPoseWxyz,      TrajectoryFormat::kSbet,   TrajectoryFormat::kThreedtkPose,
      TrajectoryFormat::kThreedtkFrames};
  constexpr AngleUnit kUnits[] = {AngleUnit::kDeclared, AngleUnit::kDegrees, AngleUnit::kRadians};
  constexpr AngleFrame kFrames[] = {AngleFrame::kDeclared, AngleFrame::kNed, AngleFrame::kEnu};
  TrajectoryOptions options{kFormats[format % std::size(kFormats)], more % 2 == 1};
  options.angle_unit = kUnits[more / 2 % 3];
  options.angle_frame = kFrames[more / 6 % 3];
  if (more / 18 % 3 != 0) {
    options.crs = kMap;
    options.datum = kGlobe;
  }
  if (more / 54 % 2 != 0) options.lever_arm = {1, -2, 0.5};
  if (more / 108 % 2 != 0) options.metres_per_unit = 0.3048;
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const TrajectoryOptions options = options_of(data[0], data[1]);
  const MemoryFile input({data + 2, size - 2});
  may_refuse([&] {
    std::vector<Message> remarks;
    for (const Pose& pose : read_trajectory(input.path(), options, &remarks)) {
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
