#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace clearway::tool {

/// Throws UsageError for the first word of a command line that is no command or option, with the
/// likeliest one: so a mistyped option is named before one that is then missing.
void check_words(const CLI::App& program, const char* program_name, int argc, char** argv);

/// The word of the list that was probably meant; empty where none is near.
std::string likeliest(const std::string& typed, const std::vector<std::string>& words);

}  // namespace clearway::tool
