#include "io/formats/pcd/pcd_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/util/format.hpp"
#include "io/formats/pcd/pcd_body_reader.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

// At least a page of memory on any machine.
constexpr std::uint64_t kMostPadding = std::uint64_t{1} << 16;

/// The remark on a viewpoint; nullopt for the default, which is 0 0 0 and no rotation.
std::optional<Message> remark_on_viewpoint(const std::array<double, 7>& viewpoint,
                                           const std::string& name) {
  const double norm =
      std::hypot(std::hypot(viewpoint[3], viewpoint[4]), std::hypot(viewpoint[5], viewpoint[6]));
  const double cosine = norm > 0 ? std::min(1.0, std::abs(viewpoint[3]) / norm) : 1;
  const double degrees = 2 * std::acos(cosine) * 180 / std::numbers::pi;
  if (std::all_of(viewpoint.begin(), viewpoint.begin() + 3, [](double c) { return c == 0; }) &&
      degrees == 0) {
    return std::nullopt;
  }
  return Message{
      Message::Severity::kWarning,
      "pcd-viewpoint",
      name + ": its VIEWPOINT lies at (" + brief(viewpoint[0]) + ", " + brief(viewpoint[1]) + ", " +
          brief(viewpoint[2]) + "), turned by " + brief(degrees) +
          " degrees. It is not applied: PCL defines it as the place of the sensor. If the points "
          "are in the sensor's frame, apply it first, for example with "
          "pcl_transform_from_viewpoint",
      {{"x", viewpoint[0]}, {"y", viewpoint[1]}, {"z", viewpoint[2]}, {"degrees", degrees}}};
}

}  // namespace

PcdBodyReader::PcdBodyReader(InputBuffer input, PcdHeader header)
    : input_(std::move(input)), header_(std::move(header)), first_point_(input_.mark()) {
  info_.declared_points = header_.points;
  if (!header_.viewpoint) return;
  if (auto remark = remark_on_viewpoint(*header_.viewpoint, input_.name())) {
    info_.remarks.push_back(std::move(*remark));
  }
}

bool PcdBodyReader::read(PointBatch& batch) {
  batch.quanta.clear();
  batch.absent.clear();
  batch.positions.resize(std::min<std::uint64_t>(kBatchPoints, header_.points - next_));
  if (batch.positions.empty()) {
    finish();
    return false;
  }
  read_points(batch.positions);
  next_ += batch.positions.size();
  if (header_.height > 1) mark_absent(batch);
  return true;
}

void PcdBodyReader::rewind() {
  input_.return_to(first_point_);
  next_ = absent_ = 0;
  start_again();
}

void PcdBodyReader::mark_absent(PointBatch& batch) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (std::uint32_t i = 0; i < batch.positions.size(); ++i) {
    Vec3& p = batch.positions[i];
    if (!std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z)) continue;
    p = {kNaN, kNaN, kNaN};
    batch.absent.push_back(i);
  }
  absent_ += batch.absent.size();
}

void PcdBodyReader::finish() {
  if (finished_) return;
  check_end();
  finished_ = true;
  if (absent_ == 0) return;
  info_.remarks.push_back({Message::Severity::kNote,
                           "absent-points",
                           input_.name() + ": " + format_count(absent_) + " of " +
                               format_count(header_.points) +
                               " places of the organised cloud hold no point",
                           {{"absent", static_cast<double>(absent_)},
                            {"records", static_cast<double>(header_.points)}}});
}

void PcdBodyReader::check_only_padding() {
  const std::uint64_t position = input_.position();
  const std::uint64_t left = *input_.size() - position;
  const auto bytes = left <= kMostPadding ? input_.take(left) : std::span<const std::byte>();
  const auto pads = [](std::byte b) {
    return b == std::byte{0} || b == std::byte{'\n'} || b == std::byte{'\r'};
  };
  if (left <= kMostPadding && std::all_of(bytes.begin(), bytes.end(), pads)) return;
  refuse_byte(input_.name(), position,
              format_count(left) + " bytes behind the last of " + format_count(header_.points) +
                  " points; expected the end of the file");
}

std::unique_ptr<PointReader> read_pcd(InputBuffer input) {
  PcdHeader header = read_pcd_header(input);
  switch (header.data) {
    case PcdData::kAscii:
      return read_ascii_pcd(std::move(input), std::move(header));
    case PcdData::kBinary:
      return read_binary_pcd(std::move(input), std::move(header));
    case PcdData::kCompressed:
      break;
  }
  return read_compressed_pcd(std::move(input), std::move(header));
}

}  // namespace clearway
