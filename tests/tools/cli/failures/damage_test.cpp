// A flipped byte of a store or a result is named by verify, and never gives a wrong answer with
// exit code 0.
#include <map>

#include "support/catch.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The number of bytes that are tried, spread over the whole file.
#ifdef CLEARWAY_SANITIZED
constexpr std::size_t kTries = 100;  // with sanitizers each takes several times as long
#else
constexpr std::size_t kTries = 150;
#endif

std::string flipped(std::string bytes, std::size_t at) {
  bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
  return bytes;
}

}  // namespace

TEST_CASE("a run on a damaged store is refused or has the same answer") {
  const Work work{Hall::small()};
  const std::string store = work.bytes("hall/site.h5");
  const std::map<std::string, std::string> options{{"sweep", "--first-pose --force --engine sweep"},
                                                   {"kdtree", "--force --engine kdtree"}};
  std::map<std::string, std::string> expected;
  for (const auto& [engine, chosen] : options) {
    require_success(work.run_hall("hall/site.h5", "expected.h5", chosen));
    REQUIRE(ResultReader(work.folder / "expected.h5").collisions() > 50);
    expected[engine] = work.bytes("expected.h5");
  }
  std::map<std::string, std::size_t> refused;
  for (std::size_t i = 0; i < kTries; ++i) {
    const std::size_t at = i * (store.size() / kTries) + i % (store.size() / kTries);
    work.put("bad.h5", flipped(store, at));
    const Outcome found = work.run("verify bad.h5");
    if (found.exit_code != 0) {
      INFO("byte " << at);
      check_outcome(found, 1, kAnything, "bad.h5:  ... damaged");
    }
    for (const auto& [engine, chosen] : options) {
      INFO(engine << ", byte " << at);
      const Outcome run = work.run_hall("bad.h5", "out.h5", chosen);
      if (run.exit_code == 0) {
        check_same(work.bytes("out.h5"), expected[engine]);
      } else {
        ++refused[engine];
        check_outcome(run, 3);
        check_outcome(found, 1);
        check_says(run.err, "bad.h5");
      }
    }
  }
  CHECK(refused["sweep"] > kTries / 10);
  CHECK(refused["kdtree"] > kTries / 10);
}

TEST_CASE("a damaged result is not exported as another one") {
  const Work work{Hall::small()};
  require_success(work.run_hall("hall/site.h5", "good.h5", "--first-pose"));
  work.succeed("export good.h5 -o good.csv");
  const std::string result = work.bytes("good.h5"), expected = work.bytes("good.csv");
  for (std::size_t i = 0; i < kTries; ++i) {
    const std::size_t at = i * (result.size() / kTries) + i % (result.size() / kTries);
    work.put("bad.h5", flipped(result, at));
    INFO("byte " << at);
    const Outcome found = work.run("verify bad.h5");
    const Outcome made = work.run("export bad.h5 --force -o bad.csv");
    CHECK((made.exit_code == 0 || made.exit_code == 3));
    if (made.exit_code == 0) {
      check_same(work.bytes("bad.csv"), expected);
    } else {
      check_outcome(found, 1);
    }
  }
}
