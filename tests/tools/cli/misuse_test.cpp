#include "io/files/pending_file.hpp"
#include "io/store/store_reader.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A folder with a few points as text, and a store of them.
struct Site : Workplace {
  Site() {
    std::string points;
    for (int i = 0; i < 500; ++i) {
      points += std::to_string(i % 25) + " " + std::to_string(i / 25) + " 0.5\n";
    }
    put("scan.xyz", points);
    require_success(run("convert scan.xyz -o site.h5"));
  }
};

}  // namespace

TEST_CASE("two writers of one output: the second is refused and leaves the first alone") {
  const Site site;
  const std::string convert = "convert scan.xyz --force -o two.h5";
  {
    const PendingFile first(site.folder / "two.h5", true);
    check_outcome(site.run(convert), 4, "another process is writing it");
    CHECK(std::filesystem::exists(first.partial()));
  }
  CHECK_FALSE(site.has("two.h5.partial"));
  site.put("two.h5.partial", "left by one that was killed");
  check_outcome(site.run(convert), 0);
  check_same(site.bytes("two.h5"), site.bytes("site.h5"));
}

TEST_CASE("a resumed conversion does not call a damaged store done") {
  const Site site;
  const std::string convert = "convert scan.xyz -o site.h5";
  const std::string sound = site.bytes("site.h5");
  const std::vector<std::uint64_t> chunks = StoreReader(site.folder / "site.h5").index().address;
  REQUIRE(chunks.size() == 4);  // x, y, z and the source indices of one cell
  for (const std::uint64_t chunk : chunks) {
    std::string damaged = sound;
    damaged[chunk + 20] = static_cast<char>(damaged[chunk + 20] ^ 1);
    site.put("site.h5", damaged);
    check_outcome(site.run(convert + " --resume"), 2,
                  "site.h5: cell 0:  ... is damaged ... --force instead of --resume overwrites it");
    check_same(site.bytes("site.h5"), damaged);
  }
  check_outcome(site.run(convert + " --force"), 0);
  check_same(site.bytes("site.h5"), sound);
}
