// Reads the files of *.case, whose form format_cases.hpp explains.
#include <cmath>
#include <random>
#include <sstream>

#include "clearway/outline.hpp"
#include "formats/format_cases.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/scans/las/geotiff_keys.hpp"
#include "io/scans/map_scale.hpp"
#include "io/scans/scan_crs.hpp"
#include "io/scans/threedtk/threedtk_frame.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Numbers = std::vector<double>;

/// What was read from a file.
struct Facts {
  std::map<std::string, Numbers> numbers;
  std::map<std::string, std::string> texts;
  std::vector<std::string> remarks;
};

std::string words_of(const Message& remark) {
  std::ostringstream out;
  out << (remark.severity == Message::Severity::kNote ? "note " : "warning ") << remark.code << ": "
      << remark.text;
  for (const auto& [name, number] : remark.numbers) out << " [" << name << ' ' << number << ']';
  return out.str();
}

void add(Numbers& numbers, const std::vector<Vec3>& points) {
  for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
}

bool same(const Numbers& a, const Numbers& b, double tolerance) {
  return std::ranges::equal(a, b, [=](double x, double y) {
    return x == y || std::abs(x - y) <= tolerance || (std::isnan(x) && std::isnan(y));
  });
}

Facts collect(PointReader& reader) {
  Facts facts;
  const ReadCloud cloud = read_all(reader);
  const CloudInfo& info = cloud.info;
  add(facts.numbers["points"], cloud.positions);
  facts.numbers["absent"].assign(cloud.absent.begin(), cloud.absent.end());
  facts.numbers["count"] = {static_cast<double>(cloud.positions.size())};
  for (const Message& remark : info.remarks) facts.remarks.push_back(words_of(remark));
  facts.numbers["declared"] = {static_cast<double>(info.declared_points.value_or(-1))};
  facts.numbers["table"] = {info.text_table ? 1. : 0.};
  facts.numbers["faces"] = {static_cast<double>(info.faces)};
  facts.numbers["heights"] = {info.height_unit};
  facts.numbers["origins"];
  for (const OriginRun& run : info.origins) add(facts.numbers["origins"], {*run.origin});
  facts.texts = {{"unit", to_string(info.unit)},
                 {"unplaced", info.unplaced},
                 {"wkt", info.crs_wkt},
                 {"crs", info.crs},
                 {"crs_unread", info.crs_unread}};
  return facts;
}

/// Reads the points twice and, where the file has pieces, piece by piece.
Facts read_points(const std::filesystem::path& path, const PointReadOptions& options) {
  const auto reader = open_point_file(path, options);
  Facts facts = collect(*reader);
  const Numbers& points = facts.numbers["points"];
  reader->rewind();
  const Facts again = collect(*reader);
  CHECK(same(again.numbers.at("points"), points, 0));
  CHECK(again.remarks == facts.remarks);
  Numbers pieces;
  PointBatch batch;
  for (std::size_t i = 0; i < reader->pieces(); ++i) {
    reader->read_piece(i, batch, nullptr);
    add(pieces, batch.positions);
  }
  if (reader->pieces() > 0) CHECK(same(pieces, points, 0));
  if (points.empty() || points.size() > 30) return facts;
  std::vector<std::uint64_t> numbers;
  while (numbers.size() < points.size() / 3) numbers.push_back(numbers.size());
  const auto lines = reader->lines_of(numbers);
  facts.numbers["lines"].assign(lines.begin(), lines.end());
  if (!lines.empty()) {
    check_equal(reader->lines_of(std::vector{numbers.back()}), {lines.back()});
  }
  return facts;
}

Facts read_mesh_file(const std::filesystem::path& path) {
  File file = File::open_for_reading(path);
  const auto format = mesh_format_of(file, path);
  if (!format) return {};
  const MeshFile read =
      read_mesh(InputBuffer(std::move(file), InputBuffer::Access::kSeek), *format);
  Facts facts;
  for (const auto& triangle : read.mesh.triangles) {
    auto& all = facts.numbers["triangles"];
    all.insert(all.end(), triangle.begin(), triangle.end());
  }
  add(facts.numbers["vertices"], read.mesh.vertices);
  const MeshRemarks& remarks = read.remarks;
  const auto number = [](std::uint64_t value) { return Numbers{static_cast<double>(value)}; };
  facts.numbers["polygons"] = number(remarks.polygons);
  facts.numbers["segments"] = number(remarks.segments);
  facts.numbers["single"] = number(remarks.single_points);
  facts.texts["end"] = remarks.last_line_open ? "open" : "closed";
  return facts;
}

/// Where the pose puts the origin and the ends of 3DTK's axes: right, up and forward.
Facts read_pose(const std::filesystem::path& path, bool frames) {
  TextTable table(InputBuffer::open_regular(path));
  const Pose pose = frames ? read_threedtk_frames(table) : read_threedtk_pose(table);
  Facts facts;
  for (const Vec3& axis : {Vec3{}, Vec3{100, 0, 0}, Vec3{0, 100, 0}, Vec3{0, 0, 100}}) {
    add(facts.numbers["axes"], {transform(pose, from_threedtk(axis))});
  }
  return facts;
}

/// A sound E57 file of two points after an edit; see e57.case.
std::string e57_after(const std::string& edit, bool index_packets) {
  E57Bytes file;
  file.scans = {e57_scan({1, 2}, {3, 4}, {5, 6})};
  file.scans[0].index_packets = index_packets;
  auto [bytes, sections, xml] = file.content();
  if (const std::size_t arrow = edit.find(" ->"); arrow != edit.npos) {
    const std::string old = edit.substr(0, arrow);
    const std::size_t at = old == "*" ? xml : bytes.find(old, xml);
    REQUIRE(at != bytes.npos);
    const std::string by = edit.substr(std::min(arrow + 4, edit.size()));
    bytes.replace(at, old == "*" ? bytes.npos : old.size(), by);
    E57Bytes::put<std::uint64_t>(bytes, 32, bytes.size() - xml);
  } else {
    std::istringstream in(edit.substr(1));
    std::size_t at;
    std::string type, number;
    in >> at >> type >> number;
    const unsigned size = static_cast<unsigned>(std::stoi(type.substr(1))) / 8;
    bytes = edited(bytes, at + (edit[0] == '+' ? sections[0] : 0), size, std::stoull(number));
  }
  return E57Bytes::paged(bytes);
}

/// E57 scans in words; see e57.case.
std::string e57_scans(const std::string& text) {
  static const Names kNames{{"X", "cartesianX"},         {"Y", "cartesianY"},
                            {"Z", "cartesianZ"},         {"CS", "cartesianInvalidState"},
                            {"R", "sphericalRange"},     {"A", "sphericalAzimuth"},
                            {"E", "sphericalElevation"}, {"SS", "sphericalInvalidState"}};
  E57Bytes file;
  for (const std::string& words : split(text, " || ")) {
    E57Bytes::Scan& scan = file.scans.emplace_back();
    for (const std::string& field : split(words, "; ")) {
      std::istringstream in(field);
      std::string name, type;
      in >> name >> type;
      if (name == "xml") {
        scan.xml = field.substr(4);
        continue;
      }
      Numbers values;
      for (std::string number; in >> number;) values.push_back(std::stod(number));
      if (const auto found = kNames.find(name); found != kNames.end()) name = found->second;
      if (type == "f64") {
        scan.fields.push_back(E57Bytes::float64(name, values));
      } else if (type == "f32") {
        scan.fields.push_back(E57Bytes::float32(name, {values.begin(), values.end()}));
      } else {
        const std::size_t star = type.find('*'), plus = type.find('+');
        std::string more;
        if (star != type.npos) more = "scale=\"" + type.substr(star + 1, plus - star - 1) + "\"";
        if (plus != type.npos) more += " offset=\"" + type.substr(plus + 1) + "\"";
        scan.fields.push_back(E57Bytes::integer(name, std::stoll(type),
                                                std::stoll(type.substr(type.find("..") + 2)),
                                                {values.begin(), values.end()}, more));
      }
    }
  }
  return file.build();
}

/// crs: the system whose map has the scale at the place; names an error only where it is a map.
Facts crs_facts(const CrsUnits& units, const std::string& unread, const std::string& crs, double x,
                double y) {
  Facts facts;
  facts.texts["unit"] = to_string(units.plane);
  facts.numbers = {{"heights", {units.heights}}, {"error", {}}};
  if (const auto map = ScanMap::of(crs)) facts.numbers["error"] = {map->at(x, y)->error()};
  for (const auto& [name, text] :
       {std::pair("trouble: ", units.trouble), {"doubt: ", units.doubt}, {"unread: ", unread}}) {
    if (!text.empty()) facts.remarks.push_back(name + text);
  }
  return facts;
}

Facts read_crs(const std::string& text) {
  const ScanCrs crs = scan_crs_of(text);
  Facts facts = crs_facts(crs.units, crs.unread, "", 0, 0);
  facts.numbers["files"] = {names_files(text) ? 1. : 0.};
  return facts;
}

/// Reads GeoTIFF keys that stand behind a place.
Facts read_geotiff(const std::string& text) {
  std::istringstream in(text);
  double x, y;
  in >> x >> y;
  std::vector<std::uint16_t> words{1, 1, 0, 0};
  std::vector<double> numbers;
  std::string texts;
  for (std::string key, value; std::getline(in >> std::ws, key, '=');) {
    std::size_t record = 0, count = 1, at = 0;
    if (in.peek() == '\'') {
      in.get();
      std::getline(in, value, '\'');
      record = 34737, count = value.size() + 1, at = texts.size();
      texts += value + "|";
    } else if (in >> value; value.find('.') != value.npos) {
      record = 34736, at = numbers.size();
      numbers.push_back(std::stod(value));
    } else {
      at = std::stoul(value);
    }
    for (const std::size_t word : {std::stoul(key), record, count, at}) {
      words.push_back(static_cast<std::uint16_t>(word));
    }
    ++words[3];
  }
  GeotiffKeys keys;
  keys.take(34737, std::as_bytes(std::span(texts)));
  keys.take(34736, std::as_bytes(std::span(numbers)));
  keys.take(34735, std::as_bytes(std::span(words)));
  const GeotiffCrs crs = keys.crs();
  return crs_facts(crs.units, crs.unread + crs.unread_heights, crs.crs, x, y);
}

Facts read_outline_file(const std::filesystem::path& path, const std::string& kind) {
  OutlineOptions options{.mirror = kind.ends_with("half")};
  if (kind.ends_with("millimetres")) options.unit = kMetresPerMillimetre;
  Facts facts;
  std::vector<Message> messages;
  for (const OutlinePoint& p : read_outline(path, options, &messages)) {
    facts.numbers["corners"].insert(facts.numbers["corners"].end(), {p.y, p.z});
  }
  for (const Message& message : messages) facts.remarks.push_back(words_of(message));
  return facts;
}

Facts read_file(const FormatCase& one, const std::filesystem::path& path) {
  const std::string kind = one.setting("read", "points");
  try {
    if (kind.starts_with("outline")) return read_outline_file(path, kind);
    if (kind == "mesh") return read_mesh_file(path);
    if (kind == "crs") return read_crs(one.bytes);
    if (kind == "geotiff") return read_geotiff(one.bytes);
    if (kind == "pose" || kind == "frames") return read_pose(path, kind == "frames");
    if (kind.starts_with("e57")) {
      put_bytes(path, kind.ends_with("scans") ? e57_scans(one.bytes)
                                              : e57_after(one.bytes, kind.ends_with("packets")));
    }
    const std::string columns = one.setting("columns");
    return read_points(path,
                       {columns.empty() ? std::vector<std::string>() : split(columns, " "), true});
  } catch (const InputError& error) {
    check_says(error.what(), path.parent_path().string());
    Facts facts;
    facts.texts["refused"] = error.what();
    if (error.remedy() == Remedy::kColumns) facts.numbers["column"] = {error.amount()};
    return facts;
  }
}

void check_fact(const Facts& facts, const std::string& fact, double tolerance) {
  const bool points = std::isdigit(fact[0]) || fact[0] == '-' || fact.starts_with("nan ");
  const std::size_t blank = std::min(fact.find(' '), fact.size());
  const std::string name = points ? "points" : fact.substr(0, blank);
  std::string words = points ? fact : fact.substr(blank);
  if (const auto text = facts.texts.find(name); text != facts.texts.end()) {
    if (!words.empty()) words.erase(0, 1);
    const bool is_message = name == "refused" || name == "unplaced" || name == "crs_unread";
    return is_message ? check_says(text->second, words) : check_equal(text->second, words);
  }
  const auto found = facts.numbers.find(name);
  if (found == facts.numbers.end()) return fail_check("there is no " + name);
  std::ranges::replace(words, ',', ' ');
  std::istringstream in(words);
  Numbers expected;
  for (std::string number; in >> number;) expected.push_back(std::stod(number));
  std::ostringstream shown;
  shown.precision(17);
  for (const double number : found->second) shown << number << ' ';
  INFO(fact << "; found " << shown.str());
  CHECK(same(found->second, expected, tolerance));
}

void check(const FormatCase& one) {
  const RowName row(one.title);
  const ScratchFolder folder;
  for (const auto& [name, other] : one.beside) folder.write(name, other);
  const auto path = folder.write(one.name, one.bytes);
  const Facts facts = read_file(one, path);
  std::vector<std::string> remarks;
  bool refused = false, absent = false;
  for (const std::string& fact : split(one.facts, " | ")) {
    refused = refused || fact.starts_with("refused");
    absent = absent || fact.starts_with("absent");
    if (fact.starts_with("remark ")) {
      remarks.push_back(fact.substr(7));
    } else if (fact != "read") {
      check_fact(facts, fact, std::stod(one.setting("near", "0")));
    }
  }
  if (refused) return;
  if (facts.texts.contains("refused")) return fail_check(facts.texts.at("refused"));
  if (facts.numbers.contains("absent") && !absent) CHECK(facts.numbers.at("absent").empty());
  std::string found = "its remarks are: ";
  for (const std::string& remark : facts.remarks) found += remark + " | ";
  if (facts.remarks.size() != remarks.size()) return fail_check(found);
  for (std::size_t i = 0; i < remarks.size(); ++i) check_says(facts.remarks[i], remarks[i]);
}

/// Checks that a file of which some bytes are changed, and perhaps the end cut, is read or refused.
void damage(const FormatCase& one, std::mt19937& random) {
  if (one.bytes.empty() || one.bytes.size() > 10'000) return;
  const ScratchFolder folder;
  for (const auto& [name, other] : one.beside) folder.write(name, other);
  for (int round = 0; round < 10; ++round) {
    FormatCase damaged = one;
    for (std::size_t flips = 1 + random() % 4; flips > 0; --flips) {
      damaged.bytes[random() % one.bytes.size()] =
          static_cast<char>(random() % 3 ? random() : 0xFF);
    }
    if (random() % 8 == 0) damaged.bytes.resize(random() % one.bytes.size());
    try {
      read_file(damaged, folder.write(one.name, damaged.bytes));
    } catch (const Error&) {
    }
  }
}

void run(const std::string& name) {
  std::mt19937 random(1);
  int cases = 0;
  FormatCases(std::string(CLEARWAY_FORMAT_CASES) + "/" + name, [&](const FormatCase& one) {
    check(one);
    const std::string kind = one.setting("read");
    if (kind != "crs" && kind != "geotiff" && !kind.starts_with("e57")) damage(one, random);
    ++cases;
  });
  CHECK(cases > 0);
}

}  // namespace

TEST_CASE("texts of points are read by their columns or refused") { run("text.case"); }
TEST_CASE("PTS and PTX are read scan by scan or refused") { run("ptx.case"); }
TEST_CASE("scans and poses of 3DTK are placed in right-handed metres or refused") {
  run("threedtk.case");
}
TEST_CASE("PLY is read in text and either byte order or refused") { run("ply.case"); }
TEST_CASE("PCD is read in text and binary or refused") { run("pcd.case"); }
TEST_CASE("meshes of STL, OBJ, OFF and PLY are read or refused") { run("mesh.case"); }
TEST_CASE("coordinate reference systems that cannot be used as they are") { run("crs.case"); }
TEST_CASE("GeoTIFF keys name units, maps and heights, or are named") { run("geotiff.case"); }
TEST_CASE("an E57 file that says what cannot be is refused") { run("e57.case"); }
TEST_CASE("outlines are read as corners or refused") { run("outline.case"); }
