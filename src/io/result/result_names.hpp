#pragma once

#include <cstdint>

/// What reader and writer of a result agree on (docs/design/result-format.md).
namespace clearway::result_names {

inline constexpr const char* kFormat = "clearway result";
inline constexpr const char* kPartFormat = "clearway part";  // not for who looks for a result
inline constexpr std::uint32_t kVersion = 3;
inline constexpr std::uint32_t kNewestVersion = 4;  // ResultHeader::version says of which results
inline constexpr std::uint32_t kOldestVersion = 2;

inline constexpr const char* kGroup = "collisions";
inline constexpr const char* kSource = "source";
inline constexpr const char* kXyz = "xyz";
inline constexpr const char* kFirstPose = "first_pose";
inline constexpr const char* kLastPose = "last_pose";  // only where kLastPoseHash is there

inline constexpr const char* kBody = "body";  // in both groups, where kBodies is there

inline constexpr const char* kClearanceGroup = "clearance";
inline constexpr const char* kDistance = "distance";
inline constexpr const char* kPose = "pose";

inline constexpr const char* kProfileGroup = "profile";  // exists where kProfile is above 0
inline constexpr const char* kChainage = "chainage";
inline constexpr const char* kSquared = "squared";  // of parts only

inline constexpr const char* kProfile = "profile";
inline constexpr const char* kModelBox = "model_box";
inline constexpr const char* kTolerance = "tolerance";  // with kEngine, only where there is one
inline constexpr const char* kEngine = "engine";
inline constexpr const char* kPrecision = "precision";  // only where it is kFloat
inline constexpr const char* kFloat = "float";
inline constexpr const char* kFirstPoseOf = "first_pose_of";  // only where it is kClosedWay
inline constexpr const char* kClosedWay = "closed way";

inline constexpr const char* kBodies = "bodies";  // names, a line each; only where there are any
inline constexpr const char* kModelTriangles = "model_triangles";  // only of a surface
inline constexpr const char* kModelSolids = "model_solids";        // only with solids
inline constexpr const char* kModelSpacing = "model_spacing";      // only of a sampled mesh

inline constexpr const char* kShard = "shard";  // of parts only, with kDivision
inline constexpr const char* kDivision = "division";
inline constexpr const char* kStore = "store";
inline constexpr const char* kLengthUnit = "length_unit";
inline constexpr const char* kDevice = "device";  // of parts that are not exact, with one of
inline constexpr const char* kFieldVoxel = "field_voxel";
inline constexpr const char* kGridCell = "grid_cell";

inline constexpr const char* kIgnoredPoints = "ignored_points";  // with what follows, in version 4
inline constexpr const char* kIgnoredHash = "ignored_hash";      // of the group's datasets
inline constexpr const char* kClassesHash = "classes_hash";      // where classes are ignored
inline constexpr const char* kIgnoredGroup = "ignored";
inline constexpr const char* kClassesIgnored = "classes";
inline constexpr const char* kClassPoints = "class_points";
inline constexpr const char* kBoxes = "boxes";  // a row each: least x, y, z, greatest x, y, z
inline constexpr const char* kBoxPoints = "box_points";

inline constexpr const char* kDoubts = "doubts";  // codes, a line each; only where nothing collides
inline constexpr const char* kIgnoredColliding = "ignored_colliding";  // where points are ignored
inline constexpr const char* kIgnoredHigh = "ignored_colliding_high";  // likewise
inline constexpr const char* kPathLength = "path_length";  // with the next two, where bodies are
inline constexpr const char* kSearchedLength = "searched_length";
inline constexpr const char* kPartlySearchedLength = "partly_searched_length";
inline constexpr const char* kRunsWithoutBodies = "runs_without_bodies";  // with the next one
inline constexpr const char* kPosesWithoutBodies = "poses_without_bodies";
inline constexpr const char* kModelIsCut = "model_is_cut";  // of parts, only where it is

inline constexpr const char* kCollisionsHash = "collisions_hash";
inline constexpr const char* kLastPoseHash = "last_pose_hash";  // so that older readers go on
inline constexpr const char* kClearanceHash = "clearance_hash";
inline constexpr const char* kProfileHash = "profile_hash";

}  // namespace clearway::result_names
