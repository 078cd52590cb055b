#pragma once

#include <filesystem>

#include "clearway/answer.hpp"
#include "clearway/stations.hpp"
#include "io/files/json.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The contents of a file of a station table. The references must outlive the writing.
struct StationFile {
  const StationTable& table;
  const StationOptions& options;  ///< the options with which the table was made
  const ResultHeader& header;     ///< header of the result
  const Answer& answer;           ///< answer of the result, of which the counts suffice
};

enum class StationFormat { kCsv, kJson };

/// The format by the ending of a name: .csv or .json. Throws UsageError for others.
StationFormat station_format_of(const std::filesystem::path& output);

/// A JSON object about the whole table, without its rows.
Json summary_of(const StationFile& file);

/// Writes the table. As CSV it has a header and a row for each stretch, where absent values are
/// empty; as JSON one object with the summary and the member `stations`. Throws ResourceError.
void write_stations(const StationFile& stations, StationFormat format,
                    const std::filesystem::path& path);

}  // namespace clearway
