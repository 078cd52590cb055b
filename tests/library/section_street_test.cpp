// The section of a real street: the known answer, and the guarantee against solids.
#include "library/section_guarantee.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// FNV-1a with 64 bits over numbers as 8 little-endian bytes each, with the starting value of the
/// known answers.
class Fnv {
 public:
  void add(std::int64_t number) {
    const auto bits = static_cast<std::uint64_t>(number);
    for (unsigned i = 0; i < 8; ++i) {
      hash_ = (hash_ ^ (bits >> (8 * i) & 0xff)) * 0x100000001b3;
    }
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 1469598103934665603;
};

struct Street {
  Street() {
    convert({data_folder() / "street/street.las"}, folder / "street.h5", {});
    path = read_trajectory(data_folder() / "street/trajectory.txt");
  }
  Section find(const SectionParameters& asked) const {
    find_section(Store(folder / "street.h5"), path, asked, folder / "section.h5",
                 {.overwrite = true});
    return Section(folder / "section.h5");
  }

  ScratchFolder folder;
  std::vector<Pose> path;
};

}  // namespace

TEST_CASE("the section of the street has the known cells, and keeps what solids are promised") {
  const Street street;
  SectionParameters asked{
      .rear = -2.25, .front = 2.25, .window = SectionWindow{-4, 4, 0, 5}, .cell = 0.02, .bin = 5};
  const Section known = street.find(asked);
  Fnv whole, bins;
  for (std::size_t i = 0; i < known.cells().size(); ++i) {
    for (const std::int64_t number :
         {std::int64_t{known.cells().j[i]}, std::int64_t{known.cells().k[i]},
          std::int64_t{known.cells().first_pose[i]}}) {
      whole.add(number);
    }
  }
  const SectionCells& cells = known.data().bin_cells;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const std::int64_t number :
         {std::int64_t{cells.bin[i]}, std::int64_t{cells.j[i]}, std::int64_t{cells.k[i]},
          std::int64_t{cells.first_pose[i]}}) {
      bins.add(number);
    }
  }
  CHECK(known.cells().size() == 34'834);
  CHECK(whole.value() == 0xc39a25dc107652d6);
  CHECK(cells.size() == 166'753);
  CHECK(bins.value() == 0x07d0d56c5dee2f06);

  asked.margin = 0.2;
  const Section section = street.find(asked);
  const Store store(street.folder / "street.h5");
  const Guarantee guarantee(store, street.path, section, street.folder);
  Random random(31);
  Verdicts verdicts;
  for (int i = 0; i < 100; ++i) {
    guarantee.check(random_outline(random, 2.2, 0.2, uniform(random, 0.4, 1.9)),
                    uniform(random, 0.01, 0.2), verdicts);
  }
  CHECK(verdicts.passes > 15);
  CHECK(verdicts.stopped > 15);
}
