#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "io/result/export/position_text.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::string text_of(double scale, double offset, std::int32_t quantum) {
  const Quantisation quantisation{{scale, scale, scale}, {offset, offset, offset}};
  return std::string(DecimalAxis(quantisation, 1).text(coordinate(quantisation, 1, quantum)));
}

double number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  REQUIRE(error == std::errc());
  REQUIRE(end == text.data() + text.size());
  return value;
}

}  // namespace

TEST_CASE("coordinates are printed as the decimals they stand for") {
  check_equal(text_of(0.01, 0, 1478), "14.78");
  check_equal(text_of(0.001, 0, 14780), "14.78");
  check_equal(text_of(0.001, 0, 0), "0");
  check_equal(text_of(0.001, 0, -1), "-0.001");
  check_equal(text_of(0.001, 0, 100'000), "100");
  check_equal(text_of(0.001, 0.5, -500), "0");
  check_equal(text_of(1, 100, -30), "70");
  check_equal(text_of(10, 0, 12), "120");
  check_equal(text_of(0.0025, 636'102.84, 3), "636102.8475");
  check_equal(text_of(1e-7, 5e6, std::numeric_limits<std::int32_t>::max()), "5000214.7483647");
}

TEST_CASE("where the step is no decimal the double's own digits are printed") {
  const double third = 1.0 / 3;
  CHECK(number_of(text_of(third, 0, 1)) == third);
  CHECK(number_of(text_of(1.0 / 1024, 1e-20, 5)) == 5.0 / 1024 + 1e-20);
}

TEST_CASE("what is printed reads back as the same integer") {
  using Limits = std::numeric_limits<std::int32_t>;
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int32_t> any(Limits::min(), Limits::max());
  for (const double scale :
       {1.0, 0.1, 0.01, 0.001, 0.0001, 1e-6, 0.0025, 0.0005, 1.0 / 3, 0.3048}) {
    for (const double offset : {0.0, 100.0, -200.0, 4.5e6, -636'102.840012, 1e9, 0.1, 1.0 / 7}) {
      CAPTURE(scale, offset);
      for (int i = 0; i < 300; ++i) {
        const std::int32_t q = i == 0   ? Limits::min()
                               : i == 1 ? Limits::max()
                               : i == 2 ? 0
                                        : any(random);
        const double back = number_of(text_of(scale, offset, q));
        REQUIRE(std::nearbyint((back - offset) / scale) == q);
      }
    }
  }
}
