#pragma once

#include <cstdint>
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

/// Of conflicts of such a result: what a table of them has for columns.
std::vector<ConflictField> sample_fields(const ResultHeader& header);

}  // namespace clearway
