#include "search/checks/query_warnings.hpp"

#include "search/checks/checks.hpp"

namespace clearway {
namespace {

void warn_of_unit(LengthUnit unit, MessageLog& log) {
  if (unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot) {
    log.warn("feet",
             "the environment is in feet: radius, model and trajectory are taken in feet too");
  }
  if (unit == LengthUnit::kDegree) {
    log.warn("degrees",
             "the environment is in degrees: radius, model and trajectory are taken in degrees "
             "too. Distances in degrees mean nothing: convert the scan to metres");
  }
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
  check_reach(question, log);
  check_height(question, log);
  check_model(question, log);
  check_model_spacing(question, log);
  check_radius(question, log);
  check_steps(question, log);
  check_heading(question, log);
}

}  // namespace clearway
