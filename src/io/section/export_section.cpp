#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "clearway/error.hpp"
#include "clearway/section.hpp"
#include "core/section/section_tables.hpp"
#include "core/util/format.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/text_writer.hpp"
#include "io/scans/length_unit.hpp"
#include "io/section/section_file.hpp"

namespace clearway {

Section::Section(const std::filesystem::path& path) : Section(read_section(path)) { path_ = path; }

namespace {

void refuse_replacing(const Section& section, const std::filesystem::path& output) {
  if (!section.path().empty()) refuse_overwriting(output, {section.path()});
}

/// What a reader of widths has to know, in lines that begin with "#".
void write_preamble(TextWriter& out, const Section& section, SectionTable table,
                    const SectionHeights& heights) {
  const double base = section_base(section, heights);
  const SectionData& data = section.data();
  const SectionParameters& asked = data.parameters;
  out << "# Widths from y = 0 to the border of the nearest blocked cell of "
      << format_length(asked.cell) << ", for a load from x = " << format_length(asked.rear)
      << " to " << format_length(asked.front) << "\n# A load must be narrower by more than "
      << format_length(kept_beside(data))
      << " on each side, and stay as far from the ends of its bands; symmetric_width has that "
         "taken off\n";
  if (data.motion) {
    out << "# Of this, " << format_length((*data.motion)[1] / 2)
        << " is half of the motion across between two poses\n";
  }
  if (data.unknown) {
    out << "# Cells that no beam of the scanner crossed end a width as blocked ones do: left_end "
           "and "
           "right_end say blocked or not-known\n";
  }
  if (const LengthUnit unit = length_unit_of(data.length_unit); is_foot(metres_of(unit))) {
    out << "# Lengths are in " << plural_of(unit) << "\n";
  }
  out << "# open: nothing blocks that side up to the border of the window\n";
  if (!heights.base && base != 0) {
    out << "# The base is the bottom of the window, z = " << format_length(base) << "\n";
  }
  if (table == SectionTable::kBoxes) {
    const std::optional<double> from = heights_of_load(section, heights).base;
    if (!heights.base && from) {
      out << "# The boxes stand at z = " << format_length(*from)
          << ", the lowest band whose middle is free\n";
    }
  }
  for (const Message& warning : data.warnings) {
    std::string line = warning.text;
    for (char& c : line) {
      if (c == '\n' || c == '\r') c = ' ';
    }
    out << "# warning " << warning.code << ": " << line << "\n";
  }
}

void write_half(TextWriter& out, const SectionData& section, const std::optional<HalfWidth>& half) {
  if (!half) {
    out << "open,,";
    return;
  }
  out << readable_length(half->width) << "," << half->first_pose << ","
      << readable_length(section.chainage[half->first_pose]);
}

void write_symmetric(TextWriter& out, const SectionData& section, const SectionBand& band) {
  const auto width = symmetric_width(section, band);
  if (width) {
    // Down to 0.1 mm, so that a load of this width still passes, but for roundings of the division.
    out << std::floor(*width * 1e4 + 1e-5) / 1e4;
  } else {
    out << "open";
  }
  if (section.unknown) {
    for (const std::optional<HalfWidth>& half : {band.left, band.right}) {
      out << "," << (!half ? "" : half->is_blocked ? "blocked" : "not-known");
    }
  }
  out << "\n";
}

/// The end of a line of names.
const char* names_of_ends(const SectionData& section) {
  return section.unknown ? ",left_end,right_end\n" : "\n";
}

void write_band(TextWriter& out, const SectionData& section, const SectionBand& band) {
  out << readable_length(band.z_from) << "," << readable_length(band.z_to) << ",";
  write_half(out, section, band.left);
  out << ",";
  write_half(out, section, band.right);
  out << ",";
  write_symmetric(out, section, band);
}

constexpr const char* kBandColumns =
    "z_from,z_to,left,left_pose,left_station,right,right_pose,right_station,symmetric_width";

void write_stations(TextWriter& out, const Section& section, const SectionHeights& heights) {
  const SectionData& data = section.data();
  const double bin = data.parameters.bin;
  out << "bin,chainage_from,chainage_to," << kBandColumns << names_of_ends(data);
  for (const SectionStretch& stretch : section_stations(section, heights)) {
    for (const SectionBand& band : stretch.bands) {
      out << stretch.bin << "," << readable_length(stretch.bin * bin) << ","
          << readable_length((stretch.bin + 1.0) * bin) << ",";
      write_band(out, data, band);
    }
  }
}

void write_boxes(TextWriter& out, const Section& section, const SectionHeights& heights) {
  const auto side = [&out](const std::optional<HalfWidth>& half) {
    if (half) {
      out << readable_length(half->width) << ",";
    } else {
      out << "open,";
    }
  };
  out << "top,left,right,symmetric_width" << names_of_ends(section.data());
  for (const SectionBand& box : section_boxes(section, heights)) {
    out << readable_length(box.z_to) << ",";
    side(box.left);
    side(box.right);
    write_symmetric(out, section.data(), box);
  }
}

void write_cells(TextWriter& out, const SectionCells& cells, bool bins) {
  out << (bins ? "bin,j,k,first_pose\n" : "j,k,first_pose\n");
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (bins) out << cells.bin[i] << ",";
    out << cells.j[i] << "," << cells.k[i] << "," << cells.first_pose[i] << "\n";
  }
}

}  // namespace

void export_section(const Section& section, SectionTable table, const std::filesystem::path& output,
                    const SectionHeights& heights, bool overwrite) {
  refuse_replacing(section, output);
  const bool of_unknown =
      table == SectionTable::kUnknownCells || table == SectionTable::kUnknownBinCells;
  if (of_unknown && !section.data().unknown) {
    throw UsageError(
        "the section was found without seen space, so that nothing says which cells "
        "are not known");
  }
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    TextWriter out(file);
    switch (table) {
      case SectionTable::kBands:
        write_preamble(out, section, table, heights);
        out << kBandColumns << names_of_ends(section.data());
        for (const SectionBand& band : section_bands(section, heights)) {
          write_band(out, section.data(), band);
        }
        break;
      case SectionTable::kStations:
        write_preamble(out, section, table, heights);
        write_stations(out, section, heights);
        break;
      case SectionTable::kBoxes:
        write_preamble(out, section, table, heights);
        write_boxes(out, section, heights);
        break;
      case SectionTable::kCells:
        write_cells(out, section.cells(), false);
        break;
      case SectionTable::kBinCells:
        write_cells(out, section.data().bin_cells, true);
        break;
      case SectionTable::kUnknownCells:
        write_cells(out, section.unknown_cells(), false);
        break;
      case SectionTable::kUnknownBinCells:
        write_cells(out, *section.data().unknown, true);
    }
    out.flush();
  }
  pending.publish();
}

namespace {

/// A pair of a DXF file: a code and its value, a line each.
template <typename Value>
void write_pair(TextWriter& out, int code, const Value& value) {
  out << code << "\n" << value << "\n";
}

constexpr const char* kLookingForward = "Looking forward: x is to the right, y is up";

/// A line of text below the outline, on a layer of its own.
void write_note(TextWriter& out, const std::vector<OutlinePoint>& outline) {
  const auto [bottom, top] = std::ranges::minmax(outline, {}, &OutlinePoint::z);
  const double left = std::ranges::max(outline, {}, &OutlinePoint::y).y;
  const double height = (top.z - bottom.z) / 20;
  write_pair(out, 0, "TEXT");
  write_pair(out, 8, "NOTES");
  write_pair(out, 10, -left);
  write_pair(out, 20, bottom.z - 2 * height);
  write_pair(out, 30, 0);
  write_pair(out, 40, height);
  write_pair(out, 1, kLookingForward);
}

/// Writes a closed polyline in the form of AutoCAD's release 12, which every program reads. y of
/// the load runs to the left, so looking forward it is drawn with the opposite sign, and the file
/// says so.
void write_dxf(TextWriter& out, const std::vector<OutlinePoint>& outline, LengthUnit unit) {
  write_pair(out, 999, std::string("Outline of the largest load, ") + plural_of(unit));
  write_pair(out, 999, kLookingForward);
  write_pair(out, 999, "Outlines for clearway section check have y to the left instead: y = -x");
  write_pair(out, 0, "SECTION");
  write_pair(out, 2, "HEADER");
  write_pair(out, 9, "$ACADVER");
  write_pair(out, 1, "AC1009");
  write_pair(out, 0, "ENDSEC");
  write_pair(out, 0, "SECTION");
  write_pair(out, 2, "ENTITIES");
  write_pair(out, 0, "POLYLINE");
  write_pair(out, 8, "LARGEST_LOAD");
  write_pair(out, 66, 1);
  write_pair(out, 70, 1);
  for (const OutlinePoint& corner : outline) {
    write_pair(out, 0, "VERTEX");
    write_pair(out, 8, "LARGEST_LOAD");
    write_pair(out, 10, -corner.y);
    write_pair(out, 20, corner.z);
    write_pair(out, 30, 0);
  }
  write_pair(out, 0, "SEQEND");
  write_note(out, outline);
  write_pair(out, 0, "ENDSEC");
  write_pair(out, 0, "EOF");
}

}  // namespace

void export_section_outline(const Section& section, const std::filesystem::path& output,
                            const SectionHeights& heights, bool overwrite) {
  refuse_replacing(section, output);
  const std::vector<OutlinePoint> outline = largest_outline(section, heights);
  PendingFile pending(output, overwrite);
  {
    const File file = File::create(pending.partial());
    TextWriter out(file);
    write_dxf(out, outline, length_unit_of(section.data().length_unit));
    out.flush();
  }
  pending.publish();
}

}  // namespace clearway
