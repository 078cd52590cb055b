#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "clearway/error.hpp"

namespace clearway {

/// Throws InputError "name: what".
[[noreturn]] void refuse(const std::string& name, const std::string& what,
                         Remedy remedy = Remedy::kNone, double amount = 0);

/// Throws InputError "name: byte N: what". `byte` counts from 0.
[[noreturn]] void refuse_byte(const std::string& name, std::uint64_t byte, const std::string& what);

/// Throws InputError "name: line N: what". `line` counts from 1.
[[noreturn]] void refuse_line(const std::string& name, std::uint64_t line, const std::string& what,
                              Remedy remedy = Remedy::kNone);

/// A position in a file, for messages.
struct FilePlace {
  const char* unit;  ///< "line", counted from 1, or "byte", counted from 0
  std::uint64_t number;

  std::string text() const { return unit + (" " + std::to_string(number)); }
};

/// Throws InputError, with what to do, for a file of another kind that no command reads as text,
/// such as a spreadsheet, a shapefile or a GeoPackage. first: its first 16 bytes, or fewer.
void refuse_foreign(const std::string& name, std::string_view first);

/// The start of a string from a file in double quotes, fit for a message: at most 40 characters,
/// unprintable bytes as '?'.
std::string excerpt(std::string_view text);

/// The whole contents of a small file. Throws ResourceError.
std::string text_of_file(const std::filesystem::path& path);

/// Writes the file under another name and renames it, so that readers see either the old or the new
/// contents. It is not synced: after a crash of the system the file may be empty. Throws
/// ResourceError.
void replace_file(const std::filesystem::path& path, std::string_view text);

}  // namespace clearway
