#include "io/result/conflicts/write_conflicts.hpp"

#include <string>

#include "clearway/error.hpp"
#include "io/files/file.hpp"
#include "io/result/conflicts/geopackage.hpp"
#include "io/result/conflicts/text_conflicts.hpp"

namespace clearway {

ConflictFormat conflict_format_of(const std::filesystem::path& output) {
  const std::string ending = file_ending(output);
  if (ending == ".csv") return ConflictFormat::kCsv;
  if (ending == ".json") return ConflictFormat::kJson;
  if (ending == ".geojson") return ConflictFormat::kGeoJson;
  if (ending == ".gpkg") return ConflictFormat::kGeoPackage;
  if (ending == ".bcf" || ending == ".bcfzip") return ConflictFormat::kBcf;
  throw UsageError(output.string() +
                   ": unknown output format; the name must end in .csv, .json, .geojson, .gpkg, "
                   ".bcf or .bcfzip");
}

void write_conflicts(const ConflictFile& conflicts, const ConflictPictures& pictures,
                     ConflictFormat format, const std::filesystem::path& path) {
  if (format == ConflictFormat::kGeoPackage) return write_geopackage(conflicts, path);
  const File file = File::create(path);
  switch (format) {
    case ConflictFormat::kCsv:
      return write_csv(conflicts, file);
    case ConflictFormat::kJson:
      return write_json(conflicts, file);
    case ConflictFormat::kGeoJson:
      return write_geojson(conflicts, file);
    case ConflictFormat::kGeoPackage:
      return;
    case ConflictFormat::kBcf:
      return write_bcf(conflicts, pictures, file);
  }
}

}  // namespace clearway
