#include "search/checks/question.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "core/trajectory/chainage.hpp"

namespace clearway {
namespace {

/// Of a foot, international or of the US survey: the checks need no more digits.
constexpr double kFoot = 0.3048;

}  // namespace

Question::Question(const PackedCloud& environment_points, LengthUnit length_unit,
                   const Query& asked)
    : Question(environment_points, length_unit, asked, {}, {}) {}

Question::Question(const PackedCloud& environment_points, LengthUnit length_unit,
                   const Query& asked, std::span<const std::uint32_t> numbers,
                   std::span<const double> chainages)
    : cloud(environment_points),
      unit(length_unit),
      query(asked),
      path_pose(numbers),
      path_chainage(chainages),
      environment(position_box(cloud.quantisation(), cloud.tree()[0].box)),
      model(box_of(query.model)),
      metre(unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot ? 1 / kFoot : 1) {}

double Question::chainage(std::uint32_t pose) const {
  const std::uint32_t number = number_of(pose);
  return path_chainage.empty() ? chainage_of(query.poses)[number] : path_chainage[number];
}

Sides::Sides(const Box& box) {
  double sides[3] = {box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
  std::sort(sides, sides + 3);
  longest = sides[2];
  middle = sides[1];
  shortest = sides[0];
}

Box moved(const Box& box, const Pose& pose) {
  const Vec3 centre = transform(pose, centre_of(box));
  Box out{centre, centre};
  for (int k = 0; k < 3; ++k) {
    double half = 0;
    for (int j = 0; j < 3; ++j) {
      half += std::abs(pose.rotation[3 * k + j]) * (box.hi[j] - box.lo[j]) / 2;
    }
    out.lo[k] -= half;
    out.hi[k] += half;
  }
  return out;
}

Box united(const Box& a, const Box& b) {
  Box out = a;
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = std::min(out.lo[k], b.lo[k]);
    out.hi[k] = std::max(out.hi[k], b.hi[k]);
  }
  return out;
}

double scale_of(const Pose& pose) {
  double sum = 0;
  for (const double r : pose.rotation) sum += r * r;
  return std::sqrt(sum / 3);
}

double path_length(const std::vector<Pose>& poses) {
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length += std::sqrt(squared_distance(translation_of(poses[i - 1]), translation_of(poses[i])));
  }
  return length;
}

double gap(const Box& a, const Box& b) {
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double apart = std::max({b.lo[k] - a.hi[k], a.lo[k] - b.hi[k], 0.0});
    squared += apart * apart;
  }
  return std::sqrt(squared);
}

}  // namespace clearway
