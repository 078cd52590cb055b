#include "campaign/option_keys.hpp"

#include <utility>

#include "core/util/format.hpp"

namespace clearway::campaign {
namespace {

std::string number_text(const nlohmann::ordered_json& number) {
  return number.is_number_float() ? format_number(number.get<double>()) : number.dump();
}

std::string list_text(const KeyReader& value) {
  if (value.value().is_string()) return value.text();
  std::string list;
  for (const KeyReader& element : value.elements()) {
    list += (list.empty() ? "" : ",") + length_text(element);
  }
  return list;
}

std::string value_text(const KeyReader& value, ValueKind kind) {
  switch (kind) {
    case ValueKind::kLength:
      return length_text(value);
    case ValueKind::kCount:
      if (!value.value().is_number_integer()) value.refuse("expected a whole number");
      return value.value().dump();
    case ValueKind::kNumber:
      if (!value.value().is_number()) value.refuse("expected a number");
      return number_text(value.value());
    case ValueKind::kSize:
      return value.value().is_number_integer() ? value.value().dump() : value.text();
    case ValueKind::kList:
      return list_text(value);
    default:
      return value.text();
  }
}

}  // namespace

std::string length_text(const KeyReader& value) {
  if (value.value().is_number()) return number_text(value.value());
  if (!value.value().is_string()) {
    value.refuse("expected a length, as 0.1 or \"10cm\"");
  }
  return value.text();
}

Arguments arguments_of(const KeyReader& object, const std::vector<OptionKey>& table) {
  Arguments out;
  for (const auto& [name, option, kind] : table) {
    if (!object.has(name)) continue;
    const KeyReader value = object.at(name);
    if (kind == ValueKind::kFlag) {
      if (value.flag()) out.push_back({value.key(), option, option});
    } else if (kind == ValueKind::kLists) {
      for (const KeyReader& one : value.elements()) {
        out.push_back({one.key(), option, option + ("=" + list_text(one))});
      }
    } else {
      out.push_back({value.key(), option, option + ("=" + value_text(value, kind))});
    }
  }
  return out;
}

std::vector<std::string> names_of(const std::vector<OptionKey>& table,
                                  std::vector<std::string> others) {
  for (const OptionKey& key : table) others.emplace_back(key.key);
  return others;
}

}  // namespace clearway::campaign
