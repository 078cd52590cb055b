// The checks of compare.hpp hold where they should, and fail where they should.
#include "support/compare.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

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

// Each of these fails, and that is expected.
TEST_CASE("rejected: words in another order", "[!shouldfail]") {
  check_says("one two", "two ... one");
}
TEST_CASE("rejected: a word that is missing", "[!shouldfail]") { check_says("one two", "three"); }
TEST_CASE("rejected: a text where none is expected", "[!shouldfail]") { check_says("one", ""); }
TEST_CASE("rejected: a word that should be missing", "[!shouldfail]") {
  check_lacks("one two", "two");
}
TEST_CASE("rejected: numbers apart", "[!shouldfail]") { check_near(1, 1.1, 0.05); }
TEST_CASE("rejected: no number", "[!shouldfail]") { check_near(std::nan(""), 1, 1e9); }
TEST_CASE("rejected: places apart", "[!shouldfail]") { check_near(Vec3{1, 2, 3}, {1, 2, 4}, 0.5); }
TEST_CASE("rejected: fewer numbers", "[!shouldfail]") {
  check_near(std::vector<double>{1}, {1, 2}, 0.5);
}
TEST_CASE("rejected: another number", "[!shouldfail]") { check_equal(1.0, 1.0 + 1e-15); }
TEST_CASE("rejected: another sign", "[!shouldfail]") { check_equal(std::int32_t{-7}, 7); }
TEST_CASE("rejected: a wrapped number", "[!shouldfail]") {
  check_equal(std::int64_t{-1}, std::uint64_t{0} - 1);
}
TEST_CASE("rejected: another text", "[!shouldfail]") { check_equal("a", "b"); }
TEST_CASE("rejected: another list", "[!shouldfail]") {
  check_equal(std::vector<std::uint32_t>{1, 2}, {1, 3});
}
TEST_CASE("rejected: a shorter list", "[!shouldfail]") {
  check_equal(std::vector<std::string>{"a"}, {});
}
TEST_CASE("rejected: an act that succeeds", "[!shouldfail]") {
  check_refused([] {}, "words");
}
TEST_CASE("rejected: another message", "[!shouldfail]") {
  check_refused<std::logic_error>([] { throw std::logic_error("a"); }, "b");
}
