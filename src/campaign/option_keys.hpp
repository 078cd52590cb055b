#pragma once

#include <string>
#include <vector>

#include "io/json/key_reader.hpp"

namespace clearway::campaign {

/// A command line option that a key of campaign.json stands for.
struct Argument {
  std::string key;     ///< "vehicles.truck.unit"
  std::string option;  ///< "--model-unit"
  std::string text;    ///< as on a command line: "--model-unit=mm"
};

using Arguments = std::vector<Argument>;

/// What a value of campaign.json may be; what it means is for the command line to judge.
enum class ValueKind {
  kLength,
  kText,
  kFlag,
  kCount,
  kSize,
  kNumber,
  kList,
  kLists  ///< a list of lists: the option once for each
};

/// A key and the option that it stands for.
struct OptionKey {
  const char* key;
  const char* option;
  ValueKind kind;
};

/// The options of the keys that the object has, in the order of the table.
Arguments arguments_of(const KeyReader& object, const std::vector<OptionKey>& table);

/// Names of the table, and others.
std::vector<std::string> names_of(const std::vector<OptionKey>& table,
                                  std::vector<std::string> others);

/// A number or a string, as on a command line. Refuses what is neither.
std::string length_text(const KeyReader& value);

}  // namespace clearway::campaign
