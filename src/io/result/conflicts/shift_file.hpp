#pragma once

#include <filesystem>
#include <string>

#include "clearway/conflicts.hpp"
#include "clearway/shift.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The contents of a file of shifts. The references must outlive the writing.
struct ShiftFile {
  const ShiftTable& table;
  const Conflicts& conflicts;
  const ConflictOptions& options;  ///< the options with which the conflicts were found
  const ResultReader& result;
  std::string unit;  ///< symbol of the environment's unit of length
};

enum class ShiftFormat { kCsv, kJson };

/// The format by the ending of a name: .csv or .json. Throws UsageError for others.
ShiftFormat shift_format_of(const std::filesystem::path& output);

/// The side to which a stretch is shifted: "left", "right", or nothing where it stays or where no
/// shift frees it.
const char* side_of(const StretchShift& stretch);

/// The whole table as one JSON object: what was asked, "path" and "conflicts".
std::string json_of(const ShiftFile& file);

/// Writes the table. As CSV it has a header, a row for the whole path with the conflict 0, and a
/// row for each conflict, where absent values are empty; as JSON it is json_of(). Throws
/// ResourceError.
void write_shifts(const ShiftFile& shifts, ShiftFormat format, const std::filesystem::path& path);

/// Reads the table of a file in JSON that write_shifts() wrote. Throws InputError where it is not
/// one, or not of this result.
ShiftTable read_shifts(const std::filesystem::path& path, const ResultReader& result);

/// Throws InputError where the rows of the table are not those of these conflicts.
void check_shifts(const ShiftTable& table, const Conflicts& conflicts, const ResultReader& result);

}  // namespace clearway
