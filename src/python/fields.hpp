#pragma once

#include <pybind11/stl.h>

#include <array>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/box.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/vec3.hpp"
#include "core/describe/field.hpp"
#include "core/describe/finding.hpp"
#include "python/arrays.hpp"
#include "python/python.hpp"
#include "python/values.hpp"

/// Properties and keyword arguments of Python from described fields. A call takes those arguments
/// as `**kwargs`; its docstring begins with the signature that Python users see and that
/// _arguments.py checks, so that only names of the signature arrive here.
namespace clearway::python {

/// A value as Python has it: the name of a choice, otherwise what pybind11 makes of it.
template <typename Value>
py::object value_to_python(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return py::str(name_in(kChoices<Value>, value));
  } else if constexpr (std::is_same_v<Value, FileUnit>) {
    return py::float_(value.metres());
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    return py::make_tuple(value.x, value.y, value.z);
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return value.empty() ? py::none() : to_python(value);
  } else {
    return py::cast(value);
  }
}

/// The value of an argument. Throws UsageError for a name that is no choice.
template <typename Struct, typename Value>
Value value_from_python(const Field<Struct, Value>& field, const py::handle& given) {
  if constexpr (std::is_enum_v<Value>) {
    return value_of(field.key, kChoices<Value>, given.cast<std::string>());
  } else if constexpr (std::is_same_v<Value, FileUnit>) {
    return file_unit(given.cast<UnitArgument>());
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    const auto [x, y, z] = given.cast<std::array<double, 3>>();
    return {x, y, z};
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return given.is_none() ? std::filesystem::path() : path_of(given);
  } else {
    return given.cast<Value>();
  }
}

/// Sets the members that are among the arguments.
template <typename... Fields, typename Owner>
void set_fields(const std::tuple<Fields...>& fields, const py::kwargs& given, Owner& owner) {
  for_each_field(fields, [&](const auto& field) {
    if (given.contains(field.key)) field.of(owner) = value_from_python(field, given[field.key]);
  });
}

/// The arguments with their defaults, for a signature: "engine='auto', threads=0". Required ones
/// are left out, because a call names them itself.
template <typename... Fields>
std::string signature_of(const std::tuple<Fields...>& fields) {
  std::string text;
  for_each_field(fields, [&text](const auto& field) {
    using Owner = typename std::decay_t<decltype(field)>::Owner;
    if (field.is_required) return;
    py::object usual = value_to_python(field.of(Owner{}));
    if (py::isinstance<py::list>(usual)) usual = py::tuple(usual);
    text += (text.empty() ? "" : ", ") + std::string(field.key) + "=" +
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

/// What _arguments.py checks of a value: the kind of value, and what limits it.
template <typename Value>
py::tuple check_of_value(FieldRange range, bool is_required) {
  if constexpr (std::is_same_v<Value, bool>) {
    return py::make_tuple("flag");
  } else if constexpr (std::is_enum_v<Value>) {
    py::list names;
    for (const auto& [name, value] : kChoices<Value>) names.append(name);
    return py::make_tuple("choice", names);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return py::make_tuple("text");
  } else if constexpr (std::is_same_v<Value, FileUnit>) {
    return py::make_tuple("unit");
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    return py::make_tuple("vector");
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return py::make_tuple("path");
  } else if constexpr (std::is_same_v<Value, double>) {
    // Zero is the default of lengths that need not be given, so it may be given too.
    const char* limit = range == FieldRange::kAny ? "any" : is_required ? "above 0" : "from 0";
    return py::make_tuple("number", limit);
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    return py::make_tuple("optional", range == FieldRange::kAny         ? "any"
                                      : range == FieldRange::kAboveZero ? "above 0"
                                                                        : "from 0");
  } else if constexpr (std::is_integral_v<Value>) {
    return py::make_tuple("whole", std::numeric_limits<Value>::max());
  } else if constexpr (std::is_same_v<Value, std::vector<Box>>) {
    return py::make_tuple("boxes");
  } else {
    return py::make_tuple("list", check_of_value<typename Value::value_type>(range, false));
  }
}

/// Passes to _arguments.py how a call checks the arguments of these names. call: its name for
/// people; for a constructor and the properties, that of the class.
template <typename... Fields>
void add_checks(py::module_& module, const char* call, const std::tuple<Fields...>& fields) {
  if (!py::hasattr(module, "_checks")) module.attr("_checks") = py::dict();
  py::dict checks = module.attr("_checks").attr("setdefault")(call, py::dict());
  for_each_field(fields, [&checks](const auto& field) {
    using Value = typename std::decay_t<decltype(field)>::Value;
    checks[field.key] = check_of_value<Value>(field.range, field.is_required);
  });
}

/// Adds a read-only property for each column of a table of findings: enumerations by their names,
/// vectors as arrays.
template <typename Row, typename... Columns>
void add_properties(py::class_<Row>& rows, const std::tuple<Columns...>& columns) {
  for_each_field(columns, [&rows](const auto& column) {
    using Value = typename std::decay_t<decltype(column)>::Value;
    const auto member = column.member;
    if constexpr (std::is_same_v<Value, Vec3>) {
      rows.def_property_readonly(
          column.key, [member](const Row& row) { return to_array(row.*member); }, column.doc);
    } else if constexpr (std::is_same_v<Value, std::optional<Vec3>>) {
      rows.def_property_readonly(
          column.key,
          [member](const Row& row) {
            return row.*member ? py::object(to_array(*(row.*member))) : py::none();
          },
          column.doc);
    } else if constexpr (std::is_same_v<Value, std::vector<Reason>>) {
      rows.def_property_readonly(
          column.key,
          [member](const Row& row) {
            std::vector<std::string> names;
            for (const Reason reason : row.*member) names.emplace_back(name_of(reason));
            return names;
          },
          column.doc);
    } else if constexpr (std::is_enum_v<Value>) {
      rows.def_property_readonly(
          column.key, [member](const Row& row) { return name_of(row.*member); }, column.doc);
    } else if constexpr (requires(const Value& value) { name_of(*value); }) {
      rows.def_property_readonly(
          column.key,
          [member](const Row& row) {
            return row.*member ? std::optional(name_of(*(row.*member))) : std::nullopt;
          },
          column.doc);
    } else {
      rows.def_readonly(column.key, member, column.doc);
    }
  });
}

/// Adds a read-only property for each field.
template <typename Class, typename... Fields>
void add_read_only(Class& owner, const std::tuple<Fields...>& fields) {
  using Owner = typename Class::type;
  for_each_field(fields, [&owner](const auto& field) {
    owner.def_property_readonly(
        field.key, [member = field.member](const Owner& value) { return value.*member; },
        field.doc);
  });
}

}  // namespace clearway::python
