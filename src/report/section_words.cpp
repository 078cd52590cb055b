#include "report/section_words.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

#include "core/section/section_tables.hpp"
#include "core/util/format.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {

std::string section_unit(const SectionFacts& section) {
  const LengthUnit unit = length_unit_of(section.length_unit);
  return symbol_of(unit == LengthUnit::kDegrees ? LengthUnit::kMetre : unit);
}

namespace {

/// Where a cell is, such as "1.24 m to the left at a height of 3.1 m".
std::string cell_words(const std::array<std::int32_t, 2>& cell, const SectionFacts& section) {
  const std::string unit = section_unit(section);
  const bool left = cell[0] >= 0;
  const double j = cell[0], g = section.parameters.cell;
  return format_brief(g * (left ? j : -j - 1)) + " " + unit + " to the " +
         (left ? "left" : "right") + " at a height of " + format_brief(g * cell[1]) + " " + unit;
}

/// On how much of the path the load was searched.
std::string extent_words(const SectionData& section) {
  const bool ways = section.parameters.between_poses;
  if (section.load_poses < section.poses) {
    return "at " + format_count(section.load_poses) + " of " + counted(section.poses, "pose") +
           " of the path" + (ways ? " and between them" : "") +
           ", as its pivots are off the path at the others";
  }
  if (ways) return "everywhere on the path";
  return section.poses == 1 ? "at the only pose of the path"
                            : "at all " + counted(section.poses, "pose") + " of the path";
}

/// The verdict on a load that passes.
std::string passes_words(const SectionData& section) {
  return section.warnings.empty() ? "passes: " : "passes with warnings: ";
}

/// The warnings of a section, as the end of a sentence.
std::string warning_words(const SectionData& section) {
  const std::size_t warned = section.warnings.size();
  return warned == 0 ? "" : ". The section has " + counted(warned, "warning");
}

std::string stop_words(const SectionStop& stop, const SectionData& section) {
  const std::string unit = section_unit(section);
  return "at pose " + std::to_string(stop.first_pose) + ", " + format_brief(stop.chainage) + " " +
         unit + " along the path, " + cell_words(stop.cell, section);
}

/// The answer in a sentence. passes(): how far a load passes; stopped(stop): where it is stopped.
template <typename Passes, typename Stopped>
std::string sentence_of(const SectionCheck& check, const SectionData& section, const Passes& passes,
                        const Stopped& stopped) {
  const std::string warnings = warning_words(section);
  if (check.verdict == SectionVerdict::kPasses) return passes_words(section) + passes() + warnings;
  if (check.verdict == SectionVerdict::kUnknown) return "unknown: " + check.reason + warnings;
  return "stopped: " + stopped(stop_words(*check.stop, section)) + " in all" + warnings;
}

}  // namespace

std::string verdict_sentence(const SectionCheck& check, const SectionData& section, double margin) {
  const std::string kept =
      margin > 0 ? " with a margin of " + format_brief(margin) + " " + section_unit(section)
      : section.parameters.margin > 0 ? " without a margin"
                                      : "";
  return sentence_of(
      check, section, [&] { return "the load passes " + extent_words(section) + kept; },
      [&](const std::string& where) {
        return "the load is stopped" + kept + " " + where + ", and in " +
               counted(check.stops.size(), "stretch", "stretches");
      });
}

namespace {

/// How many rows of a table were judged.
std::string judged_words(const OutlineTableCheck& check) {
  const std::string all = counted(check.rows.size(), "row");
  const auto left_out =
      std::ranges::find_if(check.rows, [](const OutlineRowCheck& row) { return !row.bins; });
  if (left_out == check.rows.end()) return all;
  const auto judged = std::ranges::count_if(
      check.rows, [](const OutlineRowCheck& row) { return row.bins.has_value(); });
  return format_count(static_cast<std::uint64_t>(judged)) + " of " + all + " (line " +
         std::to_string(left_out->line) +
         (static_cast<std::size_t>(judged) + 1 < check.rows.size() ? " and others are" : " is") +
         " not judged, because the load has no pose there)";
}

}  // namespace

std::string table_sentence(const OutlineTableCheck& check, const SectionData& section) {
  return sentence_of(
      check, section,
      [&] { return "the outlines of " + judged_words(check) + " pass " + extent_words(section); },
      [&](const std::string& where) {
        const OutlineRowCheck& row = check.rows[check.stop->row];
        std::set<std::uint32_t> bins;
        for (const SectionStop& stop : check.stops) bins.insert(stop.bin);
        return "the outline of line " + std::to_string(row.line) + ", " + row.file.string() +
               ", is stopped " + where + ". A load is stopped in " +
               counted(bins.size(), "stretch", "stretches");
      });
}

std::string row_words(const OutlineRowCheck& check, const SectionData& section) {
  const std::string unit = section_unit(section);
  std::string out = "line " + std::to_string(check.line) + ", chainage " +
                    format_brief(check.chainage_from) + " to " + format_brief(check.chainage_to) +
                    " " + unit + ", " + check.file.string();
  if (check.margin > 0) out += " with a margin of " + format_brief(check.margin) + " " + unit;
  if (!check.bins) return out + ": not judged, because " + check.check.reason;
  out += std::string(": ") + name_of(check.check.verdict);
  if (check.check.stop) {
    return out + " " + stop_words(*check.check.stop, section) + ", and in " +
           counted(check.check.stops.size(), "stretch", "stretches") + " in all";
  }
  return check.check.reason.empty() ? out : out + ", because " + check.check.reason;
}

namespace {

/// A load that stands on the base: its height and, unless both sides are open, its width.
struct BoxLoad {
  double height;
  std::optional<double> width;
};

std::string box_words(const BoxLoad& box, const SectionData& section) {
  const std::string unit = section_unit(section);
  const std::string wide =
      box.width ? format_brief(*box.width) + " " + unit + " wide" : "as wide as the window";
  return wide + " and " + format_brief(box.height) + " " + unit + " high";
}

/// Where a band is blocked in the very middle.
std::string first_stop_words(const SectionData& data, const SectionBand& band) {
  const auto& side =
      band.left && (!band.right || band.left->width <= band.right->width) ? band.left : band.right;
  return "first at pose " + std::to_string(side->first_pose) + ", " +
         format_brief(data.chainage[side->first_pose]) + " " + section_unit(data) +
         " along the path";
}

/// The lowest heights at which the middle is free everywhere.
std::string free_heights_words(const Section& section, const SectionHeights& heights) {
  const SectionData& data = section.data();
  const std::string unit = section_unit(data);
  std::optional<double> from, to, width;
  for (const SectionBand& band : section_bands(section, heights)) {
    const auto here = symmetric_width(data, band);
    if (here && *here == 0) {
      if (from) break;
      continue;
    }
    if (!from) from = band.z_from;
    to = band.z_to;
    if (here && (!width || *here < *width)) width = here;
  }
  if (!from) return "The middle is blocked at every height of the window";
  return "The middle is free from z = " + format_brief(*from) + " to " + format_brief(*to) + " " +
         unit + ", for a load " +
         (width ? format_brief(*width) + " " + unit + " wide" : "as wide as the window");
}

}  // namespace

std::string widths_sentence(const Section& section, const SectionHeights& heights) {
  const SectionData& data = section.data();
  const std::string unit = section_unit(data);
  const std::vector<SectionBand> boxes = section_boxes(section, heights);
  const double base = boxes[0].z_from;
  const std::vector<SectionBand> bands = section_bands(section, heights);
  std::vector<BoxLoad> loads;  // the highest of each width
  for (const SectionBand& box : boxes) {
    const auto width = symmetric_width(data, box);
    if (width && *width == 0) break;
    if (!loads.empty() && loads.back().width == width) {
      loads.back().height = box.z_to - base;
    } else {
      loads.push_back({box.z_to - base, width});
    }
  }
  const std::string stands = "a load that stands at z = " + format_brief(base) + " " + unit;
  const std::string below = base > bands[0].z_from ? ". Below z = " + format_brief(base) + " " +
                                                         unit + " the very middle is blocked, " +
                                                         first_stop_words(data, bands[0])
                                                   : "";
  if (loads.empty()) {
    return "nothing passes: " + stands + " is stopped in the very middle, " +
           first_stop_words(data, boxes[0]) + ". " + free_heights_words(section, heights);
  }
  const auto area = [&](const BoxLoad& box) {
    const SectionWindow& window = *data.parameters.window;
    return box.height * box.width.value_or(2 * std::min(window.y_to, -window.y_from));
  };
  const auto largest = std::ranges::max_element(loads, {}, area);
  std::string out = "the largest box: " + stands + " may be " + box_words(*largest, data);
  if (largest != loads.begin()) out += "; or " + box_words(loads.front(), data);
  if (largest + 1 != loads.end()) out += "; or " + box_words(loads.back(), data);
  const bool to_the_top = loads.back().height == boxes.back().z_to - base;
  out += to_the_top ? ". Heights end with the window"
                    : ". Higher loads are stopped in the very middle";
  out += below;
  return out + warning_words(data);
}

}  // namespace clearway
