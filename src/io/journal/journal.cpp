#include "io/journal/journal.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "io/journal/journal_format.hpp"

namespace clearway {

std::filesystem::path journal_of(const std::filesystem::path& output) {
  return output.string() + ".journal";
}

bool is_journal(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;
  const File file = File::open_regular(path);
  std::array<std::byte, sizeof kJournalMagic> found;
  const std::size_t bytes = std::min<std::uint64_t>(file.size_bytes(), found.size());
  file.read_at(0, std::span(found).first(bytes));
  return bytes > 0 && std::memcmp(found.data(), kJournalMagic, bytes) == 0;
}

std::string difference(const JournalIdentity& found, const JournalIdentity& expected) {
  const auto value_in = [](const JournalIdentity& identity, const std::string& name) {
    for (const auto& [field, value] : identity) {
      if (field == name) return value;
    }
    return std::string("missing");
  };
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  for (const auto& [name, value] : expected) {
    const std::string other = value_in(found, name);
    if (other != value) add(name + " is " + other + ", expected " + value);
  }
  for (const auto& [name, value] : found) {
    if (value_in(expected, name) == "missing") add(name + " is " + value + ", expected none");
  }
  return text;
}

}  // namespace clearway
