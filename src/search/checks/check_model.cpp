#include <algorithm>
#include <cmath>
#include <vector>

#include "clearway/error.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/point_box.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/model_looks.hpp"
#include "search/checks/facts/path_facts.hpp"
#include "search/checks/facts/scan_facts.hpp"
#include "search/checks/question.hpp"
#include "search/checks/single_floats.hpp"

namespace clearway {
namespace {

// Lengths in metres: above the longest trains and cranes, and below anything that a query is asked
// about.
constexpr double kLargest = 200;
constexpr double kSmallest = 0.01;
/// On a path longer than kLongWay no vehicle is shorter than kSmallVehicle.
constexpr double kSmallVehicle = 0.5;
constexpr double kLongWay = 10;
/// The factor, less 1, by which a pose may stretch the model because of noise of its numbers.
constexpr double kStretch = 0.01;
/// No vehicle is both wider and higher than this.
constexpr double kThickest = 30;

struct ModelUnit {
  double metres;
  const char* name;
};
constexpr ModelUnit kUnits[] = {{kMetresPerMillimetre, "millimetres"},
                                {kMetresPerCentimetre, "centimetres"},
                                {kMetresPerInch, "inches"},
                                {kMetresPerFoot, "feet"}};

/// A sentence with the model's size in each unit in which it would be as large as a vehicle,
/// because several may be meant. A unit in which the model would be as thin as a sheet, as a train
/// would be in centimetres, is left out.
std::string unit_guess(const Question& question) {
  constexpr double kShortVehicle = 0.3, kLongVehicle = 60, kThinnest = 0.1;
  const Sides sides(question.model);
  std::string text;
  for (const ModelUnit& unit : kUnits) {
    const double metres = sides.longest * unit.metres;
    if (metres < kShortVehicle || metres > kLongVehicle) continue;
    if (sides.shortest > 0 && sides.shortest * unit.metres < kThinnest) continue;
    Box box = question.model;
    for (int k = 0; k < 3; ++k) {
      box.lo[k] *= unit.metres;
      box.hi[k] *= unit.metres;
    }
    text += std::string(text.empty() ? "In " : ", in ") + unit.name +
            (text.empty() ? " it would be " : " ") + size_text(box, LengthUnit::kMetre);
  }
  return text.empty() ? "Check its unit" : text;
}

/// Whether the longest side of what moves is too short for anything that a query is asked about. A
/// single place, or a load without length, has no side whose unit could be wrong.
bool is_tiny(double longest, double metre) { return longest > 0 && longest < kSmallest * metre; }

/// The range of a load along the vehicle is the only side of it that is known.
void warn_of_length(const Question& question, MessageLog& log) {
  const double length = question.section->front - question.section->rear;
  const double environment = Sides(question.environment).longest;
  const bool tiny = is_tiny(length, question.metre);
  if (!tiny && length <= kLargest * question.metre && length <= environment) return;
  log.warn(tiny ? WarningCode("model-unit") : WarningCode("model-size"),
           "the load is " + question.length(length) + " long, the environment " +
               size_text(question.environment, question.unit) +
               ". Check the unit of its range along the vehicle",
           {{"model_longest", length}, {"environment_longest", environment}});
}

/// Warns of a model whose unit is probably another one, which puts the answer in doubt, or else of
/// one that is only larger or smaller than most vehicles.
void warn_of_size(const Question& question, MessageLog& log) {
  if (question.is_load()) return warn_of_length(question, log);
  const Sides model(question.model), environment(question.environment);
  const double metre = question.metre;
  const bool larger = model.longest > environment.longest;
  const bool thick = model.shortest > kThickest * metre;
  const bool tiny = is_tiny(question.longest, metre);
  const bool huge = model.longest > kLargest * metre || thick;
  const double way = path_length(question.query.poses);
  const bool small = question.longest < kSmallest * metre ||
                     (question.longest < kSmallVehicle * metre && way > kLongWay * metre);
  if (!larger && !huge && !small) return;
  std::string text = "the model is " + question.size() + ", the environment " +
                     size_text(question.environment, question.unit) + ". ";
  if (huge) text += unit_guess(question) + (larger ? ". " : "");
  if (larger) text += "Are model and environment swapped?";
  if (!larger && !huge) {
    text += "The path is " + question.length(way) +
            " long. So small a model touches hardly anything: check its unit, that of the scan, "
            "and that the model is whole";
  }
  log.warn(thick || tiny ? WarningCode("model-unit") : WarningCode("model-size"), text,
           {{"model_longest", model.longest}, {"environment_longest", environment.longest}});
}

/// Whether a pose leaves the model where it stands. If one does, the poses are motions of a model
/// that lies in the scan's coordinates.
bool is_rest(const Pose& pose, double metre) {
  constexpr double kNoise = 1e-3;
  for (int k = 0; k < 9; ++k) {
    if (std::abs(pose.rotation[k] - (k % 4 == 0 ? 1 : 0)) > kNoise) return false;
  }
  const Vec3 t = pose.position();
  return std::sqrt(squared_length(t.x, t.y, t.z)) <= kNoise * metre;
}

void warn_of_origin(const Question& question, MessageLog& log) {
  const Vec3 centre = question.model.centre();
  const double away = std::sqrt(squared_length(centre.x, centre.y, centre.z));
  const double longest = Sides(question.model).longest;
  if (!(away > 10 * longest + 10 * question.metre)) return;
  const auto rests = [&](const Pose& pose) { return is_rest(pose, question.metre); };
  if (std::ranges::any_of(question.query.poses, rests)) return;
  log.warn("model-origin",
           question.is_load()
               ? "the load lies " + question.length(away) +
                     " from the origin of its frame, which a pose turns it about. Its range counts "
                     "from the origin of the vehicle"
               : "the model's points lie " + question.length(away) +
                     " from the origin of their frame, at " + extent_text(question.model) +
                     ". A pose turns and moves the model about that origin. Is the model in the "
                     "scan's coordinates? Move its reference point to 0, 0, 0",
           {{"distance", away}, {"model_longest", longest}});
}

void warn_of_same(const Question& question, MessageLog& log) {
  if (question.points.size() != question.cloud.point_count()) return;
  if (question.points.size() == 1) return;
  for (int k = 0; k < 3; ++k) {
    const double noise =
        2 * question.cloud.quantisation().scale[k] + 1e-6 * std::abs(question.environment.hi[k]);
    if (std::abs(question.model.lo[k] - question.environment.lo[k]) > noise) return;
    if (std::abs(question.model.hi[k] - question.environment.hi[k]) > noise) return;
  }
  log.warn("model-is-environment",
           "the model has " + format_count(question.points.size()) +
               " points, as many as the environment, and the same box: is it the scan itself?",
           {{"points", static_cast<double>(question.points.size())}});
}

/// Warns where poses scale the model. Poses that are not rigid were allowed, perhaps for another
/// reason.
void warn_of_scale(const Question& question, MessageLog& log) {
  double least = kInfinity, most = 0;
  for (const Pose& pose : question.query.poses) {
    const double scale = scale_of(pose);
    least = std::min(least, scale);
    most = std::max(most, scale);
  }
  if (least > 1 - kStretch && most < 1 + kStretch) return;
  Box box = question.model;
  for (int k = 0; k < 3; ++k) {
    box.lo[k] *= most;
    box.hi[k] *= most;
  }
  const bool one = most - least < kStretch * most;
  log.warn("scaled-poses",
           "the poses scale the model by " + format_digits(least, 3) +
               (one ? std::string() : " to " + format_digits(most, 3)) + ": in the scan it is " +
               size_text(box, question.unit) + ", not " + question.size() +
               ". The motion of a vehicle has no scale. Divide the rotations by it, or check the "
               "unit of the poses",
           {{"least", least}, {"most", most}});
}

/// Warns where poses mirror the model. Such matrices are accepted only where poses need not be
/// rigid.
void warn_of_mirror(const Question& question, MessageLog& log) {
  std::vector<std::uint32_t> mirrored;
  for (std::uint32_t i = 0; i < question.query.poses.size(); ++i) {
    if (PullBack(question.query.poses[i]).determinant < 0)
      mirrored.push_back(question.number_of(i));
  }
  if (mirrored.empty()) return;
  log.warn("mirrored-poses",
           counted(mirrored.size(), "pose mirrors", "poses mirror") + " the " + question.mover() +
               ", so that its left side meets what is on the right: two axes are swapped, "
               "or one has the wrong sign",
           {{"poses", static_cast<double>(mirrored.size())}}, pose_ranges(mirrored));
}

/// Warns where the model's own points have lost digits, as those of a mesh far from its origin do
/// in formats that hold single precision alone.
void warn_of_digits(const Question& question, MessageLog& log) {
  constexpr std::size_t kSample = 4096;
  const std::vector<Vec3>& own = question.query.model.vertices;
  std::vector<Vec3> places;
  for (const std::uint32_t i : spread_poses(own.size(), kSample)) places.push_back(own[i]);
  warn_of_single_precision(question, places, "the coordinates of the model",
                           "Move its reference point to 0, 0, 0 before it is exported", log);
}

}  // namespace

void check_model(const Question& question, MessageLog& log) {
  warn_of_size(question, log);
  warn_of_origin(question, log);
  if (!question.is_load()) warn_of_same(question, log);
  warn_of_scale(question, log);
  warn_of_mirror(question, log);
  if (!question.is_load()) warn_of_digits(question, log);
}

namespace {

/// At most this many points are looked at.
constexpr std::size_t kMostInside = 65'536;
/// Fewer points than this may be noise.
constexpr std::size_t kFewInside = 10;
/// At least this many of them are measured, where there are so many.
constexpr std::size_t kMeasuredInside = 64;
/// The least open share of the model's outline, seen along the direction of motion, that is warned
/// of.
constexpr double kOpen = 0.4;

/// Some of the points that are added, evenly spread over all of them: every one up to twice as many
/// as are wanted, then every second one, every fourth one and so on.
class EvenSample {
 public:
  void add(const Vec3& point) {
    if (count_++ % step_ != 0) return;
    points_.push_back(point);
    if (points_.size() < 2 * kMeasuredInside) return;
    for (std::size_t i = 0; i < kMeasuredInside; ++i) points_[i] = points_[2 * i];
    points_.resize(kMeasuredInside);
    step_ *= 2;
  }

  /// How many points were added.
  std::uint64_t count() const { return count_; }

  /// An estimate of how many of them no model point comes within the radius of.
  std::uint64_t untouched(const Question& question) const {
    if (points_.empty()) return 0;
    return count_ * question.looks.untouched(question.points, points_) / points_.size();
  }

 private:
  std::vector<Vec3> points_;
  std::uint64_t count_ = 0, step_ = 1;
};

/// The scan's points in the model's box at the first pose, in the model's frame, except those in
/// the model's solids, which collide. Nothing where a cell is damaged, because the search reports
/// that where it matters.
struct PointsInBox {
  EvenSample all;
  EvenSample enclosed;  ///< those that have model points in all six directions

  explicit PointsInBox(const Question& question) {
    const Model& model = question.query.model;
    const SolidParts* const solids = model.is_solid() ? &question.looks.solids(model) : nullptr;
    std::size_t looked_at = 0;
    const auto look = [&](const Vec3& p, auto...) {
      if (solids == nullptr || !solids->ref().contains(p)) {
        all.add(p);
        if (is_enclosed(question, p)) enclosed.add(p);
      }
      return ++looked_at < kMostInside;
    };
    try {
      ScanPoints(question.cloud).visit(question.model, question.query.poses.front(), look);
    } catch (const InputError&) {
      all = enclosed = {};
    }
  }

 private:
  static bool is_enclosed(const Question& question, const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      const ModelView& view = question.looks.view(question.points, axis);
      if (!view.encloses(p, question.query.radius)) return false;
    }
    return true;
  }
};

/// The axis of the model along which it moves; the model's longest one where that is not clear.
int axis_of_motion(const Question& question) {
  const Drive drive(question);
  if (!drive.is_one()) return question.model.longest_axis();
  const Vec3 shares = drive.along_axes();
  return shares.x >= shares.y && shares.x >= shares.z ? 0 : shares.y >= shares.z ? 1 : 2;
}

}  // namespace

void check_inside(const Question& question, MessageLog& log) {
  const PointsInBox in_box(question);
  if (in_box.enclosed.count() < kFewInside) return;
  const std::uint64_t count = in_box.enclosed.untouched(question);
  // A rough ground that reaches into the model also touches it, and so is in the result.
  if (count < kFewInside || count < in_box.all.count() - in_box.all.untouched(question)) return;
  log.warn("inside-model",
           "at pose " + std::to_string(question.number_of(0)) + " about " + format_count(count) +
               " scanned points lie inside the model and do not touch it: only its surface is "
               "tested. Does it stand on an obstacle there? Let the path begin outside of it, "
               "search a closed mesh as a solid, or give a model that is filled with points",
           {{"points", static_cast<double>(count)}},
           {{question.number_of(0), question.number_of(0)}});
}

void check_open_model(const Question& question, MessageLog& log) {
  if (Sides(question.model).middle == 0) return;
  const int axis = axis_of_motion(question);
  const double share = question.looks.view(question.points, axis).open_share();
  if (share < kOpen) return;
  log.warn("open-model",
           "seen along its " + std::string(1, "xyz"[axis]) +
               " axis the model is open: no point in " + share_text(share) +
               " of its outline. What passes through there is not found. Does the model consist of "
               "lines, or lack its front and rear?",
           {{"share", share}});
}

void check_model_spacing(const Question& question, MessageLog& log) {
  if (Sides(question.model).longest == 0) return;  // the model is a single place
  const auto [share, largest] = question.looks.alone(question.points);
  if (largest == 0) return;
  log.warn("model-spacing",
           share_text(share) + " of the model's points are farther than the radius of " +
               question.length(question.query.radius) + " from their nearest neighbour, up to " +
               question.length(largest) +
               ": things can pass between them without a collision. Take a denser model",
           {{"share", share}, {"largest", largest}});
}

}  // namespace clearway
