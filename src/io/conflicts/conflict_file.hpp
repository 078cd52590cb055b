#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/pose.hpp"
#include "io/formats/wkt.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// What the files of conflicts say. All outlives the writing.
struct ConflictFile {
  const Conflicts& conflicts;
  const ConflictOptions& options;  ///< that they were found with
  const ResultHeader& header;      ///< of the result
  const Answer& answer;            ///< of the result; its counts are enough
  const std::vector<Pose>& poses;
  std::vector<Message> warnings;
  /// Of files that must have one: an ISO 8601 time in UTC.
  std::string date = kNoDate;

  /// Of all lengths: that which the scan's coordinate reference system names.
  LengthUnit unit() const { return units_of_wkt(header.crs_wkt).horizontal; }
  /// 1 where it is not known.
  double metres_per_unit() const { return metres_of(unit()) > 0 ? metres_of(unit()) : 1; }

  static constexpr const char* kNoDate = "2000-01-01T00:00:00Z";
};

enum class ConflictFormat { kCsv, kJson, kGeoJson, kGeoPackage, kBcf };

/// By the ending of a name: .csv, .json, .geojson, .gpkg, .bcf or .bcfzip. Throws UsageError for
/// others.
ConflictFormat conflict_format_of(const std::filesystem::path& output);

}  // namespace clearway
