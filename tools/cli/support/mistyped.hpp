#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace clearway::tool {

/// The words of a command line after the program's name, as the parser needs them. A value that
/// begins with a minus is joined to its option, as in --forward=-x, because alone it would be taken
/// for an option; a length is joined to its unit, as in --radius 10 cm. Throws UsageError for the
/// first word that is not a command or option and names the likeliest one, so that a mistyped
/// option is reported before an option that is missing because of it.
std::vector<std::string> checked_words(const CLI::App& program, const char* program_name, int argc,
                                       char** argv);

/// The word of the list that was probably meant; empty where none is similar.
std::string likeliest(const std::string& typed, const std::vector<std::string>& words);

}  // namespace clearway::tool
