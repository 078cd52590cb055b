#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "search/checks/question.hpp"

namespace clearway {

/// How the rotations of a trajectory may have been misread.
enum class Reading { kAsGiven, kTransposed, kScalarFirst, kScalarLast };

/// The rotation that was meant, if `rotation` was read from its numbers in the given way.
std::array<double, 9> reread(const std::array<double, 9>& rotation, Reading reading);

/// A path as a vehicle drives it: pieces about half as long as the model, each with its direction
/// and with the rotation at its middle. Because of that length, noise of the positions of a
/// standing vehicle does not count.
class Drive {
 public:
  explicit Drive(const Question& question);
  /// Divides the path into pieces of this length, in the environment's unit.
  Drive(const Query& query, double length);

  std::size_t pieces() const { return pieces_.size(); }
  /// Whether there are enough pieces to tell how the model moves.
  bool is_one() const { return pieces_.size() >= 8; }

  /// Shares of the motion along the model's x, y and z axes; their sum is 1.
  Vec3 along_axes(Reading reading = Reading::kAsGiven) const;
  /// The mean, over the pieces, of the direction of motion along one of the model's axes: 1 where
  /// the model moves straight along it and -1 where it moves backwards.
  double forwards(int axis) const;
  /// The mean of the z component of the model's z axis in the scan, 1 for an upright model.
  double upright(Reading reading = Reading::kAsGiven) const;
  /// How far the directions of motion agree: 1 for a straight path, lower where it turns.
  double straightness() const;
  /// For each piece that is not vertical, how far the model's z axis leans to the right of the
  /// direction of motion, in radians.
  std::vector<double> leans() const;
  /// The share of the path's turns, in plan, that are to the right; 0.5 where the path hardly
  /// turns.
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
