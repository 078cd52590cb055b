#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>

#include "clearway/error.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/result/result.hpp"
#include "io/result/result_header.hpp"
#include "io/result/result_names.hpp"
#include "io/result/row_checks.hpp"

namespace clearway {

/// The open file and datasets of a result that is read.
struct ResultReader::State {
  explicit State(const std::filesystem::path& path)
      : name(path.string()),
        file(hdf5::open_file(path)),
        header(read_result_header(file, name)),
        findings(read_result_findings(file, name, header)),
        collisions_hash(
            hdf5::read_number<std::uint64_t>(file, result_names::kCollisionsHash, name)),
        source(open<std::uint64_t>(result_names::kGroup, result_names::kSource, 0)),
        xyz(open<double>(result_names::kGroup, result_names::kXyz, 3)) {
    if (header.first_pose) {
      first_pose.emplace(open<std::uint32_t>(result_names::kGroup, result_names::kFirstPose, 0));
    }
    if (header.last_pose) {
      last_pose_hash = hdf5::read_number<std::uint64_t>(file, result_names::kLastPoseHash, name);
      last_pose.emplace(open<std::uint32_t>(result_names::kGroup, result_names::kLastPose, 0));
    }
    if (header.has_first_bodies()) {
      body.emplace(open<std::uint32_t>(result_names::kGroup, result_names::kBody, 0));
    }
    check_equal(result_names::kGroup, source.rows(),
                {xyz.rows(), rows_of(first_pose, source.rows()), rows_of(body, source.rows()),
                 rows_of(last_pose, source.rows())});
    if (header.clearance > 0) open_clearances();
    if (header.profile > 0) open_profile();
  }

  void open_clearances() {
    clearance_hash = hdf5::read_number<std::uint64_t>(file, result_names::kClearanceHash, name);
    clearance.emplace(ClearanceDatasets{
        open<std::uint64_t>(result_names::kClearanceGroup, result_names::kSource, 0),
        {},
        open<double>(result_names::kClearanceGroup, result_names::kDistance, 0),
        open<std::uint32_t>(result_names::kClearanceGroup, result_names::kPose, 0),
        {}});
    if (!header.bodies.empty()) {
      clearance->body.emplace(
          open<std::uint32_t>(result_names::kClearanceGroup, result_names::kBody, 0));
    }
    if (header.has_clearance_xyz()) {
      clearance->xyz.emplace(open<double>(result_names::kClearanceGroup, result_names::kXyz, 3));
    }
    const std::uint64_t rows = clearance->source.rows();
    check_equal(result_names::kClearanceGroup, rows,
                {clearance->distance.rows(), clearance->pose.rows(), rows_of(clearance->xyz, rows),
                 rows_of(clearance->body, rows)});
  }

  void open_profile() {
    profile_hash = hdf5::read_number<std::uint64_t>(file, result_names::kProfileHash, name);
    profile.emplace(
        ProfileDatasets{open<double>(result_names::kProfileGroup, result_names::kDistance, 0),
                        open<std::uint64_t>(result_names::kProfileGroup, result_names::kSource, 0),
                        open<double>(result_names::kProfileGroup, result_names::kXyz, 3),
                        open<double>(result_names::kProfileGroup, result_names::kChainage, 0),
                        {}});
    if (header.part) {
      profile->squared.emplace(
          open<double>(result_names::kProfileGroup, result_names::kSquared, 0));
    }
    const std::uint64_t rows = profile->distance.rows();
    check_equal(result_names::kProfileGroup, rows,
                {profile->source.rows(), profile->xyz.rows(), profile->chainage.rows(),
                 rows_of(profile->squared, rows)});
    if (profile->distance.rows() != header.poses) {
      throw InputError(name + ": /profile has " + std::to_string(profile->distance.rows()) +
                       " rows, expected one for each of " + std::to_string(header.poses) +
                       " poses");
    }
  }

  template <typename Number>
  hdf5::Rows<Number> open(const char* group, const char* dataset, std::uint64_t columns) const {
    const std::string path = std::string(group) + "/" + dataset;
    return hdf5::Rows<Number>::open(file, path, columns, name);
  }

  template <typename Rows>
  static std::uint64_t rows_of(const std::optional<Rows>& dataset, std::uint64_t otherwise) {
    return dataset ? dataset->rows() : otherwise;
  }

  void check_equal(const char* group, std::uint64_t rows,
                   std::initializer_list<std::uint64_t> others) const {
    for (const std::uint64_t other : others) {
      if (other == rows) continue;
      throw InputError(name + ": the datasets of /" + group + " differ in their rows");
    }
  }

  RowChecks checks(const char* group, std::uint64_t first) const {
    return {name, header, group, first};
  }

  struct ClearanceDatasets {
    hdf5::Rows<std::uint64_t> source;
    std::optional<hdf5::Rows<double>> xyz;
    hdf5::Rows<double> distance;
    hdf5::Rows<std::uint32_t> pose;
    std::optional<hdf5::Rows<std::uint32_t>> body;
  };

  struct ProfileDatasets {
    hdf5::Rows<double> distance;
    hdf5::Rows<std::uint64_t> source;
    hdf5::Rows<double> xyz, chainage;
    std::optional<hdf5::Rows<double>> squared;
  };

  std::string name;
  hdf5::Id file;
  ResultHeader header;
  ResultFindings findings;
  std::uint64_t collisions_hash, last_pose_hash = 0, clearance_hash = 0, profile_hash = 0;
  hdf5::Rows<std::uint64_t> source;
  hdf5::Rows<double> xyz;
  std::optional<hdf5::Rows<std::uint32_t>> first_pose, last_pose, body;
  std::optional<ClearanceDatasets> clearance;
  std::optional<ProfileDatasets> profile;
};

}  // namespace clearway
