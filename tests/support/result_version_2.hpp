#pragma once

#include <filesystem>
#include <vector>

#include "io/files/hdf5.hpp"
#include "io/files/kept_warnings.hpp"
#include "io/files/xxh64.hpp"

namespace clearway::test {

template <typename Number>
void add_column(const hdf5::Id& group, const char* name, ColumnHashes& hashes,
                const std::vector<Number>& values, std::uint64_t columns = 0) {
  hdf5::write_dataset<Number>(group, name, values, columns);
  hashes.add(values);
}

/// Writes the file that release 0.1.0 wrote for two colliding points and three clearances, with the
/// group of warnings that each result has.
inline void write_version_2(const std::filesystem::path& path) {
  hdf5::Id file = hdf5::create_file(path);
  const hdf5::Id collisions = hdf5::create_group(file, "collisions");
  const hdf5::Id clearance = hdf5::create_group(file, "clearance");
  hdf5::write_attribute(file, "format", std::string("clearway result"));
  hdf5::write_number(file, "version", std::uint32_t{2});
  hdf5::write_number(file, "environment_points", std::uint64_t{10});
  hdf5::write_number(file, "environment_hash", std::uint64_t{0xfedcba9876543210});
  hdf5::write_number(file, "model_points", std::uint64_t{5});
  hdf5::write_number(file, "model_hash", std::uint64_t{6});
  hdf5::write_number(file, "poses", std::uint64_t{4});
  hdf5::write_number(file, "trajectory_hash", std::uint64_t{7});
  hdf5::write_number(file, "radius", 0.1);
  hdf5::write_number(file, "first_pose", std::uint8_t{1});
  hdf5::write_number(file, "clearance", 0.5);
  hdf5::write_number(file, "between_poses", std::uint8_t{0});
  hdf5::write_attribute<double>(file, "scale", std::vector<double>{0.001, 0.001, 0.001});
  hdf5::write_attribute<double>(file, "offset", std::vector<double>{0, 0, 0});
  hdf5::write_attribute(file, "crs_wkt", std::string());
  ColumnHashes of_collisions, of_clearances;
  add_column<std::uint64_t>(collisions, "source", of_collisions, {3, 8});
  add_column<double>(collisions, "xyz", of_collisions, {1, 2, 3, 4, 5, 6}, 3);
  add_column<std::uint32_t>(collisions, "first_pose", of_collisions, {2, 0});
  add_column<std::uint64_t>(clearance, "source", of_clearances, {3, 5, 8});
  add_column<double>(clearance, "distance", of_clearances, {0.05, 0.3, 0.02});
  add_column<std::uint32_t>(clearance, "pose", of_clearances, {3, 1, 0});
  hdf5::write_number(file, "collisions_hash", of_collisions.digest());
  hdf5::write_number(file, "clearance_hash", of_clearances.digest());
  write_warnings(file, {});
  hdf5::write_number(file, "complete", std::uint8_t{1});
  file.close("close");
}

}  // namespace clearway::test
