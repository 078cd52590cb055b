#include "cli/check/check_record.hpp"

#include <algorithm>
#include <span>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "cli/support/program_json.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"
#include "io/files/xxh64.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

ordered_json empty_record() {
  return {{"format", "clearway check"},
          {"version", program_json({})["version"]},
          {"files", ordered_json::object()},
          {"commands", ordered_json::object()}};
}

ordered_json read_record(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return empty_record();
  try {
    ordered_json read = parse_json(text_of_file(file));
    const ordered_json empty = empty_record();
    for (const char* key : {"format", "version"}) {
      if (read.value(key, ordered_json()) != empty[key]) return empty;
    }
    for (const char* key : {"files", "commands"}) {
      if (!read.contains(key) || !read[key].is_object()) return empty;
    }
    return read;
  } catch (const JsonError&) {
    return empty_record();
  } catch (const ordered_json::exception&) {
    return empty_record();
  }
}

}  // namespace

ordered_json contents_of(const std::filesystem::path& file) {
  constexpr std::size_t kStep = std::size_t{1} << 20;
  const File opened = File::open_for_reading(file);
  const std::uint64_t bytes = opened.size_bytes();
  Xxh64Stream hash;
  std::vector<std::byte> buffer;
  for (std::uint64_t at = 0; at < bytes; at += buffer.size()) {
    buffer.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kStep, bytes - at)));
    opened.read_at(at, buffer);
    hash.update(buffer);
  }
  return {{"bytes", bytes}, {"xxh64", hash_text(hash.digest())}};
}

CheckRecord::CheckRecord(std::filesystem::path folder)
    : folder_(std::move(folder)), read_(read_record(folder_ / kRecordName)), now_(read_) {}

bool CheckRecord::exists() const {
  std::error_code unknown;
  return std::filesystem::exists(folder_ / kRecordName, unknown);
}

ordered_json CheckRecord::find(const std::string& name, const ordered_json& what) const {
  const ordered_json& files = now_["files"];
  if (!files.contains(name) || !files[name].is_object()) return nullptr;
  const ordered_json& noted = files[name];
  if (noted.value("made_for", ordered_json()) != what) return nullptr;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(folder_ / name, unknown)) return nullptr;
  if (noted.value("contents", ordered_json()) != contents_of(folder_ / name)) return nullptr;
  return noted.value("remembered", ordered_json());
}

void CheckRecord::note(const std::string& name, const ordered_json& what,
                       const ordered_json& remembered) {
  now_["files"][name] = {
      {"made_for", what}, {"contents", contents_of(folder_ / name)}, {"remembered", remembered}};
}

std::vector<std::string> CheckRecord::command_of(const std::string& name) const {
  const ordered_json& commands = now_["commands"];
  std::vector<std::string> words;
  if (!commands.contains(name) || !commands[name].is_array()) return words;
  for (const ordered_json& word : commands[name]) {
    if (!word.is_string()) return {};
    words.push_back(word.get<std::string>());
  }
  return words;
}

void CheckRecord::note_command(const std::string& name, const std::vector<std::string>& words) {
  now_["commands"][name] = words;
}

void CheckRecord::write() const {
  if (now_ == read_ && exists()) return;
  replace_file(folder_ / kRecordName, indented_text(now_, 1));
}

}  // namespace clearway::tool
