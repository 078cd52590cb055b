#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/geometry/point_box.hpp"
#include "core/trajectory/motion_tree_ref.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/path_facts.hpp"
#include "search/checks/facts/path_looks.hpp"
#include "search/checks/facts/scan_facts.hpp"
#include "search/checks/question.hpp"
#include "search/checks/warning_stretches.hpp"

namespace clearway {
namespace {

/// At most this many poses are tried.
constexpr std::size_t kTried = 64;
/// The least share of the tried poses that has to meet the scan.
constexpr double kHelps = 0.75;

using Change = Pose (*)(const Pose&);

Pose at(const Pose& pose, double x, double y, double z) {
  Pose out = pose;
  out.translation[0] = x;
  out.translation[1] = y;
  out.translation[2] = z;
  return out;
}

template <int kThousandths, int kDivisor = 1000>
Pose scaled(const Pose& pose) {
  const double factor = static_cast<double>(kThousandths) / kDivisor;
  const double* t = pose.translation;
  return at(pose, t[0] * factor, t[1] * factor, t[2] * factor);
}

Pose inverted(const Pose& pose) {
  Pose out = pose;
  for (int k = 0; k < 3; ++k) {
    out.translation[k] = 0;
    for (int j = 0; j < 3; ++j) {
      out.rotation[3 * k + j] = pose.rotation[3 * j + k];
      out.translation[k] -= pose.rotation[3 * j + k] * pose.translation[j];
    }
  }
  return out;
}

struct Hypothesis {
  Change change;
  const char* sentence;
  bool scales = false;
};

// Changes of the poses in order of preference: the first that fits is named.
constexpr Hypothesis kHypotheses[] = {
    {scaled<1>, "The path fits when its positions are divided by 1000: they seem to be millimetres",
     true},
    {scaled<10>, "The path fits when its positions are divided by 100: they seem to be centimetres",
     true},
    {[](const Pose& p) { return at(p, p.translation[1], p.translation[0], p.translation[2]); },
     "The path fits with x and y swapped: it may have northing before easting"},
    {inverted,
     "The path fits with every pose inverted: the poses seem to map the scan into the "
     "model's frame. They have to map the model into the scan's"},
    {[](const Pose& p) { return at(p, p.translation[2], -p.translation[0], -p.translation[1]); },
     "The path fits when its z points forward and its y down: it seems to be in a camera's frame"},
    {[](const Pose& p) { return at(p, p.translation[0], -p.translation[2], p.translation[1]); },
     "The path fits when its y points up: y and z seem to be swapped"},
    {[](const Pose& p) { return at(p, p.translation[0], p.translation[1], -p.translation[2]); },
     "The path fits with z negated: its z seems to point down"},
    {[](const Pose& p) { return at(p, p.translation[1], p.translation[0], -p.translation[2]); },
     "The path fits with x and y swapped and z negated: it seems to be north, east, down"},
    {scaled<3048, 10000>,
     "The path fits when its positions are multiplied by 0.3048: they seem to be feet", true},
    {scaled<10000, 3048>,
     "The path fits when its positions are divided by 0.3048: the scan seems to be in feet", true},
    {scaled<1000000>,
     "The path fits when its positions are multiplied by 1000: they seem to be kilometres, or the "
     "scan millimetres",
     true}};

class Trial {
 public:
  Trial(const Question& question, const PathCover& cover)
      : question_(question),
        cover_(cover),
        slice_(body_slice(question.model)),
        tried_(spread_poses(question.query.poses.size(), kTried)),
        path_(box_of_positions(question.query.poses)) {}

  std::string remedy() const {
    if (question_.unit != LengthUnit::kDegrees && looks_like_degrees()) {
      return "The path's positions look like degrees. Convert them to the scan's coordinates";
    }
    if (const auto height = height_difference()) {
      return "In plan the path fits, but it lies " + length_text(std::abs(*height), unit()) +
             (*height > 0 ? " above" : " below") +
             " what was scanned: heights may refer to different zeros, such as ellipsoid and sea "
             "level";
    }
    for (const Hypothesis& hypothesis : kHypotheses) {
      if (!helps(hypothesis.change)) continue;
      return hypothesis.sentence + (hypothesis.scales ? doubts(hypothesis.change) : "");
    }
    return shift();
  }

 private:
  LengthUnit unit() const { return question_.unit; }

  template <typename CoversPose>
  bool most_of(CoversPose covers) const {
    std::size_t met = 0;
    for (const std::uint32_t i : tried_) met += covers(question_.query.poses[i]) ? 1 : 0;
    return static_cast<double>(met) >= kHelps * static_cast<double>(tried_.size());
  }

  bool helps(Change change) const {
    if (fits_anywhere(change)) return false;
    return most_of([&](const Pose& pose) { return cover_.covers(moved(slice_, change(pose))); });
  }

  /// Whether the change makes the path so much shorter than the model that it fits at any place,
  /// which is not a hint.
  bool fits_anywhere(Change change) const {
    const Vec3 lo = change(at_corner(path_.lo)).position();
    const Vec3 hi = change(at_corner(path_.hi)).position();
    const double shorter = half_diagonal({lo, hi});
    const double longest = Sides(question_.model).longest;
    constexpr std::size_t kMany = 10;
    if (shorter < longest / 4 && question_.query.poses.size() >= kMany) return true;
    return shorter < half_diagonal(path_) && shorter < longest / 2;
  }

  /// Reasons to doubt a change of scale, because a factor often brings a path near some scanned
  /// place, wherever the path belongs.
  std::string doubts(Change change) const {
    std::string text;
    if (!meets_ground(change))
      text += std::string(". But then the ") + question_.words().mover +
              " would not stand on the ground";
    if (fits_by_shift())
      text += ". Or the path is of another place: a shift by about " + shift_text() +
              " would bring it to the scan's middle";
    return text;
  }

  bool meets_ground(Change change) const {
    const ScanPoints points(question_.cloud);
    const Box body = body_slice(question_.model);
    constexpr double kHigh = 1;  // metres
    try {
      return most_of([&](const Pose& pose) {
        const auto height = height_above_ground(points, body, change(pose));
        return height && *height < kHigh * question_.metre;
      });
    } catch (const InputError&) {
      return true;  // a damaged cell is reported by the search
    }
  }

  static Pose at_corner(const Vec3& corner) {
    return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {corner.x, corner.y, corner.z}};
  }

  bool looks_like_degrees() const {
    const Box& e = question_.environment;
    const bool small = std::max(std::abs(path_.lo.x), std::abs(path_.hi.x)) <= 360 &&
                       std::max(std::abs(path_.lo.y), std::abs(path_.hi.y)) <= 360;
    const bool short_path = path_.hi.x - path_.lo.x < 1 && path_.hi.y - path_.lo.y < 1;
    const bool grid = std::min(std::abs(e.lo.x), std::abs(e.lo.y)) > 10'000;
    return small && short_path && grid && question_.query.poses.size() > 1;
  }

  /// How far the path lies above the scan, if it would meet the scan without regard to height.
  std::optional<double> height_difference() const {
    std::vector<double> heights;
    const bool in_plan = most_of([&](const Pose& pose) {
      Box column = moved(slice_, pose);
      const double bottom = column.lo.z;
      column.lo.z = question_.environment.lo.z;
      column.hi.z = question_.environment.hi.z;
      const auto nearest = cover_.scan().nearest(column, cover_.reach());
      if (nearest.found) heights.push_back(bottom - nearest.block.lo.z);
      return nearest.found;
    });
    if (!in_plan) return std::nullopt;
    const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
    std::nth_element(heights.begin(), middle, heights.end());
    return *middle;
  }

  bool fits_by_shift() const {
    bool fits = true;
    for (int k = 0; k < 3; ++k) {
      const double room = question_.environment.hi[k] - question_.environment.lo[k];
      fits = fits && path_.hi[k] - path_.lo[k] <= room + cover_.far();
    }
    return fits;
  }

  std::string shift_text() const {
    std::string by;
    for (int k = 0; k < 3; ++k) {
      const double shift = question_.environment.centre()[k] - path_.centre()[k];
      const bool is_noise = std::abs(shift) < 0.001 * question_.metre;
      by += (k == 0 ? "" : ", ") + format_digits(is_noise ? 0 : shift, 3);
    }
    return by + " " + unit_name(question_.unit);
  }

  std::string shift() const {
    if (fits_by_shift()) {
      return "A shift of the path by about " + shift_text() +
             " would bring it there. Perhaps one of the two is in local coordinates, or in another "
             "grid";
    }
    return "Compare the frame and the unit of path and scan";
  }

  const Question& question_;
  const PathCover& cover_;
  Box slice_;
  std::vector<std::uint32_t> tried_;
  Box path_;
};

/// A sentence that says how model, path and environment would meet: in another unit, with axes
/// swapped, with the poses inverted, or after a shift. It is a guess for people; nothing is
/// changed. Where no such change helps, it names what to compare.
std::string likely_remedy(const Question& question, const PathCover& cover) {
  return Trial(question, cover).remedy();
}

/// The box around the model's boxes at all poses.
Box swept_box(const Question& question) {
  Box box = moved(question.model, question.query.poses.front());
  for (const Pose& pose : question.query.poses) box = box.united(moved(question.model, pose));
  return box;
}

std::string boxes_text(const Question& question, const Box& swept) {
  const std::string text = "Environment: " + extent_text(question.environment);
  if (question.is_load()) return text + ". Load on its path: about " + extent_text(swept);
  return text + ". Model on its path: " + extent_text(swept) + ". Model: " + question.size();
}

void warn_out_of_reach(const Question& question, const PathCover& cover, const Box& swept,
                       MessageLog& log) {
  const double apart = swept.distance(question.environment);
  const std::string where =
      apart > 0 ? "their boxes are " + question.length(apart) + " apart"
                : "the path crosses the environment's box where nothing was scanned";
  log.warn("out-of-reach",
           "nothing was scanned within " + question.length(cover.reach()) + " of the path: " +
               where + ". " + boxes_text(question, swept) + ". " + likely_remedy(question, cover),
           {{"gap", apart}, {"reach", cover.reach()}});
}

void warn_leaves_scan(const Question& question, const PathCover& cover, const Box& swept,
                      MessageLog& log) {
  const double share =
      static_cast<double>(cover.outside()) / static_cast<double>(cover.looked_at());
  const std::uint32_t first = question.number_of(cover.first_outside());
  const std::uint32_t last = question.number_of(cover.last_outside());
  std::string text = "nothing was scanned within " + question.length(cover.reach()) + " of the " +
                     question.mover() + " at " + share_text(share) + " of the poses, on " +
                     question.length(cover.length_outside()) + " of the " +
                     question.length(cover.length()) + " of the path, between pose " +
                     std::to_string(first) + " and pose " + std::to_string(last) +
                     ": there the result says nothing. ";
  std::vector<PoseRange> stretches = cover.stretches_outside();
  for (auto& [from, to] : stretches) {
    from = question.number_of(from);
    to = question.number_of(to);
  }
  constexpr double kWrongFrame = 0.5;
  if (share >= kWrongFrame) {
    text += boxes_text(question, swept) + ". " + likely_remedy(question, cover);
  } else {
    text += "Scan the rest of the way, or leave these poses out";
  }
  log.warn("leaves-scan", text,
           {{"share", share},
            {"reach", cover.reach()},
            {"length", cover.length_outside()},
            {"path_length", cover.length()},
            {"first_pose", first},
            {"last_pose", last},
            {"chainage_from", question.chainage(cover.first_outside())},
            {"chainage_to", question.chainage(cover.last_outside())}},
           stretches);
}

}  // namespace

void check_reach(const Question& question, const PathCover& cover, MessageLog& log) {
  if (cover.outside() == 0) return;
  const Box swept = swept_box(question);
  if (cover.outside() == cover.looked_at()) {
    warn_out_of_reach(question, cover, swept, log);
  } else {
    warn_leaves_scan(question, cover, swept, log);
  }
}

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
/// The share of looks where the model has to reach below the ground.
constexpr double kMostDeep = 0.5;

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
           "along the path the " + question.mover() + " stays " + question.length(usual) +
               " above the highest point below it, and touches no ground. Does it fly or hang? If "
               "not, the heights of the path are not those of the wheels: they may be those of an "
               "antenna, or count from the ellipsoid and not from the sea, or z = 0 of the " +
               question.mover() + " is not where it stands",
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
  const WarningStretches found(question, looks, runs);
  const Heights here(looks.of(found.longest));
  auto numbers = found.numbers;
  numbers.insert(numbers.end(), {{"height", here.at(0.5)}, {"height_elsewhere", rest.at(0.5)}});
  log.warn("floats",
           found.where + " the " + question.mover() + " is " + question.length(here.at(0.5)) +
               " above the highest point below it, and on the rest of the path " +
               question.length(rest.at(0.5)) +
               ": a part of the scan may be registered at another height, the ground may be "
               "missing there, or the path leaves it. Compare the heights of path and scan there" +
               found.others,
           numbers, found.stretches);
}

}  // namespace

bool check_depth(const Question& question, const PathLooks& looks, MessageLog& log) {
  std::vector<double> depths;
  for (const Look& look : looks.all()) {
    if (look.depth) depths.push_back(*look.depth);
  }
  const double share = static_cast<double>(depths.size()) /
                       static_cast<double>(std::max<std::size_t>(looks.covered(), 1));
  if (!(share > kMostDeep)) return false;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  const double height = question.model.hi.z - question.model.lo.z;
  std::vector<std::pair<std::string, double>> numbers{{"depth", *middle}, {"share", share}};
  if (!question.is_load()) numbers.push_back({"model_height", height});
  const std::string causes =
      question.is_load()
          ? ". The path is too low"
          : ". The model is " + question.length(height) +
                " high. Where the ground or what is below a floor is left out, the answer can be "
                "clear "
                "although the vehicle does not stand there. Either y points up in the model's "
                "file, or its origin is in its middle, or the path is too low";
  log.warn("below-ground",
           "on " + share_text(share) + " of the path the " + question.mover() +
               " reaches below the ground, by " + question.length(*middle) + " on the median" +
               causes,
           std::move(numbers));
  return true;
}

bool check_height(const Question& question, const PathLooks& looks, MessageLog& log) {
  if (stays_above_ground(question, looks, log)) return true;
  check_stretches_above(question, looks, log);
  return false;
}

}  // namespace clearway
