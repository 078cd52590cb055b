#include "io/scans/requantize.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("every stored integer is recovered from its coordinate") {
  const double scale = GENERATE(1e-6, 0.0001, 0.001, 0.01, 0.3048, 1.0, 1.0 / 3.0);
  const double offset = GENERATE(0.0, 0.5, -1e3, 5e6, -2e6 + 0.1);
  const Quantisation quantisation{{scale, scale, scale}, {offset, offset, offset}};
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const auto q = i == 0   ? std::numeric_limits<std::int32_t>::min()
                   : i == 1 ? std::numeric_limits<std::int32_t>::max()
                            : static_cast<std::int32_t>(random());
    const auto recovered = quantum_at(quantisation, i % 3, coordinate(quantisation, i % 3, q));
    REQUIRE(recovered == q);
  }
}

TEST_CASE(
    "where doubles are sparser than the scale, an integer with that very coordinate is found") {
  const Quantisation quantisation{{1e-9, 1e-9, 1e-9}, {5e6, 5e6, 5e6}};
  for (std::int32_t q = -100'000; q < 100'000; q += 7) {
    const double x = coordinate(quantisation, 0, q);
    const auto recovered = quantum_at(quantisation, 0, x);
    REQUIRE(recovered);
    REQUIRE(coordinate(quantisation, 0, *recovered) == x);
  }
}

TEST_CASE("a coordinate between two integers, or past them, has none") {
  const Quantisation quantisation{{0.001, 0.001, 0.001}, {100, 100, 100}};
  const double x = coordinate(quantisation, 1, 12345);
  CHECK(quantum_at(quantisation, 1, x) == 12345);
  CHECK_FALSE(quantum_at(quantisation, 1, std::nextafter(x, 1e9)));
  CHECK_FALSE(quantum_at(quantisation, 1, std::nextafter(x, -1e9)));
  CHECK_FALSE(quantum_at(quantisation, 1, 100 + 0.001 * 2147483648.0));
  CHECK_FALSE(quantum_at(quantisation, 1, 1e300));
  CHECK_FALSE(quantum_at(quantisation, 1, std::nan("")));
}
