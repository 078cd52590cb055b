#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "clearway/axis.hpp"
#include "clearway/box.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/vec3.hpp"
#include "cli/support/ignored_options.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "core/describe/field.hpp"

/// Options of a command line from described fields. All that is given outlives the command.
namespace clearway::tool {

/// Adds an option that takes the name of one of the choices. value_name: the help's name for it;
/// empty: the help shows the default instead.
template <typename Value>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Value& chosen,
                        const char* value_name, const std::string& help,
                        std::span<const Choice<Value>> choices = kChoices<Value>,
                        bool ignores_case = false) {
  std::vector<std::string> names;
  std::string usual;
  for (const auto& [known, value] : choices) {
    names.emplace_back(known);
    if (value == chosen) usual = known;
  }
  const auto read = [&chosen, choices](const std::string& given) {
    chosen = std::ranges::find(choices, given, &Choice<Value>::name)->value;
  };
  CLI::Option* option =
      command.add_option_function<std::string>(name, read, help)
          ->transform(ignores_case ? CLI::IsMember(names, CLI::ignore_case) : CLI::IsMember(names));
  return *value_name == '\0' ? option->default_str(usual) : option->type_name(value_name);
}

/// Adds the option of a field, in its group. lengths: where lengths with units are noted.
template <typename Struct, typename Value, typename Owner>
CLI::Option* add_field(CLI::App& command, const Field<Struct, Value>& field, Owner& owner,
                       LengthOptions& lengths) {
  const GroupScope group(command, field.group);
  const std::string name = field.option, help = field.help_with_default();
  Value& value = field.of(owner);
  if constexpr (std::is_same_v<Value, bool>) {
    return command.add_flag(name, value, help);
  } else if constexpr (std::is_same_v<Value, Axis>) {
    return add_axis_option(command, name, value, help);
  } else if constexpr (std::is_enum_v<Value>) {
    return add_choice(command, name, value, field.value_name, help);
  } else if constexpr (std::is_same_v<Value, FileUnit>) {
    return add_unit_option(command, name, value, help);
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    return lengths.add(command, name, value, help);
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return command.add_option(name, value, help)->type_name("FILE");
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return command.add_option(name, value, help)->type_name(field.value_name);
  } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
    return command.add_option(name, value, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name(field.value_name);
  } else if constexpr (std::is_same_v<Value, std::vector<std::uint8_t>>) {
    return add_class_option(command, name, value, help);
  } else if constexpr (std::is_same_v<Value, std::vector<Box>>) {
    return add_box_option(command, name, value, help);
  } else if constexpr (std::is_same_v<Value, std::vector<int>>) {
    return command.add_option(name, value, help)
        ->delimiter(',')
        ->type_name("N,...")
        ->check(CLI::Range(static_cast<int>(field.least), static_cast<int>(field.most)));
  } else if constexpr (std::is_integral_v<Value>) {
    if constexpr (std::is_same_v<Value, std::uint64_t>) {
      if (field.unit == FieldUnit::kBytes) return add_size_option(command, name, value, help);
    }
    CLI::Option* option = command.add_option(name, value, help)->type_name("N");
    if (*field.usual == '\0') option->capture_default_str();
    if (field.most == 0) return option;
    return option->check(
        CLI::Range(static_cast<Value>(field.least), static_cast<Value>(field.most)));
  } else if (field.unit == FieldUnit::kMetres) {
    return lengths.add(command, name, value, help, field.range);
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    return add_angle_option(command, name, value, help);
  } else if (field.unit == FieldUnit::kSeconds) {
    return command.add_option(name, value, help)
        ->type_name("SECONDS")
        ->check(seconds_up_to(field.most))
        ->capture_default_str();
  } else {
    return command.add_option(name, value, help)->type_name("NUMBER");
  }
}

/// Adds the options of all fields that have one and are not required.
template <typename... Fields, typename Owner>
void add_fields(CLI::App& command, const std::tuple<Fields...>& fields, Owner& owner,
                LengthOptions& lengths) {
  for_each_field(fields, [&](const auto& field) {
    if (*field.option != '\0' && !field.is_required) add_field(command, field, owner, lengths);
  });
}

/// Adds the required options, which a help text shows among the inputs.
template <typename... Fields, typename Owner>
void add_required_fields(CLI::App& command, const std::tuple<Fields...>& fields, Owner& owner,
                         LengthOptions& lengths) {
  for_each_field(fields, [&](const auto& field) {
    if (field.is_required) add_field(command, field, owner, lengths)->required();
  });
}

}  // namespace clearway::tool
