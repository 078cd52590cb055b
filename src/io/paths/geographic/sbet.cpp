#include "io/paths/geographic/sbet.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "core/geometry/angle.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/paths/geographic/geographic_poses.hpp"

namespace clearway {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr double kHighest = 1e5;  // metres; no scanner flies as high

/// A record: time, latitude, longitude, altitude, three velocities, roll, pitch, platform heading,
/// wander angle and more, in seconds, radians and metres.
using Record = std::array<double, kSbetRecordBytes / sizeof(double)>;

Record record_of(std::span<const std::byte> bytes) {
  Record record;
  std::memcpy(record.data(), bytes.data(), sizeof record);
  return record;
}

/// Why a record is not a pose; empty where it is one.
std::string objection_to(const Record& record) {
  constexpr double kTurn = 2 * std::numbers::pi + 1e-6;
  constexpr double kHalf = std::numbers::pi;
  const struct {
    const char* name;
    std::size_t at;
    double most;
  } angles[] = {{"latitude", 1, kHalf / 2}, {"longitude", 2, kTurn},
                {"roll", 7, kHalf + 1e-6},  {"pitch", 8, kHalf / 2 + 1e-6},
                {"heading", 9, kTurn},      {"wander angle", 10, kTurn}};
  for (const auto& angle : angles) {
    auto text = objection_to_angle(angle.name, record[angle.at], angle.most, "SBET");
    if (!text.empty()) return text;
  }
  if (!std::isfinite(record[0])) return "expected a finite time";
  if (!(std::abs(record[3]) <= kHighest)) {
    return "altitude " + format_digits(record[3], 9) + "; expected metres, within 100 km";
  }
  if (record[1] == 0 && record[2] == 0) return "latitude and longitude are 0; expected a position";
  return {};
}

}  // namespace

bool may_be_sbet(std::span<const std::byte> record) {
  return record.size() == kSbetRecordBytes && objection_to(record_of(record)).empty();
}

void read_sbet(InputBuffer& input, const TrajectoryOptions& options, TrajectoryFile& out) {
  out.rotations = RotationSource::kAngles;
  std::vector<AttitudeRow> rows;
  for (;;) {
    const std::uint64_t start = input.position();
    const auto bytes = input.take(kSbetRecordBytes);
    if (bytes.empty()) {
      if (input.end_position() != start) {
        refuse_byte(input.name(), start,
                    std::to_string(input.end_position() - start) +
                        " bytes behind the last whole record of 136; the file was cut, or it is "
                        "no SBET");
      }
      break;
    }
    const Record record = record_of(bytes);
    const std::string objection = objection_to(record);
    if (!objection.empty()) {
      refuse_byte(input.name(), start, "record " + std::to_string(rows.size()) + ": " + objection);
    }
    // The platform's heading is counted in the wander frame, which avoids the singularity at the
    // poles.
    rows.push_back({{record[2] / kDegree, record[1] / kDegree, record[3]},
                    record[7],
                    record[8],
                    record[9] - record[10]});
    out.labels.time.push_back(record[0]);
  }
  append_geographic_poses(rows, AngleFrame::kNed, options, input.name(), out);
  out.note("model-frame",
           input.name() + ": the model is to have x forward, y left and z up, and its origin at " +
               "the reference point of the trajectory, unless a lever arm is given");
}

}  // namespace clearway
