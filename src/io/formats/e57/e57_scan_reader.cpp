#include "io/formats/e57/e57_scan_reader.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr double kNoPosition = std::numeric_limits<double>::quiet_NaN();

/// Widens the box to hold the finite ones of the points.
void widen(std::optional<Box>& box, std::span<const Vec3> points) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Box all =
      box.value_or(Box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}});
  for (const Vec3& p : points) {
    if (!std::isfinite(p.x + p.y + p.z)) continue;
    all.extend(p);
  }
  if (all.lo.x <= all.hi.x) box = all;
}

}  // namespace

E57ScanReader::E57ScanReader(E57Pages& pages, const E57Scan& scan, const E57Extent& extent)
    : pages_(pages), scan_(scan), packets_(pages, scan, extent) {
  // Without a state field, every Cartesian coordinate is valid, so the spherical ones are not
  // needed.
  const bool only_cartesian = scan.is_cartesian() && !scan.has(kE57CartesianState);
  for (std::size_t place = 0; place < kE57Places; ++place) {
    const std::uint32_t stream = scan.places[place];
    const bool needed =
        place <= kE57CartesianState ? scan.is_cartesian() : scan.is_spherical() && !only_cartesian;
    if (stream == kNoE57Stream || !needed) continue;
    cursors_[place].emplace(packets_, scan.fields[stream], stream);
  }
}

bool E57ScanReader::read(PointBatch& batch) {
  const std::size_t before = batch.positions.size();
  while (next_ < scan_.records && batch.positions.size() < PointReader::kBatchPoints) {
    const std::size_t first = batch.positions.size();
    const std::size_t count = available(std::min(kChunk, PointReader::kBatchPoints - first));
    decode(count);
    batch.positions.resize(first + count);
    place_points(std::span(batch.positions).subspan(first), first, batch.absent);
    next_ += count;
  }
  if (batch.positions.size() > before) return true;
  finish();
  return false;
}

/// Number of records for which every field has data, at least one and at most `room`.
std::size_t E57ScanReader::available(std::size_t room) {
  std::uint64_t count = std::min<std::uint64_t>(room, scan_.records - next_);
  for (auto& cursor : cursors_) {
    if (!cursor) continue;
    while (cursor->available() == 0) {
      if (cursor->refill(pages_.name())) continue;
      refuse_byte(pages_.name(), scan_.file_offset,
                  scan_.name() + " ends after " + std::to_string(next_) + " records; expected " +
                      std::to_string(scan_.records));
    }
    count = std::min(count, cursor->available());
  }
  return count;
}

void E57ScanReader::decode(std::size_t count) {
  for (std::size_t place = 0; place < kE57Places; ++place) {
    if (cursors_[place]) cursors_[place]->decode(std::span(columns_[place]).first(count));
  }
  check_state(kE57CartesianState, count);
  check_state(kE57SphericalState, count);
}

void E57ScanReader::check_state(E57Place state, std::size_t count) const {
  if (!cursors_[state]) return;
  const auto states = std::span(columns_[state]).first(count);
  const auto wrong = std::find_if(states.begin(), states.end(),
                                  [](double s) { return s != 0 && s != 1 && s != 2; });
  if (wrong == states.end()) return;
  refuse_byte(pages_.name(), scan_.file_offset,
              scan_.name() + ", record " + std::to_string(next_ + (wrong - states.begin())) +
                  " (counted from 0) has the invalid state " + shown(*wrong) +
                  "; expected 0, 1 or 2");
}

bool E57ScanReader::is_valid(E57Place state, std::size_t i) const {
  return !cursors_[state] || columns_[state][i] == 0;
}

Vec3 E57ScanReader::cartesian(std::size_t i) const {
  return {columns_[kE57X][i], columns_[kE57Y][i], columns_[kE57Z][i]};
}

/// The position of a record with spherical coordinates: azimuth from x towards y, elevation from
/// the x-y plane towards z, in radians.
Vec3 E57ScanReader::spherical(std::size_t i) const {
  const double range = columns_[kE57Range][i];
  const double azimuth = columns_[kE57Azimuth][i];
  const double elevation = columns_[kE57Elevation][i];
  const double in_plane = range * std::cos(elevation);
  return {in_plane * std::cos(azimuth), in_plane * std::sin(azimuth), range * std::sin(elevation)};
}

/// Computes the points of decoded records and lists the absent ones. out: points of the batch from
/// index `first` on.
void E57ScanReader::place_points(std::span<Vec3> out, std::size_t first,
                                 std::vector<std::uint32_t>& absent) {
  const bool has_cartesian = cursors_[kE57X].has_value();
  const bool has_spherical = cursors_[kE57Range].has_value();
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (has_cartesian && is_valid(kE57CartesianState, i)) {
      out[i] = cartesian(i);
    } else if (has_spherical && is_valid(kE57SphericalState, i)) {
      out[i] = spherical(i);
    } else {
      out[i] = {kNoPosition, kNoPosition, kNoPosition};
      absent.push_back(static_cast<std::uint32_t>(first + i));
      ++findings_.absent;
    }
  }
  if (scan_.bounds) widen(findings_.own, out);
  if (!scan_.pose) return;
  for (Vec3& point : out) point = transform(*scan_.pose, point);
  if (scan_.bounds) widen(findings_.posed, out);
}

void E57ScanReader::finish() {
  if (finished_) return;
  packets_.check_totals();
  for (auto& cursor : cursors_) {
    if (!cursor) continue;
    while (cursor->refill(pages_.name())) {
    }
    if (!cursor->holds_more()) continue;
    refuse_byte(pages_.name(), scan_.file_offset,
                scan_.name() + " goes on behind its last record; expected " +
                    std::to_string(scan_.records) + " records and zeros up to the next word");
  }
  finished_ = true;
}

}  // namespace clearway
