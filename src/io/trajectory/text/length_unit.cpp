#include "io/trajectory/text/length_unit.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "io/system/input_error.hpp"

namespace clearway {
namespace {

struct Unit {
  std::string_view name;
  double metres;
};

constexpr Unit kLengthUnits[] = {
    {"m", 1},       {"metre", 1},     {"metres", 1},   {"meter", 1},     {"meters", 1},
    {"mm", 0.001},  {"cm", 0.01},     {"in", 0.0254},  {"inch", 0.0254}, {"inches", 0.0254},
    {"ft", 0.3048}, {"feet", 0.3048}, {"foot", 0.3048}};

/// 0 where the unit is not known.
double metres_of(std::string_view text) {
  const auto* const unit = std::find_if(std::begin(kLengthUnits), std::end(kLengthUnits),
                                        [text](const Unit& known) { return known.name == text; });
  return unit == std::end(kLengthUnits) ? 0 : unit->metres;
}

}  // namespace

std::optional<double> unit_of_positions(std::span<const std::string> texts,
                                        const TrajectoryOptions& options, const std::string& name) {
  double declared = 0;
  for (const std::string& text : texts) {
    if (text.empty()) continue;
    const double metres = metres_of(text);
    if (metres == 0) {
      refuse(name,
             "the header has positions in " + excerpt(text) + "; expected m, mm, cm, in or ft");
    }
    if (declared != 0 && declared != metres) {
      refuse(name, "the header has positions in several units; expected one");
    }
    declared = metres;
  }
  if (declared != 0 && options.metres_per_unit != 0 && declared != options.metres_per_unit) {
    refuse(name, "the header has positions in units of " + brief(declared) + " m, but a unit of " +
                     brief(options.metres_per_unit) + " m was declared");
  }
  const bool all = std::none_of(texts.begin(), texts.end(),
                                [](const std::string& text) { return text.empty(); });
  if (declared != 0 && declared != 1 && !all) {
    refuse(name, "the header has a unit for some of the positions; expected one for all or none");
  }
  if (declared == 0) declared = options.metres_per_unit;
  return declared == 0 ? std::nullopt : std::optional(declared);
}

}  // namespace clearway
