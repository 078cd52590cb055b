#include "io/store/convert/conversion_identity.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/json.hpp"
#include "io/store/convert/source_description.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kIs = ": ";

/// What is known of a file that an option names, wherever it lies: its contents.
std::string contents_text(const fs::path& path) {
  if (path.empty()) return "none";
  std::error_code unknown;
  if (!fs::is_directory(path, unknown)) File::open_regular(path);  // refuses pipes
  return hash_text(describe_with_files(path).xxh64);
}

/// The options in the text of a store.
JournalIdentity options_in(const std::string& text) {
  JournalIdentity options;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::size_t is = std::min(line.find(kIs), line.size());
    options.emplace_back(line.substr(0, is), line.substr(std::min(is + kIs.size(), line.size())));
  }
  return options;
}

}  // namespace

bool shapes_no_store(const std::string& key) {
  constexpr std::array kFree{"memory_bytes", "threads", "strict", "overwrite", "resume"};
  return std::ranges::find(kFree, key) != kFree.end();
}

fs::path known_path(const fs::path& path) {
  std::error_code failed;
  fs::path whole = fs::weakly_canonical(folder_of(path), failed);
  if (failed) return path;
  return path.has_filename() ? whole / path.filename() : whole;
}

std::string value_text(const std::string& value) { return value.empty() ? "none" : value; }
std::string value_text(const std::optional<double>& value) {
  return value ? format_number(*value) : "none";
}
std::string value_text(const FileUnit& unit) {
  if (unit.is_any_foot()) return "any foot";
  return unit.metres() > 0 ? format_number(unit.metres()) + " m" : "none";
}
std::string value_text(const Vec3& v) {
  return format_number(v.x) + " " + format_number(v.y) + " " + format_number(v.z);
}
std::string value_text(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) text += (text.empty() ? "" : ",") + value;
  return text.empty() ? "none" : text;
}

std::string store_options(const ConversionOptions& options) {
  JournalIdentity identity;
  add_option_texts(options, identity,
                   [](JournalIdentity& all, const std::string& key, const fs::path& path) {
                     all.emplace_back(key, contents_text(path));
                   });
  std::string text;
  for (auto& [key, value] : identity) {
    if (shapes_no_store(key)) continue;
    std::ranges::replace(value, '\n', ' ');
    text.append(key).append(kIs).append(value).append("\n");
  }
  return valid_utf8(text);
}

std::string difference_of_options(const std::string& found, const std::string& wanted) {
  return difference(options_in(found), options_in(wanted));
}

}  // namespace clearway
