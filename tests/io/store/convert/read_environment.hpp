#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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
};

inline Environment read_environment(const std::vector<std::filesystem::path>& inputs,
                                    const EnvironmentOptions& options = {}) {
  NoProgress progress;
  EnvironmentSource source(inputs, options, progress);
  Environment out{};
  QuantaBatch batch;
  while (source.read(batch)) {
    for (std::size_t i = 0; i < batch.quanta.size(); ++i) {
      out.points.push_back({batch.source(i), batch.quanta[i]});
    }
  }
  out.quantisation = source.quantisation();
  out.input_points = source.input_points();
  out.non_finite_points = source.non_finite_points();
  out.largest_change = source.largest_change();
  out.warnings = source.remarks();
  out.unit = source.unit();
  return out;
}

inline std::optional<InputError> refused(const std::vector<std::filesystem::path>& inputs,
                                         const EnvironmentOptions& options = {}) {
  try {
    read_environment(inputs, options);
  } catch (const InputError& error) {
    return error;
  }
  return std::nullopt;
}

inline std::string refusal(const std::vector<std::filesystem::path>& inputs,
                           const EnvironmentOptions& options = {}) {
  const auto error = refused(inputs, options);
  return error ? error->what() : "";
}

}  // namespace clearway::test
