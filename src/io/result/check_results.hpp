#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Re-reads a result and checks it: rows intact, source indices ascending and below the number of
/// environment points, coordinates finite and on the result's scale, poses below their number,
/// distances within what was asked for, chainages ascending. Returns the first fault, or nullopt.
std::optional<std::string> verify_result(const ResultReader& result, Progress& progress);

/// Whether the file, which exists, is an intact result, or part of one, with this header.
bool is_intact_result(const std::filesystem::path& file, const ResultHeader& header,
                      Progress& progress);

/// A difference between the queries of two results, in words: "radius", "0.1 m", "0.2 m".
struct QueryDifference {
  std::string what, a, b;
};

/// A point for which the two results differ.
struct PointDifference {
  enum class Kind { kOnlyInA, kOnlyInB, kFirstPose, kLastPose, kDepth, kCoordinates };

  Kind kind;
  std::uint64_t source;
  Vec3 xyz;  ///< coordinates in a, or in b where a lacks the point
  std::optional<std::uint32_t> first_pose_a, first_pose_b;  ///< where that result has first poses
  /// Where that result has last poses.
  std::optional<std::uint32_t> last_pose_a = {}, last_pose_b = {};
  /// Where the depths differ: those of both results, NaN where no point is free, and the sources of
  /// the free points.
  std::optional<double> depth_a = {}, depth_b = {};
  std::optional<std::uint64_t> depth_source_a = {}, depth_source_b = {};
};

/// How the points of a table differ between two results: those of clearances, or the near ones.
struct TableComparison {
  std::uint64_t in_a = 0, in_b = 0;
  std::uint64_t common = 0, only_in_a = 0, only_in_b = 0;
  /// Number of common points that differ in a column that both results have: distance, pose,
  /// coordinates, or the body where both have the same bodies. The class does not count, because it
  /// is no part of the answer.
  std::uint64_t differing = 0;

  bool equal() const { return only_in_a == 0 && only_in_b == 0 && differing == 0; }
  friend bool operator==(const TableComparison&, const TableComparison&) = default;
};

/// How the profiles of two results differ, pose by pose.
struct ProfileComparison {
  std::uint64_t poses = 0;
  /// Poses that differ in distance, point, its coordinates or chainage.
  std::uint64_t differing = 0;
  std::optional<std::uint64_t> first = {};  ///< first pose that differs

  bool equal() const { return differing == 0; }
  friend bool operator==(const ProfileComparison&, const ProfileComparison&) = default;
};

struct Comparison {
  std::uint64_t in_a = 0, in_b = 0;
  std::uint64_t common = 0, only_in_a = 0, only_in_b = 0;
  std::uint64_t differing_coordinates = 0;  ///< number of common points whose coordinates differ
  /// Number of common points that differ in first pose or, for the same bodies, in body. Only where
  /// both results have first poses.
  std::optional<std::uint64_t> differing_first_poses;
  /// Number of common points that differ in last pose. Only where both results have last poses.
  std::optional<std::uint64_t> differing_last_poses = {};
  /// Number of common points that differ in depth or in the free point that it is measured to. Only
  /// where both results have depths.
  std::optional<std::uint64_t> differing_depths = {};
  std::optional<TableComparison> clearances;  ///< only where both results have clearances
  std::optional<TableComparison> near;        ///< only where both results have an error budget
  /// Only where both results have a profile of the same trajectory.
  std::optional<ProfileComparison> profiles;
  std::vector<QueryDifference> queries;
  std::vector<PointDifference> points;  ///< the first of the differing points, ascending by source

  /// Whether both results have the same points at the same places with the same first poses,
  /// depths, near points, clearances and profile. Differing queries and last poses do not count.
  bool equal() const {
    return only_in_a == 0 && only_in_b == 0 && differing_coordinates == 0 &&
           differing_first_poses.value_or(0) == 0 && differing_last_poses.value_or(0) == 0 &&
           differing_depths.value_or(0) == 0 && (!clearances || clearances->equal()) &&
           (!near || near->equal()) && (!profiles || profiles->equal());
  }
};

/// Differences in what was asked: model, trajectory and parameters, whatever the environment.
std::vector<QueryDifference> question_differences(const ResultHeader& a, const ResultHeader& b);

/// Differences in what was asked, and in the environment, how its coordinates are stored, and its
/// classes.
std::vector<QueryDifference> query_differences(const ResultHeader& a, const ResultHeader& b);

/// Compares two results in constant memory and keeps up to `kept` differing points. Throws
/// InputError when they are about different environments, whose indices cannot be compared.
Comparison compare_results(const ResultReader& a, const ResultReader& b, std::size_t kept);

}  // namespace clearway
