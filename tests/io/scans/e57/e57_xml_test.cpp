// XML sections that are malformed, hostile or of another kind.
#include <chrono>

#include "support/bytes/e57_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

E57Bytes one_scan_of_xml() {
  E57Bytes file;
  file.scans = {e57_scan({1, 2}, {3, 4}, {5, 6})};
  return file;
}

std::string refusal_of_xml(const E57Bytes& file) {
  static const ScratchFolder scratch;
  return refusal_of(scratch.write("a.e57", file.build()));
}

/// The message with which a file is refused whose XML section is that of one_scan() with `what`
/// replaced.
std::string refusal_with(const std::string& what, const std::string& with) {
  E57Bytes::Content content = one_scan_of_xml().content();
  const std::size_t at = content.bytes.find(what, content.xml);
  REQUIRE(at != std::string::npos);
  content.bytes.replace(at, what.size(), with);
  E57Bytes::put<std::uint64_t>(content.bytes, 32, content.bytes.size() - content.xml);
  static const ScratchFolder scratch;
  return refusal_of(scratch.write("a.e57", E57Bytes::paged(content.bytes)));
}

/// The message with which a file with this XML section is refused.
std::string refusal_of_xml(const std::string& xml) {
  E57Bytes::Content content = one_scan_of_xml().content();
  content.bytes.replace(content.xml, std::string::npos, xml);
  E57Bytes::put<std::uint64_t>(content.bytes, 32, xml.size());
  static const ScratchFolder scratch;
  return refusal_of(scratch.write("a.e57", E57Bytes::paged(content.bytes)));
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

}  // namespace

TEST_CASE("what is no XML, or no E57 root, is refused with its byte") {
  check_says(refusal_of_xml(""), "byte ... malformed");
  check_says(refusal_of_xml("points"), "malformed");
  check_says(refusal_of_xml("<e57Root type=\"Structure\">"), "malformed");
  check_says(refusal_of_xml(std::string("<e57Root type=\"Structure\">\0</e57Root>", 37)),
             "malformed");
  check_says(refusal_of_xml("<html/>"), "\"html\" ... expected e57Root");
  check_says(refusal_of_xml("<e57Root/>"), "expected the type Structure");
  CHECK(refusal_of_xml("<e57Root type=\"Structure\"/>").empty());
}

TEST_CASE("XML in another encoding than UTF-8 is refused, a byte order mark is not") {
  E57Bytes file = one_scan_of_xml();
  for (const char* name : {"ISO-8859-1", "UTF-16", "utf8"}) {
    file.declaration = "<?xml version=\"1.0\" encoding=\"" + std::string(name) + "\"?>";
    check_says(refusal_of_xml(file), std::string(name) + " ... expected UTF-8");
  }
  for (const char* declaration :
       {"", "<?xml version=\"1.0\"?>", "\xEF\xBB\xBF", "<?xml version='1.0' encoding='utf-8'?>"}) {
    file.declaration = declaration;
    CHECK(refusal_of_xml(file).empty());
  }
  std::string wide = "\xFF\xFE";
  for (const char c : std::string("<e57Root type=\"Structure\"/>")) wide += {c, '\0'};
  check_says(refusal_of_xml(wide), "expected well-formed XML in UTF-8");
}

TEST_CASE("entities are not expanded, so a small section cannot grow") {
  E57Bytes file = one_scan_of_xml();
  std::string bomb = "<?xml version=\"1.0\"?><!DOCTYPE bomb [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c <= 'z'; ++c) {
    bomb += std::string("<!ENTITY ") + c + " \"" +
            repeated(std::string("&") + static_cast<char>(c - 1) + ";", 10) + "\">";
  }
  file.declaration = bomb + "<!ENTITY file SYSTEM \"file:///etc/passwd\">]>";
  file.root_xml = "<coordinateMetadata type=\"String\">&z;&file;</coordinateMetadata>";
  static const ScratchFolder scratch;
  check_equal(read_all(scratch.write("a.e57", file.build())).info.crs_wkt, "&z;&file;");
}

TEST_CASE("deep nesting and long lists are read or refused in time") {
  const auto begin = std::chrono::steady_clock::now();
  E57Bytes file = one_scan_of_xml();
  file.root_xml = repeated("<a>", 200'000) + repeated("</a>", 200'000);
  CHECK(refusal_of_xml(file).empty());
  file.root_xml = repeated("<a>", 200'000);
  check_says(refusal_of_xml(file), "malformed");
  file.root_xml = repeated("<a>", 2'200'000);
  check_says(refusal_of_xml(file), "tags and attributes; expected at most 2097152");
  file.root_xml.clear();
  file.scans[0].xml = repeated("<b c=\"d\" e=\"f\"/>", 100'000);
  CHECK(refusal_of_xml(file).empty());
  CHECK_THAT(
      refusal_with("<prototype type=\"Structure\">",
                   "<prototype type=\"Structure\">" + repeated("<a type=\"Structure\">", 100'000) +
                       repeated("</a>", 100'000)),
      Equals(""));
  check_says(refusal_with("<cartesianX", repeated("<a type=\"Float\"/>", 32'765) + "<cartesianX"),
             "one field too many");
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(60));
}

TEST_CASE("names that stand twice are refused") {
  const std::string set_twice[][2] = {
      {"<data3D", "<data3D type=\"Vector\"/><data3D"},
      {"<points", "<points type=\"CompressedVector\"/><points"},
      {"<prototype", "<prototype type=\"Structure\"/><prototype"},
      {"<cartesianY", "<cartesianX type=\"Float\"/><cartesianY"},
      {"recordCount=", "recordCount=\"2\" recordCount="},
      {"<points", "<pose type=\"Structure\"/><pose type=\"Structure\"/><points"}};
  for (const auto& [what, with] : set_twice) check_says(refusal_with(what, with), "twice");
}

TEST_CASE("missing nodes and nodes of another type are refused by name") {
  check_says(refusal_with("recordCount", "count"), "no attribute recordCount");
  check_says(refusal_with("fileOffset", "offset"), "no attribute fileOffset");
  check_says(refusal_with("<prototype type=\"Structure\">", "<p type=\"Structure\">"), "malformed");
  check_says(refusal_with("<cartesianZ", "<cartesianW"), "has no cartesianZ");
  check_says(refusal_with("<cartesianX", "<sphericalRange"), "has no cartesianX");
  check_says(refusal_with("<vectorChild type=\"Structure\">", "<vectorChild type=\"Float\">"),
             "expected vectorChild of type Structure");
  check_says(refusal_with("type=\"CompressedVector\"", "type=\"Vector\""),
             "\"points\" ... expected CompressedVector");
  check_says(refusal_with("<data3D type=\"Vector\"", "<data3D"), "expected Vector");
  check_says(refusal_with("<cartesianX type=\"Float\"", "<cartesianX type=\"Blob\""),
             "type that no point can have");
  check_says(refusal_with("<cartesianX type=\"Float\"", "<cartesianX type=\"String\""),
             "expected a number");
  check_says(
      refusal_with("<cartesianX type=\"Float\"", "<cartesianX type=\"Float\" precision=\"x\""),
      "single or double");
}

TEST_CASE("codecs other than bit packing are refused by name") {
  E57Bytes file = one_scan_of_xml();
  const auto codec = [](const std::string& name) {
    return "<vectorChild type=\"Structure\"><inputs type=\"Vector\"/><" + name +
           " type=\"Structure\"/></vectorChild>";
  };
  file.scans[0].codecs = codec("bitPackCodec");
  CHECK(refusal_of_xml(file).empty());
  file.scans[0].codecs += codec("e57x:zipCodec");
  check_says(refusal_of_xml(file), "\"e57x:zipCodec\" ... expected bitPackCodec");
}

TEST_CASE("limits, scales and poses that make no sense are refused") {
  const auto with_x = [](const std::string& attributes) {
    return refusal_with("<cartesianX type=\"Float\"", "<cartesianX " + attributes);
  };
  check_says(with_x("type=\"Integer\" minimum=\"1\" maximum=\"0\""),
             "from 1 to 0; expected minimum <= maximum");
  for (const char* scale : {"nan", "0", "-0.0", "inf", "1e-400"}) {
    check_says(with_x("type=\"ScaledInteger\" scale=\"" + std::string(scale) + "\""),
               "a scale other than 0");
  }
  check_says(with_x("type=\"ScaledInteger\" offset=\"nan\""), "not finite");
  for (const char* number : {"1.5", "9223372036854775808", "", "x"}) {
    check_says(with_x("type=\"Integer\" maximum=\"" + std::string(number) + "\""),
               "expected a number");
  }
  const auto with_pose = [](const std::vector<std::string>& rotation, const std::string& x) {
    E57Bytes file = one_scan_of_xml();
    file.scans[0].xml = E57Bytes::pose(rotation, {x, "0", "0"});
    return refusal_of_xml(file);
  };
  check_says(with_pose({"0", "0", "0", "0"}, "0"), "pose ... norm 0");
  check_says(with_pose({"2", "0", "0", "0"}, "0"), "norm 2");
  check_says(with_pose({"nan", "0", "0", "0"}, "0"), "expected finite numbers");
  check_says(with_pose({"1", "0", "0", "0"}, "inf"), "expected finite numbers");
  check_says(with_pose({"1", "0", "0", "0"}, "1,5"), "\"1,5\"; expected a number");
  check_says(refusal_with("<points",
                          "<pose type=\"Structure\"><rotation type=\"Structure\"/></pose>"
                          "<points"),
             "has no x");
}
