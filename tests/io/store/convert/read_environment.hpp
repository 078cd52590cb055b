#pragma once

#include <optional>

#include "clearway/error.hpp"
#include "io/store/convert/environment_source.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {

/// Everything that an EnvironmentSource gives: points and facts.
struct Environment {
  Quantisation quantisation;
  std::vector<StoredPoint> points;
  std::uint64_t input_points, non_finite_points;
  double largest_change;
  std::vector<Message> warnings;
  LengthUnit unit;

  std::vector<Quantum> quanta() const {
    std::vector<Quantum> all;
    for (const StoredPoint& point : points) all.push_back(point.q);
    return all;
  }
};

/// Files in a folder of their own that are read as an environment.
struct Inputs : Conversion {
  Environment read(const ConvertOptions& how = {}) const {
    NoProgress progress;
    const ConversionOptions all{how, options.inputs, options.output};
    EnvironmentSource source(all, progress);
    Environment out{};
    QuantaBatch batch;
    while (source.read(batch)) {
      for (std::size_t i = 0; i < batch.quanta.size(); ++i) {
        out.points.push_back({batch.source(i), batch.quanta[i]});
      }
    }
    out.quantisation = source.quantisation();
    out.input_points = source.counts().input_points;
    out.non_finite_points = source.counts().non_finite_points;
    out.largest_change = source.counts().largest_change;
    out.warnings = source.remarks();
    out.unit = source.unit();
    return out;
  }

  /// The error with which reading them is refused; "none" where it is not.
  InputError refused(const ConvertOptions& how = {}) const {
    try {
      read(how);
    } catch (const InputError& error) {
      return error;
    }
    return InputError("none");
  }
  std::string refusal(const ConvertOptions& how = {}) const { return refused(how).what(); }
};

}  // namespace clearway::test
