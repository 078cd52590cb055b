#include "clearway/section.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "clearway/outline.hpp"
#include "core/describe/section.hpp"
#include "core/describe/section_report.hpp"
#include "core/section/section_tables.hpp"
#include "python/arrays.hpp"
#include "python/binding.hpp"
#include "python/objects.hpp"
#include "python/watch.hpp"

namespace clearway {

template <>
inline constexpr std::array kChoices<SectionTable>{
    Choice<SectionTable>{"bands", SectionTable::kBands},
    Choice<SectionTable>{"stations", SectionTable::kStations},
    Choice<SectionTable>{"boxes", SectionTable::kBoxes},
    Choice<SectionTable>{"cells", SectionTable::kCells},
    Choice<SectionTable>{"bin-cells", SectionTable::kBinCells},
    Choice<SectionTable>{"unknown-cells", SectionTable::kUnknownCells},
    Choice<SectionTable>{"unknown-bin-cells", SectionTable::kUnknownBinCells}};

}  // namespace clearway

namespace clearway::python {
namespace {

/// A table of widths of a stretch of the path.
struct StretchOfPath {
  std::uint32_t bin;
  double chainage_from, chainage_to;
  std::vector<SectionBand> bands;
};

void add_section_report(py::module_& module) {
  auto parameters = add_class<SectionParameters>(
      module, "SectionParameters",
      "The question of find_section(), with the defaults filled in. Lengths are in metres, or in "
      "the unit of the scans where that is another one.",
      kSectionFields);
  parameters.def_property_readonly(
      "window",
      [](const SectionParameters& asked) {
        const SectionWindow w = asked.window.value_or(SectionWindow{});
        return std::tuple(w.y_from, w.y_to, w.z_from, w.z_to);
      },
      "The part of the cross-section that was looked at: y from and to, z from and to.");
  add_repr(parameters, [](const SectionParameters& asked) {
    return py::str("<SectionParameters: x from {} to {}, cells of {}, bins of {}, margin {}>")
        .format(asked.rear, asked.front, asked.cell, asked.bin, asked.margin);
  });
  add_class<SectionSeenCounts>(module, "SectionSeenCounts",
                               "How many cells of a section no beam of the scanner crossed.");
  auto ignored = add_class<SectionIgnoredCells>(
      module, "SectionIgnoredCells",
      "Cells of a section that ignored points would block somewhere on the path, and that no other "
      "point blocks.");
  add_repr(ignored, [](const SectionIgnoredCells& i) {
    return py::str("<{} cells, {} of them high>").format(i.blocked, i.high);
  });
  auto report =
      add_class<SectionReport>(module, "SectionReport", "How find_section() found a section.");
  add_repr(report, [](const SectionReport& r) {
    return "<" + std::to_string(r.blocked) + " cells are blocked, in " + std::to_string(r.bins) +
           (r.bins == 1 ? " stretch" : " stretches") + warning_words(r.warnings) + ">";
  });
}

void add_section_checks(py::module_& module) {
  auto stop = add_class<SectionStop>(module, "SectionStop",
                                     "A place that stops a load, or that is not known.");
  add_repr(stop, [](const SectionStop& s) {
    return py::str("<pose {} at {} m, cell ({}, {})>")
        .format(s.first_pose, s.chainage, s.cell[0], s.cell[1]);
  });
  auto check =
      add_class<SectionCheck>(module, "SectionCheck", "Whether a load with an outline passes.");
  check.def_property_readonly(
      "reason",
      [](const SectionCheck& c) {
        return c.reason.empty() ? py::object(py::none()) : text(c.reason);
      },
      "Why the verdict is 'unknown', as a clause; otherwise None.");
  add_repr(check, [](const SectionCheck& c) {
    std::string words = std::string("<") + name_of(c.verdict);
    if (!c.reason.empty()) words += ": " + c.reason;
    if (c.stop) words += " at pose " + std::to_string(c.stop->first_pose);
    return words + ">";
  });
  auto row = add_class<OutlineRowCheck>(module, "OutlineRowCheck",
                                        "The answer to one row of a table of outlines.");
  row.def_property_readonly(
      "outline", [](const OutlineRowCheck& r) { return text(r.file.string()); },
      "The file of the outline, as the table names it.");
  add_repr(row, [](const OutlineRowCheck& r) {
    return "<line " + std::to_string(r.line) + ": " + name_of(r.check.verdict) + ">";
  });
  auto gap = add_class<OutlineGap>(module, "OutlineGap",
                                   "A part of the path for which a table of outlines has none.");
  add_repr(gap, [](const OutlineGap& g) {
    return "<no outline from " + format_brief(g.chainage_from) + " to " +
           format_brief(g.chainage_to) + ">";
  });
  add_class<OutlineTableCheck, SectionCheck>(
      module, "OutlineTableCheck",
      "The answer to a table of outlines. Its places are those of all rows.");
}

void add_section_cells(py::module_& module) {
  py::class_<SectionCells>(
      module, "SectionCells",
      "Cells of a cross-section. Row i of each column is about the same cell, which holds y from j "
      "to j + 1 and z from k to k + 1 times the side of a cell.")
      .def_property_readonly(
          "bin",
          [](const SectionCells& c) {
            return c.bin.empty() ? std::nullopt : std::optional(to_array(c.bin));
          },
          "The number of the stretch: n uint32; None for the cells of the whole path, and where "
          "there are no cells.")
      .def_property_readonly(
          "j", member_array<&SectionCells::j, SectionCells>,
          "The column of the cell, 0 and more to the left of the middle: n int32.")
      .def_property_readonly("k", member_array<&SectionCells::k, SectionCells>,
                             "The row of the cell, 0 and more above z = 0: n int32.")
      .def_property_readonly("first_pose", member_array<&SectionCells::first_pose, SectionCells>,
                             "The first pose of the path at which the cell is taken: n uint32.")
      .def("__len__", &SectionCells::size);
  auto grid = add_class<SectionGrid>(
      module, "SectionGrid",
      "The whole cells of a window: columns j_from to j_to - 1 and rows k_from to k_to - 1.");
  add_repr(grid, [](const SectionGrid& g) {
    return py::str("<columns {} to {}, rows {} to {}>")
        .format(g.j_from, g.j_to - 1, g.k_from, g.k_to - 1);
  });
}

/// A part of what is known of one side of a band, where that side has a border.
template <std::optional<HalfWidth> SectionBand::*kSide, auto kPart>
auto part_of_side(const SectionBand& band) {
  const std::optional<HalfWidth>& side = band.*kSide;
  return side ? std::optional(std::invoke(kPart, *side)) : std::nullopt;
}

const char* end_of(const HalfWidth& side) { return side.is_blocked ? "blocked" : "not-known"; }

constexpr std::tuple kBandFacts{fact<&SectionBand::z_from>("Where the band begins, metres."),
                                fact<&SectionBand::z_to>("Where the band ends, metres.")};

constexpr std::tuple kStretchFacts{
    fact<&StretchOfPath::bin>("The number of the stretch."),
    fact<&StretchOfPath::chainage_from>("Where the stretch begins, metres along the path."),
    fact<&StretchOfPath::chainage_to>("Where the stretch ends, metres along the path."),
    fact<&StretchOfPath::bands>("Its widths: a list of SectionBand, upwards.")};

void add_section_widths(py::module_& module) {
  using Band = SectionBand;
  add_class<Band>(module, "SectionBand", "The room between two heights of the cross-section.",
                  kBandFacts)
      .def_property_readonly(
          "left", part_of_side<&Band::left, &HalfWidth::width>,
          "Metres from the middle, y = 0, to the border of the nearest cell on the left that is "
          "blocked or not known; None where nothing blocks that side of the window.")
      .def_property_readonly("left_pose", part_of_side<&Band::left, &HalfWidth::first_pose>,
                             "The first pose at which a cell there is blocked, or None.")
      .def_property_readonly(
          "left_end", part_of_side<&Band::left, &end_of>,
          "What the width on the left ends at: 'blocked' or 'not-known' cells, or None.")
      .def_property_readonly(
          "right", part_of_side<&Band::right, &HalfWidth::width>,
          "Metres from the middle to the border of the nearest such cell on the right, or None.")
      .def_property_readonly("right_pose", part_of_side<&Band::right, &HalfWidth::first_pose>,
                             "The first pose at which a cell there is blocked, or None.")
      .def_property_readonly("right_end", part_of_side<&Band::right, &end_of>,
                             "What the width on the right ends at, or None.");
  add_class<StretchOfPath>(module, "SectionStretch", "The widths of a stretch of the path.",
                           kStretchFacts);
}

/// For each cell of the window whether it is free, as an array of rows x columns.
py::array_t<bool> free_cells_of(const Section& section, const py::kwargs& given) {
  const auto margin = argument<std::optional<double>>(given, "margin");
  const std::vector<bool> free = without_gil([&] { return section.free_cells(margin); });
  const SectionGrid grid = section.grid();
  py::array_t<bool> array({static_cast<py::ssize_t>(grid.k_to) - grid.k_from,
                           static_cast<py::ssize_t>(grid.j_to) - grid.j_from});
  std::copy(free.begin(), free.end(), array.mutable_data());
  return array;
}

std::vector<StretchOfPath> stretches_of(const Section& section, const SectionHeights& heights) {
  const double bin = section.data().parameters.bin;
  std::vector<StretchOfPath> out;
  for (SectionStretch& stretch : section_stations(section, heights)) {
    out.push_back(
        {stretch.bin, stretch.bin * bin, (stretch.bin + 1.0) * bin, std::move(stretch.bands)});
  }
  return out;
}

constexpr std::tuple kSectionFacts{
    fact<&SectionData::parameters>("The question that the section answers: SectionParameters."),
    fact<&SectionData::environment_points>("How many points the environment has."),
    fact<&SectionData::ignored_points>("How many points of the environment were left out."),
    fact<&SectionData::ignored_cells>(
        "The cells that are free only because points were left out: SectionIgnoredCells, or None "
        "where nothing was to be left out."),
    fact<&SectionData::poses>("How many poses the path has."),
    fact<&SectionData::load_poses>(
        "At how many poses of the path the load has a place; on pivots it lacks some at the ends."),
    fact<&SectionData::rounding>(
        "Upper bound on the rounding of a place in the frame of the load, metres."),
    fact<&SectionData::motion>("How far the load moves along x, and across, from a pose to the "
                               "next: metres, or None where only poses count."),
    fact<&SectionData::warnings>("Warnings of find_section(): a list of Message."),
    fact<&SectionData::crs_wkt>(
        "The coordinate reference system of the environment as WKT, or ''."),
    fact<&SectionData::length_unit>(
        "The unit of all lengths: 'metre', 'foot', 'us-survey-foot', 'degree' or 'unknown'."),
    fact<&SectionData::bin_cells>(
        "The cells that are blocked in each stretch: SectionCells, ascending by bin, k and j."),
    fact<&SectionData::unknown>("The cells that are not known in each stretch: SectionCells, "
                                "ascending by bin, k and j, or None without seen space.",
                                "unknown_bin_cells")};

constexpr std::tuple kCellFacts{
    fact<&Section::grid>("Which cells the window has: SectionGrid."),
    fact<&Section::cells>(
        "The cells that are blocked anywhere on the path: SectionCells, ascending by k and j.")};

void add_section_facts(py::class_<Section>& section) {
  add_methods(
      section, [](const Section& s) -> const SectionData& { return s.data(); }, kSectionFacts);
  add_methods(section, std::identity(), kCellFacts);
  section
      .def_property_readonly(
          "path", [](const Section& s) { return to_python(s.path()); }, "The file: a pathlib.Path.")
      .def(
          "chainage", [](const Section& s) { return to_array(s.data().chainage); },
          "How far along the path each pose is: n float64, metres.")
      .def(
          "bins", [](const Section& s) { return to_array(s.data().bins); },
          "The numbers of the stretches in which the load has a pose: n uint32, ascending.")
      .def(
          "unknown_cells",
          [](const Section& s) {
            return s.data().unknown ? std::optional(s.unknown_cells()) : std::nullopt;
          },
          "The cells that no beam of the scanner crossed somewhere on the path, and that nothing "
          "blocks at that pose or before: SectionCells, or None without seen space.");
  add_repr(section, [](const Section& s) {
    return "<Section " + s.path().string() + ": " + std::to_string(s.cells().size()) +
           " blocked cells" + warning_words(s.data().warnings) + ">";
  });
}

OutlineTableCheck check_table(const Section& section, const py::kwargs& given) {
  OutlineOptions options;
  take<&OutlineOptions::mirror, &OutlineOptions::unit>(given, options);
  options.environment_unit = environment_unit_of(section.data().length_unit).metres;
  const auto margin = argument<std::optional<double>>(given, "margin");
  const auto stations = argument<std::vector<double>>(given, "station");
  return read_noting(given, [&, file = path_of(given["path"])](auto* noted) {
    return section.check(read_outline_table(file, options, noted), margin, stations);
  });
}

SectionHeights heights_of(const py::kwargs& given) {
  SectionHeights heights;
  take<&SectionHeights::band, &SectionHeights::base>(given, heights);
  return heights;
}

/// A method that makes a table of widths. make: the table of a section and its heights.
template <typename Make>
auto table_of(Make make) {
  return [make](const Section& section, const py::kwargs& given) {
    return without_gil([&, heights = heights_of(given)] { return make(section, heights); });
  };
}

void add_section_answers(py::class_<Section>& section) {
  section
      .def(
          "check",
          [](const Section& s, const py::kwargs& given) {
            const std::vector<OutlinePoint> corners = outline_of(given["outline"], "outline");
            const auto margin = argument<std::optional<double>>(given, "margin");
            return without_gil([&] { return s.check(corners, margin); });
          },
          R"(check(self, outline: Array, margin: From0 = None)
--

Say whether a load with this outline passes. Returns a SectionCheck.

outline: corners y, z of a simple polygon, n x 2, in the unit of the section; y is to the left, z up.
margin: the distance to keep on all sides; at most that of find_section(), which None stands for.)")
      .def(
          "check_table", &check_table,
          R"(check_table(self, path: Path, margin: From0 = None, *, mirror: Flag = False, unit: Unit = 0.0,
    station: Array = (), messages: Notes = None)
--

Judge each stretch of the path by its own outline. Returns an OutlineTableCheck.

path: a CSV file with the columns chainage_from,chainage_to (or station_from,station_to),outline and
    margin. Files of outlines are relative to it, and are read as read_outline() does.
margin: the distance to keep where a row has none; None: that of find_section().
mirror, unit: as read_outline() takes them, for all outlines; a unit of 0 is that of the section.
station: the station of each pose of the path, for a table by stations: PoseLabels.station.
messages: a list to which warnings of half an outline are appended.)")
      .def("free_cells", &free_cells_of, R"(free_cells(self, margin: From0 = None)
--

Say of each cell of the window whether it is free: an array of rows x columns of bool.

Element [k - grid.k_from, j - grid.j_from] is about the cell (j, k). All are False where the section
is in doubt, or where the margin is above that of find_section(). Cells that are not known are not
free.

margin: the distance to keep on all sides; None: that of find_section().)")
      .def("bands", table_of(&section_bands), R"(bands(self, band: From0 = 0.0, base: Number = None)
--

Say how wide the room is, height by height. Returns a list of SectionBand.

band: height of a band; 0: 0.1 m.
base: where the first band begins, in the window; None: 0, or the bottom of a window without z = 0.)")
      .def("boxes", table_of(&section_boxes), R"(boxes(self, band: From0 = 0.0, base: Number = None)
--

Say how wide a box may be that stands on the base, for each height. Returns a list of SectionBand.

band, base: as bands() takes them.)")
      .def("stations", table_of(&stretches_of),
           R"(stations(self, band: From0 = 0.0, base: Number = None)
--

Say how wide the room is in each stretch of the path. Returns a list of SectionStretch.

band, base: as bands() takes them.)")
      .def(
          "symmetric_width",
          [](const Section& s, const py::kwargs& given) {
            return symmetric_width(s.data(), argument<const SectionBand&>(given, "band"));
          },
          R"(symmetric_width(self, band: SectionBand)
--

Say how wide a load may be that is as wide to the left as to the right: metres, or None where the
window ends first on both sides. The rounding is taken off.

band: a SectionBand of this section.)");
}

SectionReport find_section(const py::kwargs& given) {
  SectionParameters asked;
  take<&SectionParameters::rear, &SectionParameters::front>(given, asked);
  set_fields(kSectionFields, given, asked);
  if (const auto window = argument<std::optional<std::array<double, 4>>>(given, "window")) {
    const auto& [y_from, y_to, z_from, z_to] = *window;
    asked.window = SectionWindow{y_from, y_to, z_from, z_to};
  }
  if (const auto pivots = argument<std::optional<std::array<double, 2>>>(given, "pivots")) {
    asked.pivots = BodyPivots{(*pivots)[0], (*pivots)[1]};
  }
  SectionOptions options;
  set_fields(kMachineFields<SectionOptions>, given, options);
  take<&SectionOptions::overwrite, &SectionOptions::strict, &SectionOptions::input_warnings>(
      given, options);
  const std::vector<Pose> path = poses_of(given);
  Watch watch(given, options);
  return watch.run([&, &store = argument<SharedStore&>(given, "store"),
                    to = path_of(given["output"])] {
    return in_turn(store, options.stop,
                   [&](const Store& own) { return find_section(own, path, asked, to, options); });
  });
}

/// Writes a file of a section without the GIL. write: gets the section, the file, the heights and
/// whether to overwrite.
template <typename Write>
void write_file_of(const py::kwargs& given, Write write) {
  without_gil([&, &section = argument<const Section&>(given, "section"),
               to = path_of(given["output"]), heights = heights_of(given),
               overwrite = argument<bool>(given, "overwrite")] {
    write(section, to, heights, overwrite);
    return true;
  });
}

void export_section(const py::kwargs& given) {
  write_file_of(given, [table = argument<SectionTable>(given, "table")](const Section& section,
                                                                        const auto&... arguments) {
    export_section(section, table, arguments...);
  });
}

void export_section_outline(const py::kwargs& given) {
  write_file_of(given, [](const Section& section, const auto&... arguments) {
    export_section_outline(section, arguments...);
  });
}

}  // namespace

void add_section(py::module_& module) {
  add_section_report(module);
  add_section_checks(module);
  add_section_cells(module);
  add_section_widths(module);
  py::class_<Section> section(
      module, "Section",
      "A section in a file of find_section(): which cells of the cross-section are blocked for a "
      "load of one length, from which pose on.");
  section.def(py::init([](const py::kwargs& given) {
                return without_gil(
                    [file = path_of(given["path"])] { return std::make_unique<Section>(file); });
              }),
              "__init__(self, path: Path)\n--\n\nRead a section, and check all of it.");
  add_section_facts(section);
  add_section_answers(section);
  module.def("find_section", &find_section,
             ("find_section(store: Store, poses: Array, output: Path, rear: Number, front: Number, "
              "*, window: Window = None, pivots: Pivots = None, " +
              signature_of(kSectionFields) + ", " + signature_of(kMachineFields<SectionOptions>) +
              R"DOC(, overwrite: Flag = False, strict: Flag = False, input_warnings: Messages = (),
    progress: Progress = None, message: Tell = None, stop: Stop = None)
--

Find which cells of the cross-section are blocked for a load of a given length along a path.

Writes the section's file `output` and returns a SectionReport. Open the file with Section, which
answers for every outline. Ctrl-C stops the search and raises KeyboardInterrupt. Lengths are in
metres, or in the unit of the scans where that is another one.

store: the Store to search.
poses: the poses of the path, n x 4 x 4 or n x 3 x 4.
output: the file of the section to write.
rear, front: where the load begins and ends along x in its own frame.
window: the part of the cross-section: y from and to, z from and to; None: -4, 4, 0, 6 m.
pivots: (front, rear), two places of the load that lie on the path; None: the load has its poses.
)DOC" + lines_of(kSectionFields) +
              lines_of(kMachineFields<SectionOptions>) +
              R"DOC(overwrite: replaces an existing section.
strict: treats warnings as errors: raises InputError, and writes nothing.
input_warnings: messages of read_trajectory(), which the section keeps, and which strict counts.
progress, message, stop: as search() takes them.)DOC")
                 .c_str());
  module.def("export_section", &export_section, R"(export_section(section: Section,
    table: OneOf('bands', 'stations', 'boxes', 'cells', 'bin-cells', 'unknown-cells', 'unknown-bin-cells'),
    output: Path, *, band: From0 = 0.0, base: Number = None, overwrite: Flag = False)
--

Write a table of a section as CSV, as clearway section export does.

section: the Section.
table: 'bands', 'stations', 'boxes', 'cells' or 'bin-cells'; with seen space also 'unknown-cells'
    or 'unknown-bin-cells'.
output: the file to write.
band: height of a band; 0: 0.1 m.
base: where the first band begins, in the window; None: 0, or the bottom of a window without z = 0.
overwrite: replaces an existing file.)");
  module.def(
      "export_section_outline", &export_section_outline,
      R"(export_section_outline(section: Section, output: Path, *, band: From0 = 0.0, base: Number = None,
    overwrite: Flag = False)
--

Write the outline of the largest load that stands on the base as a polyline in a DXF file.

The drawing looks forward: its x is to the right, which is -y of the load. Outlines for
Section.check() have y to the left.

section: the Section.
output: the file to write.
band, base, overwrite: as export_section() takes them.)");
}

}  // namespace clearway::python
