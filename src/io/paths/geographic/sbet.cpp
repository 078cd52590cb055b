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

/// The numbers of a record that make a pose, in radians and metres.
struct Record {
  double time, latitude, longitude, altitude, roll, pitch, heading, wander;
};

Record record_of(std::span<const std::byte> bytes) {
  std::array<double, 17> n;
  std::memcpy(n.data(), bytes.data(), sizeof n);
  return {n[0], n[1], n[2], n[3], n[7], n[8], n[9], n[10]};
}

/// Why a record is not a pose; empty where it is one.
std::string objection_to(const Record& record) {
  constexpr double kTurn = 2 * std::numbers::pi + 1e-6;
  const struct {
    const char* name;
    double value, most;
  } angles[] = {{"latitude", record.latitude, std::numbers::pi / 2},
                {"longitude", record.longitude, kTurn},
                {"roll", record.roll, std::numbers::pi + 1e-6},
                {"pitch", record.pitch, std::numbers::pi / 2 + 1e-6},
                {"heading", record.heading, kTurn},
                {"wander angle", record.wander, kTurn}};
  for (const auto& angle : angles) {
    auto text = objection_to_angle(angle.name, angle.value, angle.most, "SBET");
    if (!text.empty()) return text;
  }
  if (!std::isfinite(record.time)) return "expected a finite time";
  if (!(std::abs(record.altitude) <= kHighest)) {
    return "altitude " + format_digits(record.altitude, 9) + "; expected metres, within 100 km";
  }
  if (record.latitude == 0 && record.longitude == 0) {
    return "latitude and longitude are 0; expected a position";
  }
  return {};
}

AttitudeRow row_of(const Record& record) {
  // The platform's heading is counted in the wander frame, which avoids the singularity at the
  // poles.
  return {{record.longitude / kDegree, record.latitude / kDegree, record.altitude},
          record.roll,
          record.pitch,
          record.heading - record.wander};
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
    rows.push_back(row_of(record));
    out.labels.time.push_back(record.time);
  }
  append_geographic_poses(rows, AngleFrame::kNed, options, input.name(), out);
  out.note("model-frame",
           input.name() + ": the model is to have x forward, y left and z up, and its origin at " +
               "the reference point of the trajectory, unless a lever arm is given");
}

}  // namespace clearway
