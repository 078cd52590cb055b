#include "io/result/conflicts/conflict_words.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include "core/query/point_classes.hpp"
#include "core/util/format.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

std::string length_words(double length, const std::string& unit) {
  return format_length(*rounded_up(length)) + " " + unit;
}

/// A length with so many digits behind the point.
std::string fixed_digits(double length, int digits) {
  std::array<char, 400> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), length,
                                 std::chars_format::fixed, digits);
  return {text.data(), end.ptr};
}

/// The least trim, on the conflict's side; empty where there is none.
std::string trim_words(const Conflict& c, const RemedyWords& how) {
  const struct {
    Side side;
    const char* where;
    std::optional<double> trim;
  } sides[] = {{Side::kLeft, "on the left", c.trim_left},
               {Side::kRight, "on the right", c.trim_right},
               {Side::kAbove, "at the top", c.trim_above},
               {Side::kBelow, "at the bottom", c.trim_below}};
  for (const auto& [side, where, trim] : sides) {
    if (side != c.side || !trim) continue;
    const std::string cut = "a trim of " + length_words(*trim, how.unit) + " " + where;
    const std::string of = how.has_budget ? " for what is closer than the margin" : "";
    return how.body.empty() ? cut + " is enough" + of
                            : cut + " of " + body_words(how.body) + " is enough for that body" + of;
  }
  return "";
}

const StretchShift* confirmed(const Conflict& c, const RemedyWords& how) {
  if (how.shifts == nullptr) return nullptr;
  const auto& rows = how.shifts->conflicts;
  const auto row = std::ranges::find(rows, c.id, &StretchShift::conflict);
  return row == rows.end() ? nullptr : &*row;
}

const char* direction_words(bool left) { return left ? " to the left" : " to the right"; }

/// The shift that a search has confirmed; empty where there is none.
std::string confirmed_words(const Conflict& c, const RemedyWords& how) {
  const StretchShift* row = confirmed(c, how);
  if (row == nullptr || !row->shift) return "";
  return "a shift of " + format_length(std::abs(*row->shift)) + " " + how.unit +
         direction_words(*row->shift > 0) + " frees it";
}

/// What the points of the conflict itself need, as a sentence. The shifted vehicle may meet others,
/// so this says no more where no search has confirmed a shift, and nothing where one was tried.
std::string own_shift_words(const Conflict& c, const RemedyWords& how) {
  if (confirmed(c, how) != nullptr || (!c.own_shift_left && !c.own_shift_right)) return "";
  const bool left =
      c.own_shift_left && (!c.own_shift_right || *c.own_shift_left <= *c.own_shift_right);
  return "Its own points need a shift of at least " +
         length_words(left ? *c.own_shift_left : *c.own_shift_right, how.unit) +
         direction_words(left) + "; clearway shift says whether one frees it.";
}

/// The shifts that were tried: "a shift of up to 2 m".
std::string tried_words(const Conflict& c, const RemedyWords& how) {
  if (confirmed(c, how) == nullptr) {
    return "a shift of up to " + format_brief(kMostOwnShift / how.metre) + " " + how.unit;
  }
  const ShiftTable& table = *how.shifts;
  const auto up_to = [&](double most) { return format_length(most) + " " + how.unit; };
  const double left = table.lateral_to, right = -table.lateral_from;
  if (left == right) return "a shift of up to " + up_to(left);
  std::string text = "a shift of up to ";
  if (left > 0) text += up_to(left) + " to the left";
  if (left > 0 && right > 0) text += " or ";
  if (right > 0) text += up_to(right) + " to the right";
  return text;
}

}  // namespace

const Conflict* worst_of(const Conflicts& conflicts) {
  const auto worst = std::ranges::min_element(conflicts.listed, {}, &Conflict::rank);
  return worst == conflicts.listed.end() ? nullptr : &*worst;
}

RemedyWords words_about(const Conflict& conflict, const ConflictFile& file) {
  RemedyWords how{file.conflicts, symbol_of(file.unit()), file.metres_per_unit()};
  how.has_budget = file.header.budget.has_value();
  if (conflict.first_body) how.body = file.header.bodies.at(*conflict.first_body);
  if (conflict.body) how.nearest = file.header.bodies.at(*conflict.body);
  return how;
}

std::string missing_words(const Conflict& conflict, const std::string& unit, double metre) {
  if (!conflict.encroachment || !(*conflict.encroachment > 0)) return "";
  const bool exact = conflict.encroachment_is == Bound::kExact;
  if (!exact && *conflict.least_distance * metre < kTouching) return "touches";
  return (exact ? "" : "at least ") + fixed_digits(*conflict.encroachment, 3) +
         (unit.empty() ? "" : " " + unit);
}

std::string class_words(const Conflict& conflict) {
  if (!conflict.main_class) return "";
  return classified_words(
      {{static_cast<std::uint8_t>(*conflict.main_class), *conflict.main_class_points}},
      conflict.points);
}

std::string remedy_words(const Conflict& conflict, const RemedyWords& how) {
  if (conflict.colliding == 0) return "";
  const bool knows_trims = how.conflicts.knows_trims;
  const bool knows_shifts = how.conflicts.knows_shifts || confirmed(conflict, how) != nullptr;
  const std::string trim = trim_words(conflict, how), shift = confirmed_words(conflict, how);
  const std::string own = own_shift_words(conflict, how);
  if (!trim.empty() || !shift.empty()) {
    return "To pass it: " + trim + (trim.empty() || shift.empty() ? "" : ", or ") + shift + "." +
           (own.empty() ? "" : " " + own);
  }
  const std::string tried = tried_words(conflict, how);
  if (!own.empty()) return (knows_trims ? "No trim is known to free it. " : "") + own;
  if (knows_trims && knows_shifts) return "Neither a trim nor " + tried + " is known to free it.";
  if (knows_trims) return "No trim is known to free it.";
  return knows_shifts ? "No" + tried.substr(1) + " is known to free it." : "";
}

std::string conflict_words(const Conflict& conflict, const RemedyWords& how) {
  const double at = conflict.obstacle_chainage.value_or(conflict.chainage_from);
  std::string text = "conflict " + std::to_string(conflict.id) + ", " + fixed_digits(at, 2) + " " +
                     how.unit + " along the path";
  const bool is_inside = conflict.least_distance && *conflict.least_distance < 0;
  const std::string side = is_inside ? words_of(conflict.side).from : words_of(conflict.side).on;
  if (!is_inside && !side.empty()) text += ", " + side;
  const std::string missing = missing_words(conflict, how.unit, how.metre);
  if (is_inside) {
    text += ": " + fixed_digits(-*conflict.least_distance, 3) + " " + how.unit + " deep inside " +
            (how.nearest.empty() ? "it" : body_words(how.nearest)) +
            (side.empty() ? "" : ", " + side);
  } else if (conflict.colliding == 0 && conflict.least_distance) {
    text += ": " + fixed_digits(*conflict.least_distance, 3) + " " + how.unit +
            " away, which is too close only with the errors";
  } else if (!missing.empty()) {
    text += missing == "touches" ? ": it touches" : ": " + missing + " are missing";
  }
  // The class of a single conflict is that of the verdict, beside which these words stand.
  const std::string classes = how.conflicts.listed.size() > 1 ? class_words(conflict) : "";
  if (!classes.empty()) text += "; " + classes;
  const std::string remedy = remedy_words(conflict, how);
  return text + "." + (remedy.empty() ? "" : " " + remedy);
}

}  // namespace clearway
