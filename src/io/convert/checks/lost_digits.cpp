#include "io/convert/checks/lost_digits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "io/system/input_error.hpp"

namespace clearway {
namespace {

/// Steps in metres, from the coarsest. Whole centimetres are common in text and not suspicious.
constexpr std::array<double, 14> kSteps{100,  10,    8,   4,      2,       1,        0.5,
                                        0.25, 0.125, 0.1, 0.0625, 0.03125, 0.015625, 0};
// An axis with at most so many values, as in a flat scan, has lost nothing.
constexpr std::size_t kFewValues = 8;
constexpr std::size_t kFewSamples = 1000;

bool all_are_multiples(std::span<const Vec3> samples, int axis, double step) {
  return std::all_of(samples.begin(), samples.end(), [=](const Vec3& p) {
    const double steps = p[axis] / step;
    return std::abs(steps - std::round(steps)) < 1e-6;
  });
}

bool has_few_values(std::span<const Vec3> samples, int axis) {
  std::set<double> values;
  for (const Vec3& p : samples) {
    values.insert(p[axis]);
    if (values.size() > kFewValues) return false;
  }
  return true;
}

/// The coarsest step of which all samples are multiples, in metres; 0 where there is none.
double step_of(std::span<const Vec3> samples, int axis) {
  if (has_few_values(samples, axis)) return 0;
  return *std::find_if(kSteps.begin(), kSteps.end(), [&](double step) {
    return step == 0 || all_are_multiples(samples, axis, step);
  });
}

}  // namespace

std::vector<Message> warn_of_lost_digits(std::span<const Vec3> samples) {
  std::vector<Message> warnings;
  if (samples.size() < kFewSamples) return warnings;
  std::string axes, steps;
  double coarsest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double step = step_of(samples, axis);
    if (step == 0) continue;
    axes += std::string(axes.empty() ? "" : ", ") + static_cast<char>('x' + axis);
    steps += (steps.empty() ? "" : ", ") + brief(step) + " m";
    coarsest = std::max(coarsest, step);
  }
  if (coarsest == 0) return warnings;
  warnings.push_back({Message::Severity::kWarning,
                      "lost-digits",
                      "all coordinates " + axes + " are multiples of " + steps +
                          ". Rounded text or single floats have lost their digits, so points may "
                          "be wrong by " +
                          brief(coarsest / 2) + " m. Export the scan with more digits",
                      {{"step", coarsest}}});
  return warnings;
}

}  // namespace clearway
