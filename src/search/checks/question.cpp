#include "search/checks/question.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"

namespace clearway {

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
      model(box_of(query.model.vertices)),
      // An international foot also stands for a US survey foot: the checks need no more digits.
      metre(unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot ? 1 / kMetresPerFoot
                                                                           : 1) {}

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

double scale_of(const Pose& pose) {
  double sum = 0;
  for (const double r : pose.rotation) sum += r * r;
  return std::sqrt(sum / 3);
}

}  // namespace clearway
