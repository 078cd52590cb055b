#include <algorithm>
#include <cmath>

#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/words.hpp"

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

void warn_of_size(const Question& question, MessageLog& log) {
  const Sides model(question.model), environment(question.environment);
  const double metre = question.metre;
  const bool larger = model.longest > environment.longest;
  const bool huge = model.longest > kLargest * metre || model.shortest > kThickest * metre;
  const double way = path_length(question.query.poses);
  const bool small = model.longest < kSmallest * metre ||
                     (model.longest < kSmallVehicle * metre && way > kLongWay * metre);
  if (!larger && !huge && !small) return;
  std::string text = "the model is " + size_text(question.model, question.unit) +
                     ", the environment " + size_text(question.environment, question.unit) + ". ";
  if (huge) text += unit_guess(question) + (larger ? ". " : "");
  if (larger) text += "Are model and environment swapped?";
  if (!larger && !huge) {
    text += "The path is " + length_text(way, question.unit) +
            " long. So small a model touches hardly anything: check its unit, that of the scan, "
            "and that the model is whole";
  }
  log.warn("model-size", text,
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
           "the model's points lie " + length_text(away, question.unit) +
               " from the origin of their frame, at " + extent_text(question.model) +
               ". A pose turns and moves the model about that origin. Is the model in the "
               "scan's coordinates? Move its reference point to 0, 0, 0",
           {{"distance", away}, {"model_longest", longest}});
}

void warn_of_same(const Question& question, MessageLog& log) {
  if (question.query.model.vertices.size() != question.cloud.point_count()) return;
  if (question.query.model.vertices.size() == 1) return;
  for (int k = 0; k < 3; ++k) {
    const double noise =
        2 * question.cloud.quantisation().scale[k] + 1e-6 * std::abs(question.environment.hi[k]);
    if (std::abs(question.model.lo[k] - question.environment.lo[k]) > noise) return;
    if (std::abs(question.model.hi[k] - question.environment.hi[k]) > noise) return;
  }
  log.warn("model-is-environment",
           "the model has " + format_count(question.query.model.vertices.size()) +
               " points, as many as the environment, and the same box: is it the scan itself?",
           {{"points", static_cast<double>(question.query.model.vertices.size())}});
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
           "the poses scale the model by " + figure(least) +
               (one ? std::string() : " to " + figure(most)) + ": in the scan it is " +
               size_text(box, question.unit) + ", not " + size_text(question.model, question.unit) +
               ". The motion of a vehicle has no scale. Divide the rotations by it, or check the "
               "unit of the poses",
           {{"least", least}, {"most", most}});
}

/// Warns where poses mirror the model. Such matrices are accepted only where poses need not be
/// rigid.
void warn_of_mirror(const Question& question, MessageLog& log) {
  const auto mirrors = [](const Pose& pose) {
    const auto& r = pose.rotation;
    return r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
               r[2] * (r[3] * r[7] - r[4] * r[6]) <
           0;
  };
  const auto count = std::ranges::count_if(question.query.poses, mirrors);
  if (count == 0) return;
  log.warn(
      "mirrored-poses",
      counted(static_cast<std::uint64_t>(count), "pose mirrors", "poses mirror") +
          " the model, so that its left side meets what is on the right: two axes are swapped, "
          "or one has the wrong sign",
      {{"poses", static_cast<double>(count)}});
}

}  // namespace

void check_model(const Question& question, MessageLog& log) {
  warn_of_size(question, log);
  warn_of_origin(question, log);
  warn_of_same(question, log);
  warn_of_scale(question, log);
  warn_of_mirror(question, log);
}

}  // namespace clearway
