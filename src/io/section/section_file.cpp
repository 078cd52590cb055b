#include "io/section/section_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
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
constexpr std::uint32_t kVersion = 1;

constexpr const char* kCells = "section";  // the group by which the file is recognised
constexpr const char* kJ = "j";
constexpr const char* kK = "k";
constexpr const char* kFirstPose = "first_pose";
constexpr const char* kBins = "bins";
constexpr const char* kNumber = "number";
constexpr const char* kCount = "cells";
constexpr const char* kPath = "path";
constexpr const char* kChainage = "chainage";
constexpr const char* kIgnored = "ignored";
constexpr const char* kClasses = "classes";
constexpr const char* kBoxes = "boxes";
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

/// The hash of each column of cells, in their order in the file.
using CellHashes = std::array<std::uint64_t, 3>;

CellHashes hashes_of(const SectionCells& cells) {
  const auto hash = [](const auto& column) { return xxh64(std::as_bytes(std::span(column))); };
  return {hash(cells.j), hash(cells.k), hash(cells.first_pose)};
}

std::uint64_t hash_of(const SectionData& section, const std::vector<std::uint64_t>& counts,
                      const CellHashes& cells) {
  ColumnHashes hashes;
  hashes.add(numbers_of(section));
  hashes.add(counts_of(section));
  hashes.add(section.parameters.ignore_classes);
  hashes.add(rows_of(section.parameters.ignore_boxes));
  hashes.add(section.chainage);
  hashes.add(section.bins);
  hashes.add(counts);
  for (const std::uint64_t column : cells) hashes.add_digest(column);
  return hashes.digest();
}

template <typename Number>
void write_column(const hdf5::Id& group, const char* name, const std::vector<Number>& values,
                  std::uint64_t columns = 0) {
  hdf5::write_dataset(group, name, std::span<const Number>(values), columns);
}

/// Writes a column of cells in whole chunks, and returns its hash.
template <typename Number>
std::uint64_t write_cells(const hdf5::Id& group, const char* name, const SectionRows& rows,
                          std::vector<Number> SectionCells::*column) {
  hdf5::Rows<Number> dataset(group, name, rows.total(), 0);
  const std::uint64_t chunk = dataset.chunk_rows();
  Xxh64Stream hash;
  SectionCells cells;
  std::vector<Number> pending;
  std::uint64_t written = 0;
  const auto write = [&](std::span<const Number> values) {
    dataset.write(written, values);
    hash.update(std::as_bytes(values));
    written += values.size();
  };
  for (std::size_t bin = 0; bin < rows.counts.size(); ++bin) {
    cells = {};
    rows.add(bin, cells);
    std::span<const Number> left(cells.*column);
    while (!left.empty()) {
      const auto taken =
          static_cast<std::size_t>(std::min<std::uint64_t>(left.size(), chunk - pending.size()));
      pending.insert(pending.end(), left.begin(),
                     left.begin() + static_cast<std::ptrdiff_t>(taken));
      left = left.subspan(taken);
      if (pending.size() < chunk) continue;
      write(pending);
      pending.clear();
    }
  }
  write(pending);
  dataset.close();
  return hash.digest();
}

CellHashes write_cells(const hdf5::Id& file, const char* name, const SectionRows& rows) {
  const hdf5::Id group = hdf5::create_group(file, name);
  return {write_cells(group, names::kJ, rows, &SectionCells::j),
          write_cells(group, names::kK, rows, &SectionCells::k),
          write_cells(group, names::kFirstPose, rows, &SectionCells::first_pose)};
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
}

/// Throws InputError where the cells cannot be those of such a section. The hash is right, so only
/// a file that was made on purpose comes here.
void check_cells(const SectionData& section, const std::vector<std::uint64_t>& counts,
                 const std::string& name) {
  const auto require = [&name](bool holds, const char* what) {
    if (!holds) refuse(name, std::string(what));
  };
  const SectionLattice lattice = [&] {
    try {
      return section_lattice(section.parameters,
                             section.motion.value_or(std::array<double, 2>{})[0]);
    } catch (const UsageError& error) {
      refuse(name, error.what());
    }
  }();
  require(std::isfinite(section.rounding) && section.rounding > 0,
          "the rounding is no number above 0");
  require(section.chainage.size() == section.poses && section.poses < kNotBlocked &&
              std::ranges::is_sorted(section.chainage) &&
              std::ranges::all_of(section.chainage, [](double s) { return std::isfinite(s); }),
          "the chainage is not that of the poses");
  require(
      section.bins.size() == counts.size() && section.bins.size() <= section.load_poses &&
          std::ranges::adjacent_find(section.bins, std::greater_equal<>()) == section.bins.end(),
      "the bins are not ascending");
  const SectionCells& cells = section.bin_cells;
  std::uint64_t total = 0;
  for (const std::uint64_t count : counts) {
    require(count <= cells.j.size() - total, "the bins have other cells than those in the file");
    total += count;
  }
  require(total == cells.j.size() && total == cells.k.size() && total == cells.first_pose.size(),
          "the columns of the cells have different lengths");
  for (std::size_t i = 0; i < total; ++i) {
    require(cells.j[i] >= lattice.j_from && cells.j[i] < lattice.j_to &&
                cells.k[i] >= lattice.k_from && cells.k[i] < lattice.k_to,
            "a cell is outside the window");
    require(cells.first_pose[i] < section.poses, "a cell is blocked at a pose that is not there");
  }
}

/// The bin of each cell, and the order of the cells in each bin.
void spread_bins(SectionData& section, const std::vector<std::uint64_t>& counts,
                 const std::string& name) {
  SectionCells& cells = section.bin_cells;
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

}  // namespace

std::uint64_t SectionRows::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

void write_section(const SectionData& section, const SectionRows& blocked,
                   const std::filesystem::path& path) {
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
      write_column(hdf5::create_group(file, names::kPath), names::kChainage, section.chainage);
      const hdf5::Id bins = hdf5::create_group(file, names::kBins);
      write_column(bins, names::kNumber, section.bins);
      write_column(bins, names::kCount, blocked.counts);
    }
    const CellHashes hashes = write_cells(file, names::kCells, blocked);
    write_warnings(file, section.warnings);
    hdf5::write_number(file, "section_hash", hash_of(section, blocked.counts, hashes));
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
      refuse(name, "is a section of version " + std::to_string(version) + "; expected version " +
                       std::to_string(names::kVersion));
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
    const auto counts = read_column<std::uint64_t>(bins, names::kCount, name);
    const hdf5::Id cells = hdf5::open_group(file, names::kCells, name);
    section.bin_cells.j = read_column<std::int32_t>(cells, names::kJ, name);
    section.bin_cells.k = read_column<std::int32_t>(cells, names::kK, name);
    section.bin_cells.first_pose = read_column<std::uint32_t>(cells, names::kFirstPose, name);
    section.warnings = read_warnings(file, name);
    if (hash_of(section, counts, hashes_of(section.bin_cells)) !=
        hdf5::read_number<std::uint64_t>(file, "section_hash", name)) {
      refuse(name, "its cells are damaged (their hash is not the one recorded)");
    }
    check_cells(section, counts, name);
    spread_bins(section, counts, name);
    return section;
  });
}

}  // namespace clearway
