#include "core/util/shell_words.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace clearway {

std::string shell_word(const std::string& text) {
  constexpr std::string_view kPlain = "_./:=,+@%-";
  const bool plain = !text.empty() && std::ranges::all_of(text, [&](unsigned char c) {
    return std::isalnum(c) != 0 || kPlain.find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line = "clearway";
  for (const std::string& word : words) line += " " + shell_word(word);
  return line;
}

}  // namespace clearway
