#pragma once

#include <string>

#include "clearway/error.hpp"
#include "clearway/progress.hpp"

namespace clearway::tool {

/// Advice on an error in terms of the command line, such as "; --force overwrites it". Empty where
/// the error says all.
std::string advice_on(const Error& error);

/// Advice on a note or a warning, as a sentence to append: ". --between-poses ...". Empty where the
/// message says all.
std::string advice_on(const Message& message);

}  // namespace clearway::tool
