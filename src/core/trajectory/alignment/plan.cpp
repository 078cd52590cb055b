#include "core/trajectory/alignment/plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace clearway {
namespace {

using Complex = std::complex<double>;

/// Angle in radians over which the integral is taken with one set of places.
constexpr double kPieceTurn = 0.25;

/// Places and weights of Gauss and Legendre's rule with eight places on [-1, 1], which is
/// symmetric.
constexpr double kPlaces[] = {0.18343464249564980494, 0.52553240991632898582,
                              0.79666647741362673959, 0.96028985649753623168};
constexpr double kWeights[] = {0.36268378337836198297, 0.31370664587788728734,
                               0.22238103445337447054, 0.10122853629037625915};

/// Angle that an element has turned by at `u` metres from its start.
double angle_at(const PlanElement& element, double u) {
  return element.first_curvature * u +
         (element.last_curvature - element.first_curvature) * u * u / (2 * element.length);
}

Complex direction_at(const PlanElement& element, double u) {
  return std::polar(1.0, angle_at(element, u));
}

/// Integral of the direction over [from, to], which turns by at most kPieceTurn or little more.
Complex integral(const PlanElement& element, double from, double to) {
  const double middle = (from + to) / 2, half = (to - from) / 2;
  Complex sum = 0;
  for (std::size_t i = 0; i < std::size(kPlaces); ++i) {
    const double aside = half * kPlaces[i];
    sum += kWeights[i] *
           (direction_at(element, middle - aside) + direction_at(element, middle + aside));
  }
  return half * sum;
}

std::size_t pieces_of(const PlanElement& element) {
  const double most = std::max(std::abs(element.first_curvature), std::abs(element.last_curvature));
  return static_cast<std::size_t>(std::max(1.0, std::ceil(most * element.length / kPieceTurn)));
}

}  // namespace

AlignmentPlan::AlignmentPlan(std::vector<PlanElement> elements, double first_station)
    : elements_(std::move(elements)), stations_{first_station} {
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const PlanElement& element = elements_[i];
    stations_.push_back(stations_.back() + element.length);
    const std::size_t pieces = pieces_of(element);
    std::vector<Complex> sums{0.0};
    for (std::size_t k = 0; k < pieces; ++k) {
      const double from = element.length * static_cast<double>(k) / static_cast<double>(pieces);
      const double to = element.length * static_cast<double>(k + 1) / static_cast<double>(pieces);
      sums.push_back(sums.back() + integral(element, from, to));
    }
    shapes_.push_back(std::move(sums));
    turns_.push_back((node(i + 1) - node(i)) / shapes_.back().back());
  }
}

Complex AlignmentPlan::node(std::size_t i) const {
  return i < elements_.size() ? elements_[i].start : elements_.back().end;
}

Complex AlignmentPlan::shape(std::size_t element, double u) const {
  const auto& sums = shapes_[element];
  const auto pieces = static_cast<double>(sums.size() - 1);
  const double length = elements_[element].length;
  const double piece = std::clamp(std::floor(u / length * pieces), 0.0, pieces - 1);
  return sums[static_cast<std::size_t>(piece)] +
         integral(elements_[element], length * piece / pieces, u);
}

PlanPlace AlignmentPlan::at(double station) const {
  const auto begins = std::upper_bound(stations_.begin(), stations_.end() - 1, station);
  const auto element =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(begins - stations_.begin() - 1, 0));
  const double u = std::clamp(station - stations_[element], 0.0, elements_[element].length);
  return {node(element) + turns_[element] * shape(element, u),
          std::arg(turns_[element]) + angle_at(elements_[element], u)};
}

double AlignmentPlan::gap_after(std::size_t element) const {
  return std::abs(node(element + 1) - elements_[element].end);
}

double AlignmentPlan::misfit_of(std::size_t element) const {
  return std::abs(node(element + 1) - node(element)) - std::abs(shapes_[element].back());
}

double AlignmentPlan::kink_after(std::size_t element) const {
  const double before = std::arg(turns_[element]) + elements_[element].turn();
  return std::remainder(std::arg(turns_[element + 1]) - before, 2 * std::numbers::pi);
}

}  // namespace clearway
