#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/query.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// A path cut into the stretches that are the rows of a station table (docs/design/findings.md,
/// "The station table").
class PathRows {
 public:
  /// chainage: of each pose, metres from the first one. every: the length of a stretch. Throws
  /// UsageError for a length that is not above 0 or makes too many stretches.
  PathRows(std::vector<double> chainage, double every);

  std::size_t size() const { return size_; }
  std::size_t poses() const { return chainage_.size(); }
  double from(std::size_t row) const { return static_cast<double>(row) * every_; }
  double to(std::size_t row) const {
    return row + 1 == size_ ? chainage_.back() : static_cast<double>(row + 1) * every_;
  }
  /// The row that a pose is on.
  std::size_t of_pose(std::size_t pose) const { return of_pose_[pose]; }
  const std::vector<double>& chainage() const { return chainage_; }

 private:
  std::vector<double> chainage_;
  double every_;
  std::size_t size_ = 0;
  std::vector<std::uint32_t> of_pose_;
};

/// A set of rows that only grows, and finds the next row that is not in it in constant time.
class RowSet {
 public:
  explicit RowSet(std::size_t rows) : next_(rows + 1) {
    for (std::size_t row = 0; row <= rows; ++row) next_[row] = static_cast<std::uint32_t>(row);
  }

  bool contains(std::size_t row) const { return next_[row] != row; }
  void add(std::size_t row) {
    if (row + 1 < next_.size() && next_[row] == row)
      next_[row] = static_cast<std::uint32_t>(row + 1);
  }
  /// The first row from `row` on that is not in the set, or the number of rows.
  std::size_t next_outside(std::size_t row) {
    while (next_[row] != row) {
      next_[row] = next_[next_[row]];
      row = next_[row];
    }
    return row;
  }

 private:
  std::vector<std::uint32_t>
      next_;  ///< a later row for each row in the set, and else the row itself
};

/// Where along the path a body's box comes near to a place. This shows where the body itself may,
/// which takes no search.
class BoxReach {
 public:
  /// bodies, boxes: what moves, and the box of each model in its own frame; both must outlive this
  /// object, and so must the rows. ways: whether bodies are followed from pose to pose too.
  BoxReach(std::span<const MovingBody> bodies, std::span<const Box> boxes, const PathRows& rows,
           bool ways);

  /// Adds the rows from `from` to `to` (not included) on which a box comes within `distance` of a
  /// place. Rows that are in the set already cost nothing.
  void add_near(const Vec3& place, double distance, std::size_t from, std::size_t to,
                RowSet& set) const;

 private:
  /// One body on its way.
  struct Track {
    std::span<const Pose> poses;
    Box box;
    std::vector<std::uint32_t> path_pose = {};
    double radius = 0;  ///< no place of the box is farther than this from the pose's position
    std::vector<double> way =
        {};  ///< metres that the pose's position has moved since the first pose
    std::vector<double> slack = {};  ///< metres by which the box may come nearer between poses
    double most_slack = 0;
    std::vector<std::size_t> first_of_row =
        {};  ///< for each row, its first pose or that of a later one
  };

  void follow(Track& track) const;
  bool is_near(const Track& track, std::size_t pose, const Vec3& place, double distance) const;
  std::size_t next_near(const Track& track, std::size_t pose, const Vec3& place,
                        double distance) const;

  const PathRows& rows_;
  bool ways_;
  std::vector<Track> tracks_;
};

}  // namespace clearway
