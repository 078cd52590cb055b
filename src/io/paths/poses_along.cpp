#include "io/paths/poses_along.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/file_unit.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {

std::vector<Pose> PosesAlong::hand_over(std::vector<Message>* messages, PoseLabels* labels) {
  if (labels != nullptr) *labels = {.station = std::move(stations)};
  if (messages != nullptr) {
    messages->insert(messages->end(), std::make_move_iterator(remarks.begin()),
                     std::make_move_iterator(remarks.end()));
  }
  return std::move(poses);
}

void check_option(const std::optional<double>& value, const char* option, bool good,
                  const char* expected) {
  if (!value || (std::isfinite(*value) && good)) return;
  throw UsageError(fmt::format("{}: {}; expected {}", option, format_digits(*value, 9), expected));
}

std::vector<double> even_stations(double from, double to, double step) {
  const double count = std::floor((to - from) / step) + 2;
  if (!(count <= kMostPosesAlong)) {
    throw UsageError(
        "--step " + format_digits(step, 9) + ": gives about " + format_digits(count, 9) +
        " poses; expected at most " + format_count(static_cast<std::uint64_t>(kMostPosesAlong)) +
        ", for example with --step " + format_brief((to - from) / (kMostPosesAlong / 2)));
  }
  std::vector<double> stations;
  stations.reserve(static_cast<std::size_t>(count));
  for (std::size_t i = 0;; ++i) {
    const double station = from + static_cast<double>(i) * step;
    if (!(station < to - kSameStation)) break;
    stations.push_back(station);
  }
  stations.push_back(to);
  return stations;
}

void turn_round(std::vector<Pose>& poses, std::vector<double>& stations) {
  std::ranges::reverse(poses);
  std::ranges::reverse(stations);
  for (Pose& pose : poses) {
    for (int row = 0; row < 3; ++row) {
      for (const int axis : {0, 1}) {
        pose.rotation[3 * row + axis] = 0.0 - pose.rotation[3 * row + axis];
      }
    }
  }
}

void remark_cant(const std::string& name, const AlignmentCant& cant, double rail_distance,
                 std::span<const Pose> poses, Remarks& out) {
  constexpr double kLeast = 0.002, kMost = 0.3;  // metres
  double greatest = 0;
  for (const CantPoint& point : cant.points()) greatest = std::max(greatest, std::abs(point.cant));
  if (greatest > 0 && (greatest < kLeast || greatest > kMost)) {
    out.warn("cant-unit",
             name + ": the greatest cant is " + format_brief(greatest / kMetresPerMillimetre) +
                 " mm. Tracks have up to about 200 mm, so the cant may be in another unit",
             {{"greatest", greatest}});
    return;
  }
  const CurveLean lean =
      lean_in_curves(poses, std::asin(std::min(1.0, kWrongCant / rail_distance)));
  if (!lean.is_mostly_outwards()) return;
  const double share = lean.outwards / lean.curved;
  const double wrong = rail_distance * std::sin(lean.greatest);
  out.warn("cant-side", {{"share", share}, {"cant", wrong}},
           "{}: on {} % of the length of its curves the outer rail is lower than the inner one, by "
           "up to {} mm, so the cant may be to the wrong side",
           name, format_brief(100 * share), format_brief(wrong / kMetresPerMillimetre));
}

std::optional<std::int32_t> other_epsg(long code, const std::string& environment) {
  if (environment.empty() || code == 0) return std::nullopt;
  const ScanCrs scan = scan_crs_of(environment);
  const std::int32_t other = scan.horizontal_epsg != 0 ? scan.horizontal_epsg : scan.epsg;
  if (other == 0 || code == other || code == scan.epsg) return std::nullopt;
  return other;
}

std::string other_crs_text(const std::string& name, long code, std::int32_t environment,
                           const std::string& what) {
  return name + ": the coordinates are in EPSG:" + std::to_string(code) +
         ", and those of the environment in EPSG:" + std::to_string(environment) +
         "; they were not converted, so transform the " + what + " first";
}

}  // namespace clearway
