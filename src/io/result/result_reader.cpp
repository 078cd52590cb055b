#include <cmath>
#include <optional>
#include <stdexcept>

#include "clearway/error.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/result.hpp"
#include "io/result/result_names.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

namespace names = result_names;

/// What HDF5 cannot do with a file that could be opened is taken for damaged content, unless a
/// system call failed.
template <typename Call>
auto as_input(const std::string& name, Call call) {
  const hdf5::QuietScope quiet;
  try {
    return call();
  } catch (const hdf5::Failure& error) {
    throw InputError(name + ": damaged: " + error.what());
  }
}

void check_format(const hdf5::Id& file, const std::string& name) {
  if (!hdf5::has_attribute(file, "format", name) ||
      hdf5::read_text_attribute(file, "format", name) != names::kFormat) {
    throw InputError(name + ": attribute 'format': expected \"" + names::kFormat +
                     "\"; this HDF5 file is not a result of clearway run");
  }
  const auto version = hdf5::read_number<std::uint32_t>(file, "version", name);
  if (version != names::kVersion) {
    throw InputError(name + ": attribute 'version' is " + std::to_string(version) + ", expected " +
                     std::to_string(names::kVersion) + "; another release of clearway wrote it");
  }
  if (!hdf5::has_attribute(file, "complete", name) ||
      hdf5::read_number<std::uint8_t>(file, "complete", name) != 1) {
    throw InputError(name + ": not complete: the run that wrote it was interrupted");
  }
}

void read_axes(const hdf5::Id& file, const std::string& attribute, const std::string& name,
               double (&out)[3]) {
  const auto values = hdf5::read_attribute<double>(file, attribute, 3, name);
  for (int k = 0; k < 3; ++k) out[k] = values[k];
}

void check_tolerance(const ResultHeader& header, const std::string& name) {
  if (header.tolerance > 0 && header.tolerance < header.radius) return;
  throw InputError(name + ": attribute 'tolerance' is " + std::to_string(header.tolerance) +
                   ", expected a length above 0 and below the radius");
}

/// Whether the file has the attribute, which has only this one value.
bool has_value(const hdf5::Id& file, const char* attribute, const char* value,
               const std::string& name) {
  if (!hdf5::has_attribute(file, attribute, name)) return false;
  const std::string found = hdf5::read_text_attribute(file, attribute, name);
  if (found == value) return true;
  refuse(name,
         std::string("attribute '") + attribute + "' is " + excerpt(found) + ", expected " + value);
}

ResultHeader read_header(const hdf5::Id& file, const std::string& name) {
  check_format(file, name);
  ResultHeader header;
  header.environment_points = hdf5::read_number<std::uint64_t>(file, "environment_points", name);
  header.environment_hash = hdf5::read_number<std::uint64_t>(file, "environment_hash", name);
  header.model_points = hdf5::read_number<std::uint64_t>(file, "model_points", name);
  header.model_hash = hdf5::read_number<std::uint64_t>(file, "model_hash", name);
  header.poses = hdf5::read_number<std::uint64_t>(file, "poses", name);
  header.trajectory_hash = hdf5::read_number<std::uint64_t>(file, "trajectory_hash", name);
  header.radius = hdf5::read_number<double>(file, "radius", name);
  header.first_pose = hdf5::read_number<std::uint8_t>(file, "first_pose", name) != 0;
  header.clearance = hdf5::read_number<double>(file, "clearance", name);
  header.between_poses = hdf5::read_number<std::uint8_t>(file, "between_poses", name) != 0;
  read_axes(file, "scale", name, header.quantisation.scale);
  read_axes(file, "offset", name, header.quantisation.offset);
  header.crs_wkt = hdf5::read_text_attribute(file, "crs_wkt", name);
  if (hdf5::has_attribute(file, names::kTolerance, name)) {
    header.tolerance = hdf5::read_number<double>(file, names::kTolerance, name);
    header.engine = hdf5::read_text_attribute(file, names::kEngine, name);
    check_tolerance(header, name);
  }
  header.float_precision = has_value(file, names::kPrecision, names::kFloat, name);
  header.ways_without_ends =
      header.has_poses_of_ways() && !has_value(file, names::kFirstPoseOf, names::kClosedWay, name);
  return header;
}

}  // namespace

struct ResultReader::State {
  explicit State(const std::filesystem::path& path)
      : name(path.string()),
        file(hdf5::open_file(path)),
        header(read_header(file, name)),
        collisions_hash(hdf5::read_number<std::uint64_t>(file, names::kCollisionsHash, name)),
        source(open<std::uint64_t>(names::kGroup, names::kSource, 0)),
        xyz(open<double>(names::kGroup, names::kXyz, 3)) {
    if (header.first_pose) {
      first_pose.emplace(open<std::uint32_t>(names::kGroup, names::kFirstPose, 0));
    }
    if (header.clearance > 0) {
      clearance_hash = hdf5::read_number<std::uint64_t>(file, names::kClearanceHash, name);
      clearance.emplace(
          ClearanceDatasets{open<std::uint64_t>(names::kClearanceGroup, names::kSource, 0),
                            open<double>(names::kClearanceGroup, names::kDistance, 0),
                            open<std::uint32_t>(names::kClearanceGroup, names::kPose, 0)});
    }
    check_lengths();
  }

  template <typename Number>
  hdf5::Rows<Number> open(const char* group, const char* dataset, std::uint64_t columns) const {
    const std::string path = std::string(group) + "/" + dataset;
    return hdf5::Rows<Number>::open(file, path, columns, name);
  }

  void check_lengths() const {
    const auto check = [&](const char* group, bool equal) {
      if (!equal) throw InputError(name + ": the datasets of /" + group + " differ in their rows");
    };
    check(names::kGroup,
          xyz.rows() == source.rows() && (!first_pose || first_pose->rows() == source.rows()));
    if (clearance) {
      const std::uint64_t rows = clearance->source.rows();
      check(names::kClearanceGroup,
            clearance->distance.rows() == rows && clearance->pose.rows() == rows);
    }
  }

  [[noreturn]] void malformed_row(const char* group, const char* dataset, std::uint64_t row,
                                  const std::string& expected) const {
    throw InputError(name + ": /" + group + "/" + dataset + ", row " + std::to_string(row) +
                     ": expected " + expected);
  }

  void check_sources(const char* group, std::uint64_t first,
                     std::span<const std::uint64_t> out) const {
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i] >= header.environment_points || (i > 0 && out[i] <= out[i - 1])) {
        malformed_row(group, names::kSource, first + i,
                      "an index above the row before and below environment_points");
      }
    }
  }

  void check_poses(const char* group, const char* dataset, std::uint64_t first,
                   std::span<const std::uint32_t> out) const {
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i] >= header.poses) malformed_row(group, dataset, first + i, "a pose below poses");
    }
  }

  void check_distances(std::uint64_t first, std::span<const double> out) const {
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (!(out[i] >= 0 && out[i] <= header.clearance)) {
        malformed_row(names::kClearanceGroup, names::kDistance, first + i,
                      "a distance from 0 to the clearance");
      }
    }
  }

  static void check_range(std::uint64_t first, std::size_t count, std::uint64_t rows) {
    if (first > rows || count > rows - first) {
      throw std::logic_error("ResultReader: rows past the end");
    }
  }

  struct ClearanceDatasets {
    hdf5::Rows<std::uint64_t> source;
    hdf5::Rows<double> distance;
    hdf5::Rows<std::uint32_t> pose;
  };

  std::string name;
  hdf5::Id file;
  ResultHeader header;
  std::uint64_t collisions_hash;
  std::uint64_t clearance_hash = 0;
  hdf5::Rows<std::uint64_t> source;
  hdf5::Rows<double> xyz;
  std::optional<hdf5::Rows<std::uint32_t>> first_pose;
  std::optional<ClearanceDatasets> clearance;
};

ResultReader::ResultReader(const std::filesystem::path& path) {
  state_ = as_input(path.string(), [&] { return std::make_unique<State>(path); });
}

ResultReader::~ResultReader() {
  const hdf5::QuietScope quiet;
  state_.reset();
}
ResultReader::ResultReader(ResultReader&&) noexcept = default;

const std::string& ResultReader::name() const { return state_->name; }
const ResultHeader& ResultReader::header() const { return state_->header; }
std::uint64_t ResultReader::collisions() const { return state_->source.rows(); }
std::uint64_t ResultReader::collisions_hash() const { return state_->collisions_hash; }
std::uint64_t ResultReader::clearances_hash() const { return state_->clearance_hash; }

void ResultReader::read_source(std::uint64_t first, std::span<std::uint64_t> out) const {
  state_->check_range(first, out.size(), collisions());
  as_input(state_->name, [&] { state_->source.read(first, out); });
  state_->check_sources(names::kGroup, first, out);
}

void ResultReader::read_xyz(std::uint64_t first, std::span<Vec3> out) const {
  state_->check_range(first, out.size(), collisions());
  as_input(state_->name, [&] { state_->xyz.read(first, as_numbers(out)); });
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(out[i][k])) {
        state_->malformed_row(names::kGroup, names::kXyz, first + i, "finite coordinates");
      }
    }
  }
}

void ResultReader::read_first_pose(std::uint64_t first, std::span<std::uint32_t> out) const {
  state_->check_range(first, out.size(), collisions());
  if (!state_->first_pose) throw std::logic_error("ResultReader: no first poses");
  as_input(state_->name, [&] { state_->first_pose->read(first, out); });
  state_->check_poses(names::kGroup, names::kFirstPose, first, out);
}

std::uint64_t ResultReader::clearances() const {
  return state_->clearance ? state_->clearance->source.rows() : 0;
}

void ResultReader::read_clearances(std::uint64_t first, std::span<std::uint64_t> source,
                                   std::span<double> distance,
                                   std::span<std::uint32_t> pose) const {
  if (!state_->clearance) throw std::logic_error("ResultReader: no clearances");
  if (distance.size() != source.size() || pose.size() != source.size()) {
    throw std::logic_error("ResultReader: rows of unequal lengths");
  }
  state_->check_range(first, source.size(), clearances());
  as_input(state_->name, [&] {
    state_->clearance->source.read(first, source);
    state_->clearance->distance.read(first, distance);
    state_->clearance->pose.read(first, pose);
  });
  state_->check_sources(names::kClearanceGroup, first, source);
  state_->check_distances(first, distance);
  state_->check_poses(names::kClearanceGroup, names::kPose, first, pose);
}

}  // namespace clearway
