// A flipped byte of a store or a result: named by verify, never a wrong answer with exit code 0.
#include <catch2/catch.hpp>

#include "tools/cli/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

/// Bytes tried, spread over the whole file.
#ifdef CLEARWAY_SANITIZED
constexpr std::size_t kTries = 100;  // each takes several times as long
#else
constexpr std::size_t kTries = 300;
#endif

std::string flipped(std::string bytes, std::size_t at) {
  bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
  return bytes;
}

}  // namespace

TEST_CASE("a run on a damaged store is refused or has the same answer") {
  const Work work;
  const std::string store = bytes_of(work.hall.path("site.h5"));
  for (const std::string engine : {"sweep", "kdtree"}) {
    const std::string options = "--first-pose --force --engine " + engine;
    REQUIRE(work.run_hall(work.hall / "site.h5", "expected.h5", options).exit_code == 0);
    const std::string expected = work.bytes("expected.h5");
    std::size_t refused = 0;
    for (std::size_t i = 0; i < kTries; ++i) {
      const std::size_t at = i * (store.size() / kTries) + i % (store.size() / kTries);
      put_bytes(work.folder / "bad.h5", flipped(store, at));
      INFO(engine << ", byte " << at);
      const Outcome found = work.run("verify " + work.path("bad.h5"));
      const Outcome run = work.run_hall(work.path("bad.h5"), "out.h5", options);
      if (found.exit_code != 0) {
        CHECK(found.exit_code == 1);
        CHECK_THAT(found.out, Contains("bad.h5: ") && Contains("damaged"));
      }
      if (run.exit_code == 0) {
        CHECK((work.bytes("out.h5") == expected));
      } else {
        ++refused;
        CHECK(run.exit_code == 3);
        CHECK(found.exit_code == 1);
        CHECK_THAT(run.err, Contains("bad.h5"));
      }
    }
    CHECK(refused > kTries / 10);
  }
}

TEST_CASE("a damaged result is not exported as another one") {
  const Work work;
  REQUIRE(work.run_hall(work.hall / "site.h5", "good.h5", "--first-pose").exit_code == 0);
  REQUIRE(work.run("export " + work.path("good.h5") + " -o " + work.path("good.csv")).exit_code ==
          0);
  const std::string result = work.bytes("good.h5"), expected = work.bytes("good.csv");
  for (std::size_t i = 0; i < kTries; ++i) {
    const std::size_t at = i * (result.size() / kTries) + i % (result.size() / kTries);
    put_bytes(work.folder / "bad.h5", flipped(result, at));
    INFO("byte " << at);
    const Outcome found = work.run("verify " + work.path("bad.h5"));
    const Outcome made =
        work.run("export " + work.path("bad.h5") + " --force -o " + work.path("bad.csv"));
    CHECK((made.exit_code == 0 || made.exit_code == 3));
    if (made.exit_code == 0) {
      CHECK((work.bytes("bad.csv") == expected));
    } else {
      CHECK(found.exit_code == 1);
    }
  }
}
