// The section of a real street: the known answer, and the guarantee against solids.
#include "library/section_guarantee.hpp"
#include "support/road_scene.hpp"
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

TEST_CASE("sound questions about a street cause no warning") {
  const Street street;
  const Store store(street.folder / "street.h5");
  int asked = 0;
  for (const auto& [rear, front] :
       {std::pair{-2.25, 2.25}, {-1.0, 3.0}, {-2.5, 2.0}, {-1.5, 1.5}}) {
    for (const double margin : {0.0, 0.1, 0.3}) {
      for (const SectionWindow window : {SectionWindow{-4, 4, 0, 6}, {-2, 3, 0.42, 3}}) {
        const SectionParameters question{
            .rear = rear, .front = front, .window = window, .cell = 0.05, .margin = margin};
        const SectionReport report =
            find_section(store, street.path, question, street.folder / "section.h5",
                         {.threads = 2, .overwrite = true});
        INFO("from " << rear << " to " << front << ", margin " << margin);
        for (const Message& warning : report.warnings) FAIL_CHECK(warning.text);
        ++asked;
      }
    }
  }
  CHECK(asked == 24);
}

TEST_CASE("sound questions about alignments cause no warning") {
  const ScratchFolder folder;
  for (const char* name : {"UT-Alignment-Aplitop-1.xml", "PR_Twin_Branch_section_alignment.xml"}) {
    AlignmentOptions options{.step = 0.1, .max_gap = 0.01};
    std::vector<Pose> dense = read_alignment(data_folder() / "alignments" / name, options);
    if (dense.size() > 2500) dense.resize(2500);
    const double* const first = dense.front().translation;
    road_along(dense).convert_to(folder / "site.h5",
                                 {std::round(first[0]), std::round(first[1]), 0});
    std::vector<Pose> path;
    for (std::size_t i = 150; i + 150 < dense.size(); i += 5) path.push_back(dense[i]);
    CHECK(path.size() > 50);
    const Store store(folder / "site.h5");
    for (const auto& [rear, front] : {std::pair{-2.25, 2.25}, {-6.0, 6.0}}) {
      const SectionParameters question{.rear = rear, .front = front, .cell = 0.05, .margin = 0.1};
      const SectionReport report = find_section(store, path, question, folder / "section.h5",
                                                {.threads = 2, .overwrite = true});
      INFO(name << ", from " << rear << " to " << front);
      for (const Message& warning : report.warnings) FAIL_CHECK(warning.text);
    }
  }
}
