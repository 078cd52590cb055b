#include "clearway/answer.hpp"

#include <algorithm>
#include <array>

namespace clearway {

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kClear:
      return "clear";
    case Verdict::kConflict:
      return "conflict";
    case Verdict::kUndecided:
      return "undecided";
    case Verdict::kUnknown:
      break;
  }
  return "unknown";
}

const char* name_of(Reason reason) {
  switch (reason) {
    case Reason::kNear:
      return "near";
    case Reason::kFew:
      return "few";
    case Reason::kErrorsExceedMargin:
      return "errors-exceed-margin";
    case Reason::kNotScanned:
      return "not-scanned";
    case Reason::kQuestionInDoubt:
      break;
  }
  return "question-in-doubt";
}

bool is_doubt(std::string_view code) {
  constexpr std::array<std::string_view, 5> kDoubts{"all-ignored", "no-points", "no-poses",
                                                    "nothing-swept", "out-of-reach"};
  return std::ranges::find(kDoubts, code) != kDoubts.end();
}

namespace {

/// The codes of the warnings for which is_doubt() is as given, each once, in alphabetical order.
std::vector<std::string> codes_among(const std::vector<Message>& warnings, bool doubts) {
  std::vector<std::string> codes;
  for (const Message& warning : warnings) {
    const bool is_warning = warning.severity == Message::Severity::kWarning;
    if (is_warning && is_doubt(warning.code) == doubts) codes.push_back(warning.code);
  }
  std::ranges::sort(codes);
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

}  // namespace

std::vector<std::string> doubts_among(const std::vector<Message>& warnings) {
  return codes_among(warnings, true);
}

std::vector<std::string> codes_beside_doubts(const std::vector<Message>& warnings) {
  return codes_among(warnings, false);
}

bool Answer::is_in_doubt() const {
  const bool all_seen = seen && seen->swept > 0 && seen->unseen == 0;
  return std::ranges::any_of(
      doubts, [&](const std::string& code) { return !(all_seen && code == "out-of-reach"); });
}

Verdict Answer::verdict() const {
  if (budget ? certain.has_group : colliding_points > 0) return Verdict::kConflict;
  if (shard) return Verdict::kUnknown;
  const bool open = (budget && is_near()) || is_not_scanned();
  return !is_in_doubt() && !open ? Verdict::kClear : Verdict::kUndecided;
}

std::vector<Reason> Answer::reasons() const {
  if (verdict() != Verdict::kUndecided) return {};
  std::vector<Reason> all;
  if (budget && is_near()) {
    all.push_back(Reason::kNear);
    if (certain.points > 0) all.push_back(Reason::kFew);
    if (parameters.radius <= budget->conflict() && model_solids == 0) {
      all.push_back(Reason::kErrorsExceedMargin);
    }
  }
  if (is_not_scanned()) all.push_back(Reason::kNotScanned);
  if (is_in_doubt()) all.push_back(Reason::kQuestionInDoubt);
  return all;
}

const std::optional<FoundPlace>& Answer::nearest() const {
  // A profile does not say which body is nearest, so the clearance is reported if both distances
  // are equal.
  if (!bodies.empty() && least_clearance &&
      (!least_profile || least_clearance->distance <= least_profile->distance)) {
    return least_clearance;
  }
  return least_profile ? least_profile : least_clearance;
}

std::optional<std::uint64_t> Answer::points_inside() const {
  if (model_solids == 0 || !(parameters.clearance > 0)) return std::nullopt;
  return inside_points;
}

std::optional<double> Answer::greatest_depth() const {
  if (model_solids == 0 || !(std::max(parameters.clearance, parameters.profile) > 0)) {
    return std::nullopt;
  }
  return nearest() ? std::max(0.0, -nearest()->distance) : 0;
}

}  // namespace clearway
