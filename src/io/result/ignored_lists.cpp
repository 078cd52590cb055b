#include "io/result/ignored_lists.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/query/ignored_points.hpp"
#include "io/result/column_hashes.hpp"
#include "io/result/result_names.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

namespace names = result_names;

std::vector<double> as_rows(const std::vector<Box>& boxes) {
  std::vector<double> rows;
  for (const Box& box : boxes) {
    rows.insert(rows.end(), {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  }
  return rows;
}

std::vector<Box> as_boxes(const std::vector<double>& rows) {
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < rows.size(); i += 6) {
    boxes.push_back({{rows[i], rows[i + 1], rows[i + 2]}, {rows[i + 3], rows[i + 4], rows[i + 5]}});
  }
  return boxes;
}

std::uint64_t hash_of(const ResultHeader& header) {
  ColumnHashes hashes;
  hashes.add(header.ignore_classes);
  hashes.add(header.ignored.of_classes);
  hashes.add(as_rows(header.ignore_boxes));
  hashes.add(header.ignored.in_boxes);
  return hashes.digest();
}

/// Whether a query may have this box: its corners are finite and in order.
bool is_box(const Box& box) {
  for (int k = 0; k < 3; ++k) {
    if (!(box.lo[k] <= box.hi[k]) || !std::isfinite(box.lo[k]) || !std::isfinite(box.hi[k])) {
      return false;
    }
  }
  return true;
}

void check_lists(const ResultHeader& header, const std::string& name) {
  QueryParameters sorted = header;
  sort_ignored(sorted);
  const bool boxes = std::all_of(header.ignore_boxes.begin(), header.ignore_boxes.end(), is_box);
  if (!header.ignores_points() || !boxes || sorted.ignore_classes != header.ignore_classes ||
      sorted.ignore_boxes != header.ignore_boxes) {
    refuse(name, "group 'ignored': expected classes and boxes in ascending order, one at least");
  }
  const std::uint64_t most = header.environment_points;
  const auto is_too_many = [most](std::uint64_t points) { return points > most; };
  const IgnoredPointCounts& counts = header.ignored;
  if (is_too_many(counts.points) ||
      std::any_of(counts.of_classes.begin(), counts.of_classes.end(), is_too_many) ||
      std::any_of(counts.in_boxes.begin(), counts.in_boxes.end(), is_too_many)) {
    refuse(name,
           "group 'ignored' counts more points than the environment has, " + std::to_string(most));
  }
}

}  // namespace

void write_ignored(const hdf5::Id& file, const ResultHeader& header) {
  const hdf5::Id group = hdf5::create_group(file, names::kIgnoredGroup);
  hdf5::write_dataset<std::uint8_t>(group, names::kClassesIgnored, header.ignore_classes);
  hdf5::write_dataset<std::uint64_t>(group, names::kClassPoints, header.ignored.of_classes);
  hdf5::write_dataset<double>(group, names::kBoxes, as_rows(header.ignore_boxes), 6);
  hdf5::write_dataset<std::uint64_t>(group, names::kBoxPoints, header.ignored.in_boxes);
  hdf5::write_number(file, names::kIgnoredPoints, header.ignored.points);
  hdf5::write_number(file, names::kIgnoredHash, hash_of(header));
  if (!header.ignore_classes.empty()) {
    hdf5::write_number(file, names::kClassesHash, header.classes_hash);
  }
}

void read_ignored(const hdf5::Id& file, const std::string& name, ResultHeader& header) {
  const hdf5::Id group = hdf5::open_group(file, names::kIgnoredGroup, name);
  const std::uint64_t classes = hdf5::dataset_rows(group, names::kClassesIgnored, name);
  const std::uint64_t boxes = hdf5::dataset_rows(group, names::kBoxes, name);
  header.ignore_classes =
      hdf5::read_dataset<std::uint8_t>(group, names::kClassesIgnored, classes, 0, name);
  header.ignored.of_classes =
      hdf5::read_dataset<std::uint64_t>(group, names::kClassPoints, classes, 0, name);
  header.ignore_boxes = as_boxes(hdf5::read_dataset<double>(group, names::kBoxes, boxes, 6, name));
  header.ignored.in_boxes =
      hdf5::read_dataset<std::uint64_t>(group, names::kBoxPoints, boxes, 0, name);
  header.ignored.points = hdf5::read_number<std::uint64_t>(file, names::kIgnoredPoints, name);
  if (hash_of(header) != hdf5::read_number<std::uint64_t>(file, names::kIgnoredHash, name)) {
    refuse(name, "group 'ignored' is damaged (its hash is not the one recorded)");
  }
  check_lists(header, name);
  if (!header.ignore_classes.empty()) {
    header.classes_hash = hdf5::read_number<std::uint64_t>(file, names::kClassesHash, name);
  }
}

}  // namespace clearway
