#include "io/section/section_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <string>

#include "clearway/error.hpp"
#include "core/section/section_lattice.hpp"
#include "core/section/section_map.hpp"
#include "io/files/file.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/input_error.hpp"
#include "io/files/kept_warnings.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

namespace names {
constexpr const char* kFormat = "clearway section";
constexpr std::uint32_t kVersion = 3;

constexpr const char* kCells = "section";  // the group by which the file is recognised
constexpr const char* kJ = "j";
constexpr const char* kK = "k";
constexpr const char* kFirstPose = "first_pose";
constexpr const char* kLength = "length";
constexpr const char* kBins = "bins";
constexpr const char* kNumber = "number";
constexpr const char* kCount = "cells";
constexpr const char* kUnknown = "unknown";  // a group, and how many of its cells each bin has
constexpr const char* kSeenCube = "seen_cube";
constexpr const char* kPath = "path";
constexpr const char* kChainage = "chainage";
constexpr const char* kIgnored = "ignored";
constexpr const char* kClasses = "classes";
constexpr const char* kBoxes = "boxes";
constexpr const char* kBlockedByIgnored = "blocked_cells";
constexpr const char* kHighOfIgnored = "high_cells";
}  // namespace names

/// The numbers of a section's header, in the order of the attribute "numbers".
std::vector<double> numbers_of(const SectionFacts& facts) {
  const SectionParameters& asked = facts.parameters;
  const SectionWindow& w = *asked.window;
  const auto motion = facts.motion.value_or(std::array<double, 2>{});
  const BodyPivots pivots = asked.pivots.value_or(BodyPivots{});
  return {asked.rear,  asked.front,    w.y_from,  w.y_to,       w.z_from,
          w.z_to,      asked.cell,     asked.bin, asked.margin, pivots.front,
          pivots.rear, facts.rounding, motion[0], motion[1]};
}

/// The counts of a section's header, in the order of the attribute "counts".
std::vector<std::uint64_t> counts_of(const SectionData& section) {
  return {section.environment_points,
          section.ignored_points,
          section.poses,
          section.load_poses,
          section.environment_hash,
          section.trajectory_hash,
          std::uint64_t{section.parameters.between_poses},
          std::uint64_t{section.parameters.pivots.has_value()}};
}

constexpr std::size_t kNumbers = 14, kCounts = 8;

std::vector<double> rows_of(const std::vector<Box>& boxes) {
  std::vector<double> rows;
  for (const Box& box : boxes) {
    rows.insert(rows.end(), {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  }
  return rows;
}

template <typename Column>
std::uint64_t hash_of_column(const Column& column) {
  return xxh64(std::as_bytes(std::span(column)));
}

std::uint64_t sum_of(const std::vector<std::uint64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

/// How many rows each bin has, and the hashes of their columns in the order of the file.
struct CellSums {
  std::vector<std::uint64_t> counts;
  std::vector<std::uint64_t> hashes;
};

std::uint64_t hash_of(const SectionData& section, const CellSums& blocked,
                      const std::optional<CellSums>& unknown) {
  ColumnHashes hashes;
  hashes.add(numbers_of(section));
  hashes.add(counts_of(section));
  hashes.add(section.parameters.ignore_classes);
  hashes.add(rows_of(section.parameters.ignore_boxes));
  hashes.add(section.chainage);
  hashes.add(section.bins);
  const auto add = [&hashes](const CellSums& cells) {
    hashes.add(cells.counts);
    for (const std::uint64_t column : cells.hashes) hashes.add_digest(column);
  };
  add(blocked);
  if (section.ignored_cells) {
    hashes.add(std::vector{section.ignored_cells->blocked, section.ignored_cells->high});
  }
  if (unknown) {
    hashes.add(std::vector<double>{section.parameters.seen_cube});
    add(*unknown);
  }
  return hashes.digest();
}

template <typename Number>
void write_column(const hdf5::Id& group, const char* name, const std::vector<Number>& values,
                  std::uint64_t columns = 0) {
  hdf5::write_dataset(group, name, std::span<const Number>(values), columns);
}

/// Writes a column of cells in whole chunks, and returns its hash. of_bin: the column's numbers of
/// a bin.
template <typename Number, typename OfBin>
std::uint64_t write_cells(const hdf5::Id& group, const char* name,
                          const std::vector<std::uint64_t>& counts, OfBin of_bin) {
  hdf5::Rows<Number> dataset(group, name, sum_of(counts), 0);
  const std::uint64_t chunk = dataset.chunk_rows();
  Xxh64Stream hash;
  std::vector<Number> pending;
  std::uint64_t written = 0;
  const auto write = [&] {
    dataset.write(written, pending);
    hash.update(std::as_bytes(std::span<const Number>(pending)));
    written += pending.size();
    pending.clear();
  };
  for (std::size_t bin = 0; bin < counts.size(); ++bin) {
    const std::vector<Number> numbers = of_bin(bin);
    for (std::size_t at = 0; at < numbers.size();) {
      const auto taken = static_cast<std::size_t>(
          std::min<std::uint64_t>(numbers.size() - at, chunk - pending.size()));
      const auto from = numbers.begin() + static_cast<std::ptrdiff_t>(at);
      pending.insert(pending.end(), from, from + static_cast<std::ptrdiff_t>(taken));
      at += taken;
      if (pending.size() == chunk) write();
    }
  }
  write();
  dataset.close();
  return hash.digest();
}

CellSums write_cells(const hdf5::Id& file, const SectionRows& rows) {
  const hdf5::Id group = hdf5::create_group(file, names::kCells);
  const auto write = [&]<typename Number>(const char* name,
                                          std::vector<Number> SectionCells::*column) {
    return write_cells<Number>(group, name, rows.counts, [&](std::size_t bin) {
      SectionCells cells;
      rows.add(bin, cells);
      return std::move(cells.*column);
    });
  };
  return {rows.counts,
          {write(names::kJ, &SectionCells::j), write(names::kK, &SectionCells::k),
           write(names::kFirstPose, &SectionCells::first_pose)}};
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

CellRuns runs_of(const SectionRows& rows, std::size_t bin) {
  SectionCells cells;
  rows.add(bin, cells);
  CellRuns runs;
  for (std::size_t i = 0; i < cells.size(); ++i) runs.add(cells, i);
  return runs;
}

std::vector<std::uint64_t> count_runs(const SectionRows& rows) {
  std::vector<std::uint64_t> counts;
  for (std::size_t bin = 0; bin < rows.counts.size(); ++bin) {
    counts.push_back(runs_of(rows, bin).length.size());
  }
  return counts;
}

/// Writes cells that are not known as runs.
CellSums write_runs(const hdf5::Id& file, const SectionRows& rows,
                    const std::vector<std::uint64_t>& counts) {
  const hdf5::Id group = hdf5::create_group(file, names::kUnknown);
  const auto write = [&]<typename Number>(const char* name,
                                          std::vector<Number> SectionCells::*column) {
    return write_cells<Number>(group, name, counts, [&](std::size_t bin) {
      return std::move(runs_of(rows, bin).first.*column);
    });
  };
  return {counts,
          {write(names::kJ, &SectionCells::j), write(names::kK, &SectionCells::k),
           write(names::kFirstPose, &SectionCells::first_pose),
           write_cells<std::uint32_t>(group, names::kLength, counts, [&](std::size_t bin) {
             return std::move(runs_of(rows, bin).length);
           })}};
}

template <typename Number>
std::vector<Number> read_column(const hdf5::Id& group, const char* name, const std::string& file,
                                std::uint64_t columns = 0) {
  return hdf5::read_dataset<Number>(group, name, hdf5::dataset_rows(group, name, file), columns,
                                    file);
}

void read_header(const hdf5::Id& file, const std::string& name, SectionData& section) {
  const auto numbers = hdf5::read_attribute<double>(file, "numbers", kNumbers, name);
  const auto counts = hdf5::read_attribute<std::uint64_t>(file, "counts", kCounts, name);
  SectionParameters& asked = section.parameters;
  asked.rear = numbers[0];
  asked.front = numbers[1];
  asked.window = SectionWindow{numbers[2], numbers[3], numbers[4], numbers[5]};
  asked.cell = numbers[6];
  asked.bin = numbers[7];
  asked.margin = numbers[8];
  section.rounding = numbers[11];
  section.environment_points = counts[0];
  section.ignored_points = counts[1];
  section.poses = counts[2];
  section.load_poses = counts[3];
  section.environment_hash = counts[4];
  section.trajectory_hash = counts[5];
  asked.between_poses = counts[6] == 1;
  if (counts[6] == 1) section.motion = {numbers[12], numbers[13]};
  if (counts[7] == 1) asked.pivots = BodyPivots{numbers[9], numbers[10]};
  section.crs_wkt = hdf5::read_text_attribute(file, "crs_wkt", name);
  section.length_unit = hdf5::read_text_attribute(file, "length_unit", name);
  const hdf5::Id ignored = hdf5::open_group(file, names::kIgnored, name);
  asked.ignore_classes = read_column<std::uint8_t>(ignored, names::kClasses, name);
  const auto rows = read_column<double>(ignored, names::kBoxes, name, 6);
  for (std::size_t i = 0; i < rows.size(); i += 6) {
    asked.ignore_boxes.push_back(
        {{rows[i], rows[i + 1], rows[i + 2]}, {rows[i + 3], rows[i + 4], rows[i + 5]}});
  }
  if (asked.ignore_classes.empty() && asked.ignore_boxes.empty()) return;
  section.ignored_cells = {
      hdf5::read_number<std::uint64_t>(ignored, names::kBlockedByIgnored, name),
      hdf5::read_number<std::uint64_t>(ignored, names::kHighOfIgnored, name)};
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
  const bool ways = section.parameters.between_poses;
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

/// Reads the columns that blocked cells and runs have, without their bins. of_counts: the dataset
/// that says how many rows each bin has.
CellSums read_cells(const hdf5::Id& file, const char* group_name, const char* of_counts,
                    const std::string& name, SectionCells& cells) {
  const hdf5::Id group = hdf5::open_group(file, group_name, name);
  cells.j = read_column<std::int32_t>(group, names::kJ, name);
  cells.k = read_column<std::int32_t>(group, names::kK, name);
  cells.first_pose = read_column<std::uint32_t>(group, names::kFirstPose, name);
  return {read_column<std::uint64_t>(hdf5::open_group(file, names::kBins, name), of_counts, name),
          {hash_of_column(cells.j), hash_of_column(cells.k), hash_of_column(cells.first_pose)}};
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

std::uint64_t SectionRows::total() const { return sum_of(counts); }

void write_section(const SectionData& section, const SectionRows& blocked,
                   const std::optional<SectionRows>& unknown, const std::filesystem::path& path) {
  std::vector<std::uint64_t> runs;
  if (unknown) runs = count_runs(*unknown);
  hdf5::naming(path.string(), [&] {
    hdf5::Id file = hdf5::create_file(path);
    hdf5::write_attribute(file, "format", names::kFormat);
    hdf5::write_number(file, "version", names::kVersion);
    hdf5::write_attribute<double>(file, "numbers", numbers_of(section));
    hdf5::write_attribute<std::uint64_t>(file, "counts", counts_of(section));
    hdf5::write_attribute(file, "crs_wkt", section.crs_wkt);
    hdf5::write_attribute(file, "length_unit", section.length_unit);
    {
      const hdf5::Id ignored = hdf5::create_group(file, names::kIgnored);
      write_column(ignored, names::kClasses, section.parameters.ignore_classes);
      write_column(ignored, names::kBoxes, rows_of(section.parameters.ignore_boxes), 6);
      if (section.ignored_cells) {
        hdf5::write_number(ignored, names::kBlockedByIgnored, section.ignored_cells->blocked);
        hdf5::write_number(ignored, names::kHighOfIgnored, section.ignored_cells->high);
      }
      write_column(hdf5::create_group(file, names::kPath), names::kChainage, section.chainage);
      const hdf5::Id bins = hdf5::create_group(file, names::kBins);
      write_column(bins, names::kNumber, section.bins);
      write_column(bins, names::kCount, blocked.counts);
      if (unknown) write_column(bins, names::kUnknown, runs);
    }
    const CellSums cells = write_cells(file, blocked);
    std::optional<CellSums> others;
    if (unknown) {
      hdf5::write_number(file, names::kSeenCube, section.parameters.seen_cube);
      others = write_runs(file, *unknown, runs);
    }
    write_warnings(file, section.warnings);
    hdf5::write_number(file, "section_hash", hash_of(section, cells, others));
    hdf5::write_number(file, "complete", std::uint8_t{1});
    hdf5::check(H5Fflush(file.get(), H5F_SCOPE_LOCAL), "write the section");
    file.close("close the section");
  });
}

SectionData read_section(const std::filesystem::path& path) {
  const std::string name = path.string();
  return hdf5::naming(name, [&] {
    const hdf5::Id file = hdf5::open_file(path);
    if (!hdf5::has_attribute(file, "format", name) ||
        hdf5::read_text_attribute(file, "format", name) != names::kFormat) {
      refuse(name, "is not a section; expected a file of clearway section find");
    }
    const auto version = hdf5::read_number<std::uint32_t>(file, "version", name);
    if (version != names::kVersion) {
      refuse(name, "is a section of version " + std::to_string(version) +
                       " of another release; run section find again");
    }
    if (!hdf5::has_attribute(file, "complete", name)) {
      refuse(name, "not complete: the command that wrote it was interrupted");
    }
    SectionData section;
    read_header(file, name, section);
    section.chainage =
        read_column<double>(hdf5::open_group(file, names::kPath, name), names::kChainage, name);
    const hdf5::Id bins = hdf5::open_group(file, names::kBins, name);
    section.bins = read_column<std::uint32_t>(bins, names::kNumber, name);
    const CellSums blocked =
        read_cells(file, names::kCells, names::kCount, name, section.bin_cells);
    std::optional<CellSums> unknown;
    CellRuns runs;
    section.parameters.seen = hdf5::has_attribute(file, names::kSeenCube, name);
    if (section.parameters.seen) {
      section.parameters.seen_cube = hdf5::read_number<double>(file, names::kSeenCube, name);
      unknown = read_cells(file, names::kUnknown, names::kUnknown, name, runs.first);
      runs.length = read_column<std::uint32_t>(hdf5::open_group(file, names::kUnknown, name),
                                               names::kLength, name);
      unknown->hashes.push_back(hash_of_column(runs.length));
    }
    section.warnings = read_warnings(file, name);
    if (hash_of(section, blocked, unknown) !=
        hdf5::read_number<std::uint64_t>(file, "section_hash", name)) {
      refuse(name, "its cells are damaged (their hash is not the one recorded)");
    }
    const SectionLattice lattice = check_facts(section, name);
    check_cells(section, lattice, section.bin_cells, blocked.counts, name);
    spread_bins(section, blocked.counts, name, section.bin_cells);
    if (unknown) {
      check_cells(section, lattice, runs.first, unknown->counts, name);
      section.unknown = cells_of_runs(runs, lattice, name, unknown->counts);
      spread_bins(section, unknown->counts, name, *section.unknown);
    }
    return section;
  });
}

}  // namespace clearway
