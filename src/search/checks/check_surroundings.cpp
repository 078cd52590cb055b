#include <algorithm>
#include <functional>
#include <utility>

#include "core/geometry/angle.hpp"
#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/path_looks.hpp"
#include "search/checks/facts/scan_facts.hpp"
#include "search/checks/question.hpp"
#include "search/checks/warning_stretches.hpp"

namespace clearway {
namespace {

// The following numbers are shares of the looks.
constexpr double kMissing = 0.5;
constexpr double kNowhere = 0.1;
constexpr double kSomeGround = 0.2;
constexpr double kOneSideOnly = 0.2, kOtherSide = 0.8;
/// Least share of the looks outside the stretches.
constexpr double kElsewhere = 0.8;
/// A stretch without walls has to be this many times longer than the gaps that are usual on the
/// path.
constexpr double kUnusuallyLong = 3;
/// Least length of a stretch with nothing beside it, as a share of the path.
constexpr double kPartBeside = 0.05;
/// Least lengths of a stretch along the path in metres. A scanner on a tripod leaves a shadow of up
/// to 4 m, in which a slice of the model hardly moves, and streets open to side roads.
constexpr double kLeastBelow = 3, kLeastBeside = 20;
/// A look this many metres above the usual height or more counts for the warning "floats".
constexpr double kFloats = 0.5;
/// The number `side` of the warning "one-side", by the side on which nothing was scanned.
constexpr double kLeftSide = 1, kRightSide = -1;

const char* word_of_side(double number) { return number == kLeftSide ? "left" : "right"; }

bool has_below(const Look& look) { return look.below; }
/// Whether there is ground below the model, or inside it where the path is too low.
bool has_ground(const Look& look) { return look.below || look.depth; }
bool has_left(const Look& look) { return look.left; }
bool has_right(const Look& look) { return look.right; }
bool has_either(const Look& look) { return look.left || look.right; }
bool has_both(const Look& look) { return look.left && look.right; }

std::string beside_text(const Question& question) {
  return "within " + question.length(kLooksBeside * question.metre) + " and at its height";
}

/// stretches: where nothing was scanned below, if there is ground on another part of the path.
void warn_nothing_below(const Question& question, const PathLooks& looks,
                        std::vector<PoseRange> stretches, MessageLog& log) {
  const double share = 1 - looks.share(has_below);
  log.warn("nothing-below",
           "on " + share_text(share) + " of the path nothing was scanned below the " +
               question.mover() +
               ". Does the path run below the "
               "ground, or is it in another place? Did the scanner leave out what was near it? If "
               "you removed the ground on purpose, this is all right",
           {{"share", share}}, std::move(stretches));
}

void warn_nothing_beside(const Question& question, const PathLooks& looks, MessageLog& log) {
  const double share = 1 - std::max(looks.share(has_left), looks.share(has_right));
  log.warn("nothing-beside",
           "on " + share_text(share) + " of the path nothing was scanned beside the " +
               question.mover() + ", " + beside_text(question) +
               ". Was only the ground scanned, or does the path run above a "
               "roof? Compare the heights of path and scan",
           {{"share", share}});
}

void warn_one_side(const Question& question, const PathLooks& looks, MessageLog& log) {
  const double left = looks.share(has_left), right = looks.share(has_right);
  const double number = left < right ? kLeftSide : kRightSide;
  const std::string side = word_of_side(number);
  const double empty = 1 - std::min(left, right);
  log.warn("one-side",
           "on " + share_text(empty) + " of the path nothing was scanned on the " + side +
               " of the " + question.mover() + ", " + beside_text(question) +
               ". On the other side there is something. Was the " + side + " side scanned?",
           {{"share", empty}, {"left", left}, {"right", right}, {"side", number}});
}

/// Looks for what a stretch of the path lacks and the rest has. What is missing below the model
/// explains what is missing beside it. Heights, which "floats" reports, explain it too.
class Stretches {
 public:
  Stretches(const Question& question, const PathLooks& looks)
      : question_(question),
        looks_(looks),
        high_(looks.usual_height() + kFloats * question.metre) {}

  /// Where nothing was scanned below the model, for a path of which most has no ground. Without
  /// ground anywhere, it was probably removed on purpose.
  std::vector<PoseRange> without_ground() const {
    const auto runs = runs_without(has_ground);
    if (runs.empty() || looks_.share(has_ground) < kSomeGround) return {};
    return WarningStretches(question_, looks_, runs).stretches;
  }

  /// For a model that is in the ground, which on a sound stretch is therefore inside it.
  void check_holes(MessageLog& log) const {
    warn("nothing-below", runs_without(has_ground),
         " no ground was scanned below the " + mover() +
             " or inside it: the scan may have a hole there. Then what stands there is missing too",
         log);
  }

  void check_below(MessageLog& log) const {
    warn("nothing-below", runs_without(has_below),
         " nothing was scanned below the " + mover() +
             ", though there is ground below it on the rest of the path: the scan may have a hole "
             "there, or a part of it may be registered at another height. Then what stands there "
             "is missing too. If you removed the ground on purpose, this is all right",
         log);
  }

  void check_beside(MessageLog& log) const {
    const auto runs =
        unusual_runs([&](const Look& look) { return is_on_ground(look) && !has_either(look); });
    if (!is_usual(has_either, runs)) return;
    warn("nothing-beside", runs,
         " nothing was scanned beside the " + mover() + ", " + beside_text(question_) +
             ", though there is something on the rest of the path. Was only the ground scanned "
             "there? If the site is open there, this is all right",
         log);
  }

  void check_sides(MessageLog& log) const {
    const std::vector<LookRun> left = empty_sides(has_left, has_right);
    const std::vector<LookRun> right = empty_sides(has_right, has_left);
    std::vector<LookRun> all = left;
    all.insert(all.end(), right.begin(), right.end());
    std::ranges::sort(all, {}, &LookRun::first);
    if (!is_usual(has_both, all)) return;
    warn_one_side(left, kLeftSide, log);
    warn_one_side(right, kRightSide, log);
  }

 private:
  std::string mover() const { return question_.words().mover; }

  /// Warns of runs, unless there are none. text: follows the words that say where they are.
  /// numbers: of the warning, besides those of the runs.
  void warn(WarningCode code, const std::vector<LookRun>& runs, const std::string& text,
            MessageLog& log,
            const std::vector<std::pair<std::string, double>>& numbers = {}) const {
    if (runs.empty()) return;
    WarningStretches found(question_, looks_, runs);
    found.numbers.insert(found.numbers.end(), numbers.begin(), numbers.end());
    log.warn(code, found.where + text + found.others, found.numbers, found.stretches);
  }

  void warn_one_side(const std::vector<LookRun>& runs, double number, MessageLog& log) const {
    const std::string side = word_of_side(number);
    warn("one-side", runs,
         " nothing was scanned on the " + side + " of the " + mover() + ", " +
             beside_text(question_) +
             ". On the other side there is something, and on the rest of the path on both sides. "
             "Was the " +
             side + " side scanned there? If the site is open there, this is all right",
         log, {{"side", number}});
  }

  /// Runs of looks for which `has` is false, of a length that matters below the model.
  std::vector<LookRun> runs_without(bool (*has)(const Look&)) const {
    return looks_.runs(kLeastBelow * question_.metre, std::not_fn(has));
  }

  /// Runs that are unusually long for this path. Beside the path there are gaps, such as side
  /// roads, and those of usual length do not count.
  std::vector<LookRun> unusual_runs(const std::function<bool(const Look&)>& holds) const {
    const double least =
        std::max(kLeastBeside * question_.metre, kPartBeside * looks_.all().back().along);
    double usual = 0;
    for (const LookRun& run : looks_.runs(0, holds)) {
      if (looks_.length(run) < least) usual = std::max(usual, looks_.length(run));
    }
    return looks_.runs(std::max(least, kUnusuallyLong * usual), holds);
  }

  /// Unusually long runs of looks with nothing on one side, but mostly something on the other.
  std::vector<LookRun> empty_sides(bool (*one)(const Look&), bool (*other)(const Look&)) const {
    std::vector<LookRun> runs =
        unusual_runs([&](const Look& look) { return is_on_ground(look) && !one(look); });
    std::erase_if(runs, [&](const LookRun& run) {
      const std::vector<Look> looks = looks_.of(run);
      return static_cast<double>(std::ranges::count_if(looks, other)) <
             kOtherSide * static_cast<double>(looks.size());
    });
    return runs;
  }

  bool is_on_ground(const Look& look) const {
    return look.below && !(look.height && *look.height >= high_);
  }

  /// Whether `has` holds for most looks outside the runs, so that it is remarkable where a run
  /// lacks it.
  bool is_usual(bool (*has)(const Look&), const std::vector<LookRun>& runs) const {
    std::vector<Look> rest = looks_.rest(runs);
    std::erase_if(rest, [](const Look& look) { return !look.covered; });
    return static_cast<double>(std::ranges::count_if(rest, has)) >=
           kElsewhere * static_cast<double>(rest.size());
  }

  const Question& question_;
  const PathLooks& looks_;
  double high_;
};

/// Notes how long a stretch has to be to be noticed, where the path is long or its poses are far
/// apart.
void tell_resolution(const Question& question, const PathLooks& looks, MessageLog& log) {
  const double longest = Sides(question.model).longest;
  const double resolved = 2 * looks.apart();
  if (!(resolved > std::max(kLeastBelow * question.metre, longest))) return;
  log.note("the scan below and beside the " + question.mover() + " is inspected every " +
           question.length(looks.apart()) +
           " of the path: a stretch that is not scanned and shorter than " +
           question.length(resolved) + " can stay without a warning");
}

}  // namespace

void check_holes(const Question& question, const PathLooks& looks, MessageLog& log) {
  if (2 * looks.covered() < looks.all().size()) return;
  Stretches(question, looks).check_holes(log);
}

void check_surroundings(const Question& question, const PathLooks& looks, bool floats,
                        MessageLog& log) {
  if (2 * looks.covered() < looks.all().size()) return;
  const double left = looks.share(has_left), right = looks.share(has_right);
  const double less = std::min(left, right), more = std::max(left, right);
  const Stretches stretches(question, looks);
  tell_resolution(question, looks, log);
  if (looks.share(has_below) < kMissing) {
    warn_nothing_below(question, looks, stretches.without_ground(), log);
    return;
  }
  stretches.check_below(log);
  if (more < kNowhere && !floats) {
    warn_nothing_beside(question, looks, log);
    return;
  }
  if (!floats) stretches.check_beside(log);
  if (less < kOneSideOnly && more > kOtherSide) {
    warn_one_side(question, looks, log);
  } else if (!floats) {
    stretches.check_sides(log);
  }
}

namespace {

constexpr double kLargestRadius = 10;  ///< metres
/// The least number of steps of the coordinates in a radius.
constexpr double kSteps = 10;

void warn_of_large_radius(const Question& question, MessageLog& log) {
  const double radius = question.query.radius, longest = Sides(question.model).longest;
  const bool above_model = longest > 0 && radius > longest;
  if (!above_model && radius <= kLargestRadius * question.metre) return;
  log.warn("radius-size",
           "the " + std::string(question.words().distance) + " is " + question.length(radius) +
               ", the " + question.mover() + "'s longest side " + question.length(longest) +
               ". Is the " + question.words().distance +
               " meant in another unit, such as millimetres?",
           {{"radius", radius}, {"model_longest", longest}});
}

/// A step of coordinates is known to 1 %.
constexpr double kExact = 0.99;
/// Metres: whole centimetres are usual, and a coarser step causes "lost-digits" at the conversion.
constexpr double kUsualStep = 0.01 * (1 + 1e-6);

/// Compares the radius with the steps of the coordinates: those of the store, or the coarser ones
/// to which the scans were rounded before. One of the two warnings says it.
void check_steps(const Question& question, MessageLog& log) {
  const double* scale = question.cloud.quantisation().scale;
  // A section without a margin depends on its cells.
  const bool is_touching = question.is_load() && question.query.radius == 0;
  const double radius = is_touching ? question.section->cell : question.query.radius;
  double step = *std::max_element(scale, scale + 3);
  std::string axes, steps;
  for (std::size_t k = 0; k < 3; ++k) {
    if (question.steps[k] > kUsualStep * question.metre) step = std::max(step, question.steps[k]);
    if (question.steps[k] < kExact * radius || question.steps[k] == 0) continue;
    axes += std::string(axes.empty() ? "" : ", ") + "xyz"[k];
    steps += (steps.empty() ? "" : ", ") + question.length(question.steps[k]);
  }
  const std::string distance = is_touching ? "side of a cell" : question.words().distance;
  if (!axes.empty()) {
    log.warn("coarse-digits",
             "the scan's coordinates " + axes + " come in steps of " + steps + ", and the " +
                 distance + " is " + question.length(radius) +
                 ": a point may be farther than that from where it was measured, so that what "
                 "stands in the way can be missed. Export the scan with more digits, or take a " +
                 distance + " above the steps",
             {{"radius", radius}, {"step", step}});
    return;
  }
  // A radius of ten steps as typed causes no warning because of its rounding.
  if (is_touching || radius >= kSteps * step * (1 - 1e-9)) return;
  log.warn("fine-radius",
           "the " + distance + " is " + question.length(radius) +
               ", the scan's coordinates are in steps of " + question.length(step) +
               ": rounding decides which points collide. Check the " +
               (question.is_load() ? "margin's" : "radius'") +
               " unit, or store the scan in finer steps",
           {{"radius", radius}, {"step", step}});
}

/// Warns of a scan whose points are far apart, because it says nothing about what lies between
/// them. A radius bridges gaps in walls and ground, but not those in which a post stands.
void check_coarse_scan(const Question& question, MessageLog& log) {
  const double spacing = question.cloud.typical_block() / kSpacingsOfBlock;
  const double radius = question.query.radius, metre = question.metre;
  const double width = Sides(question.model).middle;
  // The following lengths are in metres.
  constexpr double kTold = 0.1, kWide = 0.3, kVeryWide = 0.5;
  const bool is_wide = spacing > 5 * radius && spacing > std::min(width / 5, kWide * metre);
  const bool is_very_wide = spacing > 2 * radius && spacing > kVeryWide * metre;
  if (!is_wide && !is_very_wide) {
    if (spacing > 2 * radius && spacing > kTold * metre) {
      log.note("the scan's points are typically " + question.length(spacing) +
               " apart: what is narrower can stand between them, where the scan does not show it");
    }
    return;
  }
  log.warn("coarse-scan",
           "the scan's points are typically " + question.length(spacing) + " apart. The " +
               question.words().distance + " is " + question.length(question.query.radius) +
               " and the " + question.mover() + (question.is_load() ? " may be " : " ") +
               question.length(width) +
               " wide: it can pass between the points of what stands in its way. Take a denser "
               "scan or a larger " +
               question.words().distance + ", and check that scan and " +
               (question.is_load() ? "path" : "model") + " have one unit",
           {{"scan_spacing", spacing}, {"radius", radius}, {"model_width", width}});
}

}  // namespace

void check_errors(const QueryParameters& query, MessageLog& log) {
  constexpr double kLeastSigmas = 1;
  constexpr double kLeastAngle = 0.001 * kDegree;
  const double angle = query.error_angle.value_or(0);
  const double deviations = std::max({query.error_scan.value_or(0), query.error_pose.value_or(0),
                                      query.error_registration.value_or(0), angle});
  if (query.sigmas < kLeastSigmas && deviations > 0) {
    log.warn("few-sigmas",
             "the error budget counts " + format_digits(query.sigmas, 3) +
                 " standard deviations, which most errors exceed, so that it says little about "
                 "what is certain. Usual are 2 or 3. Is it an error in metres?",
             {{"sigmas", query.sigmas}});
  }
  if (angle > 0 && angle < kLeastAngle) {
    log.warn("small-error-angle",
             "the standard deviation of the angles is " + format_digits(angle / kDegree, 3) +
                 " degrees, which no vehicle's rotation is known to. Was an angle in radians taken "
                 "for one in degrees?",
             {{"degrees", angle / kDegree}});
  }
}

void check_radius(const Question& question, MessageLog& log) {
  warn_of_large_radius(question, log);
  check_steps(question, log);
  if (question.cloud.point_count() >= kBlockPoints) check_coarse_scan(question, log);
}

}  // namespace clearway
