#include "io/trajectory/text/position_unit.hpp"

#include <algorithm>

#include "io/formats/length_unit.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

FileUnit unit_in_header(std::span<const std::string> texts, const std::string& name) {
  FileUnit declared;
  for (const std::string& text : texts) {
    if (text.empty()) continue;
    const auto unit = file_unit_of(text);
    if (!unit) {
      refuse(name,
             "the header has positions in " + excerpt(text) + "; expected " + file_unit_list());
    }
    if (declared.is_known() && declared != *unit) {
      refuse(name, "the header has positions in several units; expected one");
    }
    declared = *unit;
  }
  const bool all = std::ranges::none_of(texts, &std::string::empty);
  if (declared.is_known() && declared.metres() != 1 && !all) {
    refuse(name, "the header has a unit for some of the positions; expected one for all or none");
  }
  return declared;
}

bool contradict(const FileUnit& header, const FileUnit& option) {
  if (!header.is_known() || !option.is_known() || header == option) return false;
  const bool vague = header.is_any_foot() || option.is_any_foot();
  return !(vague && is_foot(header.metres()) && is_foot(option.metres()));
}

}  // namespace

FileUnit unit_of_positions(std::span<const std::string> texts, const TrajectoryOptions& options,
                           const std::string& name) {
  const FileUnit declared = unit_in_header(texts, name), option = options.metres_per_unit;
  if (contradict(declared, option)) {
    refuse(name, "the header has positions in units of " + brief(declared.metres()) +
                     " m, but a unit of " + brief(option.metres()) + " m was declared");
  }
  const bool option_counts = !declared.is_known() || (declared.is_any_foot() && option.is_known());
  return option_counts ? option : declared;
}

}  // namespace clearway
