// Compression by many threads.
#include "io/files/deflate.hpp"

#include <zlib.h>

#include <random>
#include <string>

#include "io/files/thread_limit.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Bytes with repetitions that reach from block to block.
std::string some_bytes(std::size_t count) {
  std::mt19937 random(1);
  std::string out;
  while (out.size() < count) {
    const std::size_t back = 1 + random() % 40'000;
    if (random() % 2 == 0 && back < out.size()) {
      out += out.substr(out.size() - back, 100);
    } else {
      for (int i = 0; i < 20; ++i) out += static_cast<char>(random());
    }
  }
  out.resize(count);
  return out;
}

std::string inflated(const std::string& bytes, std::size_t count) {
  std::string out(count + 1, '\0');
  uLongf length = out.size();
  REQUIRE(uncompress(reinterpret_cast<Bytef*>(out.data()), &length,
                     reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) == Z_OK);
  out.resize(length);
  return out;
}

}  // namespace

TEST_CASE("blocks that many threads compress are one zlib stream") {
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1000}, kDeflateBlock - 1, kDeflateBlock, kDeflateBlock + 1,
        3 * kDeflateBlock, 4 * kDeflateBlock + 77'777}) {
    CAPTURE(count);
    const std::string bytes = some_bytes(count);
    const std::string by_one = in_threads(1, [&] { return deflated_in_blocks(bytes, 6); });
    const std::string by_many = in_threads(5, [&] { return deflated_in_blocks(bytes, 6); });
    CHECK((by_one == by_many));
    CHECK((inflated(by_one, count) == bytes));
    const std::string whole = deflated(bytes, DeflateForm::kZlib, 6);
    if (count <= kDeflateBlock) CHECK((by_one == whole));
    // The blocks refer to the ones before them.
    CHECK(static_cast<double>(by_one.size()) < 1.02 * static_cast<double>(whole.size()) + 100);
  }
}
