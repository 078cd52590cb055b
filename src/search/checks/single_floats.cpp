#include "search/checks/single_floats.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace clearway {
namespace {

/// The step from the number of single precision that is nearest to a coordinate to the next one.
double step_at(double coordinate) {
  const auto near = static_cast<float>(std::abs(coordinate));
  return static_cast<double>(std::nextafter(near, std::numeric_limits<float>::infinity())) - near;
}

/// Whether a coordinate is a number of single precision, which may have been rounded to the digits
/// of a text. By chance one coordinate in eight is.
bool is_single(double coordinate, double step) {
  constexpr double kRounded = 1.0 / 16;  // share of the step
  return std::abs(coordinate - static_cast<float>(coordinate)) <= kRounded * step;
}

bool is_whole_hundredths(double coordinate, double unit) {
  constexpr double kPerUnit = 100, kRounding = 1e-6;
  const double hundredths = coordinate / unit * kPerUnit;
  return std::abs(hundredths - std::round(hundredths)) <= kRounding;
}

/// Whether a coordinate is that of a text with two decimals, in metres or in its own unit.
bool is_of_rounded_text(double coordinate, double metre) {
  return is_whole_hundredths(coordinate, metre) || is_whole_hundredths(coordinate, 1);
}

}  // namespace

std::optional<double> single_precision_step(std::span<const Vec3> places, double least,
                                            double metre) {
  // Fewer coordinates than this may be such numbers by chance.
  constexpr std::uint64_t kFew = 8;
  constexpr double kNearlyAll = 0.99;
  std::uint64_t judged = 0, single = 0, telling = 0;
  double largest = 0;
  for (const Vec3& place : places) {
    for (int axis = 0; axis < 3; ++axis) {
      const double step = step_at(place[axis]);
      if (!(step > least)) continue;
      ++judged;
      if (!is_single(place[axis], step)) continue;
      ++single;
      largest = std::max(largest, step);
      if (!is_of_rounded_text(place[axis], metre)) ++telling;
    }
  }
  const bool all = static_cast<double>(single) >= kNearlyAll * static_cast<double>(judged);
  if (telling < kFew || !all) return std::nullopt;
  return largest;
}

void warn_of_single_precision(const Question& question, std::span<const Vec3> places,
                              const std::string& whose, const std::string& remedy,
                              MessageLog& log) {
  constexpr double kMatters = 0.05;  // share of the radius
  // A section has cells, which decide where it has no margin.
  const double cell = question.is_load() ? question.section->cell : 0;
  const double radius = std::max(question.query.radius, cell);
  const auto step = single_precision_step(places, kMatters * radius, question.metre);
  if (!step) return;
  log.warn("single-precision",
           whose + " are numbers of single precision, which are " + question.length(*step) +
               " apart at these coordinates, so they can be wrong by " +
               question.length(*step / 2) +
               (cell > 0 ? ", with a margin or cells of " : ", with a radius of ") +
               question.length(radius) + ". " + remedy,
           {{"step", *step}, {"radius", radius}});
}

}  // namespace clearway
