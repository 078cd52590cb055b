#include "core/query/error_budget.hpp"

#include <cmath>

#include "clearway/answer.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A model that reaches 5 m from its origin and is moved by 0.4 m, without turning.
Query moved() {
  Query query;
  query.radius = 0.1;
  query.model.vertices = {{3, 4, 0}, {0, 0, 0}};
  query.poses.resize(2);
  for (Pose& pose : query.poses) {
    for (int k = 0; k < 3; ++k) pose.rotation[4 * k] = 1;
  }
  query.poses[1].translation[0] = 0.4;
  return query;
}

const Quantisation kSteps{{0.002, 0.001, 0.002}, {0, 0, 0}};  // the diagonal is 0.003

}  // namespace

TEST_CASE("a query without errors has no budget, and one with an error of 0 has") {
  Query query = moved();
  CHECK_FALSE(error_budget_of(query, kSteps));
  query.sigmas = 2;
  CHECK_FALSE(error_budget_of(query, kSteps));
  query.error_angle = 0;
  CHECK(error_budget_of(query, kSteps));
}

TEST_CASE("the parts of a budget, worked out by hand") {
  Query query = moved();
  query.error_scan = 0.003;
  query.error_registration = 0.004;
  query.error_pose = 0.012;
  query.error_angle = 0.0168;  // times 5 m is 0.084
  query.error_model = 0.01;
  const ErrorBudget budget = error_budget_of(query, kSteps).value();
  CHECK(budget.step == Approx(0.0015));
  CHECK(budget.hard() == Approx(0.0115));
  CHECK(budget.lever == Approx(5));
  CHECK(budget.motion == Approx(0.2));
  check_equal(budget.chord, 0);
  CHECK(budget.way() == Approx(0.2));
  // 3^2 + 4^2 + 12^2 + 84^2 = 85^2 (in mm), and without the scan 7216 = 84.947^2.
  CHECK(budget.clear() == Approx(0.0115 + 0.2 + 3 * 0.085));
  CHECK(budget.conflict() == Approx(0.0115 + 3 * std::sqrt(0.007216) + 6 * 0.003));
  CHECK(budget.near_radius(0.1) == 0.1 + budget.clear());
  CHECK(budget.certain_radius(0.1) == 0.1 - budget.conflict());

  query.sigmas = 4;
  CHECK(error_budget_of(query, kSteps)->clear() == Approx(0.0115 + 0.2 + 4 * 0.085));
  query.between_poses = true;
  check_equal(error_budget_of(query, kSteps)->way(), 0);
  query.model.spacing = 0.02;
  CHECK(error_budget_of(query, kSteps)->way() == Approx(0.02));
}

TEST_CASE("a gap in the poses of a body is no motion") {
  Query query = moved();
  query.error_scan = 0;
  query.bodies.push_back({"a", query.model, query.poses, {0, 2}});
  query.model = {};
  query.poses.resize(3);
  check_equal(error_budget_of(query, kSteps)->motion, 0);
  query.bodies[0].path_pose = {0, 1};
  CHECK(error_budget_of(query, kSteps)->motion == Approx(0.2));
}

TEST_CASE("a warning about a stretch puts the verdict in doubt, and one about the whole path not") {
  constexpr auto kWarning = Message::Severity::kWarning;
  const Message whole{kWarning, "floats", ""};
  const Message stretch{kWarning, "leaves-scan", "", {}, {{3, 5}}};
  const Message side{kWarning, "one-side", "", {}, {{3, 5}}};
  CHECK(doubt_of(whole) == Doubt::kNone);
  CHECK(doubt_of(stretch) == Doubt::kStretch);
  CHECK(doubt_of(side) == Doubt::kNone);
  CHECK(doubt_of({Message::Severity::kNote, "leaves-scan", "", {}, {{3, 5}}}) == Doubt::kNone);
  for (const char* code : {"no-points", "model-unit", "store-cut-off", "cut-text"}) {
    CHECK(doubt_of({kWarning, code, ""}) == Doubt::kQuestion);
  }
  for (const char* code : {"model-size", "store-lost-digits", "like-degrees"}) {
    CHECK(doubt_of({kWarning, code, ""}) == Doubt::kNone);
  }
  Answer answer;
  answer.warnings = {whole, side};
  CHECK(answer.verdict() == Verdict::kClear);
  check_equal(answer.warned_of(), {"floats", "one-side"});
  answer.warnings.push_back(stretch);
  CHECK(answer.verdict() == Verdict::kUndecided);
  CHECK(answer.reasons() == std::vector{Reason::kQuestionInDoubt});
  check_equal(answer.doubts(), {"leaves-scan"});
  // Beams that passed through all of it show that it is free.
  answer.seen = SeenSummary{.swept = 9, .unseen = 0};
  CHECK(answer.verdict() == Verdict::kClear);
  answer.colliding_points = 1;
  CHECK(answer.verdict() == Verdict::kConflict);
}

TEST_CASE("the verdict and its reasons with a budget") {
  Answer answer;
  answer.parameters.radius = 0.1;
  answer.budget = ErrorBudget{.model = 0.05};
  CHECK(answer.verdict() == Verdict::kClear);
  answer.near_points = 1;
  CHECK(answer.verdict() == Verdict::kUndecided);
  CHECK(answer.reasons() == std::vector{Reason::kNear});
  answer.colliding_points = 20;
  answer.certain.points = 9;
  answer.warnings = {{Message::Severity::kWarning, "out-of-reach", ""}};
  CHECK(answer.reasons() == std::vector{Reason::kNear, Reason::kFew, Reason::kQuestionInDoubt});
  answer.budget->model = 0.1;
  answer.certain.points = 0;
  CHECK(answer.reasons() ==
        std::vector{Reason::kNear, Reason::kErrorsExceedMargin, Reason::kQuestionInDoubt});
  answer.model_solids = 1;
  CHECK(answer.reasons() == std::vector{Reason::kNear, Reason::kQuestionInDoubt});
  answer.certain = {10, true};
  CHECK(answer.verdict() == Verdict::kConflict);
  CHECK(answer.reasons().empty());
  answer.shard = Shard{1, 2};
  CHECK(answer.verdict() == Verdict::kConflict);
  answer.certain.has_group = false;
  CHECK(answer.verdict() == Verdict::kUnknown);
}
