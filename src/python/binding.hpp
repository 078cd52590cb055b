#pragma once

#include <cctype>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/axis.hpp"
#include "clearway/body.hpp"
#include "clearway/box.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/follow.hpp"
#include "clearway/section.hpp"
#include "clearway/shard.hpp"
#include "clearway/vec3.hpp"
#include "core/describe/fact.hpp"
#include "core/describe/field.hpp"
#include "python/arrays.hpp"
#include "python/python.hpp"
#include "python/values.hpp"

/// Classes and calls of Python from described fields and facts. A call takes all of its arguments
/// by name, as `**kwargs`. Its docstring begins with its signature, in which the annotation of each
/// parameter names the check of _arguments.py, which passes on what it checked, defaults included.
namespace clearway::python {

// Values that Python does not show as pybind11 converts them.

inline py::str shown(const std::string& value) { return text(value); }
inline py::object shown(const std::filesystem::path& path) { return to_python(path); }
inline py::array_t<double> shown(const Vec3& point) { return to_array(point); }
inline py::array_t<double> shown(const std::vector<Pose>& poses) { return to_array(poses); }
inline std::pair<std::uint32_t, std::uint32_t> shown(const Shard& shard) {
  return {shard.number, shard.count};
}
template <typename Range>
requires requires(const Range& range) { range.first, range.last; }
std::pair<std::uint32_t, std::uint32_t> shown(const Range& range) {
  return {range.first, range.last};
}
inline std::pair<std::int32_t, std::int32_t> shown(const std::array<std::int32_t, 2>& cell) {
  return {cell[0], cell[1]};
}
inline std::pair<double, double> shown(const BodyPivots& pivots) {
  return {pivots.front, pivots.rear};
}
inline std::pair<std::string, std::string> shown(const ModelAxes& axes) {
  return {name_of(axes.forward), name_of(axes.up)};
}
template <typename Enum>
requires requires(Enum value) { name_of(value); }
std::string shown(Enum value) { return name_of(value); }
template <typename Value>
requires requires(const Value& value) { shown(value); }
auto shown(const std::vector<Value>& values) {
  std::vector<decltype(shown(values[0]))> all;
  for (const Value& value : values) all.push_back(shown(value));
  return all;
}
template <typename Value>
requires requires(const Value& value) { shown(value); }
auto shown(const std::optional<Value>& value) {
  return value ? std::optional(shown(*value)) : std::nullopt;
}

/// The values of a member as an array.
template <auto kMember, typename Owner>
auto member_array(const Owner& owner) {
  return to_array(std::invoke(kMember, owner));
}

/// Adds a read-only property for each field, fact or column of a list.
template <typename Class, typename... Facts>
void add_properties(Class& made, const std::tuple<Facts...>& facts) {
  using Owner = typename Class::type;
  for_each_field(facts, [&made](const auto& fact) {
    made.def_property_readonly(
        fact.key,
        [member = fact.member](const Owner& owner) -> decltype(auto) {
          if constexpr (requires { shown(std::invoke(member, owner)); }) {
            return shown(std::invoke(member, owner));
          } else {
            return std::invoke(member, owner);
          }
        },
        fact.doc);
  });
}

/// Adds a method without arguments for each fact of a list. of: what has the facts, of an object of
/// the class.
template <typename Class, typename Of, typename... Facts>
void add_methods(Class& made, const Of& of, const std::tuple<Facts...>& facts) {
  using Owner = typename Class::type;
  for_each_field(facts, [&](const auto& fact) {
    made.def(
        fact.key,
        [member = fact.member, of](const Owner& owner) {
          if constexpr (requires { shown(std::invoke(member, of(owner))); }) {
            return shown(std::invoke(member, of(owner)));
          } else {
            return std::invoke(member, of(owner));
          }
        },
        fact.doc);
  });
}

/// Adds a class, whose objects only the module makes, with a property for each of its facts and
/// each entry of further lists.
template <typename Object, typename... Bases, typename... Lists>
py::class_<Object, Bases...> add_class(py::module_& module, const char* name, const char* doc,
                                       const Lists&... lists) {
  py::class_<Object, Bases...> made(module, name, doc);
  add_properties(made, kFactsOf<Object>);
  (add_properties(made, lists), ...);
  return made;
}

/// Adds how an object is shown. words: makes the text, as the library or as Python has texts.
template <typename Class, typename Words>
void add_repr(Class& made, Words words) {
  using Object = typename Class::type;
  made.def("__repr__", [words](const Object& object) -> py::str {
    if constexpr (std::is_same_v<std::invoke_result_t<Words, const Object&>, py::str>) {
      return words(object);
    } else {
      return text(words(object));
    }
  });
}

/// The value of an argument. Throws UsageError for a name that is no choice.
template <typename Value>
Value value_from_python(const char* name, const py::handle& given) {
  if constexpr (std::is_enum_v<Value>) {
    return value_of(name, kChoices<Value>, given.cast<std::string>());
  } else if constexpr (std::is_same_v<Value, FileUnit>) {
    return file_unit(given.cast<UnitArgument>());
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    const auto [x, y, z] = given.cast<std::array<double, 3>>();
    return {x, y, z};
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return path_of(given);
  } else {
    return given.cast<Value>();
  }
}

/// The argument of this name.
template <typename Value>
Value argument(const py::kwargs& given, const char* name) {
  return value_from_python<Value>(name, given[name]);
}

/// Sets the members of a list from the arguments of their names. None leaves the default.
template <typename... Fields, typename Owner>
void set_fields(const std::tuple<Fields...>& fields, const py::kwargs& given, Owner& owner) {
  for_each_field(fields, [&](const auto& field) {
    auto& member = owner.*field.member;
    const py::object value = given[field.key];
    if (value.is_none()) return;
    member = value_from_python<std::decay_t<decltype(member)>>(field.key, value);
  });
}

/// Sets members from the arguments of their names. None leaves the default.
template <auto... kMembers, typename Owner>
void take(const py::kwargs& given, Owner& owner) {
  set_fields(std::tuple{fact<kMembers>("")...}, given, owner);
}

/// The check of _arguments.py for a value.
template <typename Value>
std::string check_of_value(FieldRange range, bool is_required) {
  if constexpr (std::is_same_v<Value, bool>) {
    return "Flag";
  } else if constexpr (std::is_same_v<Value, Axis>) {
    return "AxisName";
  } else if constexpr (std::is_enum_v<Value>) {
    std::string names;
    for (const auto& [name, value] : kChoices<Value>) {
      names += (names.empty() ? "'" : ", '") + std::string(name) + "'";
    }
    return "OneOf(" + names + ")";
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return "Text";
  } else if constexpr (std::is_same_v<Value, FileUnit>) {
    return "Unit";
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    return "Vector";
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return "Path";
  } else if constexpr (std::is_same_v<Value, double>) {
    // Zero is the default of lengths that need not be given, so it may be given too.
    return range == FieldRange::kAny ? "Number" : is_required ? "Above0" : "From0";
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    return "OrNone(" + check_of_value<double>(range, range == FieldRange::kAboveZero) + ")";
  } else if constexpr (std::is_integral_v<Value>) {
    return "Whole(" + std::to_string(std::numeric_limits<Value>::max()) + ")";
  } else if constexpr (std::is_same_v<Value, Box>) {
    return "Box";
  } else {
    return "Each(" + check_of_value<typename Value::value_type>(range, false) + ")";
  }
}

/// A default as a signature has it.
template <typename Value>
py::object default_to_python(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return py::str(name_in(kChoices<Value>, value));
  } else if constexpr (std::is_same_v<Value, FileUnit>) {
    return py::float_(value.metres());
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    return py::make_tuple(value.x, value.y, value.z);
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return py::none();
  } else {
    py::object object = py::cast(value);
    return py::isinstance<py::list>(object) ? py::tuple(object) : object;
  }
}

/// The parameters of a signature: "engine: OneOf('sweep', ...) = 'sweep', threads: ...". Required
/// ones are left out, because a call names them itself.
template <typename... Fields>
std::string signature_of(const std::tuple<Fields...>& fields) {
  std::string text;
  for_each_field(fields, [&text](const auto& field) {
    using Described = std::decay_t<decltype(field)>;
    if (field.is_required) return;
    const py::object usual = default_to_python(field.of(typename Described::Owner{}));
    text += (text.empty() ? "" : ", ") + std::string(field.key) + ": " +
            check_of_value<typename Described::Value>(field.range, field.is_required) + " = " +
            py::repr(usual).template cast<std::string>();
  });
  return text;
}

/// A line for each argument, for a docstring: "threads: how many threads work; ...".
template <typename... Fields>
std::string lines_of(const std::tuple<Fields...>& fields) {
  std::string text;
  for_each_field(fields, [&text](const auto& field) {
    if (field.is_required) return;
    std::string doc = field.doc;
    doc[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(doc[0])));
    text += std::string(field.key) + ": " + doc + "\n";
  });
  return text;
}

}  // namespace clearway::python
