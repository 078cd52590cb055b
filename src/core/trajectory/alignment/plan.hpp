#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace clearway {

/// A piece of an alignment's plan whose curvature changes evenly: a straight line, an arc or a
/// clothoid. Lengths are in metres.
struct PlanElement {
  double length = 0;                            ///< above 0
  double first_curvature = 0;                   ///< at its start, in 1/m, positive to the left
  double last_curvature = 0;                    ///< at its end
  std::complex<double> start = 0.0, end = 0.0;  ///< x + i y

  /// Angle in radians by which it turns, positive to the left.
  double turn() const { return (first_curvature + last_curvature) / 2 * length; }
};

/// A place of the plan: x + i y, and the direction counter-clockwise from x in radians.
struct PlanPlace {
  std::complex<double> at = 0.0;
  double heading = 0;
};

/// The plan of an alignment. Each element is turned and scaled so that it runs from its own start
/// to that of the next, which makes the plan continuous and lets it meet every place of the file.
/// docs/design/trajectory.md, "Alignments".
class AlignmentPlan {
 public:
  /// elements: at least one. None turns by a full circle or more. first_station: in metres.
  AlignmentPlan(std::vector<PlanElement> elements, double first_station);

  double first_station() const { return stations_.front(); }
  double last_station() const { return stations_.back(); }
  /// The station at which an element begins.
  double station_of(std::size_t element) const { return stations_[element]; }

  /// The place at a station, which is taken as that of the nearer end if it is beyond. A station on
  /// a border belongs to the later element.
  PlanPlace at(double station) const;

  const std::vector<PlanElement>& elements() const { return elements_; }
  /// Distance in metres from the end of an element to the start of the next one.
  double gap_after(std::size_t element) const;
  /// Metres by which the distance between the two nodes of an element differs from the chord that
  /// its length and curvatures give.
  double misfit_of(std::size_t element) const;
  /// Change of direction in radians between an element and the next one, from -pi to pi.
  double kink_after(std::size_t element) const;

 private:
  /// Integral of exp(i angle) over the element from its start to `u`.
  std::complex<double> shape(std::size_t element, double u) const;
  std::complex<double> node(std::size_t i) const;

  std::vector<PlanElement> elements_;
  std::vector<double> stations_;  ///< one more than there are elements
  /// For each element the values of shape() at equal steps, from its start to its end
  std::vector<std::vector<std::complex<double>>> shapes_;
  std::vector<std::complex<double>> turns_;  ///< q of each element
};

}  // namespace clearway
