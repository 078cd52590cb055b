#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "clearway/conflicts.hpp"
#include "io/result/conflicts/conflict_file.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// A value of a field: absent, a count, a number such as a length or coordinate, or a word.
using FieldValue = std::variant<std::monostate, std::uint64_t, double, std::string_view>;

/// The value of a field that may be absent, as a number of type Value.
template <typename Value = double, typename Number>
FieldValue value_of(const std::optional<Number>& number) {
  return number ? FieldValue(static_cast<Value>(*number)) : FieldValue();
}

/// A column of a conflict in files without nesting.
struct ConflictField {
  std::string_view name;
  FieldValue value;
};

/// The fields of a conflict, with the same names in the same order for every conflict of a result.
/// The arguments must outlive the fields. body and body_name exist only where the result has
/// bodies, station_from and station_to only where the conflict has stations.
std::vector<ConflictField> fields_of(const Conflict& conflict, const ResultHeader& header);

/// A shift rounded up to a thousandth of the unit, so that it is never less than needed.
std::optional<double> rounded_up(std::optional<double> shift);

/// A group that is too small to be listed, in the form of a conflict. Its id is 0, and its centroid
/// the middle of its box.
Conflict as_conflict(const SmallGroup& group);

/// The small groups, where nothing is listed although points collide, so that files are not empty;
/// otherwise none.
std::vector<Conflict> small_groups_instead(const Conflicts& conflicts);

/// The fields of a sample conflict of such a file, which give a table its columns.
std::vector<ConflictField> sample_fields(const ConflictFile& file);

/// The members of a JSON object about the whole result, without the braces, each on a line that
/// begins with two blanks: the query, hashes, how conflicts were made, counts and warnings.
std::string summary_json(const ConflictFile& file);

}  // namespace clearway
