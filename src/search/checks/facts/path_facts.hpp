#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clearway/progress.hpp"
#include "search/checks/facts/scan_facts.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// A path as a vehicle drives it: pieces about half as long as the model, each with its direction
/// and with the rotation at its middle. Because of that length, noise of the positions of a
/// standing vehicle does not count.
class Drive {
 public:
  explicit Drive(const Question& question);
  /// Divides the path into pieces of this length, in the environment's unit.
  Drive(const Query& query, double length);

  std::size_t pieces() const { return pieces_.size(); }
  /// Whether there are enough pieces to see how the model moves.
  bool is_one() const { return pieces_.size() >= 8; }

  /// Shares of the motion along the model's x, y and z axes; their sum is 1.
  Vec3 along_axes() const;
  /// The mean, over the pieces, of the direction of motion along one of the model's axes: 1 where
  /// the model moves straight along it and -1 where it moves backwards.
  double forwards(int axis) const;
  /// The mean of the z component of the model's z axis in the scan, 1 for an upright model.
  double upright() const;
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

/// Indices of at most `most` poses, evenly spread, the first and the last pose among them.
std::vector<std::uint32_t> spread_poses(std::size_t poses, std::size_t most);

/// Where along the path the scan has points around the model. It moves a slice of the model's box
/// across its longest side, as thick as the box's middle side, so that gaps of the scan that are
/// shorter than the model show too. The reasons for these lengths: docs/design/inputs.md, "Checks
/// of a query".
class PathCover {
 public:
  explicit PathCover(const Question& question);

  /// The distance from every scanned place beyond which a path passes somewhere else.
  double far() const { return far_; }
  /// The distance to the nearest scanned place beyond which a pose lies in a gap of the scan.
  double reach() const { return reach_; }
  /// The median distance from the path to the scan; at most `far()`.
  double usual() const { return usual_; }

  /// Whether the scan comes within `reach()` of this slice, which may be that of another model.
  bool covers(const Box& slice) const { return scan_.within(slice, reach_); }
  const ScanProximity& scan() const { return scan_; }

  /// How many poses were looked at.
  std::uint64_t looked_at() const { return looked_at_; }
  std::uint64_t outside() const { return outside_; }
  std::uint32_t first_outside() const { return first_outside_; }
  std::uint32_t last_outside() const { return last_outside_; }
  /// Stretches of the question's poses that are outside, with the poses before and after them up to
  /// where the scan ends: those at which nothing is within four times the usual distance, or 1 m.
  const std::vector<PoseRange>& stretches_outside() const { return stretches_outside_; }
  /// Length of the path, straight from each pose that was looked at to the next.
  double length() const { return length_; }
  double length_outside() const { return length_outside_; }

 private:
  void measure(const Question& question);
  void look(const Question& question);
  void extend_stretches(const Question& question);

  ScanProximity scan_;
  double far_ = 0, reach_ = 0, usual_ = 0, length_ = 0, length_outside_ = 0;
  std::uint64_t looked_at_ = 0, outside_ = 0;
  std::uint32_t first_outside_ = 0, last_outside_ = 0;
  std::vector<PoseRange> stretches_outside_;
};

/// The slice of a model's box that PathCover moves along the path.
Box body_slice(const Box& model);

}  // namespace clearway
