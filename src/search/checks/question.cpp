#include "search/checks/question.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"

namespace clearway {

Box assumed_load(const SectionParameters& asked, double metre) {
  constexpr double kWidest = 2.5, kHighest = 2.5, kShortest = 1;  // metres
  const SectionWindow& window = *asked.window;
  const double length = std::max(asked.front - asked.rear, kShortest * metre);
  const double width = std::min({kWidest * metre, length / 2, window.y_to - window.y_from});
  const double height = std::min(kHighest * metre, length / 4);
  const double x = (asked.rear + asked.front) / 2;
  const double y = std::max(window.y_from + width / 2, std::min(window.y_to - width / 2, 0.0));
  return {{x - length / 2, y - width / 2, 0}, {x + length / 2, y + width / 2, height}};
}

Question::Question(const PackedCloud& environment_points, LengthUnit length_unit,
                   const Query& asked, const ModelLooks& of_model,
                   std::span<const std::uint32_t> numbers, std::span<const double> chainages,
                   const SectionParameters* of_section)
    : cloud(environment_points),
      unit(length_unit),
      query(asked),
      looks(of_model),
      points(of_model.points(asked.model)),
      path_pose(numbers),
      path_chainage(chainages),
      section(of_section),
      environment(cloud.bounds()),
      model(of_model.box()),
      longest(Sides(model).longest),
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

std::string unit_name(LengthUnit unit) {
  return unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot ? "ft" : "m";
}

std::string length_text(double length, LengthUnit unit) {
  return format_digits(length, 3) + " " + unit_name(unit);
}

std::string size_text(const Box& box, LengthUnit unit) {
  return format_digits(box.hi.x - box.lo.x, 3) + " x " + format_digits(box.hi.y - box.lo.y, 3) +
         " x " + length_text(box.hi.z - box.lo.z, unit);
}

std::string extent_text(const Box& box) {
  std::string text;
  for (int k = 0; k < 3; ++k) {
    text += std::string(k == 0 ? "" : ", ") + "xyz"[k] + " " + format_digits(box.lo[k], 3) +
            " to " + format_digits(box.hi[k], 3);
  }
  return text;
}

std::string share_text(double share) {
  const long percent = std::lround(100 * share);
  if (percent == 0 && share > 0) return "below 1 %";
  if (percent == 100 && share < 1) return "above 99 %";
  return std::to_string(percent) + " %";
}

}  // namespace clearway
