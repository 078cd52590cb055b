#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/files/file.hpp"
#include "io/result/conflicts/conflict_file.hpp"

namespace clearway {

/// The points of each conflict, in the order of the list of conflicts.
using ConflictPoints = std::vector<std::vector<Vec3>>;

/// What the pictures of conflicts show.
struct ConflictPictures {
  static constexpr std::size_t kMostPoints = 5000;  ///< most points of a conflict

  ConflictPoints points;  ///< colliding points
  /// Points of the model, or of each body, in its own frame; if empty, none is drawn.
  std::vector<std::vector<Vec3>> models;
};

/// At most kMostPoints points of each conflict, every n-th. conflict_of: the conflict of each row,
/// as find_conflicts() returns it. Throws as RowStream<Collisions> does.
ConflictPoints conflict_points(const ResultReader& result, const Conflicts& conflicts,
                               const std::vector<std::uint32_t>& conflict_of);

/// Writes a BCF 2.1 archive with a topic for each conflict. Its ids depend on the hashes of the
/// result, on how conflicts were made and on the conflict's smallest source. Source: buildingSMART,
/// BIM Collaboration Format 2.1, its documentation and schemas.
void write_bcf(const ConflictFile& conflicts, const ConflictPictures& pictures, const File& file);

}  // namespace clearway
