#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Something that two results were asked differently, in words: "radius", "0.1 m", "0.2 m".
struct QueryDifference {
  std::string what, a, b;
};

/// A point that the two results do not say the same of.
struct PointDifference {
  enum class Kind { kOnlyInA, kOnlyInB, kFirstPose, kLastPose, kCoordinates };

  Kind kind;
  std::uint64_t source;
  Vec3 xyz;                                                         ///< as a has it, where a has it
  std::optional<std::uint32_t> first_pose_a, first_pose_b;          ///< where that result has it
  std::optional<std::uint32_t> last_pose_a = {}, last_pose_b = {};  ///< likewise
};

/// How the clearances of two results differ.
struct ClearanceComparison {
  std::uint64_t in_a = 0, in_b = 0;
  std::uint64_t common = 0, only_in_a = 0, only_in_b = 0;
  /// Of common points, in distance, pose or, where both have them, body and coordinates.
  std::uint64_t differing = 0;

  bool equal() const { return only_in_a == 0 && only_in_b == 0 && differing == 0; }
  friend bool operator==(const ClearanceComparison&, const ClearanceComparison&) = default;
};

/// How the profiles of two results differ, pose by pose.
struct ProfileComparison {
  std::uint64_t poses = 0;
  std::uint64_t differing = 0;              ///< in distance, point, its coordinates or chainage
  std::optional<std::uint64_t> first = {};  ///< pose that differs

  bool equal() const { return differing == 0; }
  friend bool operator==(const ProfileComparison&, const ProfileComparison&) = default;
};

struct Comparison {
  std::uint64_t in_a = 0, in_b = 0;
  std::uint64_t common = 0, only_in_a = 0, only_in_b = 0;
  std::uint64_t differing_coordinates = 0;  ///< of common points
  /// Of common points, where both have them, in pose or, of the same bodies, in body.
  std::optional<std::uint64_t> differing_first_poses;
  /// Of common points, where both have last poses.
  std::optional<std::uint64_t> differing_last_poses = {};
  std::optional<ClearanceComparison> clearances;  ///< where both have them
  /// Where both have one, of the same trajectory.
  std::optional<ProfileComparison> profiles;
  std::vector<QueryDifference> queries;
  std::vector<PointDifference> points;  ///< the first ones, ascending by source

  /// The same points at the same places with the same first poses, clearances and profile, whatever
  /// was asked.
  bool equal() const {
    return only_in_a == 0 && only_in_b == 0 && differing_coordinates == 0 &&
           differing_first_poses.value_or(0) == 0 && differing_last_poses.value_or(0) == 0 &&
           (!clearances || clearances->equal()) && (!profiles || profiles->equal());
  }
};

/// Of the model, the trajectory and the parameters: what was asked, of whichever environment.
std::vector<QueryDifference> question_differences(const ResultHeader& a, const ResultHeader& b);

/// The same with the environment, how its coordinates are stored, and its classes.
std::vector<QueryDifference> query_differences(const ResultHeader& a, const ResultHeader& b);

/// Merges both results in constant memory; keeps up to `kept` differing points. Throws InputError
/// when they are about different environments, whose indices cannot be compared.
Comparison compare_results(const ResultReader& a, const ResultReader& b, std::size_t kept);

}  // namespace clearway
