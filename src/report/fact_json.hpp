#pragma once

#include <functional>
#include <type_traits>

#include "core/describe/fact.hpp"
#include "io/files/json.hpp"

namespace clearway {

/// The items as a list of what make(item) gives.
template <typename Items, typename Make>
Json list_of(const Items& items, const Make& make) {
  Json out = Json::array();
  for (const auto& item : items) out.push_back(make(item));
  return out;
}

/// A value as a fact of a page: null where it has none, and names of enumerators.
template <typename Value>
Json fact_json(const Value& value) {
  if constexpr (requires { value.has_value(); }) {
    return value ? fact_json(*value) : Json();
  } else if constexpr (std::is_enum_v<Value>) {
    return name_of(value);
  } else if constexpr (requires { name_of(*value.begin()); }) {
    return names_of(value);
  } else {
    return value;
  }
}

/// An object with these members of a struct, or functions of it without arguments, each under its
/// own name.
template <auto... kMembers, typename Row>
Json members_json(const Row& row) {
  Json out = Json::object();
  ((out[kNameOfMember<kMembers>.data()] = fact_json(std::invoke(kMembers, row))), ...);
  return out;
}

}  // namespace clearway
