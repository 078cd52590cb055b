#pragma once

#include <string>
#include <vector>

#include "io/json/key_reader.hpp"

namespace clearway::campaign {

/// A command line option that a key of campaign.json stands for.
struct Argument {
  std::string key;     ///< for example "vehicles.truck.unit"
  std::string option;  ///< for example "--model-unit"
  /// The word of the command line, for example "--model-unit=mm".
  std::string text;
};

using Arguments = std::vector<Argument>;

/// The kind of value that a key of campaign.json has. What the value means is for the command line
/// to judge.
enum class ValueKind {
  kLength,
  kText,
  kFlag,
  kCount,
  kSize,
  kNumber,
  kList,
  kLists  ///< a list of lists: the option is repeated for each inner list
};

/// A key and the option that it stands for.
struct OptionKey {
  const char* key;
  const char* option;
  ValueKind kind;
};

/// The options for the keys that the object has, in the order of the table.
Arguments arguments_of(const KeyReader& object, const std::vector<OptionKey>& table);

/// The keys of the table after the names in `others`.
std::vector<std::string> names_of(const std::vector<OptionKey>& table,
                                  std::vector<std::string> others);

/// A number or a string, as on a command line. Refuses any other value.
std::string length_text(const KeyReader& value);

}  // namespace clearway::campaign
