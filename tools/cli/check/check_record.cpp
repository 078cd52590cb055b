#include "cli/check/check_record.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program_json.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"
#include "io/files/xxh64.hpp"
#include "io/models/model_input.hpp"
#include "io/store/convert/source_description.hpp"
#include "io/store/store_reader.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

ordered_json empty_record() {
  return {{"format", "clearway check"},
          {"version", program_json({})["version"]},
          {"files", ordered_json::object()},
          {"corridor", ordered_json::object()}};
}

ordered_json read_record(const std::filesystem::path& file) {
  const ordered_json empty = empty_record();
  try {
    ordered_json read = parse_json(text_of_file(file));
    const bool fits =
        read.at("format") == empty["format"] && read.at("version") == empty["version"];
    return fits && read.at("files").is_object() && read.at("corridor").is_object() ? read : empty;
  } catch (const std::exception&) {  // what is missing or damaged says nothing
    return empty;
  }
}

/// The size and the hash of the bytes of a file, or of all files that are read where it is named
/// (files_behind()), by which its contents are known again.
ordered_json contents_of(const std::filesystem::path& file) {
  const SourceFile contents = describe_with_files(file);
  return {{"bytes", contents.bytes}, {"xxh64", hash_text(contents.xxh64)}};
}

/// What identifies a store with the names of its scans, which pages show.
ordered_json contents_of_store(const std::filesystem::path& file) {
  const StoreReader store(file);
  ColumnHashes sources;
  for (const SourceFile& source : store.metadata().sources) {
    sources.add(source.name);
    sources.add(std::array{source.bytes, source.xxh64});
  }
  return {{"fingerprint", hash_text(store.fingerprint())},
          {"sources", hash_text(sources.digest())}};
}

/// Whether an option is about speed and memory alone, so that it changes no byte of an output.
bool is_of_speed(const CLI::Option& option) {
  return option.get_group() == title_of(OptionGroup::kSpeed) || option.check_name("--threads") ||
         option.check_name("--memory");
}

/// Adds what identifies the contents of a file that an option names.
void add_contents(const std::string& option, const std::filesystem::path& file,
                  ordered_json& contents) {
  if (option == "--env") {
    contents.push_back(contents_of_store(file));
  } else if (names_vehicle(file)) {
    for (const auto& one : vehicle_inputs(file, {})) contents.push_back(contents_of(one));
  } else {
    contents.push_back(contents_of(file));
  }
}

}  // namespace

ordered_json key_of(const CLI::App& step) {
  ordered_json words = ordered_json::object(), inputs = ordered_json::object();
  for (const CLI::Option* option : step.get_options()) {
    const std::string name = option->get_name();
    if (!option->empty() && !is_of_speed(*option)) words[name] = option->results();
    if (option->get_type_name() != "FILE" || option->check_name("--output")) continue;
    for (const std::filesystem::path file : option->results()) {
      std::error_code unknown;
      if (names_box(file) || !std::filesystem::exists(file, unknown)) continue;
      add_contents(name, file, inputs[name]);
    }
  }
  return {{"words", words}, {"inputs", inputs}};
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

double CheckRecord::corridor(const ordered_json& what) const {
  const ordered_json& noted = now_["corridor"];
  const bool is_of_it = noted.value("made_for", ordered_json()) == what;
  return is_of_it && noted["metres"].is_number() ? noted["metres"].get<double>() : 0;
}

void CheckRecord::note_corridor(const ordered_json& what, double metres) {
  now_["corridor"] = {{"made_for", what}, {"metres", metres}};
}

void CheckRecord::write() const {
  if (now_ == read_ && exists()) return;
  replace_file(folder_ / kRecordName, indented_text(now_, 1));
}

}  // namespace clearway::tool
