#pragma once

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

/// None or messages that the library gave.
std::vector<Message> messages_of(const py::handle& object);

/// Appends to a list; None: nowhere.
void append_to(const py::handle& list, const std::vector<Message>& messages);

/// Reads beside other Python threads. What was noted until an error is kept too.
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

/// Metres of a unit of length, or its name.
using UnitArgument = std::variant<double, std::string>;

/// The unit of a file. Throws UsageError for a name that is none of a unit.
FileUnit file_unit(const UnitArgument& unit);

/// The unit of an environment, also by what Store.length_unit() says.
struct EnvironmentUnit {
  double metres = 1;
  bool is_assumed = false;  ///< the environment names none
};
EnvironmentUnit environment_unit_of(const UnitArgument& unit);

/// "; 2 warnings: no-poses, steps", or nothing.
std::string warning_words(const std::vector<Message>& warnings);

}  // namespace clearway::python
