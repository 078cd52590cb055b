#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Command lines as text that a shell takes apart into the same words.
namespace clearway {

/// The text, quoted where a shell would not take it for one word.
std::string shell_word(const std::string& text);
inline std::string shell_word(const std::filesystem::path& path) {
  return shell_word(path.string());
}

/// The command line of this program with these words after its name.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace clearway
