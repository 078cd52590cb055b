#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "clearway/conflicts.hpp"
#include "core/describe/finding.hpp"
#include "core/query/point_classes.hpp"
#include "io/files/json.hpp"
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

/// A value of a row in files without nesting, with the name of its column.
struct ConflictField {
  std::string name;
  FieldValue value;
  bool is_real = false;    ///< whether the values of the column are numbers other than counts
  bool rounds_up = false;  ///< as of FindingColumn
};

/// Adds the fields of a row, by the list of its columns. A box has the corners lo and hi, a vector
/// three coordinates, and a place its distance and its source.
template <typename... Columns, typename Row>
void add_fields(std::vector<ConflictField>& fields, const std::tuple<Columns...>& columns,
                const Row& row) {
  const auto add_vector = [&fields](const std::string& name, const Vec3& v) {
    fields.push_back({name + "_x", v.x, true});
    fields.push_back({name + "_y", v.y, true});
    fields.push_back({name + "_z", v.z, true});
  };
  for_each_field(columns, [&](const auto& column) {
    if (!column.use.is_in_files) return;
    const std::string key = column.key;
    const auto& value = column.of(row);
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, Box>) {
      add_vector("lo", value.lo);
      add_vector("hi", value.hi);
    } else if constexpr (std::is_same_v<Value, Vec3>) {
      add_vector(key, value);
    } else if constexpr (std::is_same_v<Value, std::optional<FoundPlace>>) {
      fields.push_back({key, value ? FieldValue(value->distance) : FieldValue(), true});
      fields.push_back({key + "_source", value ? FieldValue(value->source) : FieldValue()});
    } else if constexpr (std::is_same_v<Value, std::string>) {
      fields.push_back({key, std::string_view(value)});
    } else if constexpr (std::is_enum_v<Value>) {
      fields.push_back({key, std::string_view(name_of(value))});
    } else if constexpr (requires { name_of(*value); }) {
      // An empty word says that the column has words.
      fields.push_back({key, std::string_view(value ? name_of(*value) : "")});
    } else if constexpr (std::is_same_v<Value, double>) {
      fields.push_back({key, value, true});
    } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
      if (value || !column.use.is_left_out)
        fields.push_back({key, value_of(value), true, column.use.rounds_up});
    } else if constexpr (std::is_unsigned_v<Value>) {
      fields.push_back({key, std::uint64_t{value}});
    } else if constexpr (requires { std::uint64_t{*value}; }) {
      if (value || !column.use.is_left_out) {
        fields.push_back({key, value_of<std::uint64_t>(value)});
      }
    }
  });
}

/// What the ledger of a file says of a conflict; null where there is no ledger, and for a group
/// that is too small to be listed.
const LedgerEntry* ledger_entry_of(const Conflict& conflict, const ConflictFile& file);

/// The fields of a conflict, with the same names in the same order for every conflict of a file.
/// The arguments must outlive the fields. body and body_name exist only where the result has
/// bodies, station_from and station_to only where the conflict has stations, and those of a ledger
/// only where there is one.
std::vector<ConflictField> fields_of(const Conflict& conflict, const ConflictFile& file);

/// A shift or trim rounded up to a thousandth of the unit, so that it is never less than needed.
std::optional<double> rounded_up(std::optional<double> shift);

/// A group that is too small to be listed, in the form of a conflict. Its id is 0, and its centroid
/// the middle of its box.
Conflict as_conflict(const SmallGroup& group);

/// The small groups, where nothing is listed although points collide, so that files are not empty;
/// otherwise none.
std::vector<Conflict> small_groups_instead(const Conflicts& conflicts);

/// The fields of a sample conflict of such a file, which give a table its columns.
std::vector<ConflictField> sample_fields(const ConflictFile& file);

/// A value as JSON: null, a number or a string.
Json json_of(const FieldValue& value);
/// A row as a JSON object. The three fields of a vector's coordinates become one, an array.
Json json_of(const std::vector<ConflictField>& fields);
/// A field's value as a cell of a CSV file, empty where it is absent.
std::string csv_value(const ConflictField& field);

/// Numbers of points by class as a JSON object.
Json json_of(const ClassCounts& classes);

/// Adds the hashes of what was searched to an object.
void add_hashes(Json& json, const ResultHeader& header);

/// A JSON object about the whole result: the query, hashes, how conflicts were made, counts and
/// warnings.
Json summary_of(const ConflictFile& file);

}  // namespace clearway
