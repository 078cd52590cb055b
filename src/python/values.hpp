#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/progress.hpp"
#include "python/python.hpp"

/// Small values of the library in Python, and how they are shown.
namespace clearway::python {

py::list to_list(const std::vector<Message>& messages);

/// The messages of a Python list that the library gave; none for None.
std::vector<Message> messages_of(const py::handle& object);

/// Appends the messages to a list; does nothing for None.
void append_to(const py::handle& list, const std::vector<Message>& messages);

/// Runs a function that reads something and notes messages, while other Python threads may run too.
/// The messages are appended also where the function throws.
template <typename Read>
auto read_noting(const py::object& messages, Read call) {
  std::vector<Message> noted;
  try {
    auto value = without_gil([&] { return call(&noted); });
    append_to(messages, noted);
    return value;
  } catch (...) {
    append_to(messages, noted);
    throw;
  }
}

/// A unit of length, as its metres or its name.
using UnitArgument = std::variant<double, std::string>;

/// The unit of a file. Throws UsageError where the name is not that of a unit.
FileUnit file_unit(const UnitArgument& unit);

/// The argument environment_unit, which may be given as Store.length_unit() returns it. None: the
/// caller has not said it.
using EnvironmentUnitArgument = std::optional<UnitArgument>;

/// The unit of an environment.
struct EnvironmentUnit {
  double metres = 1;
  bool is_assumed = false;  ///< whether the environment names no unit, or none was given
};
EnvironmentUnit environment_unit_of(const EnvironmentUnitArgument& unit);

/// Throws UsageError where `file`, which was read, names a unit that is not the metre, since
/// nothing says into which unit it is to be converted, unless environment_unit was given. of_file:
/// the argument that names the unit of the file, which overrides the file's own. noted: the
/// messages of reading it, from which those about the assumed unit are taken.
void check_unit_is_given(const std::filesystem::path& file,
                         const EnvironmentUnitArgument& environment_unit, const FileUnit& of_file,
                         std::vector<Message>& noted);

/// The warnings in words, for example "; 2 warnings: no-poses, steps"; empty where there are none.
std::string warning_words(const std::vector<Message>& warnings);

}  // namespace clearway::python
