#include "core/util/format.hpp"

#include <limits>

#include "core/util/shortened.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

namespace clearway {
using namespace test;
namespace {

TEST_CASE("numbers for people have four digits and no exponent, and rounding errors are 0") {
  struct Row {
    double value;
    const char* text;
  };
  for (const auto& [value, text] : {Row{0.0321654, "0.03217"},
                                    {-12.34567, "-12.35"},
                                    {0.1, "0.1"},
                                    {100, "100"},
                                    {12345.6, "12346"},
                                    {120'000'000, "120000000"},
                                    {9.99999, "10"},
                                    {0.00001234, "0.00001234"},
                                    {0, "0"},
                                    {-0.0, "0"},
                                    {8.327e-17, "0"},
                                    {-8.327e-17, "0"},
                                    {2e-9, "0.000000002"},
                                    {1e20, "1e+20"},  // no length, and shown all the same
                                    {std::numeric_limits<double>::infinity(), "inf"}}) {
    check_equal(format_brief(value), text);
  }
}

TEST_CASE("a long text is cut between characters") {
  check_equal(shortened("as it is", 8), "as it is");
  check_equal(shortened("as it is", 7), "as it i ...");
  check_equal(shortened("\u00e4\u00f6\u00fc", 5), "\u00e4\u00f6 ...");  // 2 bytes each
  check_equal(shortened("\U0001d11e", 3), " ...");
}

}  // namespace
}  // namespace clearway
