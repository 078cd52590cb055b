// The guarantee of sections against solids in scenes as they are scanned: a hall and a tunnel.
#include "core/util/progress.hpp"
#include "library/section_guarantee.hpp"
#include "scene/scene.hpp"
#include "scene/write.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// What is asked of a scene, and of how many outlines.
struct Trial {
  scene::Kind kind;
  std::uint64_t points, poses;
  SectionParameters asked;
  int outlines;
  double z;                ///< height of the middle of the outlines
  double least, greatest;  ///< distances of their corners from there
};

/// A scene that has been scanned, and its section.
class Site {
 public:
  explicit Site(const Trial& trial) {
    constexpr std::uint64_t kSeed = 11;
    const auto scene = scene::make_scene(trial.kind, {trial.points, 1, trial.poses}, kSeed);
    NoProgress quiet;
    {
      const File scan = File::create(folder_ / "scan.las");
      scene::write_environment(*scene, kSeed, scan, 2, quiet);
      const File path = File::create(folder_ / "path.txt");
      scene::write_trajectory(*scene, path);
      const File origins = File::create(folder_ / "origins.csv");
      scene::write_origins(*scene, origins);
    }
    ConvertOptions options{.threads = 2};
    if (trial.asked.seen) options.origins = folder_ / "origins.csv";
    convert({folder_ / "scan.las"}, folder_ / "site.h5", options);
    std::filesystem::remove(folder_ / "scan.las");
    path_ = read_trajectory(folder_ / "path.txt");
    report_ = find_section(Store(folder_ / "site.h5"), path_, trial.asked, folder_ / "section.h5",
                           {.threads = 2});
  }

  Verdicts check(const Trial& trial, std::uint64_t seed) const {
    const Store store(folder_ / "site.h5");
    const Section section(folder_ / "section.h5");
    const Guarantee guarantee(store, path_, section, folder_);
    Random random(seed);
    Verdicts verdicts;
    for (int i = 0; i < trial.outlines; ++i) {
      const double greatest = uniform(random, trial.least, trial.greatest);
      guarantee.check(random_outline(random, trial.z, trial.least, greatest),
                      uniform(random, 0.005, trial.asked.margin), verdicts);
    }
    return verdicts;
  }

  /// What `run --seen` says of an outline that passes: whether it sweeps a cube that no beam saw.
  bool sweeps_unseen(const std::vector<OutlinePoint>& outline, double margin,
                     const SectionParameters& asked) const {
    QueryParameters parameters{.radius = margin, .first_pose = true};
    parameters.seen = true;
    parameters.seen_cube = asked.seen_cube;
    const Query query(outline_model(outline, asked.rear, asked.front), path_, parameters);
    const Store store(folder_ / "site.h5");
    const SearchReport report =
        search(store, query, folder_ / "out.h5",
               {.engine = Engine::kSweep, .device = Device::kCpu, .threads = 2, .overwrite = true});
    REQUIRE(report.seen);
    return report.seen->unseen > 0;
  }

  Section section() const { return Section(folder_ / "section.h5"); }
  const SectionReport& report() const { return report_; }

 private:
  ScratchFolder folder_;
  std::vector<Pose> path_;
  SectionReport report_;
};

SectionParameters load(double rear, double front) {
  return {.rear = rear,
          .front = front,
          .window = SectionWindow{-4, 4, -0.5, 6},
          .cell = 0.05,
          .bin = 5,
          .margin = 0.25};
}

void keeps_its_promise(const Trial& trial, int at_least) {
  const Site site(trial);
  INFO(site.report().blocked << " cells are blocked, search of " << site.report().search_seconds
                             << " s");
  const Verdicts verdicts = site.check(trial, 77);
  CAPTURE(verdicts.passes, verdicts.stopped, verdicts.unknown);
  CHECK(verdicts.passes >= at_least);
  CHECK(verdicts.stopped >= at_least);
}

}  // namespace

TEST_CASE("a section of a hall keeps what solids are promised") {
  keeps_its_promise({scene::Kind::kHall, 60'000, 400, load(-1.5, 2.5), 40, 1.5, 0.2, 1.8}, 8);
}

TEST_CASE("a section of a tunnel keeps what solids are promised") {
  Trial trial{scene::Kind::kTunnel, 60'000, 400, load(-2, 2), 40, 2.5, 0.2, 3.6};
  keeps_its_promise(trial, 8);
}

TEST_CASE("where a section with seen space lets a load pass, run --seen finds no unseen cube") {
  Trial trial{scene::Kind::kHall, 300'000, 400, load(-1.5, 2.5), 120, 1.9, 0.1, 1.4};
  trial.asked.seen = true;
  trial.asked.seen_cube = 0.4;
  const Site site(trial);
  const Section section = site.section();
  Random random(9);
  int passes = 0, unknown = 0, confirmed = 0;
  for (int i = 0; i < trial.outlines; ++i) {
    const auto outline =
        random_outline(random, trial.z, trial.least, uniform(random, trial.least, trial.greatest));
    const double margin = uniform(random, 0.05, trial.asked.margin);
    const SectionCheck check = section.check(outline, margin);
    INFO("margin " << margin << ", " << outline.size() << " corners: " << check.reason);
    if (check.verdict == SectionVerdict::kPasses) {
      ++passes;
      CHECK_FALSE(site.sweeps_unseen(outline, margin, trial.asked));
    } else if (!check.unknowns.empty() && unknown < 20) {
      ++unknown;
      if (site.sweeps_unseen(outline, margin, trial.asked)) ++confirmed;
    }
  }
  CAPTURE(passes, unknown, confirmed);
  CHECK(passes >= 5);
  CHECK(confirmed >= 3);
}

// At full size this takes many minutes, so it is run by hand: section_scene_tests "[full-size]".
TEST_CASE("at full size a section of a hall and a tunnel keeps its promise", "[.][full-size]") {
  Trial hall{scene::Kind::kHall, 0, 0, load(-1.5, 2.5), 120, 1.5, 0.2, 1.8};
  Trial tunnel{scene::Kind::kTunnel, 2'000'000, 0, load(-2, 2), 120, 2.5, 0.2, 3.6};
  for (Trial* trial : {&tunnel, &hall}) {
    const scene::Sizes sizes = scene::full_sizes(trial->kind);
    if (trial->points == 0) trial->points = sizes.points;
    trial->poses = sizes.poses;
    trial->asked.cell = 0.02;
    const Site site(*trial);
    const Verdicts verdicts = site.check(*trial, 78);
    WARN(scene::name_of(trial->kind)
         << ": " << trial->points << " points, " << trial->poses << " poses, "
         << site.report().blocked << " blocked cells, search of " << site.report().search_seconds
         << " s; passes " << verdicts.passes << ", stopped " << verdicts.stopped << ", unknown "
         << verdicts.unknown);
    CHECK(verdicts.passes > 20);
    CHECK(verdicts.stopped > 20);
  }
}
