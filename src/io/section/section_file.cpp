#include "io/section/section_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <string>

#include "clearway/error.hpp"
#include "core/describe/section.hpp"
#include "core/section/section_lattice.hpp"
#include "core/section/section_map.hpp"
#include "io/files/header_values.hpp"
#include "io/files/input_error.hpp"
#include "io/files/table_file.hpp"

namespace clearway {

static void keep_facts(HeaderValues& values, SectionWindow& window) {
  values.add("y_from", window.y_from);
  values.add("y_to", window.y_to);
  values.add("z_from", window.z_from);
  values.add("z_to", window.z_to);
}

static void keep_facts(HeaderValues& values, BodyPivots& pivots) {
  values.add("front", pivots.front);
  values.add("rear", pivots.rear);
}

static void keep_facts(HeaderValues& values, SectionIgnoredCells& ignored) {
  values.add("blocked", ignored.blocked);
  values.add("high", ignored.high);
}

static void keep_facts(HeaderValues& values, SectionData& section) {
  SectionParameters& asked = section.parameters;
  values.add("rear", asked.rear);
  values.add("front", asked.front);
  values.add("window", values.reads() ? asked.window.emplace() : *asked.window);
  values.add_fields(kSectionFields, asked);
  values.add("pivots", asked.pivots);
  values.add("rounding", section.rounding);
  values.add("motion", section.motion);
  values.add("environment_points", section.environment_points);
  values.add("environment_hash", section.environment_hash);
  values.add("crs_wkt", section.crs_wkt);
  values.add("length_unit", section.length_unit);
  values.add("poses", section.poses);
  values.add("load_poses", section.load_poses);
  values.add("trajectory_hash", section.trajectory_hash);
  values.add("ignored_points", section.ignored_points);
  values.add("ignored_cells", section.ignored_cells);
  values.add("warnings", section.warnings);
}

namespace {

std::vector<TableColumn> cell_columns() {
  return {table_column<std::int32_t>("j"), table_column<std::int32_t>("k"),
          table_column<std::uint32_t>("first_pose")};
}

/// Cells side by side in a row that have one first pose: the first of them, and their number.
struct CellRuns {
  SectionCells first;
  std::vector<std::uint32_t> length;

  void add(const SectionCells& cells, std::size_t i) {
    if (!length.empty() && first.k.back() == cells.k[i] &&
        first.first_pose.back() == cells.first_pose[i] &&
        std::int64_t{first.j.back()} + length.back() == cells.j[i]) {
      ++length.back();
      return;
    }
    first.j.push_back(cells.j[i]);
    first.k.push_back(cells.k[i]);
    first.first_pose.push_back(cells.first_pose[i]);
    length.push_back(1);
  }
};

CellRuns runs_of(const SectionCells& cells) {
  CellRuns runs;
  for (std::size_t i = 0; i < cells.size(); ++i) runs.add(cells, i);
  return runs;
}

SectionCells cells_of_bin(const SectionRows& rows, std::size_t bin) {
  SectionCells cells;
  rows.add(bin, cells);
  return cells;
}

/// Writes cells that are not known as runs.
void write_unknown(TableFileWriter& file, const SectionRows& rows) {
  SectionRows runs;
  for (std::size_t bin = 0; bin < rows.counts.size(); ++bin) {
    runs.counts.push_back(runs_of(cells_of_bin(rows, bin)).length.size());
  }
  file.add_column("bins", "unknown", runs.counts);
  std::vector columns = cell_columns();
  columns.push_back(table_column<std::uint32_t>("length"));
  TableWriter& table = file.add_table("unknown", columns, runs.total());
  for (std::size_t bin = 0; bin < rows.counts.size(); ++bin) {
    const auto [cells, length] = runs_of(cells_of_bin(rows, bin));
    table.append_values(cells.j, cells.k, cells.first_pose, length);
  }
}

void require(bool holds, const std::string& name, const char* what) {
  if (!holds) refuse(name, std::string(what));
}

/// The lattice of a section that was read. Throws InputError where its facts cannot be right. Their
/// hash is, so only a file that was made on purpose comes here.
SectionLattice check_facts(const SectionData& section, const std::string& name) {
  SectionLattice lattice = [&] {
    try {
      return section_lattice(section.parameters,
                             section.motion.value_or(std::array<double, 2>{})[0]);
    } catch (const UsageError& error) {
      refuse(name, error.what());
    }
  }();
  require(std::isfinite(section.rounding) && section.rounding > 0, name,
          "the rounding is no number above 0");
  require(section.chainage.size() == section.poses && section.poses < kNotBlocked &&
              std::ranges::is_sorted(section.chainage) &&
              std::ranges::all_of(section.chainage, [](double s) { return std::isfinite(s); }),
          name, "the chainage is not that of the poses");
  const SectionParameters& asked = section.parameters;
  const bool ignores = !asked.ignore_classes.empty() || !asked.ignore_boxes.empty();
  require(asked.between_poses == section.motion.has_value() &&
              ignores == section.ignored_cells.has_value(),
          name, "what is known of its cells is not what was asked");
  const bool ways = asked.between_poses;
  require(
      (ways || section.bins.size() <= section.load_poses) &&
          std::ranges::adjacent_find(section.bins, std::greater_equal<>()) == section.bins.end(),
      name, "the bins are not ascending");
  require(!ways || section.bins.empty() ||
              section.bins.back() - section.bins.front() == section.bins.size() - 1,
          name, "the way of the load leaves out bins");
  return lattice;
}

/// Throws InputError where cells cannot be those of such a section.
void check_cells(const SectionData& section, const SectionLattice& lattice,
                 const SectionCells& cells, const std::vector<std::uint64_t>& counts,
                 const std::string& name) {
  require(counts.size() == section.bins.size(), name, "the bins have other cells than are counted");
  std::uint64_t total = 0;
  for (const std::uint64_t count : counts) {
    require(count <= cells.j.size() - total, name,
            "the bins have other cells than those in the file");
    total += count;
  }
  require(total == cells.j.size() && total == cells.k.size() && total == cells.first_pose.size(),
          name, "the columns of the cells have different lengths");
  for (std::size_t i = 0; i < total; ++i) {
    require(cells.j[i] >= lattice.j_from && cells.j[i] < lattice.j_to &&
                cells.k[i] >= lattice.k_from && cells.k[i] < lattice.k_to,
            name, "a cell is outside the window");
    require(cells.first_pose[i] < section.poses, name,
            "a cell is blocked at a pose that is not there");
  }
}

/// The bin of each cell, and the order of the cells in each bin.
void spread_bins(const SectionData& section, const std::vector<std::uint64_t>& counts,
                 const std::string& name, SectionCells& cells) {
  std::size_t at = 0;
  for (std::size_t bin = 0; bin < counts.size(); ++bin) {
    for (std::uint64_t i = 0; i < counts[bin]; ++i, ++at) {
      cells.bin.push_back(section.bins[bin]);
      if (i == 0) continue;
      if (cells.k[at] < cells.k[at - 1] ||
          (cells.k[at] == cells.k[at - 1] && cells.j[at] <= cells.j[at - 1])) {
        refuse(name, "the cells of a bin are not ascending");
      }
    }
  }
}

/// Reads the columns that blocked cells and runs have, without their bins.
SectionCells read_cells(const TableFile& file, const std::string& group) {
  SectionCells cells;
  cells.j = file.all<std::int32_t>(group + "/j");
  cells.k = file.all<std::int32_t>(group + "/k");
  cells.first_pose = file.all<std::uint32_t>(group + "/first_pose");
  return cells;
}

/// The cells of runs. counts: how many runs each bin has; becomes how many cells each has.
SectionCells cells_of_runs(const CellRuns& runs, const SectionLattice& lattice,
                           const std::string& name, std::vector<std::uint64_t>& counts) {
  constexpr std::uint64_t kMostCells = std::uint64_t{1} << 31;
  require(runs.length.size() == runs.first.size(), name,
          "the columns of the cells have different lengths");
  const std::uint64_t total =
      std::accumulate(runs.length.begin(), runs.length.end(), std::uint64_t{0});
  require(total <= kMostCells, name, "more than 2^31 cells are not known");
  SectionCells cells;
  cells.reserve(total);
  std::size_t run = 0;
  for (std::uint64_t& count : counts) {
    const std::size_t end = run + count;
    for (count = 0; run < end; ++run) {
      const std::uint32_t length = runs.length[run];
      require(length > 0 && static_cast<double>(runs.first.j[run]) + length <= lattice.j_to, name,
              "cells that are not known are outside the window");
      for (std::uint32_t i = 0; i < length; ++i) {
        cells.j.push_back(runs.first.j[run] + static_cast<std::int32_t>(i));
        cells.k.push_back(runs.first.k[run]);
        cells.first_pose.push_back(runs.first.first_pose[run]);
      }
      count += length;
    }
  }
  return cells;
}

}  // namespace

std::uint64_t SectionRows::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

void write_section(const SectionData& section, const SectionRows& blocked,
                   const std::optional<SectionRows>& unknown, const std::filesystem::path& path) {
  TableFileWriter file(path, kSectionKind);
  file.add_column("path", "chainage", section.chainage);
  file.add_column("bins", "number", section.bins);
  file.add_column("bins", "cells", blocked.counts);
  TableWriter& table = file.add_table("section", cell_columns(), blocked.total());
  for (std::size_t bin = 0; bin < blocked.counts.size(); ++bin) {
    const SectionCells cells = cells_of_bin(blocked, bin);
    table.append_values(cells.j, cells.k, cells.first_pose);
  }
  if (unknown) write_unknown(file, *unknown);
  file.finish(as_header(section));
}

SectionData read_section(const std::filesystem::path& path) {
  const TableFile file(path, kSectionKind);
  const std::string& name = file.name();
  SectionData section;
  HeaderValues values(file.header(), name);
  keep_facts(values, section);
  section.chainage = file.all<double>("path/chainage");
  section.bins = file.all<std::uint32_t>("bins/number");
  const auto counts = file.all<std::uint64_t>("bins/cells");
  section.bin_cells = read_cells(file, "section");
  const SectionLattice lattice = check_facts(section, name);
  check_cells(section, lattice, section.bin_cells, counts, name);
  spread_bins(section, counts, name, section.bin_cells);
  if (section.parameters.seen) {
    auto run_counts = file.all<std::uint64_t>("bins/unknown");
    const CellRuns runs{read_cells(file, "unknown"), file.all<std::uint32_t>("unknown/length")};
    check_cells(section, lattice, runs.first, run_counts, name);
    section.unknown = cells_of_runs(runs, lattice, name, run_counts);
    spread_bins(section, run_counts, name, *section.unknown);
  }
  return section;
}

}  // namespace clearway
