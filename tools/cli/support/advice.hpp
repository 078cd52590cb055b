#pragma once

#include <string>

#include "clearway/error.hpp"

namespace clearway::tool {

/// What the user can do about an error, in terms of the command line: "; --force overwrites it".
/// Empty where the error says all.
std::string advice_on(const Error& error);

}  // namespace clearway::tool
