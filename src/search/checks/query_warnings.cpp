#include "search/checks/query_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/unsearched.hpp"
#include "core/geometry/point_box.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "core/util/format.hpp"
#include "search/check_corridor.hpp"
#include "search/check_query.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/facts/path_looks.hpp"
#include "search/checks/question.hpp"
#include "search/checks/warning_stretches.hpp"
#include "search/ignored.hpp"
#include "search/section.hpp"

namespace clearway {
namespace {

bool has(const BodyMessages& body, std::string_view code) {
  return std::ranges::any_of(body.messages, [&](const Message& m) { return m.code == code; });
}

/// Whether every body that is near the scan has a warning with this code. For a body that is
/// nowhere near the scan, another warning says so.
bool holds_for_vehicle(const std::vector<BodyMessages>& bodies, std::string_view code) {
  return std::ranges::all_of(bodies, [&](const BodyMessages& body) {
    return has(body, code) || has(body, "out-of-reach") || has(body, "no-poses");
  });
}

/// Whether a warning about a stretch of the path matters for the vehicle. Ground that is missing
/// there is missing below every body, whereas beside a low body there may be walls that a high one
/// does not have.
bool stretch_matters(const std::vector<BodyMessages>& bodies, const Message& message) {
  return message.code == "nothing-below" || message.code == "floats" ||
         holds_for_vehicle(bodies, message.code);
}

/// Whether a warning about the whole path matters for the vehicle. A vehicle above the ground need
/// not have anything beside it.
bool path_matters(const std::vector<BodyMessages>& bodies, const Message& message) {
  return holds_for_vehicle(bodies, message.code) &&
         (message.code != "nothing-beside" || !holds_for_vehicle(bodies, "floats"));
}

/// The warning that the vehicle gets for one fault: the one about the longest stretch that a body
/// names, or else the one about its whole path.
struct OfVehicle {
  const BodyMessages* body = nullptr;
  /// nullptr where the warning does not matter for the vehicle.
  const Message* message = nullptr;
  std::vector<PoseRange> stretches;  ///< those that the bodies name together

  OfVehicle(const std::vector<BodyMessages>& bodies, const Message& fault) {
    for (const BodyMessages& candidate : bodies) {
      for (const Message& other : candidate.messages) {
        if (!have_same_fault(other, fault)) continue;
        stretches.insert(stretches.end(), other.stretches.begin(), other.stretches.end());
        if (message != nullptr && !is_better(other)) continue;
        body = &candidate;
        message = &other;
      }
    }
    stretches = united_ranges(std::move(stretches));
    const bool matters = is_of_stretch(*message) ? stretch_matters(bodies, *message)
                                                 : path_matters(bodies, *message);
    if (!matters) message = nullptr;
  }

 private:
  bool is_better(const Message& other) const {
    return length_of_stretch(other) > length_of_stretch(*message);
  }
};

void add_message(Message message, const std::string& who, const std::string& body,
                 MessageLog& log) {
  message.text = who + ": " + message.text;
  message.body = body;
  log.add(std::move(message));
}

/// Adds a message once for all bodies that have the same one. `first` is the body whose
/// message it is; nothing is added where an earlier body has the message too.
void add_alike(const std::vector<BodyMessages>& bodies, std::size_t first, const Message& message,
               MessageLog& log) {
  const auto is_same = [&](const Message& m) {
    return m.code == message.code && m.text == message.text;
  };
  std::string names;
  std::size_t count = 0;
  Message of_all = message;
  of_all.stretches.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto same = std::ranges::find_if(bodies[i].messages, is_same);
    if (same == bodies[i].messages.end()) continue;
    if (i < first) return;  // the earlier body's message named them all
    names += (count == 0 ? "" : ", ") + bodies[i].name;
    ++count;
    of_all.stretches.insert(of_all.stretches.end(), same->stretches.begin(), same->stretches.end());
  }
  of_all.stretches = united_ranges(std::move(of_all.stretches));
  const bool all = count == bodies.size() && count > 1;
  add_message(std::move(of_all),
              all         ? "each body"
              : count > 1 ? "bodies " + names
                          : body_words(names),
              count == 1 ? names : "", log);
}

}  // namespace

void warn_of_bodies_once(const std::vector<BodyMessages>& bodies, MessageLog& log) {
  std::vector<const Message*> added;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (const Message& message : bodies[i].messages) {
      if (!effect_of(message.code).of_vehicle) {
        add_alike(bodies, i, message, log);
      } else if (std::ranges::none_of(
                     added, [&](const Message* m) { return have_same_fault(*m, message); })) {
        added.push_back(&message);
        const OfVehicle found(bodies, message);
        if (found.message == nullptr) continue;
        Message of_vehicle = *found.message;
        of_vehicle.stretches = found.stretches;
        add_message(std::move(of_vehicle), "the vehicle, as its body " + found.body->name, "", log);
      }
    }
  }
}

namespace {

void warn_of_unit(LengthUnit unit, const QuestionWords& words, std::span<const Message> of_inputs,
                  MessageLog& log) {
  if (unit == LengthUnit::kUnknown) {
    log.note("the environment names no unit of length, so metres are assumed");
  }
  const bool is_reported = std::ranges::find(of_inputs, "feet", &Message::code) != of_inputs.end();
  if ((unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot) && !is_reported) {
    log.warn("feet", std::string("the environment is in feet: lengths, ") + words.mover +
                         " and trajectory without a unit of their own are taken in feet too");
  }
  if (unit == LengthUnit::kDegrees) {
    log.warn("degrees", std::string("the environment is in degrees: ") + words.distance + ", " +
                            words.mover +
                            " and trajectory are taken in degrees too. Distances in degrees mean "
                            "nothing: convert the scan to metres");
  }
}

/// Warns where all points are in a plane across an axis: a column of the scan was lost, or is all
/// zeros.
void warn_of_flat_scan(const Question& question, MessageLog& log) {
  constexpr double kFlat = 0.01;  // metres
  const Sides sides(question.environment);
  if (sides.shortest >= kFlat * question.metre || sides.longest < question.metre) return;
  log.warn("flat-scan",
           "the environment is flat: " + size_text(question.environment, question.unit) +
               ". Did its heights get lost, or is one of its columns something else?",
           {{"thickness", sides.shortest}});
}

/// Notes the sizes as they were understood, for people to compare with what they meant.
void note_sizes(const Question& question, MessageLog& log) {
  const double length = path_length(question.query.poses);
  const SectionParameters* const asked = question.section;
  log.note((asked == nullptr ? "model " + question.size()
                             : "load from x = " + format_digits(asked->rear, 3) + " to " +
                                   question.length(asked->front)) +
           ", path " + question.length(length) + " long, environment " +
           size_text(question.environment, question.unit) + ", " + question.words().distance + " " +
           question.length(question.query.radius));
}

/// The load of a section is known by its range alone, so its points are not checked.
void check_model_itself(const Question& question, MessageLog& log) {
  if (question.is_load()) return check_model(question, log);
  const ModelForm form = question.looks.form();
  const bool close = form != ModelForm::kCoarseSurface;  // otherwise gaps are those between samples
  if (close) check_inside(question, log);
  check_model(question, log);
  if (close) check_open_model(question, log);
  if (form == ModelForm::kPoints) check_model_spacing(question, log);
}

/// Checks what was scanned below and beside the model. Reads points.
void check_what_is_around(const Question& question, const PathCover& cover, bool of_body,
                          MessageLog& log) {
  std::optional<PathLooks> looks;
  try {
    looks.emplace(question, cover);
  } catch (const InputError&) {
    return;  // a damaged cell is reported by the search, where it matters
  }
  // What is missing beside a model that is in the ground needs no warning of its own, and below it
  // holes alone do.
  if (check_depth(question, *looks, log)) return check_holes(question, *looks, log);
  const bool floats = check_height(question, *looks, log);
  // For a body, what is beside it is checked in any case, because other bodies may stand on the
  // ground.
  check_surroundings(question, *looks, floats && !of_body, log);
}

/// The checks of what moves along a path: a model, a body of a vehicle or the load of a section.
/// around: whether the checks that look far from the path are made.
void check_question(const Question& question, bool around, bool of_body,
                    std::span<const Message> of_inputs, StepChecks& steps, MessageLog& log) {
  if (around) {
    const PathCover cover(question);
    check_reach(question, cover, log);
    check_what_is_around(question, cover, of_body, log);
  }
  check_model_itself(question, log);
  check_radius(question, log);
  steps.check(question, log);
  if (!of_body) check_path_digits(question, log);
  check_heading(question, of_inputs, log);
}

/// Whether the store has all that the checks look at that look far from the path. longest: the
/// longest side of what moves.
bool looks_around(const StoreReader& store, double longest, MessageLog& log) {
  return looks_stay_near(store.metadata(), kLooksBeside * metre_of(store) + longest, log);
}

/// The longest side of a vehicle where it first has most of its bodies; 0 if none has a pose.
double longest_side(std::span<const Body> bodies, const LooksOf& looks_of) {
  std::uint32_t at = 0;
  for (const Body& body : bodies) {
    if (!body.path_pose.empty()) at = std::max(at, body.path_pose.front());
  }
  std::optional<Box> all;
  for (const Body& body : bodies) {
    const auto pose = std::ranges::lower_bound(body.path_pose, at);
    if (pose == body.path_pose.end() || *pose != at) continue;
    const Box box = moved(looks_of(body.model)->box(),
                          body.poses[static_cast<std::size_t>(pose - body.path_pose.begin())]);
    all = all ? all->united(box) : box;
  }
  return all ? Sides(*all).longest : 0;
}

/// Warns of bodies that have the same model and the same poses, as a copied entry of the vehicle's
/// file has until its model or its place is changed.
void check_same_bodies(std::span<const Body> bodies, MessageLog& log) {
  std::vector<bool> named(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (named[i]) continue;
    std::string names = bodies[i].name;
    std::size_t count = 1;
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const bool is_same = bodies[i].path_pose == bodies[j].path_pose &&
                           bodies[i].poses == bodies[j].poses && bodies[i].model == bodies[j].model;
      if (!is_same) continue;
      named[j] = true;
      names += ", " + bodies[j].name;
      ++count;
    }
    if (count == 1) continue;
    log.warn("same-body",
             "the bodies " + names +
                 " have the same model at the same poses, so all but one of them add nothing. Was "
                 "an entry of the vehicle copied, and its model or its place left as it was? Then "
                 "a part of the vehicle is missing",
             {{"bodies", static_cast<double>(count)}});
  }
}

/// Checks one body by itself. Whether its warnings matter depends on the other bodies.
/// vehicle_longest: the longest side of the vehicle.
void warn_of_body(const StoreReader& store, const Body& body, const Query& query,
                  const ModelLooks& looks, std::span<const double> chainage, double vehicle_longest,
                  bool around, std::span<const Message> of_inputs, StepChecks& steps,
                  MessageLog& log) {
  if (body.poses.empty()) {
    log.warn("no-poses", "has no poses: it cannot collide");
    return;
  }
  const Query own(body.model, body.poses, query);
  Question question(store, store.metadata().unit, own, looks, body.path_pose, chainage);
  question.longest = std::max(question.longest, vehicle_longest);
  question.steps = store.metadata().steps;
  note_sizes(question, log);
  check_question(question, around, true, of_inputs, steps, log);
}

/// The indices of the path's poses at which a body has none, ascending.
std::vector<std::uint64_t> missing_poses(const Body& body, std::size_t path_poses) {
  std::vector<std::uint64_t> missing;
  for (const auto& [first, last] : poses_without_bodies(path_poses, {&body, 1})) {
    for (std::uint64_t i = first; i <= last; ++i) missing.push_back(i);
  }
  return missing;
}

/// Whether a message of reading the vehicle, or of follow(), says already which poses a body lacks.
bool is_reported(const Body& body, std::span<const Message> of_inputs) {
  return std::ranges::any_of(of_inputs, [&](const Message& message) {
    return (message.code == "body-off-path" || message.code == "body-undefined") &&
           message.body == body.name;
  });
}

/// Adds a message for each body that has no pose on part of the path, unless `of_inputs` has one.
void warn_of_missing_poses(const Query& query, std::span<const Message> of_inputs,
                           MessageLog& log) {
  for (const Body& body : query.bodies) {
    const std::vector<std::uint64_t> missing = missing_poses(body, query.poses.size());
    if (missing.empty() || body.poses.empty() || is_reported(body, of_inputs)) continue;
    Message message = off_path_message(body_words(body.name), missing, query.poses.size(),
                                       "so nothing is known of it there",
                                       "Give it those poses too, or look at the stretches that "
                                       "were not searched in the report");
    message.body = body.name;
    log.add(std::move(message));
  }
}

/// path: the vehicle's path, with a model of one point.
void warn_of_bodies(const StoreReader& store, const Question& path, const Query& query,
                    const LooksOf& looks_of, std::span<const Message> before, MessageLog& log) {
  warn_of_missing_poses(query, before, log);
  check_same_bodies(query.bodies, log);
  std::vector<BodyMessages> found;
  StepChecks steps(path);
  const std::vector<double> chainage = chainage_of(query.poses);
  const double longest = longest_side(query.bodies, looks_of);
  const bool around = looks_around(store, longest, log);
  for (const Body& body : query.bodies) {
    found.push_back({body.name, {}});
    const MessageCallback keep = [&](const Message& message) {
      found.back().messages.push_back(message);
    };
    std::vector<Message> unused;
    MessageLog own(keep, unused);
    warn_of_body(store, body, query, *looks_of(body.model), chainage, longest, around, before,
                 steps, own);
  }
  warn_of_bodies_once(found, log);
  steps.check_path(path, log);
}

/// Notes that the scans hold points which the store left out as deleted. Where they are many, a
/// warning of the store says so.
void note_withheld(const StoreMetadata& store, MessageLog& log) {
  const std::uint64_t points = store.withheld ? store.withheld->left_out() : 0;
  constexpr NoteCode kCode = "withheld-points";
  const bool is_warning =
      std::ranges::find(store.warnings, kCode.view(), &Message::code) != store.warnings.end();
  if (points == 0 || is_warning) return;
  log.add(note(kCode,
               counted(points, "point") + " of the scans " + (points == 1 ? "is" : "are") +
                   " not searched, because " + (points == 1 ? "it has" : "they have") +
                   " the flag `withheld` and the conversion left " + (points == 1 ? "it" : "them") +
                   " out",
               {{"points", static_cast<double>(points)}}));
}

/// Warns of scan and path as they are. Returns whether there is more to check.
bool warn_of_inputs(const StoreReader& store, std::size_t poses, const QuestionWords& words,
                    std::span<const Message> of_inputs, MessageLog& log) {
  for (Message& warning : store_warnings(store.metadata())) {
    // The radius is compared with the steps themselves, unless they are those of a raster.
    const std::pair<std::string, double> of_scan{"raster", 0};
    if (warning.code == "store-lost-digits" &&
        std::ranges::find(warning.numbers, of_scan) != warning.numbers.end()) {
      continue;
    }
    log.add(std::move(warning));
  }
  note_withheld(store.metadata(), log);
  const LengthUnit unit = store.metadata().unit;
  if (poses == 0) {
    log.warn("no-poses", std::string("the trajectory has no poses: ") + words.nothing);
  }
  warn_of_unit(unit, words, of_inputs, log);
  if (store.point_count() == 0) {
    log.warn("no-points", std::string("the environment has no points: ") + words.nothing);
    return false;
  }
  if (poses == 0 || unit == LengthUnit::kDegrees) return false;
  if (poses == 1) {
    log.note(std::string("the trajectory has one pose: the ") + words.mover +
             " is checked at that place alone");
  }
  return true;
}

void check_motion(const StoreReader& store, const Query& query, const LooksOf& looks_of,
                  std::span<const Message> of_inputs, MessageLog& log) {
  check_errors(query, log);
  if (!warn_of_inputs(store, query.poses.size(), kWordsOfModel, of_inputs, log)) return;
  const LengthUnit unit = store.metadata().unit;
  if (!query.bodies.empty()) {
    const Query points({Vec3{}}, query.poses, query);
    const ModelLooks looks(points.model, points.radius);
    const Question path(store, unit, points, looks);
    warn_of_flat_scan(path, log);
    check_path_digits(path, log);
    warn_of_bodies(store, path, query, looks_of, of_inputs, log);
    return;
  }
  const std::shared_ptr<const ModelLooks> looks = looks_of(query.model);
  Question question(store, unit, query, *looks);
  question.steps = store.metadata().steps;
  note_sizes(question, log);
  warn_of_flat_scan(question, log);
  StepChecks steps;
  check_question(question, looks_around(store, question.longest, log), false, of_inputs, steps,
                 log);
}

void check_load(const StoreReader& store, const SectionParameters& asked, const Body& load,
                std::span<const double> chainage, std::span<const Message> of_inputs,
                MessageLog& log) {
  if (!warn_of_inputs(store, chainage.size(), kWordsOfLoad, of_inputs, log) || load.poses.empty()) {
    return;
  }
  Query query({}, load.poses, ignored_by(asked));
  query.radius = asked.margin;
  query.between_poses = asked.between_poses;
  const Box box = assumed_load(asked, metre_of(store));
  for (unsigned corner = 0; corner < 8; ++corner) {
    query.model.vertices.push_back(box.corner(corner));
  }
  const ModelLooks looks(query.model, query.radius);
  Question question(store, store.metadata().unit, query, looks, load.path_pose, chainage, &asked);
  question.steps = store.metadata().steps;
  note_sizes(question, log);
  warn_of_flat_scan(question, log);
  StepChecks steps;
  check_question(question, looks_around(store, question.longest, log), false, of_inputs, steps,
                 log);
}

}  // namespace

void warn_of_query(const StoreReader& store, const Query& query, const IgnoredPointCounts& ignored,
                   const LooksOf& looks_of, std::span<const Message> of_inputs, MessageLog& log) {
  check_motion(store, query, looks_of, of_inputs, log);
  warn_of_ignored(store, query, ignored, log);
}

void warn_of_query(const StoreReader& store, const Query& query, const IgnoredPointCounts& ignored,
                   std::span<const Message> of_inputs, MessageLog& log) {
  const auto make = [&](const Model& model) {
    return std::make_shared<const ModelLooks>(model, query.radius);
  };
  warn_of_query(store, query, ignored, make, of_inputs, log);
}

void warn_of_section(const StoreReader& store, const SectionParameters& asked,
                     const IgnoredPointCounts& ignored, const Body& load,
                     std::span<const double> chainage, std::span<const Message> of_inputs,
                     MessageLog& log) {
  check_load(store, asked, load, chainage, of_inputs, log);
  warn_of_ignored(store, ignored_by(asked), ignored, log);
}

}  // namespace clearway
