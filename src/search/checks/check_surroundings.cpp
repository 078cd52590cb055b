#include <algorithm>
#include <array>

#include "clearway/error.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/path_cover.hpp"
#include "search/checks/facts/scan_points.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

constexpr std::size_t kSurroundedPoses = 32;
// Points: fewer may be noise. A reflecting ground has some far below it.
constexpr std::uint64_t kSurelyBelow = 10;
constexpr std::uint64_t kSurelyBeside = 3;
// Metres.
constexpr double kMargin = 1;       ///< beside wheels, where ground that was cleared away remains
constexpr double kIntoModel = 0.3;  ///< ground may reach so far above the model's lowest point
constexpr double kBeside = 20;
constexpr double kAbove = 3;
// Shares of the poses.
constexpr double kMissing = 0.5;
constexpr double kNowhere = 0.1;
constexpr double kOneSideOnly = 0.2, kOtherSide = 0.8;

/// Shares of the poses where something was scanned.
struct Surroundings {
  double below = 0, left = 0, right = 0;
};

class Look {
 public:
  Look(const Question& question, const PathCover& cover)
      : question_(question), cover_(cover), points_(question.cloud) {}

  /// Of the poses that the scan covers; none where it covers too few.
  std::optional<Surroundings> around_path() const {
    const Box slice = body_slice(question_.model);
    const auto poses = spread_poses(question_.query.poses.size(), kSurroundedPoses);
    std::array<std::size_t, 3> found{};
    std::size_t looked = 0;
    for (const std::uint32_t i : poses) {
      const Pose& pose = question_.query.poses[i];
      if (!cover_.covers(moved(slice, pose))) continue;
      ++looked;
      found[0] += points_.has(below(pose), pose, kSurelyBelow) ? 1 : 0;
      found[1] += points_.has(beside(1, pose), pose, kSurelyBeside) ? 1 : 0;
      found[2] += points_.has(beside(-1, pose), pose, kSurelyBeside) ? 1 : 0;
    }
    if (2 * looked < poses.size()) return std::nullopt;
    const auto share = [&](std::size_t k) {
      return static_cast<double>(found[k]) / static_cast<double>(looked);
    };
    return Surroundings{share(0), share(1), share(2)};
  }

 private:
  /// In the model's frame.
  double metre(const Pose& pose) const { return question_.metre / scale_of(pose); }

  /// Longer and wider than the model, so that scanned points may be expected there.
  void widen(Box& box, int axis, const Pose& pose) const {
    const double half = (box.hi[axis] - box.lo[axis]) / 2;
    const double expected = cover_.scan().typical_block() / 4 / scale_of(pose);
    const double margin = std::max(kMargin * metre(pose), expected - half);
    box.lo[axis] -= margin;
    box.hi[axis] += margin;
  }

  Box below(const Pose& pose) const {
    Box box = question_.model;
    for (int k = 0; k < 2; ++k) widen(box, k, pose);
    box.lo.z = points_.bottom_of_scan(box, pose);
    box.hi.z = question_.model.lo.z + kIntoModel * metre(pose);
    return box;
  }

  /// side: 1 is left of a model whose longer side is forward, -1 right.
  Box beside(int side, const Pose& pose) const {
    Box box = question_.model;
    const int across = box.hi.x - box.lo.x >= box.hi.y - box.lo.y ? 1 : 0;
    const bool upwards = (side > 0) == (across == 1);
    const double edge = upwards ? box.hi[across] : box.lo[across];
    box.lo[across] = upwards ? edge : edge - kBeside * metre(pose);
    box.hi[across] = upwards ? edge + kBeside * metre(pose) : edge;
    widen(box, 1 - across, pose);
    box.lo.z += kIntoModel * metre(pose);
    box.hi.z += kAbove * metre(pose);
    return box;
  }

  const Question& question_;
  const PathCover& cover_;
  ScanPoints points_;
};

void warn_nothing_below(const Surroundings& around, MessageLog& log) {
  log.warn("nothing-below",
           "at " + share_text(1 - around.below) +
               " of the poses nothing was scanned below the model. Does the path run below the "
               "ground, or is it in another place? Did the scanner leave out what was near it? If "
               "you removed the ground on purpose, this is all right",
           {{"share", 1 - around.below}});
}

void warn_nothing_beside(const Question& question, const Surroundings& around, MessageLog& log) {
  const double share = 1 - std::max(around.left, around.right);
  log.warn("nothing-beside",
           "at " + share_text(share) +
               " of the poses nothing was scanned beside the model, within " +
               length_text(kBeside * question.metre, question.unit) +
               " and at its height. Was only the ground scanned, or does the path run above a "
               "roof? Compare the heights of path and scan",
           {{"share", share}});
}

void warn_one_side(const Question& question, const Surroundings& around, MessageLog& log) {
  const bool left_is_empty = around.left < around.right;
  const double empty = 1 - std::min(around.left, around.right);
  log.warn("one-side",
           "at " + share_text(empty) + " of the poses nothing was scanned on the " +
               (left_is_empty ? "left" : "right") + " of the model, within " +
               length_text(kBeside * question.metre, question.unit) +
               " and at its height. On the other side there is something. Was the " +
               (left_is_empty ? "left" : "right") + " side scanned?",
           {{"share", empty}, {"left", around.left}, {"right", around.right}});
}

}  // namespace

void check_surroundings(const Question& question, const PathCover& cover, bool floats,
                        MessageLog& log) {
  std::optional<Surroundings> around;
  try {
    around = Look(question, cover).around_path();
  } catch (const InputError&) {
    return;  // a damaged cell is for the search to meet, where it matters
  }
  if (!around) return;
  const double less = std::min(around->left, around->right);
  const double more = std::max(around->left, around->right);
  if (around->below < kMissing) {
    warn_nothing_below(*around, log);
  } else if (more < kNowhere && !floats) {
    warn_nothing_beside(question, *around, log);
  } else if (less < kOneSideOnly && more > kOtherSide) {
    warn_one_side(question, *around, log);
  }
}

}  // namespace clearway
