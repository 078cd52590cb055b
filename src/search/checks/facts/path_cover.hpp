#pragma once

#include <cstdint>
#include <vector>

#include "search/checks/facts/scan_proximity.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// Every n-th pose, the first and the last among them: at most `most`.
std::vector<std::uint32_t> spread_poses(std::size_t poses, std::size_t most);

/// Where along the path the scan has points around the model. What moves is a slice of the model's
/// box across its longest side, as thick as the box's middle side: so a gap in the scan shows that
/// is shorter than the model. Why these lengths: docs/design/inputs.md, "Checks of a query".
class PathCover {
 public:
  explicit PathCover(const Question& question);

  /// Farther than this from every scanned place, a path passes somewhere else.
  double far() const { return far_; }
  /// Poses with no scanned place within this distance lie where the scan has a gap.
  double reach() const { return reach_; }
  /// The distance to the scan that half of the poses do not exceed; `far()` at the most.
  double usual() const { return usual_; }

  /// The slice at another pose, or of another model.
  bool covers(const Box& slice) const { return scan_.within(slice, reach_); }
  const ScanProximity& scan() const { return scan_; }

  /// What was found at the poses that were looked at.
  std::uint64_t looked_at() const { return looked_at_; }
  std::uint64_t outside() const { return outside_; }
  std::uint32_t first_outside() const { return first_outside_; }
  std::uint32_t last_outside() const { return last_outside_; }
  /// Of the path, straight from one pose that was looked at to the next.
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

/// The slice of a model's box that PathCover moves.
Box body_slice(const Box& model);

}  // namespace clearway
