#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "search/checks/facts/path_facts.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// A place of the path, and what was scanned there below and beside the model.
struct Look {
  /// Index of a pose of the question.
  std::uint32_t pose;
  /// Length of the path of the model's middle from the first look, straight between looks.
  double along;
  /// Whether the scan has points around the model. If not, below, left and right are unset.
  bool covered = false;
  bool below = false, left = false, right = false;
  /// Height of the model above the highest point below its inner part: 0 where it touches a point,
  /// and nothing where there is no point below.
  std::optional<double> height = {};
  /// How far the model reaches below the lowest surface that was scanned under or inside it, with
  /// what is below a floor; nothing where that is at most kDeepest, or where no surface was scanned
  /// there.
  std::optional<double> depth = {};
};

/// Consecutive looks from the first to the last one, as indices into PathLooks::all().
struct LookRun {
  std::size_t first, last;
};

/// Looks at the scan below and beside the model, evenly spaced along the path of the model's
/// middle, so that a vehicle that stops is looked at once there. Each look reads a few blocks of
/// points.
class PathLooks {
 public:
  /// Looks on the threads of the calling oneTBB arena. Throws InputError where a cell is damaged.
  PathLooks(const Question& question, const PathCover& cover);

  const std::vector<Look>& all() const { return looks_; }
  /// The mean distance from one look to the next. It is larger than desired where the path is too
  /// long for that, or its poses are too far apart.
  double apart() const;

  /// How many looks the scan covers.
  std::size_t covered() const;
  /// The share of the covered looks for which `holds`; 0 where there are none.
  double share(const std::function<bool(const Look&)>& holds) const;

  /// The lower quartile of the heights above ground: the height of a vehicle that stands on the
  /// ground, although a part of the scan may be too low. 0 where no look has a point below the
  /// model.
  double usual_height() const;

  /// Runs of covered looks for all of which `holds`. A run has at least three looks and a length of
  /// at least `least`. Beside looks that the scan does not cover it has to be longer by the scan's
  /// reach, so that the rim of a gap, about which there is another warning, is not reported twice.
  std::vector<LookRun> runs(double least, const std::function<bool(const Look&)>& holds) const;
  double length(const LookRun& run) const {
    return looks_[run.last].along - looks_[run.first].along;
  }
  std::vector<Look> of(const LookRun& run) const {
    const auto from = looks_.begin();
    return {from + static_cast<std::ptrdiff_t>(run.first),
            from + static_cast<std::ptrdiff_t>(run.last) + 1};
  }
  /// The looks outside all of the runs.
  std::vector<Look> rest(const std::vector<LookRun>& runs) const;

 private:
  std::vector<Look> looks_;
  double reach_;
};

/// How far beside the model the scan is looked at, at the model's height, in metres.
inline constexpr double kLooksBeside = 20;

/// How far the ground may reach above the model's lowest point, in metres: rails, kerbs and rough
/// ground do.
inline constexpr double kDeepest = 0.3;

}  // namespace clearway
