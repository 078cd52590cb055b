#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/result.hpp"
#include "core/util/progress.hpp"
#include "report/page.hpp"

namespace clearway {

/// The points of the result that the page shows: colliding points, and others that are closer than
/// the last class.
struct ShownPoints {
  static constexpr std::size_t kMostClasses = 3;
  /// Points in their order along the curve, with their class as the tag.
  std::vector<PagePoint> points;
  /// Number of points of each class in the result.
  std::array<std::uint64_t, kMostClasses> of_class{};
  /// Number of points of each class on the page.
  std::array<std::uint64_t, kMostClasses> shown_class{};
  TableSummary summary;  ///< what collisions and clearances say in short
  /// Coordinates of the colliding points whose source was asked for, by source.
  std::map<std::uint64_t, Vec3> places;
};

struct PointSelection {
  /// Upper bounds of the classes in metres, ascending.
  std::vector<double> classes;
  const Conflicts* conflicts = nullptr;
  /// The conflict of each row; empty where it is not known.
  const std::vector<std::uint32_t>* conflict_of = nullptr;
  /// Source indices of points whose coordinates are wanted, ascending.
  std::vector<std::uint64_t> wanted;
  std::uint64_t most_colliding = 2'000'000, most_others = 1'000'000;
};

/// Reads the rows once, front to back. More than `most_colliding` colliding points are thinned
/// evenly in their order, but each conflict keeps some hundred points. Throws InputError as reading
/// the rows does.
ShownPoints read_shown_points(const Result& result, const PageLattice& lattice,
                              const PointSelection& selection, Progress& progress);

}  // namespace clearway
