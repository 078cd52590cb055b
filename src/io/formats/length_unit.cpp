#include "io/formats/length_unit.hpp"

#include <array>

namespace clearway {
namespace {

struct NamedUnit {
  const char *name, *symbol;
  double metres;
};

/// In the order of LengthUnit.
constexpr std::array<NamedUnit, 5> kUnits{{{"unknown", "m", 0},
                                           {"metre", "m", 1},
                                           {"foot", "ft", 0.3048},
                                           {"us-survey-foot", "US ft", 1200.0 / 3937},
                                           {"degree", "deg", 0}}};

}  // namespace

std::string to_string(LengthUnit unit) { return kUnits[static_cast<std::size_t>(unit)].name; }

LengthUnit length_unit_of(const std::string& name) {
  for (std::size_t i = 0; i < kUnits.size(); ++i) {
    if (name == kUnits[i].name) return static_cast<LengthUnit>(i);
  }
  return LengthUnit::kUnknown;
}

const char* symbol_of(LengthUnit unit) { return kUnits[static_cast<std::size_t>(unit)].symbol; }

double metres_of(LengthUnit unit) { return kUnits[static_cast<std::size_t>(unit)].metres; }

}  // namespace clearway
