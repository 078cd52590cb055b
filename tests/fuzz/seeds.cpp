// Writes small inputs of every kind, one folder a fuzz target: fuzz_seeds FOLDER.
#include <fstream>
#include <iostream>

#include "core/cloud/packed_cloud.hpp"
#include "io/result/journal.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/bytes/mesh_bytes.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/bytes/sbet_bytes.hpp"
#include "support/clouds.hpp"
#include "support/land_xml.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Writes the seeds of one fuzz target.
class Seeds {
 public:
  Seeds(const std::filesystem::path& folder, const std::string& target) : folder_(folder / target) {
    std::filesystem::create_directories(folder_);
  }
  std::filesystem::path next() { return folder_ / std::to_string(count_++); }
  void add(const std::string& bytes) { put_bytes(next(), bytes); }

 private:
  std::filesystem::path folder_;
  int count_ = 0;
};

void write_las_seeds(Seeds seeds) {
  const std::string keys("\1\0\1\0\0\0\1\0\0\4\0\0\1\0\1\0", 16);
  for (unsigned format = 0; format <= 10; ++format) {
    LasBytes las;
    las.minor = format < 6 ? format < 4 ? 2 : 3 : 4;
    las.format = format;
    las.extra_bytes = format % 3;
    las.vlrs = {{"LASF_Projection", 34735, keys}, {"liblas", 2112, "LOCAL_CS[\"a\"]"}};
    if (las.minor == 3) las.global_encoding = 2;
    if (las.minor >= 3) {
      las.evlrs = {
          {"LASF_Projection", 2112, "PROJCS[\"a\",GEOGCS[\"b\"],UNIT[\"US survey foot\",0.3048]]"}};
    }
    seeds.add(las.build());
  }
}

/// Writes each E57 seed as a file and as its content; see e57.cpp.
void write_e57_seeds(Seeds seeds) {
  E57Bytes file;
  file.root_xml = "<coordinateMetadata type=\"String\">LOCAL_CS[\"a\"]</coordinateMetadata>";
  file.scans = {e57_scan({1, 2, 3}, {4, 5, 6}, {7, 8, 9}), e57_scan({}, {}, {})};
  file.scans[0].xml = E57Bytes::pose({"0", "1", "0", "0"}, {"1", "2", "3"});
  file.scans[0].packets = {{9, 3, 0}};
  file.scans[0].index_packets = true;
  file.scans.emplace_back();
  file.scans[2].fields = {E57Bytes::float32("sphericalRange", {1, 2}),
                          E57Bytes::float64("sphericalAzimuth", {0.5, 1}),
                          E57Bytes::integer("sphericalElevation", -9, 9, {-9, 4}, "scale=\"0.1\""),
                          E57Bytes::integer("sphericalInvalidState", 0, 2, {0, 2}),
                          E57Bytes::integer("cartesianX", 4, 4, {4, 4}),
                          E57Bytes::integer("cartesianY", -1, 1L << 40, {4, 5}),
                          E57Bytes::integer("cartesianZ", 0, 1, {0, 1}),
                          E57Bytes::float32("cartesianInvalidState", {1, 0})};
  seeds.add('\1' + file.build());
  file.page = 128;
  seeds.add('\0' + file.build());
  seeds.add('\2' + file.content().bytes);
  for (E57Bytes::Scan& scan : file.scans) {
    E57Bytes one;
    one.page = 128;
    one.scans = {scan};
    seeds.add('\2' + one.content().bytes);
  }
}

/// Writes LAZ seeds as whole files, and the same points behind the settings of laz.cpp.
void write_laz_seeds(Seeds seeds) {
  for (const unsigned format : kLazFormats) {
    LazBytes laz = laz_bytes(format, 60);
    laz.chunks = {25};
    laz.variable = format % 2 == 1;
    seeds.add(laz.build());
    laz.variable = false;
    laz.chunks = {51};
    laz.las.extra_bytes = 1;
    for (const auto table : {LazBytes::Table::kNone, LazBytes::Table::kAtEnd}) {
      laz.table = table;
      const char setting = static_cast<char>(format < 6 ? format : format - 2);
      seeds.add(std::string{setting, 1, 60, 0, 1} + laz.build().substr(laz.head(60).size()));
    }
  }
}

void write_ply_seeds(Seeds seeds) {
  const auto header = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment c\nelement a 2\nproperty list uchar int n\nelement vertex 2\n"
           "property float x\nproperty double y\nproperty short z\nproperty list char uchar l\n"
           "end_header\n";
  };
  seeds.add(header("binary_little_endian") + std::string(100, '\1'));
  seeds.add(header("binary_big_endian") + std::string(100, '\1'));
  seeds.add(header("ascii") + "0\n1 7\n1 2 3 0\n4 5 6 1 9\n");
  const std::string plain =
      "element vertex 2\nproperty uint8 x\nproperty int32 y\nproperty float64 z\nend_header\n";
  seeds.add("ply\nformat ascii 1.0\n" + plain + "1 2 3\n4 -5 6e-1\n");
  seeds.add("ply\nformat binary_little_endian 1.0\n" + plain + std::string(26, '\2'));
}

void write_pcd_seeds(Seeds seeds) {
  PcdHeaderText header;
  const std::string columns = raw(1.F, 1.F, 2.F, 2.F, 3.F, 3.F);
  seeds.add(header.build("ascii") + "1 2 3\n4,5,6\n");
  seeds.add(header.build("binary") + columns + std::string(20, '\0'));
  seeds.add(header.build("binary_compressed") + compressed(columns));
  header = {"z _ n Y x", "8 1 4 2 4", "F U F I F", "1 2 2 1 1", "1", "2", "1 2 3 0 1 0 0", "2"};
  seeds.add(header.build("ascii") + "nan 0 0 7 7 2 1.5\n6 0 0 1 1 5 4\n");
  seeds.add(header.build("binary") + std::string(48, '\2'));
  seeds.add(header.build("binary_compressed") + compressed(std::string(44, '\3')));
  header = {"x y z", "8 8 8", "F F F", "1 1 1", "300", "300", "0 0 0 1 0 0 0", "90000"};
  seeds.add(header.build("binary_compressed") + compressed(std::string(2'160'000, '\1')));
  seeds.add("COLUMNS x y z\nPOINTS 1\nDATA ascii\n1 2 3");
}

void write_ptx_seeds(Seeds seeds) {
  const std::string scan =
      "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n1 2 3 1\n"
      "0 0 0 0.5\n1 2 3 0.5 1 2 3\n";
  seeds.add(std::string(1, '\0') + scan + scan);
  seeds.add(
      "\1"
      "1\n1 2 3 -5\n2\n1 2 3\n4 5 6\n");
  seeds.add("\2" + scan);
  seeds.add(
      "\3"
      "361 225\n1 2 3 0.5\n4 5 6\n");
  seeds.add(
      "\4"
      "1 2 3\n4 5 6\n");
  seeds.add(
      "\5"
      "1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1 2\n1 0 0 0 0 0 1 0 0 -1 0 0 1 2 3 1\n");
}

void write_text_seeds(Seeds xyz, Seeds trajectory) {
  xyz.add("2\n1 2 3 4\n5 6 7 8\n");
  xyz.add("# c\n1.5;-2e3;+3\n4;5;6;7\n");
  xyz.add("\xEF\xBB\xBF//X Z Y\n1 2 3\nnan inf 1\n");
  xyz.add("a,z,y,x\n1,2,3,4\r\n5,6,7,8");
  xyz.add("# id Easting [m] Northing [ft] H (mm)\nP1 1 2 3\nP2 4 5 6\n");
  xyz.add("Lat;Lon;E_m;N;Elevation\n1;2;3;4;5\n1,5;2;3;4;5.");
  xyz.add("0.1 1 2 3 0 0 0.6 0.8\n0.2 1 2 3 0 0 0.8 0.6\n");
  xyz.add("1 0 0 5 0 1 0 6 0 0 1 7\n0 5.5 3.25 1\n1 5.5 3.25 1\n2 5.25 3.5 1\n");
  const std::string matrix = "1 0 0 5 0 1 0 6 0 0 1 7";
  const auto add = [&trajectory](char format, char options, const std::string& text) {
    trajectory.add(std::string{format, options} + text);
  };
  add(0, 0, "# c\n" + matrix + "\n" + matrix + "\n");
  add(1, 108, matrix + " 0 0 0 1\n// c\n");
  add(2, 54, "1.5 1 2 3 0 0 0 1\n");
  add(3, 0, "#timestamp [ns], p_x\n1403636579758555392,1,2,3,1,0,0,0\n");
  add(4, 0, "t,x,y,z,qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n");
  add(4, 0, "x;y;z;r00;r01;r02;r10;r11;r12;r20;r21;r22\n1;2;3;1;0;0;0;1;0;0;0;1\n");
  add(0, 0, "x[mm],y[mm],z[mm],roll_deg,pitch_deg,heading_deg\n1,2,3,4,5,6\n7,8,9,1,2,300\n");
  add(0, 8, "x y z roll pitch yaw\n1 2 3 0.4 0.5 6\n7 8 9 1 2 3\n");
  add(0, 18, "lat,lon,height,roll_rad,pitch_rad,heading_rad\n48,9,300,0,0.1,2\n");
  add(5, 0, "1 2 3 0 0 0 1\n");
  add(6, 0, "1 2 3 1 0 0 0\n");
  add(7, 18, SbetRecord().bytes() + SbetRecord{.heading = 1, .wander = 0.1}.bytes());
  add(8, 0, "1 2 3\n10 20 30\n");
  add(9, 0, "1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1 2\n");
}

void write_line_seeds(Seeds seeds) {
  const auto add = [&seeds](char options, const std::string& text) {
    seeds.add(std::string{options} + text);
  };
  add(0, "x [m],y [m],z [m],station,cant [mm]\n0,0,1,5,0\n10,0,2,15,10\n20,1,3,25,20\n");
  add(6, "# route\nx;y\n0;0\n10;0\n10;0\n10;10\n");
  add(2, R"({"type": "LineString", "coordinates": [[0, 0], [10, 0], [20, 1]]})");
  add(4, R"({"type": "FeatureCollection", "crs": {"properties": {"name": "EPSG:25832"}}, )"
         R"("features": [{"type": "Feature", "geometry": {"type": "MultiLineString", )"
         R"("coordinates": [[[0, 0, 1], [10, 0, 2], [10, 10, 3]]]}}]})");
}

void write_alignment_seeds(Seeds seeds) {
  const auto add = [&seeds](char options, const LandFile& file) {
    seeds.add(std::string{options} + file.text());
  };
  LandFile file;
  add(0, file);
  add(2, file);
  file.more = cant_of(R"(gauge="1.435" rotationPoint="insideRail")",
                      cant_station(1000, 0, "") + cant_station(1100, 90, R"(curvature="ccw")")) +
              R"(<StaEquation staAhead="5" staInternal="1050"/>)";
  file.profile =
      R"(<Profile><ProfAlign name="p"><PVI>1000 10</PVI><ParaCurve length="20">1050 12</ParaCurve>)"
      R"(<UnsymParaCurve lengthIn="9" lengthOut="20">1090 12</UnsymParaCurve>)"
      R"(<CircCurve length="9" radius="500">1150 12</CircCurve><PVI>1179 10</PVI></ProfAlign></Profile>)";
  add(0, file);
  add(static_cast<char>(0xF0), file);
  file.curve =
      R"(<Spiral length="60" radiusStart="INF" radiusEnd="80" rot="ccw" spiType="clothoid">)"
      R"(<Start>0 100</Start><End>7.425001432715223 159.16172537187745</End></Spiral>)";
  file.units = R"(<Imperial linearUnit="USSurveyFoot"/>)";
  file.other = R"(<CoordinateSystem epsgCode="3878"/>)";
  add(8, file);
  file.profile = "";
  add(12, file);
}

void write_mesh_seeds(Seeds seeds) {
  const TriangleMesh cube = unit_cube();
  const auto add = [&](char format, const std::string& bytes) {
    seeds.add(std::string(1, format) + bytes);
  };
  add('\0', ascii_stl(cube));
  add('\0', binary_stl(cube, "solid"));
  add('\1', obj_text(cube));
  add('\1',
      "v 0 0 0 1\nv 1 0 0\nv 1 1 0\nv 0.5 .2 0\nv 0 1 0\nf -5/1/1 2//2 -3 \\\n4/4 5\nl 1 2\n");
  add('\2', off_text(cube));
  add('\2',
      "COFF 4 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0 1 1 1 1 # c\n0 1 0 1 1 1 1\n4 0 1 2 3 9\n");
  add('\3', ply_mesh(cube, "ascii"));
  add('\3', ply_mesh(cube, "binary_little_endian"));
}

template <typename Value>
void add_chunk(Seeds& seeds, const std::vector<Value>& values) {
  std::vector<std::byte> bytes;
  append_packed_chunk(std::span<const Value>(values), bytes);
  const std::size_t count = values.size() - 1;
  seeds.add(std::string{static_cast<char>(count % 256), static_cast<char>(count / 256)} +
            std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void write_chunk_seeds(Seeds seeds) {
  for (const unsigned bits : {0u, 1u, 5u, 8u, 17u, 31u, 32u}) {
    std::vector<std::int32_t> values{0};
    for (std::uint32_t i = 1; i < 70; ++i) {
      values.push_back(static_cast<std::int32_t>(static_cast<std::uint32_t>(
          (std::uint64_t{i} * 0x9E3779B97F4A7C15 >> 32) & ((std::uint64_t{1} << bits) - 1))));
    }
    add_chunk(seeds, values);
    add_chunk(seeds, std::vector<std::uint64_t>(values.begin(), values.end()));
  }
}

void write_store_seeds(Seeds seeds, Seeds values) {
  const ScratchFolder folder;
  for (const std::size_t points : {0, 1, 65, 300}) {
    write_las(folder / "a.las", cube_cloud(points, -4000, 4000, 3));
    convert_quietly(conversion_of({folder / "a.las"}, seeds.next()));
  }
  for (char what = 0; what < 27; ++what) {
    values.add(std::string(1, what) + std::string("\1\0\0\0\0\0\0\0\1\0", 10));
  }
}

void write_result_seeds(Seeds seeds) {
  for (const bool first_pose : {false, true}) {
    for (const std::size_t rows : {0, 1, 20}) {
      ResultHeader header = sample_header(first_pose);
      write_result(seeds.next(), header, sample_rows(header, rows));
      header.clearance = 0.5;
      write_result(seeds.next(), header, sample_rows(header, rows), 1000,
                   sample_clearances(header, rows));
      header.poses = 20;
      header.profile = 0.25;
      write_result(seeds.next(), header, {}, 1000, {}, sample_profile(header));
    }
  }
}

/// Payloads of records, in the form that journal.cpp needs for a first byte.
std::vector<std::string> payloads_of(int kind) {
  const bool first_pose = (kind & 1) != 0, clearance = (kind & 2) != 0, profile = (kind & 8) != 0;
  // A word of two points, and for each of them a pose and a squared distance of 1/16
  const std::string rows("\1\0\5\0\0\0\0\0\0\0", 10), poses("\7\0\0\0\11\0\0\0", 8);
  const std::string distance("\0\0\0\0\0\0\xb0\x3f", 8);
  std::string cell = clearance ? std::string("\1\2\0\1\0", 5) : std::string("\1\1\0\0", 4);
  cell += rows + (first_pose ? poses : "");
  if (clearance) cell += rows + poses + distance + distance;
  if (profile) return {cell, "\2\1\5" + distance + '\7'};
  return {cell};
}

void write_journal_seeds(Seeds seeds) {
  const ScratchFolder folder;
  for (const int kind : {0, 1, 2, 3, 8, 11}) {
    std::string payloads(1, static_cast<char>(kind + 4));
    std::filesystem::remove(folder / "a.journal");
    {
      JournalWriter writer = JournalWriter::create(folder / "a.journal", {{"radius", "0.1"}}, 0);
      for (const std::string& payload : payloads_of(kind)) {
        JournalRecord record;
        for (const char byte : payload) record.put(byte);
        writer.append(record);
        payloads += std::string{static_cast<char>(payload.size()), '\0'} + payload;
      }
    }
    const std::string file = bytes_of(folder / "a.journal");
    seeds.add(payloads);
    const char first = static_cast<char>(kind);
    seeds.add(first + file);
    seeds.add(first + file.substr(0, file.size() - 2));
  }
}

/// Writes JSON seeds, whose first byte is 0 for any value, 1 for a vehicle and 2 for a campaign.
/// The files that the campaigns name exist.
void write_json_seeds(Seeds seeds) {
  const std::string value(1, '\0'), vehicle = "\1", campaign = "\2";
  seeds.add(value + R"({"a": [1, -2.5e3, "\u00e4\\\"", true, null, {"b": {}}], "c": [[[]]]})");
  seeds.add(value + R"({"a": 1, "a": 2})");
  seeds.add(value + std::string(65, '[') + std::string(65, ']'));
  seeds.add(vehicle + R"({"bodies": [{"name": "tractor", "model": "a.ply", "at": "10cm"},)"
                      R"({"name": "wagon", "model": "b.obj", "model_unit": "mm",)"
                      R"("pivots": [10, "-10 m"]},)"
                      R"({"name": "own", "model": "c.xyz", "trajectory": "path.txt"}]})");
  seeds.add(campaign +
            R"({"name": "a", "environments": {"e": "."}, "vehicles": {"v": {"model": ".",)"
            R"("as": "solid", "unit": "mm", "spacing": 0.1, "vertices": true,)"
            R"("forward": "-x", "up": "+z"}}, "routes": {"r": {"trajectory": ".",)"
            R"("environment": "e", "angles": ["deg", "ned"], "lever_arm": [0, 1, 2],)"
            R"("chainage_start": 5}}, "radii": [0.1, "25cm"],)"
            R"("query": {"first_pose": true, "clearance": 0.3, "ignore_classes": [2, 7],)"
            R"("ignore_boxes": [[0, 0, 0, 1, 1, 1]]},)"
            R"("classes": [0.1, 0.3], "outputs": {"conflicts": ["csv", "bcf"], "report": true,)"
            R"("gap": 0.3, "min_points": 5}, "limits": {"memory": "1G", "threads": 2,)"
            R"("shard_seconds": 60, "gpus": [0]}, "slurm": ["--partition=long"]})");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: fuzz_seeds FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  write_las_seeds({folder, "las"});
  write_las_seeds({folder, "las_records"});
  write_e57_seeds({folder, "e57"});
  write_pcd_seeds({folder, "pcd"});
  write_laz_seeds({folder, "laz"});
  write_ply_seeds({folder, "ply"});
  write_ptx_seeds({folder, "ptx"});
  write_text_seeds({folder, "xyz"}, {folder, "trajectory"});
  write_alignment_seeds({folder, "alignment"});
  write_line_seeds({folder, "line"});
  write_mesh_seeds({folder, "mesh"});
  write_chunk_seeds({folder, "packed_chunk"});
  write_store_seeds({folder, "store"}, {folder, "store_values"});
  write_result_seeds({folder, "result"});
  write_journal_seeds({folder, "journal"});
  write_json_seeds({folder, "json"});
}
