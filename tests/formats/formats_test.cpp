// Runs the rows of *.case: small files, and what has to be read from them or why they are refused.
//
//   let NAME = TEXT         {NAME} stands for TEXT in everything below
//   = a sentence            begins a block, which has its own settings
//   read KIND               points (unless set otherwise), mesh, pose, frames, and
//                           those that crs.case, geotiff.case and e57.case explain
//   file NAME               the name of the file that the rows are written to
//   columns 2 3 4           the columns of x, y and z that the caller chooses
//   beside NAME = TEXT      another file in the folder
//   start TEXT, end TEXT    stands before, or behind, the text of every row
//   newline TEXT            is written for every \n
//   near NUMBER             the tolerance of numbers; they are equal unless it is set
//   each NAME = A ~ B ~ C   the rows are tried with each of these; several names stand for words
//   TEXT => FACT | FACT     a row
//   # a comment
//
// TEXT has the escapes \n, \r, \t, \s (a blank), \\ and \xHH, and {f32 1 2} for numbers in binary
// (i8 to u64, f32 and f64; >f32 is big-endian), {9*TEXT} for repeated text.
// FACT is `refused WORDS`, the points with commas between, or a name and what it is; `remark` is
// the next remark as "note CODE: TEXT [NAME NUMBER]", and a row that names none has none. WORDS are
// those of check_says().
#include <cmath>
#include <fstream>
#include <sstream>

#include "io/models/mesh/mesh_reader.hpp"
#include "io/scans/las/geotiff_keys.hpp"
#include "io/scans/map_scale.hpp"
#include "io/scans/scan_crs.hpp"
#include "io/scans/threedtk/threedtk_frame.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/pcd_bytes.hpp"
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

struct Block {
  std::string title, kind = "points", file = "a.txt", start, end, newline = "\\n";
  PointReadOptions options{.may_choose = true};
  double near = 0;
  std::map<std::string, std::string> beside;
  std::vector<std::pair<std::string, std::vector<std::string>>> each;
};

std::vector<std::string> split(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t at = 0;
  for (std::size_t end; (end = text.find(separator, at)) != text.npos; at = end + separator.size())
    parts.push_back(text.substr(at, end - at));
  parts.push_back(text.substr(at));
  return parts;
}

/// The parts of `NAME = TEXT`.
std::pair<std::string, std::string> pair_of(const std::string& text) {
  const std::size_t at = std::min(text.find(" = "), text.size());
  return {text.substr(0, at), at < text.size() ? text.substr(at + 3) : ""};
}

void replace_all(std::string& text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
    text.replace(at, what.size(), with);
}

std::string unescaped(const std::string& text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      bytes += text[i];
      continue;
    }
    static const std::map<char, char> kEscapes{
        {'n', '\n'}, {'r', '\r'}, {'t', '\t'}, {'s', ' '}, {'\\', '\\'}};
    if (text.at(++i) == 'x') {
      bytes += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      bytes += kEscapes.at(text[i]);
    }
  }
  return bytes;
}

template <typename Number>
std::string binary(double value, bool big) {
  std::string bytes = raw(static_cast<Number>(value)), escaped;
  if (big) std::reverse(bytes.begin(), bytes.end());
  for (const unsigned char c : bytes) {
    constexpr const char* kDigits = "0123456789ABCDEF";
    escaped += {'\\', 'x', kDigits[c / 16], kDigits[c % 16]};
  }
  return escaped;
}

/// What stands for {words}: a text of that name, a repeated text, or numbers.
std::string expanded(const std::string& words, const std::map<std::string, std::string>& names) {
  if (const auto named = names.find(words); named != names.end()) return named->second;
  std::string out;
  if (const std::size_t star = words.find('*'); star != words.npos) {
    for (int i = std::stoi(words); i > 0; --i) out += words.substr(star + 1);
    return out;
  }
  static const std::map<std::string, std::string (*)(double, bool)> kTypes{
      {"i8", binary<std::int8_t>},   {"u8", binary<std::uint8_t>},
      {"i16", binary<std::int16_t>}, {"u16", binary<std::uint16_t>},
      {"i32", binary<std::int32_t>}, {"u32", binary<std::uint32_t>},
      {"i64", binary<std::int64_t>}, {"u64", binary<std::uint64_t>},
      {"f32", binary<float>},        {"f64", binary<double>}};
  const bool big = words[0] == '>';
  std::istringstream in(words.substr(big ? 1 : 0));
  std::string type;
  in >> type;
  for (std::string number; in >> number;) out += kTypes.at(type)(std::stod(number), big);
  return out;
}

std::string with_names(std::string text, const std::map<std::string, std::string>& names) {
  for (std::size_t end; (end = text.find('}')) != text.npos;) {  // the innermost one first
    const std::size_t begin = text.rfind('{', end);
    text.replace(begin, end + 1 - begin, expanded(text.substr(begin + 1, end - begin - 1), names));
  }
  return text;
}

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
  REQUIRE(format);
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
  InputBuffer input(File::open_regular(path), InputBuffer::Access::kSeek);
  const Pose pose = frames ? read_threedtk_frames(input) : read_threedtk_pose(input);
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

Facts read_file(const Block& block, const std::filesystem::path& path) {
  try {
    if (block.kind == "mesh") return read_mesh_file(path);
    if (block.kind.starts_with("e57")) {
      put_bytes(path, e57_after(bytes_of(path), block.kind.ends_with("packets")));
      return read_points(path, {});
    }
    if (block.kind == "points") return read_points(path, block.options);
    if (block.kind == "crs") return read_crs(bytes_of(path));
    if (block.kind == "geotiff") return read_geotiff(bytes_of(path));
    return read_pose(path, block.kind == "frames");
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
    return check_says(text->second, words.empty() ? words : words.substr(1));
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

void check_row(const Block& block, const std::string& text, const std::string& expected) {
  const ScratchFolder folder;
  for (const auto& [name, other] : block.beside) folder.write(name, unescaped(other));
  std::string all = block.start + text + block.end;
  replace_all(all, "\\n", block.newline);
  const Facts facts = read_file(block, folder.write(block.file, unescaped(all)));
  std::vector<std::string> remarks;
  bool refused = false, absent = false;
  for (const std::string& fact : split(expected, " | ")) {
    refused = refused || fact.starts_with("refused");
    absent = absent || fact.starts_with("absent");
    if (fact.starts_with("remark ")) {
      remarks.push_back(fact.substr(7));
    } else if (fact != "read") {
      check_fact(facts, fact, block.near);
    }
  }
  if (refused) return;
  if (facts.texts.contains("refused")) return fail_check(facts.texts.at("refused"));
  if (facts.numbers.contains("absent") && !absent) CHECK(facts.numbers.at("absent").empty());
  if (facts.remarks.size() != remarks.size()) {
    std::string found = "its remarks are: ";
    for (const std::string& remark : facts.remarks) found += remark + " | ";
    return fail_check(found);
  }
  for (std::size_t i = 0; i < remarks.size(); ++i) check_says(facts.remarks[i], remarks[i]);
}

/// Checks the row with all choices of the block's names.
void check_each(const Block& block, std::map<std::string, std::string> names,
                const std::string& row, std::size_t chosen = 0) {
  if (chosen < block.each.size()) {
    for (std::string choice : block.each[chosen].second) {
      choice.erase(0, choice.find_first_not_of(' '));
      choice.erase(choice.find_last_not_of(' ') + 1);
      const auto words = split(block.each[chosen].first, " ");
      const auto values = words.size() == 1 ? std::vector{choice} : split(choice + " ", " ");
      for (std::size_t i = 0; i < words.size(); ++i) {
        names[words[i]] = with_names(values.at(i), names);
      }
      check_each(block, names, row, chosen + 1);
    }
    return;
  }
  Block one = block;
  for (std::string* text : {&one.file, &one.start, &one.end, &one.newline}) {
    *text = with_names(*text, names);
  }
  one.beside.clear();
  for (const auto& [name, text] : block.beside) {
    one.beside[with_names(name, names)] = with_names(text, names);
  }
  const std::size_t arrow = row.find(" => ");
  const std::string text = row.substr(0, arrow), facts = row.substr(arrow + 4);
  const RowName name(block.title + ": " + with_names(text, names).substr(0, 300));
  check_row(one, with_names(text, names), with_names(facts, names));
}

void set(Block& block, const std::string& key, const std::string& value) {
  const auto pair = pair_of(value);
  if (key == "read") block.kind = value;
  if (key == "file") block.file = value;
  if (key == "columns") block.options.columns = split(value, " ");
  if (key == "beside") block.beside[pair.first] = pair.second;
  if (key == "start") block.start = value;
  if (key == "end") block.end = value;
  if (key == "newline") block.newline = value;
  if (key == "near") block.near = std::stod(value);
  if (key == "each") block.each.emplace_back(pair.first, split(" " + pair.second + " ", " ~ "));
}

/// Runs a file. Settings before its first block are those of all blocks.
void run(const std::string& name) {
  std::ifstream file(std::string(CLEARWAY_FORMAT_CASES) + "/" + name);
  REQUIRE(file);
  Block first, block;
  std::map<std::string, std::string> names;
  int rows = 0;
  for (std::string line; std::getline(file, line);) {
    const bool is_row = line.find(" => ") != line.npos;
    if (line.empty() || (line[0] == '#' && !is_row)) continue;
    if (is_row) {
      ++rows;
      check_each(block, names, line);
      continue;
    }
    const std::size_t blank = line.find(' ');
    const std::string key = line.substr(0, blank), value = line.substr(blank + 1);
    if (key == "=") {
      if (first.title.empty()) first = block;
      block = first;
      block.title = value;
      first.title = name;
    } else if (key == "let") {
      const auto pair = pair_of(value);
      names[pair.first] = with_names(pair.second, names);
    } else {
      set(block, key, value);
    }
  }
  CHECK(rows > 0);
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
