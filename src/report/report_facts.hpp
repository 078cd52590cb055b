#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/report.hpp"
#include "clearway/stations.hpp"
#include "clearway/unsearched.hpp"
#include "clearway/unseen.hpp"
#include "io/store/store_metadata.hpp"
#include "report/drawn_bodies.hpp"
#include "report/environment_sample.hpp"
#include "report/path_places.hpp"
#include "report/section_view.hpp"
#include "report/shown_points.hpp"

namespace clearway {

/// The least distance that the result knows, and where it is.
struct LeastDistance : FoundPlace {
  const char* of = nullptr;  ///< "clearance" or "profile", whichever it is from
  double chainage = 0;
  /// The side on which the point lies at the pose, as for conflicts.
  Side side = Side::kUnknown;
  std::optional<double> lateral = {}, height = {};
  /// The number of the body of a vehicle that is so near.
  std::optional<std::uint32_t> body_number = {};
};

/// Everything that the page says in words and numbers.
struct ReportFacts {
  const Result& result;
  const Store& store;
  const ReportOptions& options;
  std::span<const Pose> poses;   ///< of the path
  std::vector<double> chainage;  ///< of each pose, from 0
  Answer answer;                 ///< as far as it is known by now
  std::vector<double> classes;
  std::vector<DrawnBody> bodies;  ///< the model alone where there is no vehicle
  std::string title = {};
  std::vector<UnsearchedStretch> unsearched = {};
  SearchedLength searched = {};
  const Conflicts* conflicts = nullptr;       ///< null where the result has no first poses
  std::optional<SectionView> section = {};    ///< none where none was given
  std::optional<StationTable> stations = {};  ///< none where the result has no first poses
  double every = 0;                           ///< length of its stretches
  UnseenGroups unseen = {};                   ///< empty where seen space was not asked for
  ShownPoints points = {};
  EnvironmentSample environment = {};
  /// How far from the model's centre environment points are shown at all, and densely.
  double reach = 0, dense_reach = 0;
  std::size_t shown_poses = 0, shown_model_points = 0;
  std::optional<LeastDistance> least = {};  ///< the least of the clearances or of the profile
  PageLattice lattice = {}, environment_lattice = {}, model_lattice = {};
};

inline constexpr std::size_t kMostListedConflicts = 5'000;

/// The most cubes of listed groups that the page draws; each group keeps its share, and at least
/// one.
inline constexpr std::size_t kMostShownCubes = 1'000'000;

/// How many cubes of a listed group the page draws.
std::uint64_t shown_cubes(const UnseenGroups& unseen, const UnseenGroup& group);

/// The scans that a store was made of: how many `files`, the `names` of the first of them, since
/// there may be thousands, and the days on which they were made, null where their files do not say.
Json json_of_scans(const StoreMetadata& store);

/// What no file can prove and a person can compare on site: the sizes of the bodies and how they
/// stand on the path, their axles, and where the path begins and ends, runs to, and bends most.
/// docs/guide/report.md, "Check these on site".
Json on_site(const ReportFacts& facts);

/// The facts as one JSON object. docs/guide/report.md describes its keys.
std::string json_of(const ReportFacts& facts);

}  // namespace clearway
