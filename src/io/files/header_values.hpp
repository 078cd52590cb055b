#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
#include "core/describe/field.hpp"
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"

namespace clearway {

/// Writes facts into the header of a file, or reads them from one: both by the same calls, so that
/// what is kept is listed once. A struct lists its own in a function `void keep_facts(HeaderValues&
/// values, Struct& facts)` of its namespace, which calls values.add(). Reading throws InputError
/// for a fact that is missing or has another form.
class HeaderValues {
 public:
  /// Writes into an object.
  explicit HeaderValues(Json& object) : to_(&object) {}
  /// Reads from an object of a file with this name. Both must outlive this object.
  /// within: the names of the objects around it, as in "near.".
  HeaderValues(const Json& object, const std::string& file, std::string within = "")
      : from_(&object), file_(&file), within_(std::move(within)) {}

  bool reads() const { return from_ != nullptr; }
  bool has(const char* key) const { return from_ != nullptr && from_->contains(key); }

  template <typename Value>
  void add(const char* key, Value& value) {
    if (to_ != nullptr) {
      (*to_)[key] = put(value);
    } else if (!has(key)) {
      refuse_fact(key, "to be there");
    } else {
      take((*from_)[key], key, value);
    }
  }

  /// A fact that is absent where it is not known.
  template <typename Value>
  void add(const char* key, std::optional<Value>& value) {
    if (reads() ? !has(key) : !value.has_value()) return;
    if (reads()) value.emplace();
    add(key, *value);
  }

  /// A fact that is absent unless `is_kept`; reading then leaves it as it is.
  template <typename Value>
  void add_if(bool is_kept, const char* key, Value& value) {
    if (reads() ? has(key) : is_kept) add(key, value);
  }

  /// The fields of a struct, of which some are absent where they have their default.
  template <typename Struct, typename... Fields>
  void add_fields(const std::tuple<Fields...>& fields, Struct& owner) {
    for_each_field(fields, [&](const auto& field) {
      if (field.is_kept_if_set) {
        add_if(!field.is_default(owner), field.key, field.of(owner));
      } else {
        add(field.key, field.of(owner));
      }
    });
  }

  /// Throws InputError that names a fact.
  [[noreturn]] void refuse_fact(const std::string& key, const std::string& expected) const {
    refuse(*file_, "header: '" + within_ + key + "': expected " + expected);
  }

 private:
  using Numbers = decltype(Message::numbers);

  template <typename Value>
  static constexpr bool is_list = requires(Value& value) {
    value.begin();
    value.end();
  }
  &&!std::is_same_v<Value, std::string>;

  template <typename Value>
  static Json put(Value& value) {
    if constexpr (requires(HeaderValues & values) { keep_facts(values, value); }) {
      Json object = Json::object();
      HeaderValues within(object);
      keep_facts(within, value);
      return object;
    } else if constexpr (std::is_same_v<Value, Numbers>) {
      Json object = Json::object();
      for (const auto& [name, number] : value) object[name] = number;
      return object;
    } else if constexpr (requires { value.has_value(); }) {
      return value ? put(*value) : Json();
    } else if constexpr (is_list<Value> || std::is_array_v<Value>) {
      Json list = Json::array();
      for (auto& entry : value) list.push_back(put(entry));
      return list;
    } else {
      return Json(value);
    }
  }

  template <typename Value>
  void take(const Json& json, const std::string& key, Value& value) const {
    if constexpr (requires(HeaderValues & values) { keep_facts(values, value); }) {
      if (!json.is_object()) refuse_fact(key, "an object");
      HeaderValues within(json, *file_, within_ + key + ".");
      keep_facts(within, value);
    } else if constexpr (std::is_same_v<Value, Vec3>) {
      std::array<double, 3> v{};
      take(json, key, v);
      value = {v[0], v[1], v[2]};
    } else if constexpr (std::is_same_v<Value, PoseRange>) {
      std::array<std::uint32_t, 2> poses{};
      take(json, key, poses);
      value = {poses[0], poses[1]};
    } else if constexpr (std::is_same_v<Value, Numbers>) {
      if (!json.is_object()) refuse_fact(key, "an object");
      for (const auto& [name, number] : json.items()) {
        value.emplace_back(name, std::nan(""));  // JSON has null for what is not finite
        if (!number.is_null()) take(number, key, value.back().second);
      }
    } else if constexpr (requires { value.has_value(); }) {
      value.reset();
      if (!json.is_null()) take(json, key, value.emplace());
    } else if constexpr (is_list<Value> || std::is_array_v<Value>) {
      if (!json.is_array()) refuse_fact(key, "a list");
      if constexpr (requires { value.resize(1); }) value.resize(json.size());
      if (std::size(value) != json.size()) {
        refuse_fact(key, std::to_string(std::size(value)) + " values");
      }
      auto from = json.begin();
      for (auto& entry : value) take(*from++, key, entry);
    } else {
      take_one(json, key, value);
    }
  }

  template <typename Value>
  void take_one(const Json& json, const std::string& key, Value& value) const {
    if constexpr (std::is_same_v<Value, bool>) {
      if (!json.is_boolean()) refuse_fact(key, "true or false");
    } else if constexpr (std::is_same_v<Value, std::string>) {
      if (!json.is_string()) refuse_fact(key, "a text");
    } else if constexpr (std::is_floating_point_v<Value>) {
      if (!json.is_number()) refuse_fact(key, "a number");
    } else {
      static_assert(std::is_unsigned_v<Value> || std::is_same_v<Value, std::int32_t>);
      constexpr std::int64_t kLeast = std::numeric_limits<Value>::min();
      constexpr std::uint64_t kMost = std::numeric_limits<Value>::max();
      const bool fits = json.is_number_unsigned()
                            ? json.get<std::uint64_t>() <= kMost
                            : json.is_number_integer() && json.get<std::int64_t>() >= kLeast &&
                                  json.get<std::int64_t>() < 0;
      if (!fits) refuse_fact(key, "a whole number up to " + std::to_string(kMost));
    }
    value = json.get<Value>();
  }

  Json* to_ = nullptr;
  const Json* from_ = nullptr;
  const std::string* file_ = nullptr;
  std::string within_ = {};
};

inline void keep_facts(HeaderValues& values, Box& box) {
  values.add("lo", box.lo);
  values.add("hi", box.hi);
}

/// A warning of a file. Throws InputError for stretches that do not ascend.
void keep_facts(HeaderValues& values, Message& warning);

/// The facts of a struct as an object.
template <typename Facts>
Json as_header(Facts facts) {
  Json object = Json::object();
  HeaderValues values(object);
  keep_facts(values, facts);
  return object;
}

}  // namespace clearway
