#include "io/result/conflicts/text_conflicts.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "io/files/text_writer.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/conflicts/json_text.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
void write_csv(const ConflictFile& conflicts, const File& file) {
  const Conflicts& found = conflicts.conflicts;
  TextWriter out(file);
  for (const ConflictField& field : sample_fields(conflicts)) out << field.name << ",";
  out << "small_groups,small_points\n";
  const auto write_row = [&](const Conflict& conflict) {
    for (const ConflictField& field : fields_of(conflict, conflicts.header)) {
      out << csv_value(field.value) << ",";
    }
    out << found.small_groups << "," << found.small_points << "\n";
  };
  for (const Conflict& conflict : found.listed) write_row(conflict);
  for (const Conflict& group : small_groups_instead(found)) write_row(group);
  out.flush();
}

void write_json(const ConflictFile& conflicts, const File& file) {
  TextWriter out(file);
  out << "{\n" << summary_json(conflicts) << ",\n  \"conflicts\": [";
  const char* between = "\n    ";
  for (const Conflict& conflict : conflicts.conflicts.listed) {
    out << between << json_object(fields_of(conflict, conflicts.header));
    between = ",\n    ";
  }
  out << (conflicts.conflicts.listed.empty() ? "]\n}\n" : "\n  ]\n}\n");
  out.flush();
}

namespace {

/// The name of the coordinate reference system, or of a local one where there is none, because
/// readers take files that name none for WGS 84.
std::string crs_name(const std::string& wkt) {
  if (wkt.empty()) return R"(LOCAL_CS["unknown",UNIT["metre",1]])";
  const ScanCrs crs = scan_crs_of(wkt);
  return crs.epsg != 0 ? "urn:ogc:def:crs:EPSG::" + std::to_string(crs.epsg) : crs.wkt;
}

/// The member "crs" as defined by GeoJSON of 2008. RFC 7946 knows only WGS 84, into which a scan in
/// a local frame cannot be converted.
std::string crs_json(const std::string& wkt) {
  const std::string name = crs_name(wkt);
  return R"({"type": "name", "properties": {"name": )" + json_string(name) + "}}";
}

const char* note_on(const std::string& wkt) {
  return wkt.empty()
             ? "Coordinates are those of the scans, which name no coordinate reference system: not "
               "longitudes and latitudes as in RFC 7946."
             : "Coordinates are in the coordinate reference system of the scans, which the member "
               "crs names: not longitudes and latitudes as in RFC 7946.";
}

std::string point_json(const Vec3& v) {
  return R"({"type": "Point", "coordinates": )" + json_vector(v) + "}";
}

/// The footprint of a box: a polygon, counter-clockwise, at the lowest height.
std::string footprint_json(const Box& box) {
  const Vec3 corners[] = {{box.lo.x, box.lo.y, box.lo.z},
                          {box.hi.x, box.lo.y, box.lo.z},
                          {box.hi.x, box.hi.y, box.lo.z},
                          {box.lo.x, box.hi.y, box.lo.z},
                          {box.lo.x, box.lo.y, box.lo.z}};
  std::string ring;
  for (const Vec3& corner : corners) ring += (ring.empty() ? "" : ", ") + json_vector(corner);
  return R"({"type": "Polygon", "coordinates": [[)" + ring + "]]}";
}

/// A feature. number: its number in the file; without one, readers would take the property "id",
/// which the two features of a conflict share.
std::string feature_json(std::uint64_t number, const Conflict& conflict, const ResultHeader& header,
                         const char* shape, const std::string& geometry) {
  std::string properties = R"("shape": )" + json_string(shape);
  for (const ConflictField& field : fields_of(conflict, header)) {
    properties += ", " + json_string(field.name) + ": " + json_value(field.value);
  }
  return R"({"type": "Feature", "id": )" + std::to_string(number) + R"(, "geometry": )" + geometry +
         R"(, "properties": {)" + properties + "}}";
}

}  // namespace

void write_geojson(const ConflictFile& conflicts, const File& file) {
  const std::string& wkt = conflicts.header.crs_wkt;
  TextWriter out(file);
  out << "{\n  \"type\": \"FeatureCollection\",\n  \"crs\": " << crs_json(wkt)
      << ",\n  \"note\": " << json_string(note_on(wkt)) << ",\n  \"summary\": {\n"
      << summary_json(conflicts) << "\n  },\n  \"features\": [";
  std::uint64_t number = 0;
  const auto add = [&](const Conflict& of, const char* shape, const std::string& geometry) {
    ++number;
    out << (number == 1 ? "\n    " : ",\n    ")
        << feature_json(number, of, conflicts.header, shape, geometry);
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
