#include "search/checks/facts/path_looks.hpp"

#include <tbb/blocked_range.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "io/files/parallel_loop.hpp"
#include "search/checks/facts/scan_facts.hpp"

namespace clearway {
namespace {

constexpr std::size_t kMostLooks = 1024, kFewLooks = 32, kFewestLooks = 8;
/// A run consists of at least this many looks.
constexpr std::size_t kLooksOfRun = 3;
/// Looks are taken this many times while the model moves on by its own length.
constexpr double kLooksOfModel = 4;
// Numbers of points; fewer may be noise. A reflecting ground has some points far below it.
constexpr std::uint64_t kSurelyBelow = 10, kFewestBelow = 3;
constexpr std::uint64_t kSurelyBeside = 3;
constexpr double kPartOfGround = 1.0 / 32;
// The following lengths are in metres.
/// By how much a box beside the model is extended along the path, so that it is long enough for the
/// scan to have points in it.
constexpr double kBesideMargin = 1;
constexpr double kAbove = 3;
/// How far below the model's lowest point a surface counts as its ground.
constexpr double kUnder = 1.5;
/// Bounds of the distance between looks, which short and long vehicles reach.
constexpr double kClosestApart = 0.5, kFarthestApart = 2;
/// How far around a scanner on a tripod or a vehicle nothing is scanned, because it stands there.
/// Below a model that is smaller than this, ground may be expected only at the model's edge.
constexpr double kScannerShadow = 1;
/// Least width in metres of the column below a model in which points of the ground are looked for;
/// it is wider than a model that is smaller than this.
constexpr double kNarrowest = 1;

/// A range of distances beside the model and the least height above the model's bottom, in metres.
/// A ground that falls or rises across the path by 4 degrees stays below the bands.
struct Band {
  double from, to, height;
};
constexpr Band kBands[] = {{0, 4, 0.3}, {4, 10, 0.75}, {10, kLooksBeside, 1.5}};

/// The inner part of a slice of the model. Walls and kerbs beside the model do not count there, nor
/// do wires that its upper part meets.
Box inner_body(const Box& model, double metre) {
  constexpr double kInner = 0.6;
  Box body = body_slice(model);
  const Vec3 centre = body.centre();
  for (int k = 0; k < 2; ++k) {
    const double half = std::max(kInner * (body.hi[k] - body.lo[k]), kNarrowest * metre) / 2;
    body.lo[k] = centre[k] - half;
    body.hi[k] = centre[k] + half;
  }
  body.hi.z = body.lo.z + (body.hi.z - body.lo.z) / 3;
  return body;
}

/// Looks around the model at single poses. Each thread has one of its own, because the points that
/// it reads are kept.
class Looking {
 public:
  Looking(const Question& question, const PathCover& cover)
      : question_(question),
        cover_(cover),
        points_(question.cloud),
        slice_(body_slice(question.model)),
        inner_(inner_body(question.model, question.metre)) {
    if (question.is_load()) inner_.lo.z = question.lowest_of_load();
  }

  /// look.covered is known already.
  void at(Look& look) const {
    const Pose& pose = question_.query.poses[look.pose];
    look.height = height_above_ground(points_, inner_, pose);
    if (!look.covered) return;
    const Box ground = below(pose);
    look.below = points_.has(ground, pose, surely_below(ground, pose));
    look.depth = depth(pose);
    look.left = is_beside(1, pose);
    look.right = is_beside(-1, pose);
  }

 private:
  /// A metre of the scan in the model's frame at a pose.
  double metre(const Pose& pose) const { return question_.metre / scale_of(pose); }

  double spacing(const Pose& pose) const {
    return cover_.scan().typical_block() / kSpacingsOfBlock / scale_of(pose);
  }

  /// The number of points in the box that are surely ground and not noise: a fraction of those that
  /// ground on its whole area would have. The floor of a tunnel may be narrow, and around a scanner
  /// that stands still points are scarce where others are dense.
  std::uint64_t surely_below(const Box& ground, const Pose& pose) const {
    const double area = (ground.hi.x - ground.lo.x) * (ground.hi.y - ground.lo.y);
    const double part = kPartOfGround * area / (spacing(pose) * spacing(pose));
    return part >= kSurelyBelow  // large also where all points are at the same place
               ? kSurelyBelow
               : std::max(kFewestBelow, static_cast<std::uint64_t>(part));
  }

  /// Widens the box by `margin` on both sides of an axis, and farther where the scan has too few
  /// points for such a box.
  void widen(Box& box, int axis, double margin, const Pose& pose) const {
    const double half = (box.hi[axis] - box.lo[axis]) / 2;
    const double expected = cover_.scan().typical_block() / 4 / scale_of(pose);
    const double more = std::max(margin, expected - half);
    box.lo[axis] -= more;
    box.hi[axis] += more;
  }

  /// The column below the slice, wider by one spacing of the scan and no more, because ground
  /// beside the model says nothing about what it runs over. The column reaches out of the shadow
  /// of a scanner.
  Box below(const Pose& pose) const {
    Box box = slice_;
    for (int k = 0; k < 2; ++k) {
      const double to_shadow = kScannerShadow * metre(pose) - (box.hi[k] - box.lo[k]) / 2;
      widen(box, k, std::max(spacing(pose), to_shadow), pose);
    }
    box.lo.z = points_.bottom_of_scan(box, pose);
    box.hi.z = question_.model.lo.z + kDeepest * metre(pose);
    return box;
  }

  /// Look::depth. Where there is ground at the height of the model's lowest point, as below every
  /// sound vehicle, some of it is found at once, and nothing else is read. It is sought as widely
  /// as for Look::below, and the surface inside the model only in its inner part, where no
  /// platform, wall or tree beside the path is taken for the ground.
  std::optional<double> depth(const Pose& pose) const {
    constexpr double kUpright = 0.7;  // the cosine of 45 degrees
    if (!(pose.rotation[8] >= kUpright * scale_of(pose))) return std::nullopt;
    Box under = below(pose);
    under.lo.z = question_.model.lo.z - kUnder * metre(pose);
    under.hi.z = question_.model.lo.z + kDeepest * metre(pose);
    Box inside = inner_;
    inside.lo.z = under.hi.z;
    inside.hi.z = question_.model.hi.z;
    if (inside.hi.z <= inside.lo.z) return std::nullopt;
    if (points_.has(under, pose, surely_below(under, pose))) return std::nullopt;
    std::vector<double> heights;
    points_.visit(inside, pose, [&](const Vec3& p, auto...) {
      heights.push_back(p.z);
      return true;
    });
    if (heights.size() < surely_below(inside, pose)) return std::nullopt;
    constexpr std::size_t kShareBelow = 10;  // a tenth of the points lies lower
    const auto surface =
        heights.begin() + static_cast<std::ptrdiff_t>((heights.size() - 1) / kShareBelow);
    std::nth_element(heights.begin(), surface, heights.end());
    return (*surface - question_.model.lo.z) * scale_of(pose);
  }

  /// Whether the scan has points beside the model at a pose. side: 1 for the left of a model whose
  /// longer side points forward, -1 for its right.
  bool is_beside(int side, const Pose& pose) const {
    return std::ranges::any_of(kBands, [&](const Band& band) {
      return points_.has(beside(side, band, pose), pose, kSurelyBeside);
    });
  }

  Box beside(int side, const Band& band, const Pose& pose) const {
    const Box& model = question_.model;
    Box box = slice_;
    const int across = model.hi.x - model.lo.x >= model.hi.y - model.lo.y ? 1 : 0;
    const bool upwards = (side > 0) == (across == 1);
    const double near = band.from * metre(pose), far = band.to * metre(pose);
    const double edge = upwards ? box.hi[across] : box.lo[across];
    box.lo[across] = upwards ? edge + near : edge - far;
    box.hi[across] = upwards ? edge + far : edge - near;
    widen(box, 1 - across, kBesideMargin * metre(pose), pose);
    box.lo.z += band.height * metre(pose);
    box.hi.z += kAbove * metre(pose);
    return box;
  }

  const Question& question_;
  const PathCover& cover_;
  ScanPoints points_;
  Box slice_, inner_;
};

/// Looks at the poses where a point of the model has moved on by at least `apart` since the last
/// one, straight from one look to the next.
std::vector<Look> looks_every(double apart, const std::vector<Pose>& poses, const Vec3& point) {
  std::vector<Look> looks{{0, 0}};
  Vec3 at = transform(poses.front(), point);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Vec3 here = transform(poses[i], point);
    const double way = std::sqrt(squared_distance(at, here));
    if (!(way >= apart)) continue;
    looks.push_back({static_cast<std::uint32_t>(i), looks.back().along + way});
    at = here;
  }
  return looks;
}

/// Looks evenly spread over the indices of the poses, for a model that hardly moves and for poses
/// that jump beyond all measure.
std::vector<Look> looks_by_number(const std::vector<Pose>& poses, const Vec3& point) {
  std::vector<Look> looks;
  Vec3 at = transform(poses.front(), point);
  double along = 0;
  for (const std::uint32_t i : spread_poses(poses.size(), kFewLooks)) {
    const Vec3 here = transform(poses[i], point);
    along += std::sqrt(squared_distance(at, here));
    looks.push_back({i, along});
    at = here;
  }
  return looks;
}

std::vector<Look> chosen_looks(const Question& question) {
  const std::vector<Pose>& poses = question.query.poses;
  const Vec3 centre = question.model.centre();
  const double longest = Sides(question.model).longest;
  double apart = std::clamp(longest / kLooksOfModel, kClosestApart * question.metre,
                            kFarthestApart * question.metre);
  std::vector<Look> looks = looks_every(apart, poses, centre);
  constexpr double kFarthest = 1e12;  // metres: no path is so long
  while (looks.size() > kMostLooks && apart < kFarthest) {
    constexpr double kFewer = 1.01;  // so that few rounds are needed
    apart *= kFewer * static_cast<double>(looks.size()) / static_cast<double>(kMostLooks);
    looks = looks_every(apart, poses, centre);
  }
  constexpr double kHalvings = 16;
  const double closest = apart / kHalvings;
  while (looks.size() < kFewLooks && apart > closest) {
    apart /= 2;
    looks = looks_every(apart, poses, centre);
  }
  const bool is_usable = looks.size() >= kFewestLooks && looks.size() <= kMostLooks;
  return is_usable ? looks : looks_by_number(poses, centre);
}

}  // namespace

PathLooks::PathLooks(const Question& question, const PathCover& cover)
    : looks_(chosen_looks(question)), reach_(cover.reach()) {
  const Box slice = body_slice(question.model);
  for (Look& look : looks_) {
    look.covered = cover.covers(moved(slice, question.query.poses[look.pose]));
  }
  // Looks that follow each other read the same cells, so a thread takes several of them.
  constexpr std::size_t kLooksOfTask = 16;
  using Range = tbb::blocked_range<std::size_t>;
  const auto look = [&](const Range& part) {
    const Looking looking(question, cover);
    for (std::size_t i = part.begin(); i < part.end(); ++i) looking.at(looks_[i]);
  };
  for_each_parallel(Range(0, looks_.size(), kLooksOfTask), look, tbb::simple_partitioner());
}

double PathLooks::apart() const {
  return looks_.size() < 2 ? 0 : looks_.back().along / static_cast<double>(looks_.size() - 1);
}

std::size_t PathLooks::covered() const {
  return static_cast<std::size_t>(std::ranges::count_if(looks_, &Look::covered));
}

double PathLooks::share(const std::function<bool(const Look&)>& holds) const {
  const std::size_t all = covered();
  if (all == 0) return 0;
  const auto count =
      std::ranges::count_if(looks_, [&](const Look& look) { return look.covered && holds(look); });
  return static_cast<double>(count) / static_cast<double>(all);
}

double PathLooks::usual_height() const {
  std::vector<double> heights;
  for (const Look& look : looks_) {
    if (look.height) heights.push_back(*look.height);
  }
  if (heights.empty()) return 0;
  const auto quarter = heights.begin() + static_cast<std::ptrdiff_t>((heights.size() - 1) / 4);
  std::nth_element(heights.begin(), quarter, heights.end());
  return *quarter;
}

std::vector<LookRun> PathLooks::runs(double least,
                                     const std::function<bool(const Look&)>& holds) const {
  std::vector<LookRun> runs;
  const auto is_uncovered = [&](std::size_t i) { return i < looks_.size() && !looks_[i].covered; };
  std::size_t first = 0;
  for (std::size_t i = 0; i <= looks_.size(); ++i) {
    if (i < looks_.size() && looks_[i].covered && holds(looks_[i])) continue;
    const int rims = int{first > 0 && is_uncovered(first - 1)} + int{is_uncovered(i)};
    if (i >= first + kLooksOfRun && length({first, i - 1}) >= least + rims * reach_) {
      runs.push_back({first, i - 1});
    }
    first = i + 1;
  }
  return runs;
}

std::vector<Look> PathLooks::rest(const std::vector<LookRun>& runs) const {
  std::vector<Look> rest;
  std::size_t from = 0;
  for (const LookRun& run : runs) {
    rest.insert(rest.end(), looks_.begin() + static_cast<std::ptrdiff_t>(from),
                looks_.begin() + static_cast<std::ptrdiff_t>(run.first));
    from = run.last + 1;
  }
  rest.insert(rest.end(), looks_.begin() + static_cast<std::ptrdiff_t>(from), looks_.end());
  return rest;
}

}  // namespace clearway
