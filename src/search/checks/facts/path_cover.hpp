#pragma once

#include <cstdint>
#include <vector>

#include "search/checks/facts/scan_proximity.hpp"
#include "search/checks/question.hpp"

namespace clearway {

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
  /// Length of the path, straight from each pose that was looked at to the next.
  double length() const { return length_; }
  double length_outside() const { return length_outside_; }

 private:
  void measure(const Question& question);
  void look(const Question& question);

  ScanProximity scan_;
  double far_ = 0, reach_ = 0, usual_ = 0, length_ = 0, length_outside_ = 0;
  std::uint64_t looked_at_ = 0, outside_ = 0;
  std::uint32_t first_outside_ = 0, last_outside_ = 0;
};

/// The slice of a model's box that PathCover moves along the path.
Box body_slice(const Box& model);

}  // namespace clearway
