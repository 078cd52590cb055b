#pragma once

#include <cmath>

namespace clearway {

/// Converts numbers from one unit to another. Each is rounded only once if one unit is a whole
/// multiple of the other: 9 millimetres are the double nearest to 0.009.
class UnitFactor {
 public:
  /// Lengths of both units in metres, above 0.
  explicit UnitFactor(double from, double to = 1)
      : factor_(from / to), parts_(std::round(to / from)), divides_(1 / parts_ == factor_) {}

  double operator()(double value) const { return divides_ ? value / parts_ : value * factor_; }
  double factor() const { return factor_; }

 private:
  double factor_, parts_;
  bool divides_;
};

}  // namespace clearway
