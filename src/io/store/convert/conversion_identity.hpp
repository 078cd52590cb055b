#pragma once

#include <filesystem>
#include <string>
#include <type_traits>

#include "core/describe/convert.hpp"
#include "core/util/format.hpp"
#include "io/result/journal.hpp"
#include "io/store/convert/convert.hpp"

/// The options of a conversion as text, by which an unfinished conversion and a store are known
/// again. The lists of fields decide what belongs to them, so that a new option does by itself.
namespace clearway {

/// Whether an option of a conversion changes no byte of the store. A strict conversion makes the
/// same store or none.
bool shapes_no_store(const std::string& key);

/// A path by which a file is known however the user wrote it. The name itself is not followed,
/// because the store names its sources.
std::filesystem::path known_path(const std::filesystem::path& path);

template <typename Number>
requires std::is_arithmetic_v<Number> || std::is_enum_v<Number> std::string value_text(
    Number value) {
  if constexpr (std::is_same_v<Number, bool>) {
    return value ? "yes" : "no";
  } else if constexpr (std::is_floating_point_v<Number>) {
    return format_number(value);
  } else {
    return std::to_string(
        static_cast<std::conditional_t<std::is_enum_v<Number>, int, Number>>(value));
  }
}
std::string value_text(const std::string& value);
std::string value_text(const std::optional<double>& value);
std::string value_text(const FileUnit& unit);
std::string value_text(const Vec3& v);
std::string value_text(const std::vector<std::string>& values);

/// Adds the options with their values. add_file(identity, key, path): adds one that names a file.
template <typename AddFile>
void add_option_texts(const ConversionOptions& options, JournalIdentity& identity,
                      const AddFile& add_file) {
  for_each_field(kConvertFields, [&](const auto& field) {
    const auto& value = field.of(options);
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::filesystem::path>) {
      add_file(identity, std::string(field.key), value);
    } else {
      identity.emplace_back(field.key, value_text(value));
    }
  });
  for_each_field(kReadingFields, [&](const auto& field) {
    identity.emplace_back(std::string("path_") + field.key,
                          value_text(field.of(options.path_options)));
  });
}

/// StoreMetadata::options of the store that these options make. Files count by their contents.
/// Throws ResourceError where a file cannot be read, and UsageError where it is none that can be
/// read twice.
std::string store_options(const ConversionOptions& options);

/// How the options of a store differ from those asked for, such as "scale is 0.5, expected none";
/// empty where they do not.
std::string difference_of_options(const std::string& found, const std::string& wanted);

}  // namespace clearway
