#pragma once

#include <cstdint>

/// Names and the version on which reader and writer of a result agree
/// (docs/design/result-format.md). Attributes that are one number or text are named where
/// result_header.cpp lists them.
namespace clearway::result_names {

inline constexpr const char* kFormat = "clearway result";
// Differs, so that no reader takes a part for a result.
inline constexpr const char* kPartFormat = "clearway part";
inline constexpr std::uint32_t kVersion = 6;

inline constexpr const char* kGroup = "collisions";
inline constexpr const char* kCollisionsHash = "collisions_hash";
inline constexpr const char* kSource = "source";
inline constexpr const char* kXyz = "xyz";
inline constexpr const char* kFirstPose = "first_pose";
inline constexpr const char* kLastPose = "last_pose";
inline constexpr const char* kDepth = "depth";
inline constexpr const char* kDepthSource = "depth_source";
inline constexpr const char* kBody = "body";
inline constexpr const char* kCertain = "certain";
inline constexpr const char* kClass = "class";

inline constexpr const char* kNearGroup = "near";
inline constexpr const char* kNearHash = "near_hash";

inline constexpr const char* kClearanceGroup = "clearance";
inline constexpr const char* kClearanceHash = "clearance_hash";
inline constexpr const char* kDistance = "distance";
inline constexpr const char* kPose = "pose";

inline constexpr const char* kProfileGroup = "profile";
inline constexpr const char* kProfileHash = "profile_hash";
inline constexpr const char* kChainage = "chainage";
inline constexpr const char* kSquared = "squared";

inline constexpr const char* kUnseenGroup = "unseen";
inline constexpr const char* kUnseenHash = "unseen_hash";
inline constexpr const char* kCube = "cube";
inline constexpr const char* kGroupOfCube = "group";
inline constexpr const char* kStep = "step";
inline constexpr const char* kSweptGroup = "swept";
inline constexpr const char* kSweptHash = "swept_hash";
inline constexpr const char* kCell = "cell";
inline constexpr const char* kParts = "parts";

// What is ignored: a group and attributes of the root.
inline constexpr const char* kIgnoredGroup = "ignored";
inline constexpr const char* kClassesIgnored = "classes";
inline constexpr const char* kClassPoints = "class_points";
inline constexpr const char* kBoxes = "boxes";  // one row per box: least x, y, z, greatest x, y, z
inline constexpr const char* kBoxPoints = "box_points";
inline constexpr const char* kIgnoredPoints = "ignored_points";
inline constexpr const char* kIgnoredHash = "ignored_hash";  // hash of the group's datasets

inline constexpr const char* kFloorColliding = "floor_colliding";
inline constexpr const char* kBodies = "bodies";  // names, one per line
inline constexpr const char* kBodyFloors = "body_floors";
inline constexpr const char* kRunsWithoutBodies = "runs_without_bodies";
inline constexpr const char* kPosesWithoutBodies = "poses_without_bodies";

}  // namespace clearway::result_names
