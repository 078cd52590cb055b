// E57 of many records, damaged, and with scans that cannot be put into tests/formats/e57.case.
#include "support/bytes/e57_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Integers = std::vector<std::int64_t>;

ReadCloud read_scans(const E57Bytes& file) {
  const ScratchFolder scratch;
  return read_all(scratch.write("a.e57", file.build()));
}

std::string refusal(const std::string& bytes) { return refusal_of_file("a.e57", bytes); }

E57Bytes one_scan() {
  E57Bytes file;
  file.scans = {e57_scan({1, 2}, {3, 4}, {5, 6})};
  return file;
}

std::string all_texts(const CloudInfo& info) {
  std::string all;
  for (const Message& message : info.remarks) all += message.text + "\n";
  return all;
}

/// The file's bytes with `old` replaced in its XML, and with right checksums.
std::string replaced(const E57Bytes& file, const std::string& old, const std::string& by) {
  auto [bytes, sections, xml] = file.content();
  const std::size_t at = bytes.find(old, xml);
  REQUIRE(at != bytes.npos);
  bytes.replace(at, old.size(), by);
  E57Bytes::put<std::uint64_t>(bytes, 32, bytes.size() - xml);
  return E57Bytes::paged(bytes);
}

}  // namespace

TEST_CASE("absent records and remarks are those of the whole file, after every rewind") {
  constexpr std::size_t kCount = 70'000;
  Integers x(kCount), state(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    x[i] = static_cast<std::int64_t>(i);
    state[i] = i % 1000 == 7 ? 2 : 0;
  }
  E57Bytes file;
  for (int scan = 0; scan < 2; ++scan) {
    file.scans.emplace_back().fields = {E57Bytes::integer("cartesianX", 0, 1 << 20, x),
                                        E57Bytes::integer("cartesianY", 0, 0, x),
                                        E57Bytes::integer("cartesianZ", 0, 1 << 20, x),
                                        E57Bytes::integer("cartesianInvalidState", 0, 2, state)};
    file.scans.back().packets.assign(20, {8000, 0, 9000, 700});
  }
  const ScratchFolder scratch;
  const auto reader = open_point_file(scratch.write("a.e57", file.build()));
  for (int pass = 0; pass < 3; ++pass) {
    const ReadCloud all = read_all(*reader);
    REQUIRE(all.positions.size() == 2 * kCount);
    REQUIRE(all.absent.size() == 140);
    for (std::size_t i = 0; i < 140; ++i) REQUIRE(all.absent[i] == i * 1000 + 7);
    check_equal(all.positions[kCount + 5].x, 5);
    REQUIRE(all.info.remarks.size() == 2);
    check_says(all_texts(all.info), "2 scans; none has a pose ... 140 of 140,000 records");
    reader->rewind();
    PointBatch batch;
    if (pass == 1) REQUIRE(reader->read(batch));  // then it is rewound from the middle
    reader->rewind();
  }
}

TEST_CASE("a file without scans, and a scan without a binary section, hold no points") {
  E57Bytes file;
  check_equal(read_scans(file).info.declared_points, 0);
  file.scans = {e57_scan({}, {}, {})};
  check_equal(refusal(replaced(file, "fileOffset=\"48\"", "fileOffset=\"0\"")), "");
}

TEST_CASE("points far beyond the declared bounds are warned of, in either frame") {
  E57Bytes file;
  file.scans = {e57_scan({1000, 5000}, {0, 0}, {0, 2000})};
  const auto bounds = [](const std::string& least, const std::string& greatest) {
    std::string xml = "<cartesianBounds type=\"Structure\">";
    for (const std::string axis : {"x", "y", "z"}) {
      xml +=
          E57Bytes::number(axis + "Minimum", least) + E57Bytes::number(axis + "Maximum", greatest);
    }
    return xml + "</cartesianBounds>";
  };
  const auto check = [&](const std::string& xml, const std::string& codes,
                         const std::string& words) {
    file.scans[0].xml = xml;
    const auto remarks = read_scans(file).info.remarks;
    check_equal(codes_of(remarks), codes);
    if (!codes.empty()) check_says(remarks.at(0).text, words);
  };
  check(bounds("0", "5"), "outside-bounds", "scan 1: all 2 points ... (5000, 0, 2000)");  // mm
  check(bounds("0", "1500"), "declared-bounds", "scan 1: 1 of 2 points");
  for (const auto& [least, greatest] : {std::pair{"0", "5000"},
                                        {"0", "4999.9"},
                                        {"0", "0"},
                                        {"-1.79e308", "1.79e308"},
                                        {"3", "1"},
                                        {"nan", "inf"}}) {
    check(bounds(least, greatest), "", "");
  }
  // Some writers declare the bounds behind the pose.
  const auto posed = [](const std::string& x) {
    return E57Bytes::pose({"1", "0", "0", "0"}, {x, "-4000", "-4000"});
  };
  check(bounds("-6000", "-2000") + posed("-7000"), "note ", "pose");
  check(bounds("0", "5000") + posed("-1e6"), "note ", "pose");
}

TEST_CASE("a flipped bit of an E57 file or a cut is refused, a byte with a right checksum may be") {
  // Two small scans: one with a pose, in several packets, and a spherical one.
  E57Bytes file;
  file.page = 128;
  file.scans = {e57_scan({1, 2, 3}, {4, 5, 6}, {7, 8, 9})};
  file.scans[0].xml = E57Bytes::pose({"0", "1", "0", "0"}, {"1", "2", "3"});
  file.scans[0].packets = {{9, 3, 0}};
  file.scans[0].index_packets = true;
  file.scans.emplace_back().fields = {
      E57Bytes::float32("sphericalRange", {1, 2}), E57Bytes::float64("sphericalAzimuth", {0.5, 1}),
      E57Bytes::integer("sphericalElevation", -9, 9, {-9, 4}, "scale=\"0.1\""),
      E57Bytes::integer("sphericalInvalidState", 0, 2, {0, 2})};
  const std::string good = file.build();
  REQUIRE(refusal(good).empty());
  for (std::size_t i = 0; i < good.size(); ++i) {
    INFO("byte " << i);
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ (1 << (i % 8)));
    check_says(refusal(bytes), "expected");
    check_says(refusal(good.substr(0, i)), "expected");
    for (const int change : {0x01, 0x80, 0xFF}) {
      bytes[i] = static_cast<char>(good[i] ^ change);
      E57Bytes::repair(bytes, 128);
      const std::string message = refusal(bytes);
      if (!message.empty()) check_says(message, "expected");
      bytes = good;
    }
  }
  check_says(refusal(good + "x"), "expected ... as its header says");
  // The header declares the cut file's size, and cuts are at whole pages.
  for (std::size_t size = 128; size < good.size(); size += 128) {
    std::string bytes = edited(good.substr(0, size), 16, 8, size);
    E57Bytes::repair(bytes, 128);
    check_says(refusal(bytes), "expected");
  }
  std::string longer = edited(good, 16, 8, good.size() + 1);
  E57Bytes::repair(longer, 128);
  check_says(refusal(longer), "as its header says");
}

TEST_CASE("records of few bits or of none are counted") {
  const auto fields = [](std::int64_t least, std::int64_t greatest, const Integers& values) {
    E57Bytes::Scan scan;
    for (const std::string axis : {"X", "Y", "Z"}) {
      scan.fields.push_back(E57Bytes::integer("cartesian" + axis, least, greatest, values));
    }
    return scan;
  };
  const auto refusal_with = [](const E57Bytes& file, const std::string& count) {
    return refusal(replaced(file, "recordCount=\"2\"", "recordCount=\"" + count + "\""));
  };
  E57Bytes narrow, nothing;
  narrow.scans = {fields(0, 3, {1, 2})};  // the last byte has room for the bits of one more
  check_says(refusal_with(narrow, "1"), "behind its last record");
  nothing.scans = {fields(4, 4, {4, 4})};  // of which there could be any number
  CHECK(refusal_with(nothing, "65536").empty());
  check_says(refusal_with(nothing, "65537"), "take no byte");
  nothing.scans.push_back(nothing.scans[0]);
  CHECK(refusal_with(nothing, "65534").empty());
  check_says(refusal_with(nothing, "65535"), "scan 2 has 2 records that take no byte");
}

TEST_CASE("a packet that restarts within a record is refused, at a record's end it is read") {
  for (const bool within : {false, true}) {
    E57Bytes file = one_scan();
    file.scans[0].packets = {{within ? 9U : 8U, 8, 8}};
    // The second packet has 6 bytes, 3 lengths and the streams, filled up to words.
    auto [bytes, sections, xml] = file.content();
    bytes[sections[0] + 32 + (within ? 40 : 36) + 1] = 1;
    check_says(refusal(E57Bytes::paged(bytes)), within ? "within a record" : "");
  }
}

TEST_CASE("scans that share their bytes are refused") {
  E57Bytes file = one_scan();
  file.scans.push_back(file.scans[0]);
  const std::string second = std::to_string(file.physical(file.content().sections[1]));
  check_says(refusal(replaced(file, "fileOffset=\"" + second + "\"", "fileOffset=\"48\"")),
             "scan 2 shares bytes with scan 1");
}

TEST_CASE("entities are not expanded, so a small section cannot grow") {
  E57Bytes file = one_scan();
  std::string bomb = "<?xml version=\"1.0\"?><!DOCTYPE bomb [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c <= 'z'; ++c) {
    bomb += std::string("<!ENTITY ") + c + " \"";
    for (int i = 0; i < 10; ++i) bomb += std::string("&") + static_cast<char>(c - 1) + ";";
    bomb += "\">";
  }
  file.declaration = bomb + "<!ENTITY file SYSTEM \"file:///etc/passwd\">]>";
  file.root_xml = "<coordinateMetadata type=\"String\">&z;&file;</coordinateMetadata>";
  check_equal(read_scans(file).info.crs_wkt, "&z;&file;");
}
