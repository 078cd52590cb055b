#pragma once

#include <cstdint>

/// Names and versions on which reader and writer of a result agree (docs/design/result-format.md).
namespace clearway::result_names {

inline constexpr const char* kFormat = "clearway result";
// Differs, so that no reader takes a part for a result.
inline constexpr const char* kPartFormat = "clearway part";
inline constexpr std::uint32_t kVersion = 3;
inline constexpr std::uint32_t kNewestVersion = 5;  // see ResultHeader::version
inline constexpr std::uint32_t kOldestVersion = 2;

inline constexpr const char* kGroup = "collisions";
inline constexpr const char* kSource = "source";
inline constexpr const char* kXyz = "xyz";
inline constexpr const char* kFirstPose = "first_pose";
inline constexpr const char* kLastPose = "last_pose";  // exists where kLastPoseHash does

inline constexpr const char* kBody = "body";  // exists in both groups where kBodies does

inline constexpr const char* kClearanceGroup = "clearance";
inline constexpr const char* kDistance = "distance";
inline constexpr const char* kPose = "pose";

inline constexpr const char* kProfileGroup = "profile";  // exists where kProfile is above 0
inline constexpr const char* kNearGroup = "near";        // only with an error budget
inline constexpr const char* kCertain = "certain";       // likewise, in kGroup
inline constexpr const char* kChainage = "chainage";
inline constexpr const char* kSquared = "squared";  // only in parts

inline constexpr const char* kUnseenGroup = "unseen";  // exists where seen space is asked for
inline constexpr const char* kUnseenHash = "unseen_hash";
inline constexpr const char* kCube = "cube";
inline constexpr const char* kGroupOfCube = "group";
inline constexpr const char* kStep = "step";         // only in parts
inline constexpr const char* kSweptGroup = "swept";  // exists where kUnseenGroup does
inline constexpr const char* kSweptHash = "swept_hash";
inline constexpr const char* kCell = "cell";
inline constexpr const char* kParts = "parts";
// Attributes with what is known of seen space.
inline constexpr const char* kCubeSide = "unseen_cube_side";
inline constexpr const char* kSweptCubes = "swept_cubes";
inline constexpr const char* kUnseenCubes = "unseen_cubes";
inline constexpr const char* kUnseenGroups = "unseen_groups";
inline constexpr const char* kListedGroups = "unseen_listed_groups";
inline constexpr const char* kListedCubes = "unseen_listed_cubes";
inline constexpr const char* kNotScanned = "not_scanned_length";

inline constexpr const char* kProfile = "profile";
inline constexpr const char* kModelBox = "model_box";
inline constexpr const char* kFirstPoseOf = "first_pose_of";  // written only where it is kClosedWay
inline constexpr const char* kClosedWay = "closed way";

// Names, one per line; only for a query with bodies.
inline constexpr const char* kBodies = "bodies";
inline constexpr const char* kModelTriangles = "model_triangles";  // only for a surface
inline constexpr const char* kModelSolids = "model_solids";        // only with solids
inline constexpr const char* kModelSpacing = "model_spacing";      // only for a sampled mesh

inline constexpr const char* kModelAxes = "model_axes";  // only for a model that was turned

inline constexpr const char* kShard = "shard";  // only in parts, together with kDivision
inline constexpr const char* kDivision = "division";
inline constexpr const char* kStore = "store";
inline constexpr const char* kLengthUnit = "length_unit";

// Only in version 4, as are the attributes up to kBoxPoints.
inline constexpr const char* kIgnoredPoints = "ignored_points";
// Hash of the datasets of kIgnoredGroup.
inline constexpr const char* kIgnoredHash = "ignored_hash";
inline constexpr const char* kClassesHash = "classes_hash";  // only where classes are ignored
inline constexpr const char* kIgnoredGroup = "ignored";
inline constexpr const char* kClassesIgnored = "classes";
inline constexpr const char* kClassPoints = "class_points";
inline constexpr const char* kBoxes = "boxes";  // one row per box: least x, y, z, greatest x, y, z
inline constexpr const char* kBoxPoints = "box_points";

// Only where points are ignored.
inline constexpr const char* kIgnoredColliding = "ignored_colliding";
// Only where points are ignored.
inline constexpr const char* kWithheldPoints = "withheld_points";
inline constexpr const char* kIgnoredHigh = "ignored_colliding_high";
// With the next two, only where there are bodies.
inline constexpr const char* kPathLength = "path_length";
inline constexpr const char* kSearchedLength = "searched_length";
inline constexpr const char* kPartlySearchedLength = "partly_searched_length";
// Number of runs; with kPosesWithoutBodies.
inline constexpr const char* kRunsWithoutBodies = "runs_without_bodies";
inline constexpr const char* kPosesWithoutBodies = "poses_without_bodies";
inline constexpr const char* kModelIsCut = "model_is_cut";  // only in parts whose model is cut

// Only in version 5, besides the parameters of the query, as are the attributes up to
// kCertainGroup.
inline constexpr const char* kBudgetStep = "budget_step";
inline constexpr const char* kBudgetLever = "budget_lever";
inline constexpr const char* kBudgetMotion = "budget_motion";
inline constexpr const char* kBudgetChord = "budget_chord";
inline constexpr const char* kBudgetSpacing = "budget_spacing";
inline constexpr const char* kCertainPoints = "certain_points";
inline constexpr const char* kCertainGroup = "certain_group";

inline constexpr const char* kNearHash = "near_hash";
inline constexpr const char* kCollisionsHash = "collisions_hash";
// A hash of its own, so that older readers still accept the file.
inline constexpr const char* kLastPoseHash = "last_pose_hash";
inline constexpr const char* kClearanceHash = "clearance_hash";
inline constexpr const char* kProfileHash = "profile_hash";

}  // namespace clearway::result_names
