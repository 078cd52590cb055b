#include <algorithm>
#include <array>

#include "clearway/error.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/path_cover.hpp"
#include "search/checks/scan_points.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

constexpr std::size_t kSurroundedPoses = 60;
// Points: fewer may be noise. A reflecting ground has some far below it.
constexpr std::uint64_t kSurelyBelow = 10;
constexpr std::uint64_t kSurelyBeside = 3;
// Metres.
constexpr double kBesideTracks = 1;  ///< ground that was cleared away is looked for beside it
constexpr double kIntoModel = 0.3;   ///< ground may reach so far above the model's lowest point
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
  explicit Look(const Question& question) : question_(question), points_(question.cloud) {}

  /// Of the poses that the scan covers; none where it covers too few.
  std::optional<Surroundings> around_path(const PathCover& cover) const {
    const Box slice = body_slice(question_.model);
    const auto poses = spread_poses(question_.query.poses.size(), kSurroundedPoses);
    std::array<std::size_t, 3> found{};
    std::size_t looked = 0;
    for (const std::uint32_t i : poses) {
      const Pose& pose = question_.query.poses[i];
      if (!cover.covers(moved(slice, pose))) continue;
      ++looked;
      found[0] += points_.has(below(pose, cover), pose, kSurelyBelow) ? 1 : 0;
      found[1] += points_.has(beside(1), pose, kSurelyBeside) ? 1 : 0;
      found[2] += points_.has(beside(-1), pose, kSurelyBeside) ? 1 : 0;
    }
    if (2 * looked < poses.size()) return std::nullopt;
    const auto share = [&](std::size_t k) {
      return static_cast<double>(found[k]) / static_cast<double>(looked);
    };
    return Surroundings{share(0), share(1), share(2)};
  }

 private:
  /// Wide enough that the scan's usual spacing leaves points in it.
  Box below(const Pose& pose, const PathCover& cover) const {
    Box box = question_.model;
    const double least =
        std::max(kBesideTracks * question_.metre, cover.scan().typical_block() / 4);
    for (int k = 0; k < 2; ++k) {
      box.lo[k] -= least;
      box.hi[k] += least;
    }
    box.lo.z = points_.bottom_of_scan(box, pose);
    box.hi.z = question_.model.lo.z + kIntoModel * question_.metre;
    return box;
  }

  /// side: 1 is left of a model whose x axis points forward.
  Box beside(int side) const {
    Box box = question_.model;
    const int across = box.hi.x - box.lo.x >= box.hi.y - box.lo.y ? 1 : 0;
    const bool to_high = (side > 0) == (across == 1);
    const double edge = to_high ? box.hi[across] : box.lo[across];
    box.lo[across] = to_high ? edge : edge - kBeside * question_.metre;
    box.hi[across] = to_high ? edge + kBeside * question_.metre : edge;
    box.lo.z += kIntoModel * question_.metre;
    box.hi.z += kAbove * question_.metre;
    return box;
  }

  const Question& question_;
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
    around = Look(question).around_path(cover);
  } catch (const InputError&) {
    return;  // a damaged cell is for the search to meet, where it matters
  }
  if (!around) return;
  if (around->below < kMissing) warn_nothing_below(*around, log);
  const double less = std::min(around->left, around->right);
  const double more = std::max(around->left, around->right);
  if (more < kNowhere && !floats) {
    warn_nothing_beside(question, *around, log);
  } else if (less < kOneSideOnly && more > kOtherSide) {
    warn_one_side(question, *around, log);
  }
}

}  // namespace clearway
