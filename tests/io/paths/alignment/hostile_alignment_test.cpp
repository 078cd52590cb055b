// LandXML that was damaged, or made to do harm: it is read, or refused with what is wrong.
#include <chrono>
#include <cmath>
#include <string>

#include "clearway/alignment.hpp"
#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/land_xml.hpp"
#include "support/reader_fixture.hpp"
#include "support/text_rows.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// "read", or the message with which the text is refused.
std::string refusal_of_text(const std::string& text) {
  const ScratchFolder scratch;
  try {
    for (const Pose& pose : read_alignment(scratch.write("a.xml", text), {.step = 10})) {
      for (const double number : pose.translation) REQUIRE(std::isfinite(number));
      for (const double number : pose.rotation) REQUIRE(std::isfinite(number));
    }
  } catch (const Error& error) {
    return error.what();
  }
  return "read";
}

/// The text with the first `what` in it replaced.
std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), with);
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

const std::string kGood = LandFile().text();

std::string refusal_with(const std::string& what, const std::string& with) {
  return refusal_of_text(replaced(kGood, what, with));
}

}  // namespace

TEST_CASE("an alignment that is cut anywhere is refused") {
  const std::size_t end = kGood.rfind('>');
  for (std::size_t bytes = 0; bytes < end; bytes += 7) {
    check_says(refusal_of_text(kGood.substr(0, bytes)), "line ... malformed");
  }
  check_equal(refusal_of_text(kGood.substr(0, end + 1)), "read");
}

TEST_CASE("any byte of an alignment may be another one") {
  std::size_t read = 0, refused = 0;
  for (std::size_t i = 0; i < kGood.size(); i += 3) {
    for (const char c : {'<', '"', '9', '\0', '-'}) {
      std::string text = kGood;
      text[i] = c;
      (refusal_of_text(text) == "read" ? read : refused) += 1;
    }
  }
  CHECK(read > 100);
  CHECK(refused > 100);
}

TEST_CASE("what is no LandXML is refused by what it is") {
  for (const auto& row : text_rows(R"(
                                                                                      | malformed
    x y z\n1 2 3\n                                                                     | malformed
    <html><body/></html>                                                              | "html" ... expected LandXML
    <LandXML/>                                                                        | has no Units
    <LandXML><Units/></LandXML>                                                       | neither Metric nor Imperial
    <LandXML><Units><Metric linearUnit="meter"/></Units></LandXML>                    | holds no Alignment
    <LandXML><Units><Metric linearUnit="meter"/></Units><Alignments/></LandXML>       | holds no Alignment
  )")) {
    check_says(refusal_of_text(row[0]), row[1]);
  }
}

TEST_CASE("parts of an alignment that are missing, stand twice or are no numbers are refused") {
  // A part of the sound file, what stands for it, and the answer.
  for (const auto& row : text_rows(R"(
    <Metric                 | <Imperial linearUnit="foot"/><Metric          | both Metric and Imperial
    linearUnit="meter"      |                                               | no attribute linearUnit
    "meter"                 | "cubit"                                       | linearUnit="cubit" ... USSurveyFoot
    "meter"                 | "foot"                                        | linearUnit="foot"
    "meter"                 | "meter" elevationUnit="feet"                  | elevationUnit="feet" and linearUnit="meter"
    "meter"                 | "meter" elevationUnit="ell"                   | elevationUnit="ell"
    "meter"                 | "meter" elevationUnit="meter"                 | read
    <Units>                 | <Units><Metric linearUnit="meter"/></Units><Units> | "Units" ... stands twice
    <Metric                 | <Metric linearUnit="meter"/><Metric           | "Metric" ... twice
    <Profile>               | <CoordGeom/><Profile>                         | "CoordGeom" ... twice
    <CoordGeom>             | <CoordGeom/><Other>                           | malformed
    staStart="1000"         |                                               | "Alignment" ... no attribute staStart
    <Start>0 0</Start>      |                                               | "Line" ... has no Start
    <End>0 100</End>        | <End/>                                        | "End" ... holds 0 numbers
    <End>0 100</End>        | <End>0 100</End><End>0 100</End>              | stands twice
    <End>0 100</End>        | <End>0 100 0 0</End>                          | more than 3 numbers
    <End>0 100</End>        | <End>0 nan</End>                              | "End" ... finite numbers
    <End>0 100</End>        | <End>0 1e999</End>                            | "End" ... finite numbers
    length="100"            | length="100" length="100"                     | the attribute length twice
    length="100"            | length="nan"                                  | "Line" ... length="nan"
    length="100"            | length="1,5"                                  | "Line" ... length="1,5"
    length="100"            | length=""                                     | "Line" ... length=""
    radius="50"             | radius="x"                                    | "Curve"
    radius="50"             | radius="1e-320"                               | full circle
    radius="50"             | radius="0"                                    | the radius 0 m
    1200 12                 | 1000.0001 1e308                               | no finite pose
    1200 12                 | 1200 1e300                                    | read
    1200 12                 | 1e308 12                                      | read
  )")) {
    const RowName name(row[1]);
    check_says(refusal_with(row[0], row[1]), row[2]);
  }
  LandFile empty;
  empty.line = empty.curve = "";
  check_says(refusal_of_text(empty.text()), "\"CoordGeom\" ... no element with a length");
  // Finite numbers whose sums and products are not.
  check_lacks(refusal_with("<End>0 100</End>", "<End>0 1e308</End>"), "read");
  check_lacks(refusal_with("length=\"100\"", "length=\"1e308\""), "read");
  check_lacks(refusal_with("staStart=\"1000\"", "staStart=\"1e308\""), "read");
}

TEST_CASE("elements with the prefix of the file's namespace are read") {
  const std::string space = "http://www.landxml.org/schema/LandXML-1.2";
  std::string prefixed;
  for (std::size_t i = 0; i < kGood.size(); ++i) {
    prefixed += kGood[i];
    const bool closes = kGood[i] == '/' && kGood[i - 1] == '<';
    const bool opens = kGood[i] == '<' && kGood[i + 1] != '/' && kGood[i + 1] != '?';
    if (opens || closes) prefixed += "lx:";
  }
  const auto declared = [](const std::string& text, const std::string& root,
                           const std::string& names) {
    return replaced(text, root, root + " " + names);
  };
  const std::string own = "xmlns:lx=\"" + space + "\"", other = "xmlns:x=\"urn:other\"";
  const std::string root = "<lx:LandXML";
  for (const std::string& names : {own, own + " " + other, other}) {
    check_equal(refusal_of_text(declared(prefixed, root, names)), "read");
  }
  check_equal(refusal_of_text(declared(kGood, "<LandXML", "xmlns=\"" + space + "\" " + other)),
              "read");
  // A part may have a prefix where the rest has none.
  const std::string mixed = replaced(
      replaced(kGood, "<Line ", "<a:Line xmlns:a=\"" + space + "\" "), "</Line>", "</a:Line>");
  check_equal(refusal_of_text(declared(mixed, "<LandXML", "xmlns=\"" + space + "\"")), "read");
  check_says(refusal_of_text(mixed), "line 7 ... \"a:Line\"");
  const std::string twice = replaced(prefixed, "<lx:Units", "<lx:Units xmlns:lx=\"urn:other\"");
  check_says(refusal_of_text(declared(twice, root, own)), "prefix \"lx\"");
  // Messages name the line also where names were shortened.
  const std::string wrong =
      replaced(declared(prefixed, root, own), "length=\"100\"", "length=\"a\"");
  check_says(refusal_of_text(wrong), "line 7: XML element \"Line\"");
}

TEST_CASE("entities that a document declares are not expanded") {
  std::string bomb = "<!DOCTYPE LandXML [<!ENTITY a \"" + repeated("a", 1000) + "\">";
  for (char c = 'b'; c < 'k'; ++c) {
    const std::string before(1, static_cast<char>(c - 1));
    bomb += "<!ENTITY " + std::string(1, c) + " \"" + repeated("&" + before + ";", 20) + "\">";
  }
  std::string text = replaced(kGood, "<LandXML", bomb + "]>\n<LandXML");
  check_equal(refusal_of_text(text), "read");
  text = replaced(text, "<End>0 100</End>", "<End>&j;</End>");
  check_says(refusal_of_text(text), "\"&j;\"");
  // Nor is a file that one names opened.
  text = replaced(kGood, "<LandXML",
                  "<!DOCTYPE LandXML [<!ENTITY x SYSTEM \"file:///etc/hostname\">]>\n<LandXML");
  check_says(refusal_of_text(replaced(text, "<End>0 100</End>", "<End>&x;</End>")), "\"&x;\"");
}

TEST_CASE("deep nesting and long lists end in time") {
  const auto start = std::chrono::steady_clock::now();
  const std::string deep = repeated("<a>", 200'000) + repeated("</a>", 200'000);
  check_equal(refusal_with("</CoordGeom>", "</CoordGeom>" + deep), "read");
  check_says(refusal_with("</CoordGeom>", repeated("<a>", 200'000) + "</CoordGeom>"), "malformed");
  check_says(refusal_with("<Units>", repeated("<a/>", 9'000'000) + "<Units>"),
             "tags and attributes; expected at most 8388608");
  const std::string many = repeated("<Alignment name=\"x\" staStart=\"0\"/>", 20'000);
  check_says(refusal_with("<Alignments>", "<Alignments>" + many),
             "has 20,001 alignments ... and 19,993 more");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  CHECK(took.count() < 60);
}

TEST_CASE("names cannot spoil a message") {
  const std::string refusal =
      refusal_with("<Alignments>", "<Alignments><Alignment name=\"\x1b[31m&#10;x\"/>");
  check_says(refusal, "\"?[31m?x\"");
}
