#include "io/result/conflicts/text_conflicts.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "io/files/text_writer.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
void write_csv(const ConflictFile& conflicts, const File& file) {
  const Conflicts& found = conflicts.conflicts;
  TextWriter out(file);
  for (const ConflictField& field : sample_fields(conflicts)) out << field.name << ",";
  out << "small_groups,small_points\n";
  const auto write_row = [&](const Conflict& conflict) {
    for (const ConflictField& field : fields_of(conflict, conflicts)) {
      out << csv_value(field) << ",";
    }
    out << found.small_groups << "," << found.small_points << "\n";
  };
  for (const Conflict& conflict : found.listed) write_row(conflict);
  for (const Conflict& group : small_groups_instead(found)) write_row(group);
  out.flush();
}

void write_json(const ConflictFile& conflicts, const File& file) {
  TextWriter out(file);
  out << "{\n" << member_lines(summary_of(conflicts)) << ",\n  \"conflicts\": [";
  const char* between = "\n    ";
  for (const Conflict& conflict : conflicts.conflicts.listed) {
    out << between << line_text(json_of(fields_of(conflict, conflicts)));
    between = ",\n    ";
  }
  out << (conflicts.conflicts.listed.empty() ? "]\n}\n" : "\n  ]\n}\n");
  out.flush();
}

namespace {

/// The name of the coordinate reference system, or of a local one where there is none, because
/// readers take files that name none for WGS 84.
std::string crs_name(const ResultHeader& header) {
  if (header.crs_wkt.empty()) return local_system(unit_of(header));
  const ScanCrs crs = scan_crs_of(header.crs_wkt);
  return crs.epsg != 0 ? "urn:ogc:def:crs:EPSG::" + std::to_string(crs.epsg) : crs.wkt;
}

/// The member "crs" as defined by GeoJSON of 2008. RFC 7946 knows only WGS 84, into which a scan in
/// a local frame cannot be converted.
Json crs_json(const ResultHeader& header) {
  return {{"type", "name"}, {"properties", {{"name", crs_name(header)}}}};
}

const char* note_on(const std::string& wkt) {
  return wkt.empty()
             ? "Coordinates are those of the scans, which name no coordinate reference system: not "
               "longitudes and latitudes as in RFC 7946."
             : "Coordinates are in the coordinate reference system of the scans, which the member "
               "crs names: not longitudes and latitudes as in RFC 7946.";
}

Json point_json(const Vec3& v) { return {{"type", "Point"}, {"coordinates", v}}; }

/// The footprint of a box: a polygon, counter-clockwise, at the lowest height.
Json footprint_json(const Box& box) {
  const std::vector<Vec3> corners{{box.lo.x, box.lo.y, box.lo.z},
                                  {box.hi.x, box.lo.y, box.lo.z},
                                  {box.hi.x, box.hi.y, box.lo.z},
                                  {box.lo.x, box.hi.y, box.lo.z},
                                  {box.lo.x, box.lo.y, box.lo.z}};
  return {{"type", "Polygon"}, {"coordinates", Json::array({corners})}};
}

/// A feature. number: its number in the file; without one, readers would take the property "id",
/// which the two features of a conflict share.
Json feature_json(std::uint64_t number, const Conflict& conflict, const ConflictFile& file,
                  const char* shape, const Json& geometry) {
  Json properties{{"shape", shape}};
  for (const ConflictField& field : fields_of(conflict, file)) {
    properties[field.name] = json_of(field.value);
  }
  return {{"type", "Feature"}, {"id", number}, {"geometry", geometry}, {"properties", properties}};
}

}  // namespace

void write_geojson(const ConflictFile& conflicts, const File& file) {
  const std::string& wkt = conflicts.header.crs_wkt;
  TextWriter out(file);
  out << "{\n  \"type\": \"FeatureCollection\",\n  \"crs\": "
      << line_text(crs_json(conflicts.header)) << ",\n  \"note\": " << json_string(note_on(wkt))
      << ",\n  \"summary\": {\n"
      << member_lines(summary_of(conflicts)) << "\n  },\n  \"features\": [";
  std::uint64_t number = 0;
  const auto add = [&](const Conflict& of, const char* shape, const Json& geometry) {
    ++number;
    out << (number == 1 ? "\n    " : ",\n    ")
        << line_text(feature_json(number, of, conflicts, shape, geometry));
  };
  for (const Conflict& conflict : conflicts.conflicts.listed) {
    add(conflict, "centroid", point_json(conflict.centroid));
    add(conflict, "footprint", footprint_json(conflict.box));
  }
  for (const Conflict& group : small_groups_instead(conflicts.conflicts)) {
    add(group, "small group", point_json(group.centroid));
  }
  out << (conflicts.conflicts.groups == 0 ? "]\n}\n" : "\n  ]\n}\n");
  out.flush();
}

}  // namespace clearway
