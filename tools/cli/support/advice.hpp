#pragma once

#include <string>

#include "clearway/error.hpp"
#include "clearway/progress.hpp"

namespace clearway::tool {

/// What the user can do about an error, in terms of the command line: "; --force overwrites it".
/// Empty where the error says all.
std::string advice_on(const Error& error);

/// The same of a note or a warning, as a sentence behind it: ". --between-poses ...".
std::string advice_on(const Message& message);

}  // namespace clearway::tool
