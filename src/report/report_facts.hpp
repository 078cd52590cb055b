#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/report.hpp"
#include "clearway/unsearched.hpp"
#include "report/drawn_bodies.hpp"
#include "report/environment_sample.hpp"
#include "report/path_places.hpp"
#include "report/shown_points.hpp"

namespace clearway {

/// All that the page says in words and numbers.
struct ReportFacts {
  const Result& result;
  Answer answer;  ///< without what only its rows tell
  const Store& store;
  const ReportOptions& options;
  std::string title;
  Box model_box{};
  std::span<const DrawnBody> bodies;  ///< the model alone, where it is no vehicle
  std::vector<double> classes;
  std::vector<UnsearchedStretch> unsearched;
  SearchedLength searched;
  const Conflicts* conflicts = nullptr;  ///< none where the result has no first poses
  const ShownPoints& points;
  const EnvironmentSample& environment;
  double reach = 0, dense_reach = 0;  ///< of the environment points, from the model's middle
  std::size_t shown_poses = 0, shown_model_points = 0;
  std::optional<LeastDistance> least;  ///< of clearances or profile
  double least_chainage = 0;
  const char* least_of = nullptr;  ///< "clearance" or "profile"
  PageLattice lattice, environment_lattice, model_lattice;
};

inline constexpr std::size_t kMostListedConflicts = 5'000;

/// The conflict that matters most: the greatest encroachment, or else the most points; of equals
/// the first. Null for none.
const Conflict* worst_of(const Conflicts& conflicts);

/// One JSON object. Keys are in docs/guide/report.md.
std::string json_of(const ReportFacts& facts);

}  // namespace clearway
