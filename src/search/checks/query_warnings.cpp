#include "search/checks/query_warnings.hpp"

#include <cmath>

#include "search/checks/checks.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

void warn_of_unit(LengthUnit unit, MessageLog& log) {
  if (unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot) {
    log.warn("feet",
             "the environment is in feet: lengths, model and trajectory without a unit of their own are "
             "taken in feet too");
  }
  if (unit == LengthUnit::kDegree) {
    log.warn("degrees",
             "the environment is in degrees: radius, model and trajectory are taken in degrees "
             "too. Distances in degrees mean nothing: convert the scan to metres");
  }
}

/// What was understood, for people to compare with what they meant.
void note_sizes(const Question& question, MessageLog& log) {
  const auto& poses = question.query.poses;
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length += std::sqrt(squared_distance(translation_of(poses[i - 1]), translation_of(poses[i])));
  }
  log.note("model " + size_text(question.model, question.unit) + ", path " +
           length_text(length, question.unit) + " long, environment " +
           size_text(question.environment, question.unit) + ", radius " +
           length_text(question.query.radius, question.unit));
}

}  // namespace

void warn_of_query(const StoreReader& store, const Query& query, MessageLog& log) {
  const LengthUnit unit = store.metadata().unit;
  if (query.poses.empty()) {
    log.warn("no-poses", "the trajectory has no poses: nothing can collide");
  }
  warn_of_unit(unit, log);
  if (store.point_count() == 0) {
    log.warn("no-points", "the environment has no points: nothing can collide");
    return;
  }
  if (query.poses.empty() || unit == LengthUnit::kDegree) return;
  if (query.poses.size() == 1) {
    log.note("the trajectory has one pose: the model is checked at that place alone");
  }
  const Question question(store, unit, query);
  note_sizes(question, log);
  check_reach(question, log);
  check_height(question, log);
  check_model(question, log);
  check_model_spacing(question, log);
  check_radius(question, log);
  check_steps(question, log);
  check_heading(question, log);
}

}  // namespace clearway
