#include <algorithm>
#include <cmath>

#include "core/geometry/angle.hpp"
#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/drive.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

// The least shares of the motion along one axis of the model. 0.9 means 18 degrees aside on
// average.
constexpr double kAlongAxis = 0.9;
constexpr double kSurelyAlongAxis = 0.95;

double greatest_share(const Vec3& shares) { return std::max({shares.x, shares.y, shares.z}); }

struct Misreading {
  Reading reading;
  const char* sentence;
};
constexpr Misreading kMisreadings[] = {
    {Reading::kTransposed,
     "It moves along its axis when the rotations are transposed: they seem to be column-major, or "
     "to turn the scan into the model's frame"},
    {Reading::kScalarFirst,
     "It moves along its axis when the quaternions are read as w x y z, not as x y z w"},
    {Reading::kScalarLast,
     "It moves along its axis when the quaternions are read as x y z w, not as w x y z"}};

/// A sentence that says how the rotations may have been misread; nullptr where no reading makes the
/// model move along an axis.
const char* misreading(const Drive& drive) {
  for (const Misreading& other : kMisreadings) {
    const bool fits = greatest_share(drive.along_axes(other.reading)) > kSurelyAlongAxis &&
                      drive.upright(other.reading) > kSurelyAlongAxis;
    if (fits) return other.sentence;
  }
  return nullptr;
}

bool warn_of_rotations(const Drive& drive, MessageLog& log) {
  const double share = greatest_share(drive.along_axes());
  if (share >= kAlongAxis) return false;
  constexpr double kTurns = 0.97;
  const char* other = misreading(drive);
  const bool still = drive.never_turns() && drive.straightness() < kTurns;
  const std::string why =
      other != nullptr ? other
      : still ? "All rotations are the same although the path turns: do the poses lack their "
                "rotations?"
              : "Check order, sign and zero direction of the angles, and the frame that the poses "
                "are of";
  log.warn("rotations",
           "the model does not move along one of its own axes: only " + share_text(share) +
               " of the motion is along the likeliest. " + why,
           {{"share", share}});
  return true;
}

bool warn_of_tilt(const Drive& drive, MessageLog& log) {
  const double upright = drive.upright();
  constexpr double kTilted = 0.5;  // 60 degrees on average
  if (upright >= kTilted) return false;
  const char* other = misreading(drive);
  log.warn("tilted",
           std::string("the model's z axis ") +
               (upright < -kTilted ? "points down" : "does not point up") +
               " along the path: the poses seem to be of a frame with other axes, such as a "
               "camera's, or with z down" +
               (other != nullptr ? std::string(". ") + other : ""),
           {{"mean_z", upright}});
  return true;
}

/// Warns where the model leans steadily to one side. Roads bank by 4 degrees at most, and rails by
/// 7 degrees in curves, towards the inside.
void warn_of_lean(const Drive& drive, MessageLog& log) {
  constexpr double kLeans = 4.5, kSteady = 1.5;  // degrees
  constexpr double kCurve = 0.8;
  std::vector<double> leans = drive.leans();
  if (leans.empty()) return;
  std::sort(leans.begin(), leans.end());
  const auto at = [&](double share) {
    return leans[static_cast<std::size_t>(share * static_cast<double>(leans.size() - 1))] / kDegree;
  };
  const double lean = at(0.5);
  if (std::abs(lean) < kLeans || at(0.95) - lean > kSteady || lean - at(0.05) > kSteady) return;
  const double right = drive.right_turns();
  if ((lean > 0 ? right : 1 - right) >= kCurve) return;  // it leans into a curve
  log.warn("leans",
           "along the whole path the model leans to the " +
               std::string(lean > 0 ? "right" : "left") + " by " + figure(std::abs(lean)) +
               " degrees, also where it does not turn: are the poses of a scanner or an inertial "
               "unit that is mounted askew? If the ground has this slope, this is all right",
           {{"degrees", lean}});
}

void warn_of_flat_model(const Question& question, int axis, MessageLog& log) {
  log.warn("flat-model",
           "the model is flat: " + size_text(question.model, question.unit) +
               ". It moves along its " + "xyz"[axis] +
               " axis, along which it has no length. A vehicle needs more room in curves than its "
               "profile. Give the whole vehicle",
           {{"thickness", question.model.hi[axis] - question.model.lo[axis]}});
}

void warn_sideways(const Question& question, const Drive& drive, MessageLog& log) {
  const Vec3 shares = drive.along_axes();
  if (greatest_share(shares) < kAlongAxis) return;
  const int axis = shares.x >= shares.y && shares.x >= shares.z ? 0 : shares.y >= shares.z ? 1 : 2;
  const int longest = question.model.longest_axis();
  constexpr double kLonger = 1.3;
  const double side = question.model.hi[axis] - question.model.lo[axis];
  const double other = question.model.hi[longest] - question.model.lo[longest];
  constexpr double kFlatSide = 0.01;
  if (side < kFlatSide * other) {
    warn_of_flat_model(question, axis, log);
    return;
  }
  const bool across = longest != 2 && other > kLonger * side;
  if (axis != 2 && !across) return;
  log.warn("sideways",
           std::string("the model moves along its ") + "xyz"[axis] + " axis, but is " +
               size_text(question.model, question.unit) +
               (axis == 2 ? ": z is expected to point up. " : ": it drives sideways. ") +
               "Turn the model, or the rotations of the poses",
           {{"share", shares[axis]}});
}

/// Notes that the model moves backwards. This is no mistake where the vehicle reverses, or its
/// front points along -x; otherwise its parts meet the scan on the wrong side.
void tell_backwards(const Drive& drive, MessageLog& log) {
  const double along = drive.forwards(0);
  if (along > -kAlongAxis) return;
  log.add(
      {Message::Severity::kNote,
       "drives-backwards",
       "the model moves backwards, against its x axis: if it does not reverse, turn the poses or "
       "the model by 180 degrees, because left and right are swapped",
       {{"share", -along}}});
}

/// Whether the poses hardly turn the model. If so, it is no crane that slews on the spot.
bool hardly_turns(const Question& question) {
  constexpr double kThirtyDegrees = 0.866;
  const Pose& first = question.query.poses.front();
  return std::ranges::all_of(question.query.poses, [&](const Pose& pose) {
    double trace = 0;
    for (int k = 0; k < 9; ++k) trace += pose.rotation[k] * first.rotation[k];
    return (trace / (scale_of(pose) * scale_of(first)) - 1) / 2 > kThirtyDegrees;
  });
}

/// Whether the model moves as a vehicle does, although in steps that are much too small.
bool is_small_drive(const Question& question, double across) {
  constexpr double kPieces = 50;
  if (!(across > 0)) return false;
  const Drive drive(question.query, across / kPieces);
  return drive.is_one() && greatest_share(drive.along_axes()) > kSurelyAlongAxis;
}

void warn_of_tiny_path(const Question& question, MessageLog& log) {
  const auto& poses = question.query.poses;
  constexpr std::size_t kMany = 10;
  if (poses.size() < kMany) return;
  const Vec3 first = poses.front().position();
  Box path{first, first};
  for (const Pose& pose : poses) {
    const Vec3 p = pose.position();
    path = path.united({p, p});
  }
  const double across = 2 * half_diagonal(path), longest = Sides(question.model).longest;
  constexpr double kHuge = 200;  // metres: a longer model has the wrong unit itself
  if (!(across < longest / 4) || longest > kHuge * question.metre) return;
  if (!hardly_turns(question) && !is_small_drive(question, across)) return;
  log.warn("tiny-path",
           "all " + format_count(poses.size()) + " poses lie within " +
               length_text(across, question.unit) + ", and the model is " +
               length_text(longest, question.unit) +
               " long: is the path in another unit, such as kilometres or degrees?",
           {{"path", across}, {"model_longest", longest}});
}

}  // namespace

void check_heading(const Question& question, MessageLog& log) {
  warn_of_tiny_path(question, log);
  const Drive drive(question);
  if (!drive.is_one()) return;
  if (warn_of_tilt(drive, log) || warn_of_rotations(drive, log)) return;
  warn_of_lean(drive, log);
  warn_sideways(question, drive, log);
  tell_backwards(drive, log);
}

}  // namespace clearway
