#pragma once

#include <filesystem>
#include <string>

namespace clearway {

/// The ending of a name including its dot, with ASCII letters in lower case: ".las"; empty where
/// there is none.
inline std::string file_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending;
}

}  // namespace clearway
