#include "io/result/conflicts/geopackage.hpp"

#include <functional>
#include <string>
#include <vector>

#include "core/geometry/point_box.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/conflicts/geopackage_geometry.hpp"
#include "io/result/conflicts/sqlite.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

constexpr std::int32_t kUnknownCartesian = -1;
constexpr std::int32_t kOwnCode = 100'000;  // number of a reference system without EPSG code
constexpr const char* kWgs84 =
    R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]])";

constexpr const char* kTables = R"(
CREATE TABLE gpkg_spatial_ref_sys (
  srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (
  table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
  description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
  min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER,
  CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (
  table_name TEXT NOT NULL, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
)";

/// A layer: one feature for each conflict.
struct Layer {
  const char* table;
  const char* description;
  const char* type;
  GeoShape shape;
  std::function<std::vector<Vec3>(const Conflict&)> points;
  const std::vector<Conflict>& features;
};

std::vector<Vec3> ring_of(const Box& box) {
  const double z = box.lo.z;
  return {{box.lo.x, box.lo.y, z},
          {box.hi.x, box.lo.y, z},
          {box.hi.x, box.hi.y, z},
          {box.lo.x, box.hi.y, z},
          {box.lo.x, box.lo.y, z}};
}

/// The path along a conflict. A line needs two places, so a single pose is joined by its neighbour,
/// or by itself where there is none.
std::vector<Vec3> path_of(const Conflict& conflict, const std::vector<Pose>& poses) {
  std::size_t first = conflict.first_pose, last = conflict.last_pose;
  if (first == last && last + 1 < poses.size()) ++last;
  if (first == last && first > 0) --first;
  std::vector<Vec3> out;
  for (std::size_t i = first; i <= last; ++i) {
    const double* p = poses[i].translation;
    out.push_back({p[0], p[1], p[2]});
  }
  if (out.size() == 1) out.push_back(out.front());
  return out;
}

std::vector<Layer> layers_of(const ConflictFile& file, const std::vector<Conflict>& small) {
  const std::vector<Pose>& poses = file.poses;
  const std::vector<Conflict>& listed = file.conflicts.listed;
  std::vector<Layer> layers{
      {"conflicts", "centroids of the colliding points", "POINT", GeoShape::kPoint,
       [](const Conflict& c) { return std::vector<Vec3>{c.centroid}; }, listed},
      {"footprints", "boxes of the colliding points, seen from above", "POLYGON",
       GeoShape::kPolygon, [](const Conflict& c) { return ring_of(c.box); }, listed},
      {"stretches", "the path from the first pose to the last of each conflict", "LINESTRING",
       GeoShape::kLine, [&poses](const Conflict& c) { return path_of(c, poses); }, listed}};
  if (!small.empty()) {
    layers.push_back({"small_groups", "groups of too few points to be listed", "POINT",
                      GeoShape::kPoint,
                      [](const Conflict& c) { return std::vector<Vec3>{c.centroid}; }, small});
  }
  return layers;
}

const char* sql_type(const ConflictField& field) {
  if (std::holds_alternative<std::string_view>(field.value)) return "TEXT";
  return field.is_real ? "DOUBLE" : "INTEGER";
}

void add_system(sqlite::Database& database, std::int32_t id, const std::string& name,
                const std::string& organization, std::int32_t code, const std::string& wkt) {
  sqlite::Insert(database, "INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, NULL)")
      .add_text(name)
      .add_integer(id)
      .add_text(organization)
      .add_integer(code)
      .add_text(wkt)
      .run();
}

/// Adds the reference systems and returns the number of that of the scans.
std::int32_t add_systems(sqlite::Database& database, const std::string& wkt) {
  add_system(database, -1, "Undefined Cartesian SRS", "NONE", -1, "undefined");
  add_system(database, 0, "Undefined geographic SRS", "NONE", 0, "undefined");
  add_system(database, 4326, "WGS 84", "EPSG", 4326, kWgs84);
  if (wkt.empty()) return kUnknownCartesian;
  const ScanCrs crs = scan_crs_of(wkt);
  if (crs.epsg == 4326) return crs.epsg;
  const std::int32_t id = crs.epsg != 0 ? crs.epsg : kOwnCode;
  add_system(database, id, crs.name, crs.epsg != 0 ? "EPSG" : "NONE", id, crs.wkt);
  return id;
}

void add_contents(sqlite::Database& database, const Layer& layer, const std::vector<Vec3>& corners,
                  const std::string& date, std::int32_t srs) {
  sqlite::Insert insert(database,
                        "INSERT INTO gpkg_contents VALUES (?, 'features', ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.add_text(layer.table).add_text(layer.table).add_text(layer.description);
  insert.add_text(date.substr(0, date.size() - 1) + ".000Z");
  const bool any = !corners.empty();
  const Box box = any ? box_of(corners) : Box{};
  for (const double side : {box.lo.x, box.lo.y, box.hi.x, box.hi.y}) {
    insert.add(any ? FieldValue(side) : FieldValue());
  }
  insert.add_integer(srs).run();
  sqlite::Insert(database, "INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, 1, 0)")
      .add_text(layer.table)
      .add_text(layer.type)
      .add_integer(srs)
      .run();
}

/// Adds a layer, in which the number of a feature is that of its conflict.
void add_layer(sqlite::Database& database, const Layer& layer, const ConflictFile& file,
               std::int32_t srs) {
  std::string columns, places = "?, ?";
  for (const ConflictField& field : sample_fields(file)) {
    if (field.name == "id") continue;
    columns += ", \"" + field.name + "\" " + sql_type(field);
    places += ", ?";
  }
  const std::string table = layer.table;
  database.run("CREATE TABLE " + table + " (id INTEGER PRIMARY KEY NOT NULL, geom " + layer.type +
               columns + ")");
  sqlite::Insert insert(database, "INSERT INTO " + table + " VALUES (" + places + ")");
  std::vector<Vec3> corners;
  for (const Conflict& conflict : layer.features) {
    const std::vector<Vec3> points = layer.points(conflict);
    const Box box = box_of(points);
    corners.insert(corners.end(), {box.lo, box.hi});
    const auto fields = fields_of(conflict, file);
    insert.add(fields.front().value).add_blob(geometry_bytes(layer.shape, points, srs));
    for (std::size_t i = 1; i < fields.size(); ++i) insert.add(fields[i].value);
    insert.run();
  }
  add_contents(database, layer, corners, file.date, srs);
}

}  // namespace

void write_geopackage(const ConflictFile& conflicts, const std::filesystem::path& path) {
  sqlite::Database database(path);
  database.run("PRAGMA application_id = 0x47504B47");  // "GPKG"
  database.run("PRAGMA user_version = 10300");
  database.run("BEGIN");
  database.run(kTables);
  const std::int32_t srs = add_systems(database, conflicts.header.crs_wkt);
  std::vector<Conflict> small;
  for (const SmallGroup& group : conflicts.conflicts.small) {
    small.push_back(as_conflict(group));
    small.back().id = static_cast<std::uint32_t>(small.size());
  }
  for (const Layer& layer : layers_of(conflicts, small)) {
    add_layer(database, layer, conflicts, srs);
  }
  database.run("COMMIT");
  database.close();
}

}  // namespace clearway
