#include "core/util/format.hpp"

#include <limits>

#include "core/util/shortened.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

namespace clearway {
using namespace test;
namespace {

TEST_CASE("numbers for people have four digits and no exponent", "[format]") {
  check_equal(format_brief(0.0321654), "0.03217");
  check_equal(format_brief(-12.34567), "-12.35");
  check_equal(format_brief(0.1), "0.1");
  check_equal(format_brief(100), "100");
  check_equal(format_brief(12345.6), "12346");
  check_equal(format_brief(120'000'000), "120000000");
  check_equal(format_brief(9.99999), "10");
  check_equal(format_brief(0.00001234), "0.00001234");
}

TEST_CASE("rounding errors of coordinates are 0 for people", "[format]") {
  check_equal(format_brief(0), "0");
  check_equal(format_brief(-0.0), "0");
  check_equal(format_brief(8.327e-17), "0");
  check_equal(format_brief(-8.327e-17), "0");
  check_equal(format_brief(2e-9), "0.000000002");
}

TEST_CASE("numbers that no length has are shown all the same", "[format]") {
  check_equal(format_brief(1e20), "1e+20");
  check_equal(format_brief(std::numeric_limits<double>::infinity()), "inf");
}

TEST_CASE("a long text is cut between characters", "[format]") {
  check_equal(shortened("as it is", 8), "as it is");
  check_equal(shortened("as it is", 7), "as it i ...");
  check_equal(shortened("\u00e4\u00f6\u00fc", 5), "\u00e4\u00f6 ...");  // 2 bytes each
  check_equal(shortened("\U0001d11e", 3), " ...");
}

}  // namespace
}  // namespace clearway
