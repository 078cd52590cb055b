#include "clearway/section.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "clearway/outline.hpp"
#include "core/describe/section.hpp"
#include "core/section/section_tables.hpp"
#include "python/arrays.hpp"
#include "python/fields.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

constexpr Choice<SectionTable> kSectionTables[] = {
    {"bands", SectionTable::kBands},
    {"stations", SectionTable::kStations},
    {"boxes", SectionTable::kBoxes},
    {"cells", SectionTable::kCells},
    {"bin-cells", SectionTable::kBinCells},
    {"unknown-cells", SectionTable::kUnknownCells},
    {"unknown-bin-cells", SectionTable::kUnknownBinCells}};

/// Cells of a section that Python has.
struct CellColumns {
  SectionCells cells;
};

/// A table of widths of the whole path, or of a stretch.
struct StretchOfPath {
  std::uint32_t bin;
  double chainage_from, chainage_to;
  std::vector<SectionBand> bands;
};

template <typename Value>
py::object or_none(const std::optional<Value>& value) {
  return value ? py::cast(*value) : py::none();
}

void add_section_parameters(py::module_& module) {
  using Asked = SectionParameters;
  py::class_<Asked> parameters(
      module, "SectionParameters",
      "The question of find_section(), with the defaults filled in. Lengths are in metres, or in "
      "the unit of the scans where that is another one.");
  parameters.def_readonly("rear", &Asked::rear, "Where the load begins along x in its own frame.")
      .def_readonly("front", &Asked::front, "Where the load ends along x in its own frame.")
      .def_property_readonly(
          "window",
          [](const Asked& asked) {
            const SectionWindow w = asked.window.value_or(SectionWindow{});
            return py::make_tuple(w.y_from, w.y_to, w.z_from, w.z_to);
          },
          "The part of the cross-section that was looked at: y from and to, z from and to.")
      .def_property_readonly(
          "pivots",
          [](const Asked& asked) -> py::object {
            if (!asked.pivots) return py::none();
            return py::make_tuple(asked.pivots->front, asked.pivots->rear);
          },
          "The two places of the load that lie on the path, front and rear; None where the load "
          "has "
          "the poses of the path.")
      .def("__repr__", [](const Asked& asked) {
        return py::str("<SectionParameters: x from {} to {}, cells of {}, bins of {}, margin {}>")
            .format(asked.rear, asked.front, asked.cell, asked.bin, asked.margin);
      });
  add_read_only(parameters, kSectionFields);
}

void add_section_report(py::module_& module) {
  using Counts = SectionSeenCounts;
  py::class_<Counts>(module, "SectionSeenCounts",
                     "How many cells of a section no beam of the scanner crossed.")
      .def_readonly("cube", &Counts::cube, "The side of the cubes of space, metres.")
      .def_readonly("unknown", &Counts::unknown,
                    "How many cells are not known somewhere on the path, and not blocked before.")
      .def_readonly("unknown_in_bins", &Counts::unknown_in_bins,
                    "How many cells are not known in each stretch, added up.");
  using Ignored = SectionIgnoredCells;
  py::class_<Ignored>(module, "SectionIgnoredCells",
                      "Cells of a section that ignored points would block somewhere on the path, "
                      "and that no other point blocks.")
      .def_readonly("blocked", &Ignored::blocked, "How many such cells there are.")
      .def_readonly("high", &Ignored::high,
                    "How many of them begin more than 0.5 m above z = 0, where the wheels stand.")
      .def("__repr__", [](const Ignored& i) {
        return py::str("<{} cells, {} of them high>").format(i.blocked, i.high);
      });
  py::class_<SectionReport>(module, "SectionReport", "How find_section() found a section.")
      .def_readonly("blocked", &SectionReport::blocked,
                    "How many cells of the cross-section are blocked somewhere on the path.")
      .def_readonly("blocked_in_bins", &SectionReport::blocked_in_bins,
                    "How many cells are blocked in each stretch, added up.")
      .def_readonly("bins", &SectionReport::bins,
                    "How many stretches there are in which the load has a "
                    "pose.")
      .def_readonly("rounding", &SectionReport::rounding,
                    "Upper bound on the rounding of a place in the frame of the load, metres.")
      .def_readonly("motion", &SectionReport::motion,
                    "How far the load moves along x, and across, from a pose to the next, metres; "
                    "None unless between_poses was given.")
      .def_readonly("ignored_points", &SectionReport::ignored_points,
                    "How many points of the environment were left out.")
      .def_readonly("ignored_cells", &SectionReport::ignored_cells,
                    "The cells that are free only because points were left out: "
                    "SectionIgnoredCells, or None where nothing was to be left out.")
      .def_readonly(
          "seen", &SectionReport::seen,
          "How many cells are not known: SectionSeenCounts, or None unless seen was given.")
      .def_property_readonly(
          "warnings", [](const SectionReport& r) { return to_list(r.warnings); },
          "What the section may have misread: a list of Message.")
      .def_property_readonly(
          "device", [](const SectionReport& r) { return name_of(r.device); },
          "The device that searched: 'cpu' or 'cuda'.")
      .def_readonly("peak_device_bytes", &SectionReport::peak_device_bytes,
                    "How many bytes were taken on the GPU.")
      .def_readonly("needed_host_bytes", &SectionReport::needed_host_bytes,
                    "How many bytes of working memory the search took.")
      .def_readonly("seconds", &SectionReport::seconds, "Seconds of the whole call.")
      .def_readonly("search_seconds", &SectionReport::search_seconds,
                    "Seconds of searching the points.")
      .def("__repr__", [](const SectionReport& r) {
        return text("<" + std::to_string(r.blocked) + " cells are blocked, in " +
                    std::to_string(r.bins) + (r.bins == 1 ? " stretch" : " stretches") +
                    warning_words(r.warnings) + ">");
      });
}

void add_section_checks(py::module_& module) {
  using Stop = SectionStop;
  using Check = SectionCheck;
  py::class_<Stop>(module, "SectionStop", "A place that stops a load, or that is not known.")
      .def_readonly("bin", &Stop::bin, "The number of the stretch of the path.")
      .def_readonly("first_pose", &Stop::first_pose,
                    "The first pose of the stretch that stops the load.")
      .def_readonly("chainage", &Stop::chainage, "How far along the path that pose is, metres.")
      .def_property_readonly(
          "cell", [](const Stop& s) { return py::make_tuple(s.cell[0], s.cell[1]); },
          "The cell (j, k) that stops the load at that pose: the lowest one, and of several the "
          "one "
          "farthest to the right.")
      .def("__repr__", [](const Stop& s) {
        return py::str("<pose {} at {} m, cell ({}, {})>")
            .format(s.first_pose, s.chainage, s.cell[0], s.cell[1]);
      });
  py::class_<Check>(module, "SectionCheck", "Whether a load with an outline passes.")
      .def_property_readonly(
          "verdict", [](const Check& c) { return text(name_of(c.verdict)); },
          "'passes', 'stopped' or 'unknown'.")
      .def_property_readonly(
          "reason",
          [](const Check& c) -> py::object {
            return c.reason.empty() ? py::object(py::none()) : py::object(text(c.reason));
          },
          "Why the verdict is 'unknown', as a clause; otherwise None.")
      .def_property_readonly(
          "stop", [](const Check& c) { return or_none(c.stop); },
          "The first place where the load is stopped: a SectionStop, or None.")
      .def_readonly("stops", &Check::stops,
                    "The first place of each stretch that stops the load: a list of SectionStop "
                    "along the path.")
      .def_readonly(
          "unknowns", &Check::unknowns,
          "The first place of each stretch where the load needs a cell that no beam of the "
          "scanner crossed: a list of SectionStop, empty without seen space.")
      .def("__repr__", [](const Check& c) {
        std::string shown = std::string("<") + name_of(c.verdict);
        if (!c.reason.empty()) shown += ": " + c.reason;
        if (c.stop) shown += " at pose " + std::to_string(c.stop->first_pose);
        return text(shown + ">");
      });
}

void add_outline_tables(py::module_& module) {
  using Row = OutlineRowCheck;
  using Gap = OutlineGap;
  using Table = OutlineTableCheck;
  const auto bins = [](const SectionBinRange& range) {
    return py::make_tuple(range.first, range.last);
  };
  py::class_<Row>(module, "OutlineRowCheck", "The answer to one row of a table of outlines.")
      .def_readonly("line", &Row::line, "The line of the table that has the row.")
      .def_property_readonly(
          "outline", [](const Row& r) { return text(r.file.string()); },
          "The file of the outline, as the table names it.")
      .def_readonly("chainage_from", &Row::chainage_from, "Where the row begins, metres.")
      .def_readonly("chainage_to", &Row::chainage_to, "Where the row ends, metres.")
      .def_readonly("margin", &Row::margin, "The distance that was kept, metres.")
      .def_property_readonly(
          "bins", [bins](const Row& r) { return r.bins ? py::object(bins(*r.bins)) : py::none(); },
          "The first and the last stretch that were judged, or None where the load has no pose "
          "there.")
      .def_readonly("check", &Row::check, "The answer: a SectionCheck.")
      .def("__repr__", [](const Row& r) {
        return text("<line " + std::to_string(r.line) + ": " + name_of(r.check.verdict) + ">");
      });
  py::class_<Gap>(module, "OutlineGap",
                  "A part of the path for which a table of outlines has none.")
      .def_readonly("chainage_from", &Gap::chainage_from, "Where the gap begins, metres.")
      .def_readonly("chainage_to", &Gap::chainage_to, "Where the gap ends, metres.")
      .def_property_readonly(
          "bins", [bins](const Gap& g) { return bins(g.bins); },
          "The first and the last stretch that it touches, which are unknown.")
      .def("__repr__", [](const Gap& g) {
        return text("<no outline from " + format_brief(g.chainage_from) + " to " +
                    format_brief(g.chainage_to) + ">");
      });
  py::class_<Table, SectionCheck>(module, "OutlineTableCheck",
                                  "The answer to a table of outlines. Its places are those of all "
                                  "rows.")
      .def_readonly("rows", &Table::rows,
                    "The answer to each row, along the path: a list of OutlineRowCheck.")
      .def_readonly("gaps", &Table::gaps,
                    "Parts of the path without an outline: a list of OutlineGap.");
}

void add_section_cells(py::module_& module) {
  using Cells = CellColumns;
  py::class_<Cells>(module, "SectionCells",
                    "Cells of a cross-section. Row i of each column is about the same cell, which "
                    "holds y from j to j + 1 and z from k to k + 1 times the side of a cell.")
      .def_property_readonly(
          "bin",
          [](const Cells& c) {
            return c.cells.bin.empty() ? py::object(py::none()) : py::object(to_array(c.cells.bin));
          },
          "The number of the stretch: n uint32; None for the cells of the whole path, and where "
          "there are no cells.")
      .def_property_readonly(
          "j", [](const Cells& c) { return to_array(c.cells.j); },
          "The column of the cell, 0 and more to the left of the middle: n int32.")
      .def_property_readonly(
          "k", [](const Cells& c) { return to_array(c.cells.k); },
          "The row of the cell, 0 and more above z = 0: n int32.")
      .def_property_readonly(
          "first_pose", [](const Cells& c) { return to_array(c.cells.first_pose); },
          "The first pose of the path at which the cell is taken: n uint32.")
      .def("__len__", [](const Cells& c) { return c.cells.size(); });
  py::class_<SectionGrid>(module, "SectionGrid",
                          "The whole cells of a window: columns j_from to j_to - 1 and rows k_from "
                          "to k_to - 1.")
      .def_readonly("j_from", &SectionGrid::j_from, "The first column of the window.")
      .def_readonly("j_to", &SectionGrid::j_to, "One more than the last column of the window.")
      .def_readonly("k_from", &SectionGrid::k_from, "The first row of the window.")
      .def_readonly("k_to", &SectionGrid::k_to, "One more than the last row of the window.")
      .def("__repr__", [](const SectionGrid& g) {
        return py::str("<columns {} to {}, rows {} to {}>")
            .format(g.j_from, g.j_to - 1, g.k_from, g.k_to - 1);
      });
}

py::object end_of(const std::optional<HalfWidth>& half) {
  if (!half) return py::none();
  return py::str(half->is_blocked ? "blocked" : "not-known");
}

void add_section_widths(py::module_& module) {
  using Band = SectionBand;
  py::class_<Band>(module, "SectionBand", "The room between two heights of the cross-section.")
      .def_readonly("z_from", &Band::z_from, "Where the band begins, metres.")
      .def_readonly("z_to", &Band::z_to, "Where the band ends, metres.")
      .def_property_readonly(
          "left", [](const Band& b) { return b.left ? py::cast(b.left->width) : py::none(); },
          "Metres from the middle, y = 0, to the border of the nearest cell on the left that is "
          "blocked or not known; None where nothing blocks that side of the window.")
      .def_property_readonly(
          "left_pose",
          [](const Band& b) { return b.left ? py::cast(b.left->first_pose) : py::none(); },
          "The first pose at which a cell there is blocked, or None.")
      .def_property_readonly(
          "right", [](const Band& b) { return b.right ? py::cast(b.right->width) : py::none(); },
          "Metres from the middle to the border of the nearest such cell on the right, or None.")
      .def_property_readonly(
          "left_end", [](const Band& b) { return end_of(b.left); },
          "What the width on the left ends at: 'blocked' or 'not-known' cells, or None.")
      .def_property_readonly(
          "right_end", [](const Band& b) { return end_of(b.right); },
          "What the width on the right ends at, or None.")
      .def_property_readonly(
          "right_pose",
          [](const Band& b) { return b.right ? py::cast(b.right->first_pose) : py::none(); },
          "The first pose at which a cell there is blocked, or None.");
  using Stretch = StretchOfPath;
  py::class_<Stretch>(module, "SectionStretch", "The widths of a stretch of the path.")
      .def_readonly("bin", &Stretch::bin, "The number of the stretch.")
      .def_readonly("chainage_from", &Stretch::chainage_from,
                    "Where the stretch begins, metres along the path.")
      .def_readonly("chainage_to", &Stretch::chainage_to,
                    "Where the stretch ends, metres along the path.")
      .def_readonly("bands", &Stretch::bands, "Its widths: a list of SectionBand, upwards.");
}

/// For each cell of the window whether it is free, as an array of rows x columns.
py::array free_cells_of(const Section& section, std::optional<double> margin) {
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

void add_section_facts(py::class_<Section>& section) {
  section
      .def(
          "parameters", [](const Section& s) { return s.data().parameters; },
          "The question that the section answers: SectionParameters.")
      .def(
          "environment_points", [](const Section& s) { return s.data().environment_points; },
          "How many points the environment has.")
      .def(
          "ignored_points", [](const Section& s) { return s.data().ignored_points; },
          "How many points of the environment were left out.")
      .def(
          "ignored_cells", [](const Section& s) { return s.data().ignored_cells; },
          "The cells that are free only because points were left out: SectionIgnoredCells, or "
          "None where nothing was to be left out.")
      .def(
          "poses", [](const Section& s) { return s.data().poses; }, "How many poses the path has.")
      .def(
          "load_poses", [](const Section& s) { return s.data().load_poses; },
          "At how many poses of the path the load has a place; on pivots it lacks some at the "
          "ends.")
      .def(
          "rounding", [](const Section& s) { return s.data().rounding; },
          "Upper bound on the rounding of a place in the frame of the load, metres.")
      .def(
          "motion", [](const Section& s) { return s.data().motion; },
          "How far the load moves along x, and across, from a pose to the next: metres, or None "
          "where only poses count.")
      .def(
          "warnings", [](const Section& s) { return to_list(s.data().warnings); },
          "Warnings of find_section(): a list of Message.")
      .def(
          "crs_wkt", [](const Section& s) { return text(s.data().crs_wkt); },
          "The coordinate reference system of the environment as WKT, or ''.")
      .def(
          "length_unit", [](const Section& s) { return text(s.data().length_unit); },
          "The unit of all lengths: 'metre', 'foot', 'us-survey-foot', 'degree' or 'unknown'.")
      .def_property_readonly(
          "path", [](const Section& s) { return to_python(s.path()); }, "The file: a pathlib.Path.")
      .def(
          "chainage", [](const Section& s) { return to_array(s.data().chainage); },
          "How far along the path each pose is: n float64, metres.")
      .def(
          "bins", [](const Section& s) { return to_array(s.data().bins); },
          "The numbers of the stretches in which the load has a pose: n uint32, ascending.")
      .def(
          "grid", [](const Section& s) { return s.grid(); },
          "Which cells the window has: SectionGrid.");
}

void add_section_cells(py::class_<Section>& section) {
  section
      .def(
          "cells", [](const Section& s) { return CellColumns{s.cells()}; },
          "The cells that are blocked anywhere on the path: SectionCells, ascending by k and j.")
      .def(
          "bin_cells", [](const Section& s) { return CellColumns{s.data().bin_cells}; },
          "The cells that are blocked in each stretch: SectionCells, ascending by bin, k and j.")
      .def(
          "unknown_cells",
          [](const Section& s) -> py::object {
            if (!s.data().unknown) return py::none();
            return py::cast(CellColumns{s.unknown_cells()});
          },
          "The cells that no beam of the scanner crossed somewhere on the path, and that nothing "
          "blocks at that pose or before: SectionCells, or None without seen space.")
      .def(
          "unknown_bin_cells",
          [](const Section& s) -> py::object {
            if (!s.data().unknown) return py::none();
            return py::cast(CellColumns{*s.data().unknown});
          },
          "The cells that are not known in each stretch: SectionCells, ascending by bin, k and j, "
          "or None without seen space.");
}

void add_section_checks(py::class_<Section>& section) {
  section
      .def(
          "check",
          [](const Section& s, const py::object& outline, std::optional<double> margin) {
            const std::vector<OutlinePoint> corners = outline_of(outline, "outline");
            return without_gil([&] { return s.check(corners, margin); });
          },
          "outline"_a, "margin"_a = py::none(),
          R"(check(self, outline, margin=None)
--

Say whether a load with this outline passes. Returns a SectionCheck.

outline: corners y, z of a simple polygon, n x 2, in the unit of the section; y is to the left, z up.
margin: the distance to keep on all sides; at most that of find_section(), which None stands for.)")
      .def(
          "check_table",
          [](const Section& s, const py::object& path, std::optional<double> margin, bool mirror,
             const UnitArgument& unit, const py::object& station, const py::object& messages) {
            const std::string of_section = s.data().length_unit;
            const OutlineOptions options{
                .mirror = mirror,
                .unit = file_unit(unit),
                .environment_unit = environment_unit_of(UnitArgument(of_section)).metres};
            const auto stations = station.cast<std::vector<double>>();
            return read_noting(messages, [&, file = path_of(path)](auto* noted) {
              return s.check(read_outline_table(file, options, noted), margin, stations);
            });
          },
          "path"_a, "margin"_a = py::none(), py::kw_only(), "mirror"_a = false, "unit"_a = 0.0,
          "station"_a = py::tuple(), "messages"_a = py::none(),
          R"(check_table(self, path, margin=None, *, mirror=False, unit=0.0, station=(), messages=None)
--

Judge each stretch of the path by its own outline. Returns an OutlineTableCheck.

path: a CSV file with the columns chainage_from,chainage_to (or station_from,station_to),outline and
    margin. Files of outlines are relative to it, and are read as read_outline() does.
margin: the distance to keep where a row has none; None: that of find_section().
mirror, unit: as read_outline() takes them, for all outlines; a unit of 0 is that of the section.
station: the station of each pose of the path, for a table by stations: PoseLabels.station.
messages: a list to which warnings of half an outline are appended.)")
      .def("free_cells", &free_cells_of, "margin"_a = py::none(),
           R"(free_cells(self, margin=None)
--

Say of each cell of the window whether it is free: an array of rows x columns of bool.

Element [k - grid.k_from, j - grid.j_from] is about the cell (j, k). All are False where the section
is in doubt, or where the margin is above that of find_section(). Cells that are not known are not
free.

margin: the distance to keep on all sides; None: that of find_section().)");
}

void add_section_widths(py::class_<Section>& section) {
  section
      .def(
          "bands",
          [](const Section& s, double band, std::optional<double> base) {
            return without_gil([&] { return section_bands(s, {band, base}); });
          },
          "band"_a = 0.0, "base"_a = py::none(),
          R"(bands(self, band=0.0, base=None)
--

Say how wide the room is, height by height. Returns a list of SectionBand.

band: height of a band; 0: 0.1 m.
base: where the first band begins, in the window; None: 0, or the bottom of a window without z = 0.)")
      .def(
          "boxes",
          [](const Section& s, double band, std::optional<double> base) {
            return without_gil([&] { return section_boxes(s, {band, base}); });
          },
          "band"_a = 0.0, "base"_a = py::none(),
          R"(boxes(self, band=0.0, base=None)
--

Say how wide a box may be that stands on the base, for each height. Returns a list of SectionBand.

band, base: as bands() takes them.)")
      .def(
          "stations",
          [](const Section& s, double band, std::optional<double> base) {
            return without_gil([&] { return stretches_of(s, {band, base}); });
          },
          "band"_a = 0.0, "base"_a = py::none(),
          R"(stations(self, band=0.0, base=None)
--

Say how wide the room is in each stretch of the path. Returns a list of SectionStretch.

band, base: as bands() takes them.)")
      .def(
          "symmetric_width",
          [](const Section& s, const SectionBand& band) { return symmetric_width(s.data(), band); },
          "band"_a,
          R"(symmetric_width(self, band)
--

Say how wide a load may be that is as wide to the left as to the right: metres, or None where the
window ends first on both sides. The rounding is taken off.

band: a SectionBand of this section.)");
}

void add_section_class(py::module_& module) {
  py::class_<Section> section(
      module, "Section",
      "A section in a file of find_section(): which cells of the cross-section are blocked for a "
      "load of one length, from which pose on.");
  section.def(
      py::init([](const py::object& path) {
        return without_gil([file = path_of(path)] { return std::make_unique<Section>(file); });
      }),
      "path"_a, "__init__(self, path)\n--\n\nRead a section, and check all of it.");
  add_section_facts(section);
  add_section_cells(section);
  add_section_checks(section);
  add_section_widths(section);
  section.def("__repr__", [](const Section& s) {
    return text("<Section " + s.path().string() + ": " + std::to_string(s.cells().size()) +
                " blocked cells" + warning_words(s.data().warnings) + ">");
  });
}

void add_find_section(py::module_& module) {
  module.def(
      "find_section",
      [](SharedStore& store, const py::object& poses, const py::object& output, double rear,
         double front, std::optional<std::array<double, 4>> window,
         std::optional<std::array<double, 2>> pivots, bool overwrite, bool strict,
         const py::object& input_warnings, py::object progress, py::object message, py::object stop,
         const py::kwargs& given) {
        SectionParameters asked{.rear = rear, .front = front};
        set_fields(kSectionFields, given, asked);
        if (window) {
          const auto& [y_from, y_to, z_from, z_to] = *window;
          asked.window = SectionWindow{y_from, y_to, z_from, z_to};
        }
        if (pivots) asked.pivots = BodyPivots{(*pivots)[0], (*pivots)[1]};
        SectionOptions options;
        set_fields(kMachineFields<SectionOptions>, given, options);
        options.overwrite = overwrite;
        options.strict = strict;
        options.input_warnings = messages_of(input_warnings);
        const std::vector<Pose> path = poses_of(poses_array(poses, "poses"), "poses");
        Watch watch(std::move(progress), std::move(message), std::move(stop));
        watch.attach(options);
        return watch.run([&, to = path_of(output)] {
          return in_turn(store, options.stop, [&](const Store& own) {
            return find_section(own, path, asked, to, options);
          });
        });
      },
      "store"_a, "poses"_a, "output"_a, "rear"_a, "front"_a, py::kw_only(), "window"_a = py::none(),
      "pivots"_a = py::none(), "overwrite"_a = false, "strict"_a = false,
      "input_warnings"_a = py::tuple(), "progress"_a = py::none(), "message"_a = py::none(),
      "stop"_a = py::none(),
      ("find_section(store, poses, output, rear, front, *, window=None, pivots=None, " +
       signature_of(kSectionFields) + ", " + signature_of(kMachineFields<SectionOptions>) +
       R"DOC(, overwrite=False, strict=False, input_warnings=(), progress=None, message=None, stop=None)
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
  add_checks(module, "find_section", kSectionFields);
  add_checks(module, "find_section", kMachineFields<SectionOptions>);
}

void add_section_exports(py::module_& module) {
  module.def(
      "export_section",
      [](const Section& section, const std::string& table, const py::object& output, double band,
         std::optional<double> base, bool overwrite) {
        const SectionTable asked = value_of("table", kSectionTables, table);
        without_gil([&, to = path_of(output)] {
          export_section(section, asked, to, {band, base}, overwrite);
          return true;
        });
      },
      "section"_a, "table"_a, "output"_a, py::kw_only(), "band"_a = 0.0, "base"_a = py::none(),
      "overwrite"_a = false,
      R"(export_section(section, table, output, *, band=0.0, base=None, overwrite=False)
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
      "export_section_outline",
      [](const Section& section, const py::object& output, double band, std::optional<double> base,
         bool overwrite) {
        without_gil([&, to = path_of(output)] {
          export_section_outline(section, to, {band, base}, overwrite);
          return true;
        });
      },
      "section"_a, "output"_a, py::kw_only(), "band"_a = 0.0, "base"_a = py::none(),
      "overwrite"_a = false,
      R"(export_section_outline(section, output, *, band=0.0, base=None, overwrite=False)
--

Write the outline of the largest load that stands on the base as a polyline in a DXF file.

The drawing looks forward: its x is to the right, which is -y of the load. Outlines for
Section.check() have y to the left.

section: the Section.
output: the file to write.
band, base, overwrite: as export_section() takes them.)");
}

}  // namespace

void add_section(py::module_& module) {
  add_section_parameters(module);
  add_section_report(module);
  add_section_checks(module);
  add_outline_tables(module);
  add_section_cells(module);
  add_section_widths(module);
  add_section_class(module);
  add_find_section(module);
  add_section_exports(module);
}

}  // namespace clearway::python
