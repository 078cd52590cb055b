#include "io/formats/length_unit.hpp"

#include <array>

namespace clearway {
namespace {

struct NamedUnit {
  const char* name;
  double metres;
};

/// In the order of LengthUnit.
constexpr std::array<NamedUnit, 5> kUnits{{{"unknown", 0},
                                           {"metre", 1},
                                           {"foot", 0.3048},
                                           {"us-survey-foot", 1200.0 / 3937},
                                           {"degree", 0}}};

}  // namespace

std::string to_string(LengthUnit unit) { return kUnits[static_cast<std::size_t>(unit)].name; }

LengthUnit length_unit_of(const std::string& name) {
  for (std::size_t i = 0; i < kUnits.size(); ++i) {
    if (name == kUnits[i].name) return static_cast<LengthUnit>(i);
  }
  return LengthUnit::kUnknown;
}

double metres_of(LengthUnit unit) { return kUnits[static_cast<std::size_t>(unit)].metres; }

}  // namespace clearway
