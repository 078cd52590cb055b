// The checks of compare.hpp hold where they should, and fail where they should.
#include "support/compare.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "support/catch.hpp"
#include "support/compare_json.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("comparing functions accept what is equal, near or said") {
  const RowName row("a row");
  check_says("line 3: found 2, expected 3", "line 3 ... expected 3");
  check_says("line 3: found 2, expected 3", "line 3: ... found 2");
  check_says("", "");
  check_lacks("line 3", "line 4");
  check_near(1.05, 1, 0.051);
  check_near(Vec3{1, 2, 3}, {1, 2, 3.01}, 0.02);
  check_near(std::vector<double>{1, 2}, {1, 2.01}, 0.02);
  check_equal(1.5, 1.5);
  check_equal("a", std::string("a"));
  check_equal(std::size_t{7}, 7);
  check_equal(std::int32_t{-7}, std::int64_t{-7});
  check_equal(std::vector<std::string>{"a"}, {"a"});
  check_equal(std::vector<Vec3>{{1, 2, 3}}, {{1, 2, 3}});
  check_refused<std::logic_error>([] { throw std::logic_error("a file of 3 bytes"); },
                                  "a file ... bytes");
}

TEST_CASE("JSON is compared by the members that are named") {
  const nlohmann::json value{{"a", 1}, {"list", {{{"b", 0.5}}, nullptr}}, {"text", "words"}};
  check_json(value, R"({"a": 1, "list": {"0": {"b": 0.5}, "1": null}})");
  check_json(value, R"({"list": [{"b": 0.5}, null], "text": "words"})");
  check_json_text("[1, 2]", "[1, 2]");
  check_near(value, "/list/0/b", 0.500001);
  check_near(value, "/list/0/b", 0.6, 0.11);
  check_same("bytes", "bytes");
}

// Each of these fails, and that is expected.
TEST_CASE("rejected: words in another order", "[!shouldfail]") {
  check_says("one two", "two ... one");
}
TEST_CASE("rejected: a text where none is expected", "[!shouldfail]") { check_says("one", ""); }
TEST_CASE("rejected: no number", "[!shouldfail]") { check_near(std::nan(""), 1, 1e9); }
TEST_CASE("rejected: a wrapped number", "[!shouldfail]") {
  check_equal(std::int64_t{-1}, std::uint64_t{0} - 1);
}
TEST_CASE("rejected: another list", "[!shouldfail]") {
  check_equal(std::vector<std::uint32_t>{1, 2}, {1, 3});
}
TEST_CASE("rejected: an act that succeeds", "[!shouldfail]") {
  check_refused([] {}, "words");
}
TEST_CASE("rejected: a member that JSON lacks", "[!shouldfail]") {
  check_json(nlohmann::json{{"a", 1}}, R"({"b": null})");
}
TEST_CASE("rejected: other bytes", "[!shouldfail]") { check_same("bytes", "byteS"); }
