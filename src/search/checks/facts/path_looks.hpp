#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "search/checks/facts/path_cover.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// A place of the path, and what was scanned there below and beside the model.
struct Look {
  std::uint32_t pose;  ///< of the question
  double along;  ///< the way of the model's middle from the first look, straight between looks
  bool covered =
      false;  ///< whether the scan has points around the model; if not, the rest is unset
  bool below = false, left = false, right = false;
  /// Of the model above the highest point below its inner part: 0 where it touches one, none where
  /// there is none.
  std::optional<double> height = {};
};

/// Consecutive looks, from the first to the last one, as indices into PathLooks::all().
struct LookRun {
  std::size_t first, last;
};

/// Looks at the scan below and beside the model, evenly spaced by the way that the model's middle
/// goes, so that a vehicle that stops is looked at once. Each reads a few blocks of points.
class PathLooks {
 public:
  /// Throws InputError where a cell is damaged.
  PathLooks(const Question& question, const PathCover& cover);

  const std::vector<Look>& all() const { return looks_; }
  /// The distance from look to look; more than was wished where the path is too long for that, or
  /// its poses are too far apart.
  double apart() const;

  /// How many looks the scan covers.
  std::size_t covered() const;
  /// The share of the covered looks for which `holds`; 0 where there are none.
  double share(const std::function<bool(const Look&)>& holds) const;

  /// The height above ground that a quarter of the looks do not exceed: of a vehicle that stands on
  /// it, although a part of the scan may be too low. 0 where nothing is below.
  double usual_height() const;

  /// Of three looks at least, and `least` long at least, for all of which `holds`. Beside looks
  /// that the scan does not cover they are longer by its reach: their rim is not told twice.
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

/// At the sides, at the height of the model: how far beside it is looked, in metres.
inline constexpr double kLooksBeside = 20;

}  // namespace clearway
