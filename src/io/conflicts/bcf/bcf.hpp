#pragma once

#include <vector>

#include "clearway/vec3.hpp"
#include "io/conflicts/conflict_file.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// Points of each conflict, in the order of the list.
using ConflictPoints = std::vector<std::vector<Vec3>>;

/// What is drawn.
struct ConflictPictures {
  static constexpr std::size_t kMostPoints = 5000;  ///< of a conflict

  ConflictPoints points;  ///< colliding ones
  /// Of the model, or of each body, in its own frame; empty: none is drawn.
  std::vector<std::vector<Vec3>> models;
};

/// At most kMostPoints points of each conflict, every n-th of a conflict. conflict_of: of each row,
/// as find_conflicts gives it. Throws as ResultRowStream does.
ConflictPoints conflict_points(const ResultReader& result, const Conflicts& conflicts,
                               const std::vector<std::uint32_t>& conflict_of);

/// A BCF 2.1 archive with a topic for each conflict. Ids depend on the hashes of the result, on how
/// conflicts were made and on the conflict's smallest source.
/// Source: buildingSMART, BIM Collaboration Format 2.1, its documentation and schemas.
void write_bcf(const ConflictFile& conflicts, const ConflictPictures& pictures, const File& file);

}  // namespace clearway
