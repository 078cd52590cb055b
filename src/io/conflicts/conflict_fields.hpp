#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "clearway/conflicts.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// What there is not, a count or number, a length or coordinate, a word.
using FieldValue = std::variant<std::monostate, std::uint64_t, double, std::string_view>;

/// A column of a conflict, in files without nesting.
struct ConflictField {
  std::string_view name;
  FieldValue value;
};

/// The same names in the same order for every conflict of a result, which outlives them; body and
/// body_name only where it has bodies.
std::vector<ConflictField> fields_of(const Conflict& conflict, const ResultHeader& header);

/// A shift for people, to a thousandth of the unit: never less than is needed.
std::optional<double> rounded_up(std::optional<double> shift);

/// A group that is too small to be listed, in the form of a conflict; its id is 0, and its centroid
/// the middle of its box.
Conflict as_conflict(const SmallGroup& group);

/// Where nothing is listed although points collide, the small groups, which files show then so that
/// they are not empty. Otherwise none.
std::vector<Conflict> small_groups_instead(const Conflicts& conflicts);

/// Of conflicts of such a result: what a table of them has for columns.
std::vector<ConflictField> sample_fields(const ResultHeader& header);

}  // namespace clearway
