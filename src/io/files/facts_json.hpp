#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "core/describe/fact.hpp"
#include "core/describe/field.hpp"
#include "io/files/json.hpp"

/// Reports as JSON, by the lists of their facts.
namespace clearway {

template <typename Report, typename... Facts>
void add_facts(Json& out, const Report& report, const std::tuple<Facts...>& facts);

/// The value of a fact: the name of an enumeration, null for what is missing, [first, last] of a
/// range, and an object of all facts for a report within a report.
template <typename Value>
Json json_of_fact(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return name_of(value);
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return value.string();
  } else if constexpr (std::tuple_size_v<std::remove_cvref_t<decltype(kFactsOf<Value>)>> > 0) {
    Json out;
    add_facts(out, value, kFactsOf<Value>);
    return out;
  } else if constexpr (requires { value.first, value.last; }) {
    return Json::array({value.first, value.last});
  } else if constexpr (requires { value.has_value(); }) {
    return value ? json_of_fact(*value) : Json();
  } else {
    return value;
  }
}

template <typename Value>
Json json_of_fact(const std::vector<Value>& values) {
  Json out = Json::array();
  for (const Value& value : values) out.push_back(json_of_fact(value));
  return out;
}

/// Adds the facts of a list to an object.
template <typename Report, typename... Facts>
void add_facts(Json& out, const Report& report, const std::tuple<Facts...>& facts) {
  for_each_field(facts, [&](const auto& fact) {
    out[fact.key] = json_of_fact(std::invoke(fact.member, report));
  });
}

/// An object with these members of a struct, or functions of it without arguments, each under its
/// own name.
template <auto... kMembers, typename Row>
Json members_json(const Row& row) {
  Json out = Json::object();
  add_facts(out, row, std::tuple{fact<kMembers>("")...});
  return out;
}

/// The items as a list of what make(item) gives.
template <typename Items, typename Make>
Json list_of(const Items& items, const Make& make) {
  Json out = Json::array();
  for (const auto& item : items) out.push_back(make(item));
  return out;
}

/// Adds all facts of a report to an object.
template <typename Report>
void add_facts(Json& out, const Report& report) {
  add_facts(out, report, kFactsOf<Report>);
}

}  // namespace clearway
