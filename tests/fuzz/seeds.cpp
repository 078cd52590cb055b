// Writes small inputs of every kind, one folder a fuzz target: fuzz_seeds FOLDER.
#include <fstream>
#include <iostream>
#include <map>

#include "core/cloud/packed_cloud.hpp"
#include "formats/format_cases.hpp"
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

/// Writes the seeds of all targets, with their first bytes, which choose options, before the rest.
class Seeds {
 public:
  explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::filesystem::path next(const std::string& target) {
    std::filesystem::create_directories(folder_ / target);
    return folder_ / target / std::to_string(counts_[target]++);
  }
  void add(const std::string& target, const std::vector<int>& first, const std::string& rest) {
    std::string bytes;
    for (const int byte : first) bytes += static_cast<char>(byte);
    put_bytes(next(target), bytes + rest);
  }

 private:
  std::filesystem::path folder_;
  std::map<std::string, int> counts_;
};

void write_scans(Seeds& seeds) {
  const std::string keys("\1\0\1\0\0\0\1\0\0\4\0\0\1\0\1\0", 16);
  for (unsigned format = 0; format <= 10; ++format) {
    LasBytes las{.minor = format < 6 ? format < 4 ? 2U : 3U : 4U,
                 .format = format,
                 .extra_bytes = format % 3};
    las.vlrs = {{"LASF_Projection", 34735, keys}, {"liblas", 2112, "LOCAL_CS[\"a\"]"}};
    if (las.minor == 3) las.global_encoding = 2;
    if (las.minor >= 3) {
      las.evlrs = {
          {"LASF_Projection", 2112, "PROJCS[\"a\",GEOGCS[\"b\"],UNIT[\"US survey foot\",0.3048]]"}};
    }
    for (const char* target : {"las", "las_records"}) seeds.add(target, {}, las.build());
  }
  // LAZ as whole files, and the same points behind the settings of their target
  for (const unsigned format : kLazFormats) {
    LazBytes laz = laz_bytes(format, 60);
    laz.chunks = {25};
    laz.variable = format % 2 == 1;
    seeds.add("laz", {}, laz.build());
    laz.variable = false;
    laz.chunks = {51};
    laz.las.extra_bytes = 1;
    for (const auto table : {LazBytes::Table::kNone, LazBytes::Table::kAtEnd}) {
      laz.table = table;
      seeds.add("laz", {static_cast<int>(format < 6 ? format : format - 2), 1, 60, 0, 1},
                laz.build().substr(laz.head(60).size()));
    }
  }
}

/// Writes E57 as files and as their content.
void write_e57(Seeds& seeds) {
  E57Bytes file;
  file.root_xml = "<coordinateMetadata type=\"String\">LOCAL_CS[\"a\"]</coordinateMetadata>";
  file.scans = {e57_scan({1, 2, 3}, {4, 5, 6}, {7, 8, 9}), e57_scan({}, {}, {})};
  file.scans[0].xml = E57Bytes::pose({"0", "1", "0", "0"}, {"1", "2", "3"});
  file.scans[0].packets = {{9, 3, 0}};
  file.scans[0].index_packets = true;
  file.scans.emplace_back().fields = {
      E57Bytes::float32("sphericalRange", {1, 2}),
      E57Bytes::float64("sphericalAzimuth", {0.5, 1}),
      E57Bytes::integer("sphericalElevation", -9, 9, {-9, 4}, "scale=\"0.1\""),
      E57Bytes::integer("sphericalInvalidState", 0, 2, {0, 2}),
      E57Bytes::integer("cartesianX", 4, 4, {4, 4}),
      E57Bytes::integer("cartesianY", -1, 1L << 40, {4, 5}),
      E57Bytes::integer("cartesianZ", 0, 1, {0, 1}),
      E57Bytes::float32("cartesianInvalidState", {1, 0})};
  seeds.add("e57", {1}, file.build());
  file.page = 128;
  seeds.add("e57", {0}, file.build());
  seeds.add("e57", {2}, file.content().bytes);
  for (const E57Bytes::Scan& scan : file.scans) {
    E57Bytes one;
    one.page = 128;
    one.scans = {scan};
    seeds.add("e57", {2}, one.content().bytes);
  }
}

/// Writes the files of tests/formats, which are of one target for each reader and ending.
void write_cases(Seeds& seeds) {
  const std::map<std::string, std::pair<const char*, std::vector<int>>> targets{
      {"points.ply", {"ply", {}}},  {"points.pcd", {"pcd", {}}}, {"points.ptx", {"ptx", {0}}},
      {"points.pts", {"ptx", {1}}}, {"points.3d", {"ptx", {3}}}, {"pose.3d", {"ptx", {4}}},
      {"frames.3d", {"ptx", {5}}},  {"points.csv", {"xyz", {}}}, {"mesh.stl", {"mesh", {0}}},
      {"mesh.obj", {"mesh", {1}}},  {"mesh.off", {"mesh", {2}}}, {"mesh.ply", {"mesh", {3}}}};
  for (const std::string name : {"mesh", "pcd", "ply", "ptx", "text", "threedtk"}) {
    FormatCases(
        std::string(CLEARWAY_FORMAT_CASES) + "/" + name + ".case", [&](const FormatCase& one) {
          const auto found = targets.find(one.setting("read", "points") +
                                          std::filesystem::path(one.name).extension().string());
          if (found == targets.end() || one.bytes.size() > 65536) return;
          seeds.add(found->second.first, found->second.second, one.bytes);
        });
  }
}

/// Writes binary files of which tests/formats has none.
void write_points(Seeds& seeds) {
  PcdHeaderText header;
  const auto pcd = [&](const std::string& columns) {
    seeds.add("pcd", {}, header.build("binary_compressed") + compressed(columns));
  };
  pcd(raw(1.F, 1.F, 2.F, 2.F, 3.F, 3.F));
  header = {"z _ n Y x", "8 1 4 2 4", "F U F I F", "1 2 2 1 1", "1", "2", "1 2 3 0 1 0 0", "2"};
  pcd(std::string(44, '\3'));
  header = {"x y z", "8 8 8", "F F F", "1 1 1", "300", "300", "0 0 0 1 0 0 0", "90000"};
  pcd(std::string(2'160'000, '\1'));
  seeds.add("mesh", {0}, binary_stl(unit_cube(), "solid"));
  seeds.add("mesh", {3}, ply_mesh(unit_cube(), "binary_little_endian"));
}

/// Writes the seeds of texts.case: a target and its first bytes, a bar, and the text.
void write_texts(Seeds& seeds) {
  std::ifstream file(std::string(CLEARWAY_FUZZ_SEEDS) + "/texts.case");
  for (std::string line; std::getline(file, line);) {
    const std::size_t bar = line.find(" | ");
    if (bar == line.npos) continue;
    std::istringstream in(line.substr(0, bar));
    std::string target;
    in >> target;
    std::vector<int> first;
    for (int byte; in >> byte;) first.push_back(byte);
    seeds.add(target, first, unescaped(line.substr(bar + 3)));
  }
  seeds.add("trajectory", {7, 18},
            SbetRecord().bytes() + SbetRecord{.heading = 1, .wander = 0.1}.bytes());
  seeds.add("json", {0}, std::string(65, '[') + std::string(65, ']'));
}

void write_alignments(Seeds& seeds) {
  LandFile file;
  const auto add = [&](int options) { seeds.add("alignment", {options}, file.text()); };
  add(0);
  add(2);
  file.more = cant_of(R"(gauge="1.435" rotationPoint="insideRail")",
                      cant_station(1000, 0, "") + cant_station(1100, 90, R"(curvature="ccw")")) +
              R"(<StaEquation staAhead="5" staInternal="1050"/>)";
  file.profile =
      R"(<Profile><ProfAlign name="p"><PVI>1000 10</PVI><ParaCurve length="20">1050 12</ParaCurve>)"
      R"(<UnsymParaCurve lengthIn="9" lengthOut="20">1090 12</UnsymParaCurve>)"
      R"(<CircCurve length="9" radius="500">1150 12</CircCurve><PVI>1179 10</PVI></ProfAlign></Profile>)";
  add(0);
  add(0xF0);
  file.curve =
      R"(<Spiral length="60" radiusStart="INF" radiusEnd="80" rot="ccw" spiType="clothoid">)"
      R"(<Start>0 100</Start><End>7.425001432715223 159.16172537187745</End></Spiral>)";
  file.units = R"(<Imperial linearUnit="USSurveyFoot"/>)";
  file.other = R"(<CoordinateSystem epsgCode="3878"/>)";
  add(8);
  file.profile = "";
  add(12);
}

template <typename Value>
void add_chunk(Seeds& seeds, const std::vector<Value>& values) {
  std::vector<std::byte> bytes;
  append_packed_chunk(std::span<const Value>(values), bytes);
  const int count = static_cast<int>(values.size()) - 1;
  seeds.add("packed_chunk", {count % 256, count / 256},
            std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void write_stores(Seeds& seeds) {
  for (const unsigned bits : {0u, 1u, 5u, 8u, 17u, 31u, 32u}) {
    std::vector<std::int32_t> values{0};
    for (std::uint32_t i = 1; i < 70; ++i) {
      values.push_back(static_cast<std::int32_t>(static_cast<std::uint32_t>(
          (std::uint64_t{i} * 0x9E3779B97F4A7C15 >> 32) & ((std::uint64_t{1} << bits) - 1))));
    }
    add_chunk(seeds, values);
    add_chunk(seeds, std::vector<std::uint64_t>(values.begin(), values.end()));
  }
  const ScratchFolder folder;
  for (const std::size_t points : {0, 1, 65, 300}) {
    write_las(folder / "a.las", cube_cloud(points, -4000, 4000, 3));
    convert_quietly(conversion_of({folder / "a.las"}, seeds.next("store")));
  }
  for (int what = 0; what < 27; ++what) {
    seeds.add("store_values", {what, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0}, "");
  }
  for (const bool first_pose : {false, true}) {
    for (const std::size_t rows : {0, 1, 20}) {
      const auto next = [&] { return seeds.next("result"); };
      ResultHeader header = sample_header(first_pose);
      write_result(next(), header, sample_rows(header, rows));
      header.clearance = 0.5;
      write_result(next(), header, sample_rows(header, rows), 1000,
                   sample_clearances(header, rows));
      header.poses = 20;
      header.profile = 0.25;
      write_result(next(), header, {}, 1000, {}, sample_profile(header));
    }
  }
}

/// Payloads of records, in the form that the target `journal` needs for a first byte.
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

void write_journals(Seeds& seeds) {
  const ScratchFolder folder;
  for (const int kind : {0, 1, 2, 3, 8, 11}) {
    std::string payloads;
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
    seeds.add("journal", {kind + 4}, payloads);
    seeds.add("journal", {kind}, file);
    seeds.add("journal", {kind}, file.substr(0, file.size() - 2));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: fuzz_seeds FOLDER\n";
    return 2;
  }
  Seeds seeds(argv[1]);
  for (const auto write : {write_scans, write_e57, write_cases, write_points, write_texts,
                           write_alignments, write_stores, write_journals}) {
    write(seeds);
  }
}
