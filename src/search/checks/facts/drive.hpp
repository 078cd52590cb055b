#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "search/checks/question.hpp"

namespace clearway {

/// How the rotations of a trajectory may have been misread.
enum class Reading { kAsGiven, kTransposed, kScalarFirst, kScalarLast };

/// The rotation that the numbers of another one stand for in a reading.
std::array<double, 9> reread(const std::array<double, 9>& rotation, Reading reading);

/// A path as a vehicle drives it: pieces about half as long as the model, each with its direction
/// and with the rotation at its middle. So noise of the positions while it stands does not count.
class Drive {
 public:
  explicit Drive(const Question& question);
  /// In pieces of this length.
  Drive(const Query& query, double length);

  std::size_t pieces() const { return pieces_.size(); }
  /// Enough pieces to tell how it moves.
  bool is_one() const { return pieces_.size() >= 8; }

  /// Shares of the motion along the model's x, y and z axes; their sum is 1.
  Vec3 along_axes(Reading reading = Reading::kAsGiven) const;
  /// The mean of the direction of motion along the model's axis, 1 where it moves straight along it
  /// and -1 where it moves backwards.
  double forwards(int axis) const;
  /// The mean of the model's z axis along the scan's z axis, 1 for an upright model.
  double upright(Reading reading = Reading::kAsGiven) const;
  /// Of the directions of motion: 1 for a straight path, lower where it turns.
  double straightness() const;
  /// How far the model's z axis leans to the right of the way, in radians, of each piece.
  std::vector<double> leans() const;
  /// Of all that the path turns, in plan: the part to the right; half where it hardly turns.
  double right_turns() const;
  /// Whether no rotation differs from the first by more than a degree or so.
  bool never_turns() const;

 private:
  struct Piece {
    Vec3 direction;                  ///< unit length
    std::array<double, 9> rotation;  ///< without a scale
  };
  std::vector<Piece> pieces_;
};

}  // namespace clearway
