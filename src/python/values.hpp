#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "clearway/file_unit.hpp"
#include "clearway/progress.hpp"
#include "python/python.hpp"

/// Small values of the library in Python, and how they are shown.
namespace clearway::python {

/// Appends the messages to the argument `messages`, a list; does nothing for None.
void append_to(const py::kwargs& given, const std::vector<Message>& messages);

/// Runs a function that reads something and notes messages, while other Python threads may run too.
/// The messages are appended to the argument `messages`, also where the function throws.
template <typename Read>
auto read_noting(const py::kwargs& given, Read call) {
  std::vector<Message> noted;
  try {
    auto value = without_gil([&] { return call(&noted); });
    append_to(given, noted);
    return value;
  } catch (...) {
    append_to(given, noted);
    throw;
  }
}

/// A unit of length, as its metres or its name.
using UnitArgument = std::variant<double, std::string>;

/// The unit of a file. Throws UsageError where the name is not that of a unit.
FileUnit file_unit(const UnitArgument& unit);

/// The unit of an environment.
struct EnvironmentUnit {
  double metres = 1;
  bool is_assumed = false;  ///< whether the environment names no unit, or none was given
  bool is_given = true;
};
/// unit: may be given as Store.length_unit() returns it; none: the caller has not said it.
EnvironmentUnit environment_unit_of(const std::optional<UnitArgument>& unit);

/// Puts the argument `environment_unit` into options, and returns it.
template <typename Options>
EnvironmentUnit take_environment_unit(const py::kwargs& given, Options& options) {
  const EnvironmentUnit unit =
      environment_unit_of(given["environment_unit"].cast<std::optional<UnitArgument>>());
  options.environment_unit = unit.metres;
  options.environment_unit_is_assumed = unit.is_assumed;
  return unit;
}

/// Throws UsageError where `file`, which was read, names a unit that is not the metre, since
/// nothing says into which unit it is to be converted, unless the environment's unit was given.
/// of_file: the argument that names the unit of the file, which overrides the file's own. noted:
/// the messages of reading it, from which those about the assumed unit are taken.
void check_unit_is_given(const std::filesystem::path& file, const EnvironmentUnit& environment,
                         const FileUnit& of_file, std::vector<Message>& noted);

/// The warnings in words, for example "; 2 warnings: no-poses, steps"; empty where there are none.
std::string warning_words(const std::vector<Message>& warnings);

}  // namespace clearway::python
