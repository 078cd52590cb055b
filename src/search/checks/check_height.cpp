#include <algorithm>
#include <cmath>
#include <vector>

#include "search/checks/checks.hpp"
#include "search/checks/facts/path_looks.hpp"
#include "search/checks/told_stretches.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

// The following lengths are in metres.
constexpr double kLeast = 0.5;
constexpr double kSteady = 0.5;
/// The largest spread of heights on the rest of the path where only a stretch is above the ground.
constexpr double kSteadyRest = 0.25;
/// The shortest stretch that floats, longer than the shadow below a scanner.
constexpr double kLeastFloating = 5;
/// The share of looks that have to be high above the ground. The others may be beside vegetation or
/// noise.
constexpr double kMostHigh = 0.75;

/// Heights above ground in ascending order; at(share) is the quantile.
class Heights {
 public:
  explicit Heights(const std::vector<Look>& looks) {
    for (const Look& look : looks) {
      if (look.height) sorted_.push_back(*look.height);
    }
    std::sort(sorted_.begin(), sorted_.end());
  }

  bool empty() const { return sorted_.empty(); }
  double at(double share) const {
    return sorted_[static_cast<std::size_t>(share * static_cast<double>(sorted_.size() - 1))];
  }
  double spread() const { return at(0.75) - at(0.25); }

 private:
  std::vector<double> sorted_;
};

bool stays_above_ground(const Question& question, const PathLooks& looks, MessageLog& log) {
  std::vector<Look> high;
  for (const Look& look : looks.all()) {
    if (look.height && *look.height >= kLeast * question.metre) high.push_back(look);
  }
  const auto all = static_cast<double>(looks.all().size());
  if (high.size() < 2 || static_cast<double>(high.size()) < kMostHigh * all) return false;
  const Heights heights(high);
  const double usual = heights.at(0.5), spread = heights.spread();
  if (spread > std::max(kSteady * question.metre, usual / 4)) return false;
  log.warn("floats",
           "along the path the model stays " + length_text(usual, question.unit) +
               " above the highest point below it, and touches no ground. Does it fly or hang? If "
               "not, its heights have another zero: an antenna's, an ellipsoid's, or the model's",
           {{"height", usual}, {"spread", spread}});
  return true;
}

/// Warns where the model is higher above the ground on a part of the path than on the rest, where
/// it keeps its height. Which of the two parts is right does not matter.
void check_stretches_above(const Question& question, const PathLooks& looks, MessageLog& log) {
  const double low = looks.usual_height() + kLeast * question.metre;
  const std::vector<LookRun> runs = looks.runs(
      kLeastFloating * question.metre, [&](const Look& l) { return l.height && *l.height >= low; });
  const Heights rest(looks.rest(runs));
  if (runs.empty() || rest.empty() || rest.spread() > kSteadyRest * question.metre) return;
  const ToldStretches told(question, looks, runs);
  const Heights here(looks.of(told.longest));
  auto numbers = told.numbers;
  numbers.insert(numbers.end(), {{"height", here.at(0.5)}, {"height_elsewhere", rest.at(0.5)}});
  log.warn("floats",
           told.where + " the model is " + length_text(here.at(0.5), question.unit) +
               " above the highest point below it, and on the rest of the path " +
               length_text(rest.at(0.5), question.unit) +
               ": a part of the scan may be registered at another height, the ground may be "
               "missing there, or the path leaves it. Compare the heights of path and scan there" +
               told.others,
           numbers);
}

}  // namespace

bool check_height(const Question& question, const PathLooks& looks, MessageLog& log) {
  if (stays_above_ground(question, looks, log)) return true;
  check_stretches_above(question, looks, log);
  return false;
}

}  // namespace clearway
