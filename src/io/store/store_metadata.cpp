#include "io/store/store_metadata.hpp"

#include <array>

namespace clearway {
namespace {

constexpr std::array<const char*, 5> kUnitNames{"unknown", "metre", "foot", "us-survey-foot",
                                                "degree"};

}  // namespace

std::string to_string(LengthUnit unit) { return kUnitNames[static_cast<std::size_t>(unit)]; }

LengthUnit length_unit_of(const std::string& name) {
  for (std::size_t i = 0; i < kUnitNames.size(); ++i) {
    if (name == kUnitNames[i]) return static_cast<LengthUnit>(i);
  }
  return LengthUnit::kUnknown;
}

}  // namespace clearway
