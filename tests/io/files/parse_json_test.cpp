#include <string>

#include "clearway/error.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/json.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

namespace clearway {
using namespace test;
namespace {

using nlohmann::ordered_json;

std::string repeated(const std::string& text, std::size_t times) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += text;
  return out;
}

std::string complaint_about(const std::string& text) {
  try {
    parse_json(text);
  } catch (const JsonError& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("JSON is read as the library reads it", "[json]") {
  for (const char* text :
       {"null", "[]", "{}",
        R"({"b": [1, -2, 2.5, "x", true, null, {"c": {}}], "a": {"b": [[], 3]}})",
        R"(["[[{", "\"]\\", "ä\u00e4"])", "18446744073709551615", " -0.0 "}) {
    CAPTURE(text);
    CHECK(parse_json(text) == ordered_json::parse(text));
    CHECK(parse_json(text).dump() == ordered_json::parse(text).dump());
  }
  for (const char* text : {"", "{", "[1,]", "nul", "{\"a\" 1}", "1 2", "[\"\xff\"]", "1e999"}) {
    CAPTURE(text);
    CHECK(complaint_about(text).starts_with("is no JSON: "));
  }
  for (const auto& [text, words] :
       {std::pair("{\"a\": 1,}", "a comma too many, before '}'"),
        {"[1, 2,]", "a comma too many or a value too few, before ']'"},
        {"{\"a\": 1 \"b\": 2}", "a comma or '}' is missing before this"},
        {"{\"a\" 1}", "a colon is missing after the name"},
        {"{\"a\"}", "a colon is missing after the name"},
        {"{\"a\": }", "a value is missing before '}'"},
        {"{\"a\": 1, 5}", "a name in double quotes is expected here"},
        {"{,}", "a name in double quotes is expected here"},
        {"[1, , 2]", "a value is missing before ','"},
        {"[1 2]", "a comma or ']' is missing before this"},
        {"[\"a\" \"b\"]", "a comma or ']' is missing before this"},
        {"{\"a\": 1]", "a comma or '}' is missing before this"},
        {"{}}", "the text goes on after its end"},
        {"{} x", "not JSON; texts and names stand in double quotes (x)"},
        {"[True]", "stand in double quotes (True)"},
        {"['a']", "stand in double quotes ('a')"},
        {"{\"a\": 01}", "a number that JSON does not have, or one that is too large (01)"},
        {"[1.]", "one that is too large (1.)"},
        {"[1e999]", "one that is too large (1e999)"},
        {"\"ab\nc\"", "line 1, column 4: a text in quotes has no closing quote on its line"},
        {"\"a\tb\"", "a text in quotes has a control character"},
        {"\"a\\xb\"", "an escape that JSON does not have (\\x)"},
        {"\"\\ud800\"", "an escape that JSON does not have (\\ud800\")"},
        {"[\"\xff\"]", "a text in quotes is not UTF-8"},
        {"[\"\xC3x\"]", "a text in quotes is not UTF-8"},
        {"\"abc", "the text ends too early"},
        {"", "the text ends too early"},
        {"[1", "the text ends too early"},
        {"{a: 1}", "texts and names stand in double quotes"}}) {
    CAPTURE(text);
    check_says(complaint_about(text), words);
  }
  CHECK(complaint_about("[\n1, x]").find("line 2, column 4") != std::string::npos);
  CHECK(complaint_about("\"" + std::string(100'000, 'x')).size() < 400);
}

TEST_CASE("JSON that is nested too deep is refused with its place", "[json]") {
  const auto nested = [](std::size_t depth) { return repeated("[", depth) + repeated("]", depth); };
  CHECK(complaint_about(nested(kMostJsonNesting)).empty());
  CHECK(complaint_about("\n " + nested(kMostJsonNesting + 1)) ==
        "line 2, column 66: lists and objects are nested too deep, expected at most 64 levels");
  for (const char* open : {"[", "{\"a\":", "[{\"a\":"}) {
    CHECK(complaint_about(repeated(open, 1'000'000)).find("nested too deep") != std::string::npos);
  }
  CHECK(
      complaint_about("[\"" + repeated("[", 1000) + "\\\"" + repeated("{", 1000) + "\"]").empty());
  CHECK(complaint_about("[" + repeated("[],", 1000) + "0]").empty());
}

TEST_CASE("a key that stands twice in JSON is refused by its place", "[json]") {
  check_equal(complaint_about(R"({"a": 1, "a": 1})"), "a: stands twice");
  CHECK(complaint_about(R"({"b": [0, {"c": {"x": 1, "y": 2, "x": 3}}]})") ==
        "b[1].c.x: stands twice");
  CHECK(complaint_about(R"([{"a": 1}, {"a": 1}])").empty());
}

TEST_CASE("long lists and large objects of JSON are read in linear time", "[json]") {
  std::string list = "[0", object = "{\"k\": 0";
  for (int i = 0; i < 300'000; ++i) {
    list += ",{\"a\":1}";
    object += ",\"k" + std::to_string(i) + "\":" + std::to_string(i);
  }
  const Stopwatch time;
  check_equal(parse_json(list + "]").size(), 300'001);
  check_equal(parse_json(object + "}").size(), 300'001);
  CHECK(time.seconds() < 20);  // it takes a minute where each element looks at all before it
}

TEST_CASE("a reader of keys keeps its file's text alive, and counts before it reads", "[json]") {
  const auto inner = [] {
    return KeyReader::parse("folder/vehicle.json", R"({"bodies": [{"name": "a"}, {"name": "b"}]})")
        .at("bodies")
        .elements(2)[1]
        .at("name");
  }();
  check_equal(inner.text(), "b");
  check_equal(inner.key(), "bodies[1].name");
  const KeyReader file = KeyReader::parse("vehicle.json", R"({"bodies": [1, 2, 3]})");
  CHECK_THROWS_WITH(file.at("bodies").elements(2),
                    "vehicle.json: bodies: has 3 entries, expected at most 2");
  CHECK_THROWS_WITH(file.at("name"), "vehicle.json: name: is missing");
  CHECK_THROWS_WITH(
      KeyReader::parse("vehicle.json", repeated("[", 100'000)),
      clearway::test::StartsWith("vehicle.json: line 1, column 65: lists and objects"));
}

}  // namespace
}  // namespace clearway
