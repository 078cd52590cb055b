#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/result.hpp"
#include "core/util/progress.hpp"
#include "report/packed_points.hpp"

namespace clearway {

/// The least distance of all that the result knows, and where.
struct LeastDistance {
  double distance = 0;  ///< metres
  std::uint32_t pose = 0;
  std::uint64_t source = 0;
  std::optional<Vec3> xyz;
  Side side = Side::kUnknown;  ///< of xyz at the pose, as of conflicts
  std::optional<double> lateral = {}, height = {};
  std::optional<std::uint32_t> body = {};  ///< of a vehicle, that is so near
};

/// Points of the result for the page: colliding ones, and others closer than the last class.
struct ShownPoints {
  static constexpr std::size_t kMostClasses = 3;
  std::vector<PagePoint> points;                       ///< along the curve; their tag is the class
  std::array<std::uint64_t, kMostClasses> of_class{};  ///< in the result
  std::array<std::uint64_t, kMostClasses> shown_class{};  ///< and on the page
  std::uint64_t without_place =
      0;                     ///< closer than the last class, of a result without their places
  std::uint64_t inside = 0;  ///< points with a clearance below 0
  std::optional<LeastDistance> least;    ///< of the clearances
  std::map<std::uint64_t, Vec3> places;  ///< of the sources asked for that collide
};

struct PointSelection {
  std::vector<double> classes;  ///< metres, ascending
  const Conflicts* conflicts = nullptr;
  const std::vector<std::uint32_t>* conflict_of = nullptr;  ///< of each row; empty: not known
  std::vector<std::uint64_t> wanted;                        ///< sources, ascending
  std::uint64_t most_colliding = 2'000'000, most_others = 1'000'000;
};

/// Reads the rows once, front to back. Colliding points beyond `most_colliding` are thinned evenly
/// in their order, but no conflict to fewer than some hundred. Throws InputError as the rows do.
ShownPoints read_shown_points(const Result& result, const PageLattice& lattice,
                              const PointSelection& selection, Progress& progress);

}  // namespace clearway
