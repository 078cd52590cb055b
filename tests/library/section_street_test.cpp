// The section of a real street: the known answer, and the guarantee against solids.
#include "library/section_guarantee.hpp"
#include "support/road_scene.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// FNV-1a with 64 bits over the numbers of cells as 8 little-endian bytes each, with the starting
/// value of the known answers.
std::uint64_t hash_of(const SectionCells& cells) {
  std::uint64_t hash = 1469598103934665603;
  const auto add = [&](std::int64_t number) {
    const auto bits = static_cast<std::uint64_t>(number);
    for (unsigned i = 0; i < 8; ++i) hash = (hash ^ (bits >> (8 * i) & 0xff)) * 0x100000001b3;
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells.bin.empty()) add(cells.bin[i]);
    add(cells.j[i]);
    add(cells.k[i]);
    add(cells.first_pose[i]);
  }
  return hash;
}

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
  CHECK(known.cells().size() == 34'834);
  CHECK(hash_of(known.cells()) == 0xc39a25dc107652d6);
  CHECK(known.data().bin_cells.size() == 166'753);
  CHECK(hash_of(known.data().bin_cells) == 0x07d0d56c5dee2f06);

  asked.margin = 0.2;
  const Section section = street.find(asked);
  const Guarantee guarantee(street.folder / "street.h5", street.path, section, street.folder);
  Random random(31);
  Verdicts verdicts;
  for (int i = 0; i < 100; ++i) {
    guarantee.check(random_outline(random, 2.2, 0.2, uniform(random, 0.4, 1.9)),
                    uniform(random, 0.01, 0.2), verdicts);
  }
  CHECK(verdicts.passes > 15);
  CHECK(verdicts.stopped > 15);
}

TEST_CASE("sound questions about a street and about alignments cause no warning") {
  const Street street;
  check_sound(street.folder / "street.h5", street.path,
              {{-2.25, 2.25}, {-1, 3}, {-2.5, 2}, {-1.5, 1.5}}, {0, 0.1, 0.3},
              {SectionWindow{-4, 4, 0, 6}, SectionWindow{-2, 3, 0.42, 3}});
  for (const char* name : {"UT-Alignment-Aplitop-1.xml", "PR_Twin_Branch_section_alignment.xml"}) {
    INFO(name);
    std::vector<Pose> dense =
        read_alignment(data_folder() / "alignments" / name, {.step = 0.1, .max_gap = 0.01});
    if (dense.size() > 2500) dense.resize(2500);
    const double* const first = dense.front().translation;
    const auto store = street.folder / "site.h5";
    road_along(dense).convert_to(store, {std::round(first[0]), std::round(first[1]), 0});
    std::vector<Pose> path;
    for (std::size_t i = 150; i + 150 < dense.size(); i += 5) path.push_back(dense[i]);
    CHECK(path.size() > 50);
    check_sound(store, path, {{-2.25, 2.25}, {-6, 6}}, {0.1}, {std::nullopt});
  }
}
