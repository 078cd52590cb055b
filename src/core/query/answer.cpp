#include "clearway/answer.hpp"

#include <algorithm>

#include "core/messages/message_table.hpp"

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

namespace {

/// The codes of the warnings for which doubt_of() is a doubt, or none, as given.
std::vector<std::string> codes_of(const Answer& answer, bool doubts) {
  std::vector<std::string> codes;
  for (const Message& warning : answer.warnings) {
    if ((answer.doubt_of(warning) != Doubt::kNone) == doubts) codes.push_back(warning.code);
  }
  std::ranges::sort(codes);
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

}  // namespace

Doubt doubt_of(const Message& message) {
  if (message.severity != Message::Severity::kWarning) return Doubt::kNone;
  const Doubt doubt = effect_of(message.code).doubt;
  return doubt == Doubt::kStretch && message.stretches.empty() ? Doubt::kNone : doubt;
}

bool is_doubt(std::string_view code) { return effect_of(code).doubt == Doubt::kQuestion; }

bool lacks_points(std::string_view code) { return effect_of(code).missing == Missing::kScan; }

Doubt Answer::doubt_of(const Message& warning) const {
  const bool all_seen = seen && seen->swept > 0 && seen->unseen == 0;
  return all_seen && lacks_points(warning.code) ? Doubt::kNone : clearway::doubt_of(warning);
}

std::vector<std::string> Answer::doubts() const { return codes_of(*this, true); }
std::vector<std::string> Answer::warned_of() const { return codes_of(*this, false); }

bool Answer::is_in_doubt() const {
  return std::ranges::any_of(
      warnings, [this](const Message& warning) { return doubt_of(warning) != Doubt::kNone; });
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
