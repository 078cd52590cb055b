#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/ledger.hpp"
#include "clearway/pose.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The contents of a file of conflicts. The references must outlive the writing.
struct ConflictFile {
  const Conflicts& conflicts;
  const ConflictOptions& options;  ///< the options with which the conflicts were found
  const ResultHeader& header;      ///< header of the result
  const Answer& answer;            ///< answer of the result, of which the counts suffice
  const std::vector<Pose>& poses;
  std::vector<Message> warnings;
  /// Date for formats that need one: an ISO 8601 time in UTC.
  std::string date = kNoDate;
  const Ledger* ledger = nullptr;  ///< where the conflicts were compared with one

  /// The warnings of the search, and those about the conflicts.
  std::vector<Message> all_warnings() const {
    std::vector<Message> all = answer.warnings;
    all.insert(all.end(), warnings.begin(), warnings.end());
    return all;
  }
  /// Unit of all lengths, which the scan's coordinate reference system names.
  LengthUnit unit() const { return unit_of(header); }
  /// Metres per unit of length; 1 where the unit is not known.
  double metres_per_unit() const { return clearway::metres_per_unit(header); }

  static constexpr const char* kNoDate = "2000-01-01T00:00:00Z";
};

enum class ConflictFormat { kCsv, kJson, kGeoJson, kGeoPackage, kBcf };

/// The format by the ending of a name: .csv, .json, .geojson, .gpkg, .bcf or .bcfzip. Throws
/// UsageError for others.
ConflictFormat conflict_format_of(const std::filesystem::path& output);

}  // namespace clearway
