// What a section warns of: the checks that a run makes of its path, its place and the scan, and
// what ignored points would block.
#include <algorithm>
#include <map>
#include <set>

#include "clearway/clearway.hpp"
#include "core/util/progress.hpp"
#include "scene/scene.hpp"
#include "scene/write.hpp"
#include "support/catch.hpp"
#include "support/result_fixture.hpp"
#include "support/road_scene.hpp"
#include "support/section_scene.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The codes of warnings, each once, ascending and joined by blanks.
std::string codes_of(const std::vector<Message>& warnings) {
  std::set<std::string> codes;
  for (const Message& warning : warnings) codes.insert(warning.code);
  std::string text;
  for (const std::string& code : codes) text += (text.empty() ? "" : " ") + code;
  return text;
}

SectionParameters load_of(double rear, double front) {
  return {.rear = rear, .front = front, .cell = 0.05};
}

/// A question about a road of 100 m.
struct RoadQuestion {
  RoadScan scan = road_along(road_path(0, 100, 0.1));
  std::vector<Pose> path = road_path(15, 85, 0.5);
  SectionParameters asked = load_of(-2.25, 2.25);
};

void raise_path(RoadQuestion& question, double by) {
  for (Pose& pose : question.path) pose.translation[2] += by;
}

void bend(RoadQuestion& question, double step) {
  question.scan = road_along(road_path(0, 60, 0.1, 20));
  question.path = road_path(10, 50, step, 20);
}

/// A question, and the codes of its warnings.
struct AskedTrial {
  const char* name;
  std::function<void(RoadQuestion&)> change;
  std::string codes;
};

void stand_in_the_way(RoadQuestion& question) {
  for (double y = 0; y <= 0.5; y += 0.05) {
    for (double z = 0.3; z <= 1.8; z += 0.05) question.scan.add({40.02, y, z}, kObstacleClass);
  }
}

const std::vector<AskedTrial>& trials() {
  static const std::vector<AskedTrial> all{
      {"a sound road", [](RoadQuestion&) {}, ""},
      {"an obstacle of an ignored class",
       [](RoadQuestion& q) {
         stand_in_the_way(q);
         q.asked.ignore_classes = {kObstacleClass};
       },
       "ignored-high"},
      {"an obstacle in an ignored box",
       [](RoadQuestion& q) {
         stand_in_the_way(q);
         q.asked.ignore_boxes = {{{39, -1, 0.2}, {41, 1, 2}}};
       },
       "ignored-high"},
      {"the ground is ignored", [](RoadQuestion& q) { q.asked.ignore_classes = {kGroundClass}; },
       ""},
      {"more is ignored than is left",
       [](RoadQuestion& q) {
         q.scan.erase([](const Vec3& p) { return std::abs(p.y) > 3 && p.z > 0.3; });
         q.asked.ignore_classes = {kGroundClass};
       },
       "ignored-collide"},
      {"a class that no point has", [](RoadQuestion& q) { q.asked.ignore_classes = {17}; },
       "absent-class"},
      {"a path 1.73 m too high", [](RoadQuestion& q) { raise_path(q, 1.73); }, "floats"},
      {"the path of an antenna, and a window that reaches below the wheels",
       [](RoadQuestion& q) {
         raise_path(q, 1.73);
         q.asked.window = SectionWindow{-4, 4, -2, 4};
       },
       ""},
      {"a window that begins above the ground",
       [](RoadQuestion& q) {
         q.asked.window = SectionWindow{-4, 4, 0.42, 5};
       },
       ""},
      {"a window that begins in the ground",
       [](RoadQuestion& q) {
         q.asked.window = SectionWindow{-3, 3, -0.5, 4};
       },
       ""},
      {"a window beside the middle",
       [](RoadQuestion& q) {
         q.asked.window = SectionWindow{0.5, 3, 0, 4};
       },
       ""},
      {"the ground is ignored, and a window that begins below it",
       [](RoadQuestion& q) {
         q.asked.ignore_classes = {kGroundClass};
         q.asked.window = SectionWindow{-2, 2, -0.5, 3};
         int n = 0;
         for (Vec3& p : q.scan.points) p.z += p.z == 0 ? 0.07 * (n++ % 2) : 0;
       },
       "ignored-collide nothing-blocked"},
      {"steps as long as the load, to the rounding of sums",
       [](RoadQuestion& q) {
         q.asked = load_of(-0.05, 0.05);
         q.asked.window = SectionWindow{-2, 2, 0, 3};
         q.path.clear();
         double x = 15;
         for (int i = 0; i < 700; ++i, x += 0.1)
           q.path.push_back(rotation({0, 0, 1}, 0, {x, 0, 0}));
       },
       ""},
      {"a path in the ground", [](RoadQuestion& q) { raise_path(q, -1); }, "below-ground"},
      {"a path in the ground, and a hole of 15 m in it",
       [](RoadQuestion& q) {
         raise_path(q, -1);
         q.scan.erase([](const Vec3& p) { return p.x > 35 && p.x < 50 && std::abs(p.y) < 3; });
       },
       "below-ground nothing-below"},
      {"a path below the ground", [](RoadQuestion& q) { raise_path(q, -3); }, "nothing-below"},
      {"a hole of 15 m in the ground",
       [](RoadQuestion& q) {
         q.scan.erase([](const Vec3& p) { return p.x > 35 && p.x < 50 && std::abs(p.y) < 3; });
       },
       "nothing-below"},
      {"a hole of 15 m in the scan",
       [](RoadQuestion& q) { q.scan.erase([](const Vec3& p) { return p.x > 35 && p.x < 50; }); },
       "leaves-scan"},
      {"no wall on the right",
       [](RoadQuestion& q) { q.scan.erase([](const Vec3& p) { return p.y < -3 && p.z > 0.2; }); },
       "one-side"},
      {"poses 4 m apart in a bend", [](RoadQuestion& q) { bend(q, 4); }, "large-steps"},
      {"poses 4 m apart in a bend, and the ways between them",
       [](RoadQuestion& q) {
         bend(q, 4);
         q.asked.between_poses = true;
       },
       "motion-exceeds-cell"},
      {"poses half a metre apart in a bend", [](RoadQuestion& q) { bend(q, 0.5); }, ""},
      {"poses 4 m apart on a straight road", [](RoadQuestion& q) { q.path = road_path(15, 85, 4); },
       ""},
      {"poses 5 m apart", [](RoadQuestion& q) { q.path = road_path(15, 85, 5); }, "large-steps"},
      {"poses are missing",
       [](RoadQuestion& q) { q.path.erase(q.path.begin() + 40, q.path.begin() + 52); },
       "trajectory-jump"},
      {"a load that drives sideways",
       [](RoadQuestion& q) {
         for (Pose& pose : q.path) pose = rotation({0, 0, 1}, M_PI / 2, pose.position());
       },
       "large-steps nothing-beside sideways"},
      {"poses that mirror the load",
       [](RoadQuestion& q) {
         for (Pose& pose : q.path) pose.rotation[4] = -1;
       },
       "mirrored-poses"},
      {"a range in millimetres",
       [](RoadQuestion& q) {
         q.asked.rear = -2250;
         q.asked.front = 2250;
         q.asked.bin = 1000;
       },
       "model-size"},
      {"a range in coordinates of the map",
       [](RoadQuestion& q) {
         q.asked.rear = 4000;
         q.asked.front = 4004;
       },
       "model-origin nothing-blocked out-of-reach"},
      {"a margin in millimetres", [](RoadQuestion& q) { q.asked.margin = 100; }, "radius-size"},
      {"a margin", [](RoadQuestion& q) { q.asked.margin = 0.1; }, ""},
      {"a load on pivots",
       [](RoadQuestion& q) {
         q.asked.rear = -10;
         q.asked.front = 10;
         q.asked.pivots = BodyPivots{7, -7};
       },
       ""},
      {"a path elsewhere",
       [](RoadQuestion& q) {
         for (Pose& pose : q.path) pose.translation[1] += 500;
       },
       "nothing-blocked out-of-reach"},
  };
  return all;
}

bool names(const std::vector<Message>& warnings, const std::string& code, std::uint32_t pose) {
  const auto found = std::ranges::find(warnings, code, &Message::code);
  return found != warnings.end() &&
         std::ranges::any_of(found->stretches, [&](const PoseRange& stretch) {
           return stretch.first <= pose && pose <= stretch.last;
         });
}

}  // namespace

TEST_CASE("a section warns where its path, its place or what it ignores may be wrong") {
  const ScratchFolder folder;
  for (const AskedTrial& trial : trials()) {
    RoadQuestion question;
    trial.change(question);
    question.scan.convert_to(folder / "road.h5");
    const SectionReport report =
        find_section(Store(folder / "road.h5"), question.path, question.asked,
                     folder / "section.h5", {.threads = 2, .overwrite = true});
    INFO(trial.name);
    CHECK(codes_of(report.warnings) == trial.codes);
    // The file keeps the warnings with their stretches.
    const SectionData kept = Section(folder / "section.h5").data();
    REQUIRE(kept.warnings.size() == report.warnings.size());
    CHECK(kept.ignored_cells == report.ignored_cells);
    for (std::size_t i = 0; i < kept.warnings.size(); ++i) {
      CHECK(kept.warnings[i].text == report.warnings[i].text);
      CHECK((kept.warnings[i].stretches == report.warnings[i].stretches));
    }
    if (report.warnings.empty()) continue;
    CHECK_THROWS_AS(find_section(Store(folder / "road.h5"), question.path, question.asked,
                                 folder / "strict.h5", {.threads = 2, .strict = true}),
                    InputError);
    CHECK_FALSE(std::filesystem::exists(folder / "strict.h5"));
  }
}

TEST_CASE("warnings of a section name the poses that they are about") {
  const ScratchFolder folder;
  const auto warnings_of = [&](const std::function<void(RoadQuestion&)>& change) {
    RoadQuestion question;
    change(question);
    question.scan.convert_to(folder / "road.h5");
    return find_section(Store(folder / "road.h5"), question.path, question.asked,
                        folder / "section.h5", {.threads = 2, .overwrite = true})
        .warnings;
  };
  // Pose i stands at x = 15 + i / 2.
  const auto mostly = warnings_of([](RoadQuestion& q) {
    q.scan.erase([](const Vec3& p) { return p.x > 20 && p.x < 70 && std::abs(p.y) < 3; });
  });
  CHECK(names(mostly, "nothing-below", 55));
  CHECK_FALSE(names(mostly, "nothing-below", 125));
  const auto hole = warnings_of([](RoadQuestion& q) {
    q.scan.erase([](const Vec3& p) { return p.x > 35 && p.x < 50 && std::abs(p.y) < 3; });
  });
  CHECK(names(hole, "nothing-below", 55));
  CHECK_FALSE(names(hole, "nothing-below", 30));
  const auto obstacle = warnings_of([](RoadQuestion& q) {
    stand_in_the_way(q);
    q.asked.ignore_classes = {kObstacleClass};
  });
  CHECK(names(obstacle, "ignored-high", 50));
  CHECK_FALSE(names(obstacle, "ignored-high", 20));
  CHECK_FALSE(names(obstacle, "ignored-high", 80));
  const auto steps = warnings_of([](RoadQuestion& q) { bend(q, 4); });
  CHECK(names(steps, "large-steps", 0));
  CHECK(names(steps, "large-steps", 10));
}

TEST_CASE("no load passes where nothing could be found on a stretch of the path") {
  const ScratchFolder folder;
  const std::vector<OutlinePoint> load{{-1, 0.4}, {1, 0.4}, {1, 2}, {-1, 2}};
  const auto is_in_hole = [](const Vec3& p) { return p.x > 35 && p.x < 50; };
  struct Row {
    const char* what;
    std::function<void(RoadQuestion&)> change;
    std::string reason;  ///< empty where the load passes
  };
  for (const Row& row :
       {Row{"a sound road", [](RoadQuestion&) {}, ""},
        Row{"a hole in the ground",
            [&](RoadQuestion& q) {
              q.scan.erase([&](const Vec3& p) { return is_in_hole(p) && std::abs(p.y) < 3; });
            },
            "on stretches of the path nothing could be found (nothing-below)"},
        Row{"a hole in the scan", [&](RoadQuestion& q) { q.scan.erase(is_in_hole); },
            "on stretches of the path nothing could be found (leaves-scan)"},
        Row{"no wall on a stretch of the right",
            [](RoadQuestion& q) {
              q.scan.erase([](const Vec3& p) { return p.x > 35 && p.y < -3 && p.z > 0.2; });
            },
            ""}}) {
    INFO(row.what);
    RoadQuestion question;
    question.asked.window = SectionWindow{-3, 3, 0.3, 4};
    row.change(question);
    question.scan.convert_to(folder / "road.h5");
    find_section(Store(folder / "road.h5"), question.path, question.asked, folder / "section.h5",
                 {.threads = 2, .overwrite = true});
    const SectionCheck check = Section(folder / "section.h5").check(load);
    CHECK(check.reason == row.reason);
    CHECK((check.verdict == SectionVerdict::kPasses) == row.reason.empty());
  }
}

TEST_CASE("the place of a path causes the same warnings whoever asks") {
  const ScratchFolder folder;
  // Of a run at poses half a metre apart, the steps are larger than the radius.
  const std::set<std::string> kOfPlace{"floats",         "leaves-scan",    "nothing-below",
                                       "nothing-beside", "one-side",       "out-of-reach",
                                       "absent-class",   "trajectory-jump"};
  int same = 0;
  for (const AskedTrial& trial : trials()) {
    RoadQuestion question;
    trial.change(question);
    const bool is_of_place = question.path.size() > 20 && !question.asked.window &&
                             !question.asked.pivots && question.asked.margin == 0 &&
                             question.asked.rear == -2.25;
    if (!is_of_place) continue;
    question.scan.convert_to(folder / "road.h5");
    const Store store(folder / "road.h5");
    const SectionReport section =
        find_section(store, question.path, question.asked, folder / "section.h5",
                     {.threads = 2, .overwrite = true});
    QueryParameters parameters{.radius = 0.1};
    parameters.ignore_classes = question.asked.ignore_classes;
    parameters.ignore_boxes = question.asked.ignore_boxes;
    const Query query(box_model(4.5, 2.2, 1.1), question.path, parameters);
    const SearchReport run = search(store, query, folder / "result.h5",
                                    {.device = Device::kCpu, .threads = 2, .overwrite = true});
    const auto of_place = [&](std::vector<Message> warnings) {
      std::erase_if(warnings, [&](const Message& w) { return kOfPlace.count(w.code) == 0; });
      return codes_of(warnings);
    };
    INFO(trial.name);
    CHECK(of_place(section.warnings) == of_place(run.warnings));
    ++same;
  }
  CHECK(same > 12);
}

TEST_CASE("cells that only ignored points block are those of all pairs") {
  const ScratchFolder folder;
  Random random(21);
  int with_cells = 0, with_high = 0;
  for (int i = 0; i < 60; ++i) {
    SectionScene scene = random_section_scene(random);
    if (scene.quanta.empty()) continue;
    scene.path_pose.clear();
    for (std::uint32_t pose = 0; pose < scene.path.size(); ++pose) scene.path_pose.push_back(pose);
    const std::vector<Vec3> points = positions_of(scene.quanta, scene.quantisation);
    const Vec3 at = points[below(random, points.size())];
    const double size = uniform(random, 0.2, 4);
    scene.ignored = {{at - Vec3{size, size, size}, at + Vec3{size, size, size}}};
    SectionScene all = scene;
    all.ignored.clear();
    std::set<std::pair<std::int64_t, std::int64_t>> others, found;  // k, j
    for (const auto& [cell, pose] : by_brute_force(scene, 0)) {
      others.insert({std::get<1>(cell), std::get<2>(cell)});
    }
    for (const auto& [cell, pose] : by_brute_force(all, 0)) {
      found.insert({std::get<1>(cell), std::get<2>(cell)});
    }
    SectionIgnoredCells expected;
    constexpr double high_from = 0.5;
    for (const auto& [k, j] : found) {
      if (others.count({k, j}) > 0) continue;
      ++expected.blocked;
      if (static_cast<double>(k) * scene.asked.cell > high_from) ++expected.high;
    }
    write_las(folder / "scene.las", scene.quanta, scene.quantisation);
    convert({folder / "scene.las"}, folder / "scene.h5",
            {.cell_points = scene.cell_points, .threads = 2, .overwrite = true});
    scene.asked.ignore_boxes = scene.ignored;
    const SectionReport report =
        find_section(Store(folder / "scene.h5"), scene.path, scene.asked, folder / "section.h5",
                     {.threads = 2, .overwrite = true});
    CHECK((report.ignored_cells == expected));
    with_cells += expected.blocked > 0 ? 1 : 0;
    with_high += expected.high > 0 ? 1 : 0;
  }
  CHECK(with_cells > 20);
  CHECK(with_high > 10);
}

TEST_CASE("sound questions about scenes cause no warning") {
  struct Asked {
    scene::Kind kind;
    std::uint64_t points, poses;
  };
  const ScratchFolder folder;
  NoProgress quiet;
  int asked = 0;
  for (const Asked& of :
       {Asked{scene::Kind::kHall, 600'000, 800}, Asked{scene::Kind::kPlant, 1'200'000, 4000},
        Asked{scene::Kind::kMine, 1'500'000, 1600}, Asked{scene::Kind::kTunnel, 600'000, 3000},
        Asked{scene::Kind::kRoad, 800'000, 1500}}) {
    const auto scene = scene::make_scene(of.kind, {of.points, 1, of.poses}, 3);
    {
      const File scan = File::create(folder / "scan.las");
      scene::write_environment(*scene, 3, scan, 2, quiet);
    }
    std::vector<Pose> path;
    for (std::uint64_t i = 0; i < of.poses; ++i) path.push_back(scene->pose(i));
    convert({folder / "scan.las"}, folder / "site.h5", {.threads = 2, .overwrite = true});
    const Store store(folder / "site.h5");
    for (const auto& [rear, front] : {std::pair{-2.25, 2.25}, {-1.0, 3.5}, {-4.0, 4.0}}) {
      for (const double margin : {0.0, 0.2}) {
        for (const SectionWindow window : {SectionWindow{-4, 4, 0, 6}, {-2, 2, 0.3, 4}}) {
          const SectionParameters question{
              .rear = rear, .front = front, .window = window, .cell = 0.05, .margin = margin};
          const SectionReport report = find_section(store, path, question, folder / "section.h5",
                                                    {.threads = 2, .overwrite = true});
          INFO(scene::name_of(of.kind) << " from " << rear << " to " << front << ", margin "
                                       << margin << ", z from " << window.z_from);
          CHECK(codes_of(report.warnings).empty());
          ++asked;
        }
      }
    }
  }
  CHECK(asked == 60);
}
