// What sections and vehicles on a road warn of: the checks of their path, their place and the scan,
// and what ignored points would block.
#include <algorithm>
#include <functional>
#include <set>

#include "clearway/clearway.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"
#include "support/road_scene.hpp"
#include "support/section_scene.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The codes of warnings, each once, ascending and joined by blanks.
std::string codes_once(const std::vector<Message>& warnings) {
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

/// A change of a question.
using Change = std::function<void(RoadQuestion&)>;

Change raised(double by) {
  return [=](RoadQuestion& q) {
    for (Pose& pose : q.path) pose.translation[2] += by;
  };
}

Change bent(double step) {
  return [=](RoadQuestion& q) {
    q.scan = road_along(road_path(0, 60, 0.1, 20));
    q.path = road_path(10, 50, step, 20);
  };
}

Change with_steps(double step) {
  return [=](RoadQuestion& q) { q.path = road_path(15, 85, step); };
}

Change in_window(SectionWindow window) {
  return [=](RoadQuestion& q) { q.asked.window = window; };
}

Change ignoring(std::uint8_t point_class) {
  return [=](RoadQuestion& q) { q.asked.ignore_classes = {point_class}; };
}

Change without(bool (*is_gone)(const Vec3&)) {
  return [=](RoadQuestion& q) { q.scan.erase(is_gone); };
}

Change on_range(double rear, double front, double margin = 0) {
  return [=](RoadQuestion& q) {
    q.asked.rear = rear;
    q.asked.front = front;
    q.asked.margin = margin;
  };
}

Change asking(void (*change)(SectionParameters&)) {
  return [=](RoadQuestion& q) { change(q.asked); };
}

Change posing(void (*change)(Pose&)) {
  return [=](RoadQuestion& q) { std::ranges::for_each(q.path, change); };
}

bool is_in_hole(const Vec3& p) { return p.x > 35 && p.x < 50; }
bool is_ground_in_hole(const Vec3& p) { return is_in_hole(p) && std::abs(p.y) < 3; }

bool is_middle(const Vec3& p) { return p.x > 20 && p.x < 70 && std::abs(p.y) < 3; }
bool is_beside(const Vec3& p) { return std::abs(p.y) > 3 && p.z > 0.3; }
bool is_right_wall(const Vec3& p) { return p.y < -3 && p.z > 0.2; }

void obstacle(RoadQuestion& q) {
  for (double y = 0; y <= 0.5; y += 0.05) {
    for (double z = 0.3; z <= 1.8; z += 0.05) q.scan.add({40.02, y, z}, kObstacleClass);
  }
}

void rough_ground(RoadQuestion& q) {
  int n = 0;
  for (Vec3& p : q.scan.points) p.z += p.z == 0 ? 0.07 * (n++ % 2) : 0;
}

/// Steps as long as the load, to the rounding of sums.
void step_by_the_load(RoadQuestion& q) {
  q.asked = load_of(-0.05, 0.05);
  q.path.clear();
  double x = 15;
  for (int i = 0; i < 700; ++i, x += 0.1) q.path.push_back(translation({x, 0, 0}));
}

void lose_poses(RoadQuestion& q) { q.path.erase(q.path.begin() + 40, q.path.begin() + 52); }

/// A question, and the codes of its warnings. Pose i stands at x = 15 + i / 2.
struct Trial {
  const char* name;
  std::vector<Change> changes;
  const char* codes;
  /// Poses that the first of the warnings names, and poses that it does not name.
  std::vector<std::uint32_t> named = {}, others = {};

  RoadQuestion question() const {
    RoadQuestion out;
    for (const Change& change : changes) change(out);
    return out;
  }
};

std::vector<Trial> trials() {
  const Change in_box = asking([](auto& q) { q.ignore_boxes = {{{39, -1, 0.2}, {41, 1, 2}}}; });
  const Change between = asking([](auto& q) { q.between_poses = true; });
  const Change wide_bins = asking([](auto& q) { q.bin = 1000; });
  const Change on_pivots = asking([](auto& q) { q.pivots = BodyPivots{7, -7}; });
  const Change sideways = posing([](Pose& p) { p = rotation({0, 0, 1}, M_PI / 2, p.position()); });
  const Change mirrored = posing([](Pose& p) { p.rotation[4] = -1; });
  const Change elsewhere = posing([](Pose& p) { p.translation[1] += 500; });
  const Change no_road = without(is_ground_in_hole);
  return {
      {"a sound road", {}, ""},
      {"an ignored obstacle", {obstacle, ignoring(kObstacleClass)}, "ignored-high", {50}, {20, 80}},
      {"an obstacle in an ignored box", {obstacle, in_box}, "ignored-high"},
      {"ignored ground", {ignoring(kGroundClass)}, ""},
      {"little left", {without(is_beside), ignoring(kGroundClass)}, "ignored-collide"},
      {"a class that no point has", {ignoring(17)}, "absent-class"},
      {"a path 1.73 m too high", {raised(1.73)}, "floats"},
      {"the path of an antenna", {raised(1.73), in_window({-4, 4, -2, 4})}, ""},
      {"a window above the ground", {in_window({-4, 4, 0.42, 5})}, ""},
      {"a window that begins in the ground", {in_window({-3, 3, -0.5, 4})}, ""},
      {"a window beside the middle", {in_window({0.5, 3, 0, 4})}, ""},
      {"ignored ground in the window",
       {ignoring(kGroundClass), in_window({-2, 2, -0.5, 3}), rough_ground},
       "ignored-collide nothing-blocked"},
      {"steps as long as the load", {step_by_the_load, in_window({-2, 2, 0, 3})}, ""},
      {"a path in the ground", {raised(-1)}, "below-ground"},
      {"a path in ground with a hole", {raised(-1), no_road}, "below-ground nothing-below"},
      {"a path below the ground", {raised(-3)}, "nothing-below"},
      {"a hole of 15 m in the ground", {no_road}, "nothing-below", {55}, {30}},
      {"ground at the ends alone", {without(is_middle)}, "nothing-below", {55}, {125}},
      {"a hole of 15 m in the scan", {without(is_in_hole)}, "leaves-scan"},
      {"no wall on the right", {without(is_right_wall)}, "one-side"},
      {"poses 4 m apart in a bend", {bent(4)}, "large-steps", {0, 10}},
      {"the ways between these poses", {bent(4), between}, "motion-exceeds-cell"},
      {"poses half a metre apart in a bend", {bent(0.5)}, ""},
      {"poses 4 m apart on a straight road", {with_steps(4)}, ""},
      {"poses 5 m apart", {with_steps(5)}, "large-steps"},
      {"poses are missing", {lose_poses}, "trajectory-jump"},
      {"a load that drives sideways", {sideways}, "large-steps nothing-beside sideways"},
      {"poses that mirror the load", {mirrored}, "mirrored-poses"},
      {"a range in millimetres", {on_range(-2250, 2250), wide_bins}, "model-size"},
      {"map coordinates", {on_range(4000, 4004)}, "model-origin nothing-blocked out-of-reach"},
      {"a margin in millimetres", {on_range(-2.25, 2.25, 100)}, "radius-size"},
      {"a margin", {on_range(-2.25, 2.25, 0.1)}, ""},
      {"a load on pivots", {on_range(-10, 10), on_pivots}, ""},
      {"a path elsewhere", {elsewhere}, "nothing-blocked out-of-reach"}};
}

bool names(const Message& warning, std::uint32_t pose) {
  return std::ranges::any_of(warning.stretches, [&](const PoseRange& stretch) {
    return stretch.first <= pose && pose <= stretch.last;
  });
}

/// Checks that the place of the path causes the warnings of the section when a run asks, too.
/// Returns whether the question is one that a run may ask.
bool check_run(const Store& store, const RoadQuestion& q, const SectionReport& section,
               const ScratchFolder& folder) {
  // Of a run at poses half a metre apart, the steps are larger than the radius.
  const std::set<std::string> of_place{"floats",         "leaves-scan",    "nothing-below",
                                       "nothing-beside", "one-side",       "out-of-reach",
                                       "absent-class",   "trajectory-jump"};
  const SectionParameters& asked = q.asked;
  if (q.path.size() <= 20 || asked.window || asked.pivots || asked.margin != 0 ||
      asked.rear != -2.25) {
    return false;
  }
  QueryParameters parameters{.radius = 0.1};
  parameters.ignore_classes = asked.ignore_classes;
  parameters.ignore_boxes = asked.ignore_boxes;
  const Query query(box_model(4.5, 2.2, 1.1), q.path, parameters);
  const SearchReport run = search(store, query, folder / "result.h5",
                                  {.device = Device::kCpu, .threads = 2, .overwrite = true});
  const auto codes = [&](std::vector<Message> warnings) {
    std::erase_if(warnings, [&](const Message& w) { return of_place.count(w.code) == 0; });
    return codes_once(warnings);
  };
  CHECK(codes(section.warnings) == codes(run.warnings));
  return true;
}

}  // namespace

TEST_CASE("a section warns where its path, its place or what it ignores may be wrong") {
  const ScratchFolder folder;
  int runs = 0;
  for (const Trial& trial : trials()) {
    INFO(trial.name);
    const RoadQuestion question = trial.question();
    question.scan.convert_to(folder / "road.h5");
    const Store store(folder / "road.h5");
    const auto find = [&](const char* output, bool strict) {
      return find_section(store, question.path, question.asked, folder / output,
                          {.threads = 2, .overwrite = true, .strict = strict});
    };
    const SectionReport report = find("section.h5", false);
    CHECK(codes_once(report.warnings) == trial.codes);
    // The file keeps the warnings with their stretches.
    const SectionData kept = Section(folder / "section.h5").data();
    REQUIRE(kept.warnings.size() == report.warnings.size());
    CHECK(kept.ignored_cells == report.ignored_cells);
    for (std::size_t i = 0; i < kept.warnings.size(); ++i) {
      CHECK(kept.warnings[i].text == report.warnings[i].text);
      CHECK((kept.warnings[i].stretches == report.warnings[i].stretches));
    }
    runs += check_run(store, question, report, folder);
    if (report.warnings.empty()) continue;
    for (const std::uint32_t pose : trial.named) CHECK(names(report.warnings[0], pose));
    for (const std::uint32_t pose : trial.others) CHECK_FALSE(names(report.warnings[0], pose));
    CHECK_THROWS_AS(find("strict.h5", true), InputError);
    CHECK_FALSE(std::filesystem::exists(folder / "strict.h5"));
  }
  CHECK(runs > 12);
}

TEST_CASE("no load passes where nothing could be found on a stretch of the path") {
  const ScratchFolder folder;
  const std::vector<OutlinePoint> load{{-1, 0.4}, {1, 0.4}, {1, 2}, {-1, 2}};
  const std::string nothing = "on stretches of the path nothing could be found ";
  const auto reason_on = [&](const Change& change) {
    RoadQuestion question;
    question.asked.window = SectionWindow{-3, 3, 0.3, 4};
    change(question);
    question.scan.convert_to(folder / "road.h5");
    find_section(Store(folder / "road.h5"), question.path, question.asked, folder / "section.h5",
                 {.threads = 2, .overwrite = true});
    const SectionCheck check = Section(folder / "section.h5").check(load);
    CHECK((check.verdict == SectionVerdict::kPasses) == check.reason.empty());
    return check.reason;
  };
  CHECK(reason_on([](RoadQuestion&) {}).empty());
  CHECK(reason_on(without(is_ground_in_hole)) == nothing + "(nothing-below)");
  CHECK(reason_on(without(is_in_hole)) == nothing + "(leaves-scan)");
  // A wall is missing on a stretch of the right.
  CHECK(
      reason_on(without([](const Vec3& p) { return p.x > 35 && p.y < -3 && p.z > 0.2; })).empty());
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
    const auto cells = [&] {
      std::set<std::pair<std::int64_t, std::int64_t>> out;  // k, j
      for (const auto& [cell, pose] : by_brute_force(scene, 0)) {
        out.insert({std::get<1>(cell), std::get<2>(cell)});
      }
      return out;
    };
    scene.ignored.clear();
    const auto all = cells();
    scene.ignored = {{at - Vec3{size, size, size}, at + Vec3{size, size, size}}};
    const auto searched = cells();
    SectionIgnoredCells expected;
    for (const auto& cell : all) {
      if (searched.count(cell) > 0) continue;
      ++expected.blocked;
      if (static_cast<double>(cell.first) * scene.asked.cell > 0.5) ++expected.high;
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

namespace {

/// A body that stands at a place of the frame, and moves `behind` the path.
struct Part {
  const char* name;
  Vec3 size, at;
  double behind = 0, unit = 1;
};

const Part kWagon{"wagon", {6, 2, 3}, {0, 0, 0.3}};
const Part kMirror{"mirror", {0.2, 0.2, 0.4}, {2.5, 1.2, 2}};

}  // namespace

TEST_CASE("a vehicle is warned of as a whole") {
  const ScratchFolder folder;
  road_along(road_path(0, 100, 0.1)).convert_to(folder / "road.h5");
  const auto report_of = [&](const std::vector<Part>& parts) {
    Query query({}, road_path(15, 85, 0.08), {.radius = 0.1});
    for (const Part& part : parts) {
      Body body{part.name, box_model(part.size.x, part.size.y, part.size.z), query.poses, {}};
      for (Vec3& p : body.model.vertices) p = part.unit * (p + part.at);
      for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
        body.poses[i].translation[0] -= part.behind;
        body.path_pose.push_back(i);
      }
      query.bodies.push_back(std::move(body));
    }
    return search(Store(folder / "road.h5"), query, folder / "result.h5",
                  {.device = Device::kCpu, .threads = 2, .overwrite = true});
  };
  const auto check_codes = [&](const std::vector<Part>& parts, const char* codes) {
    check_equal(codes_of(report_of(parts).warnings), codes);
  };
  check_codes({kWagon, kMirror}, "");
  check_codes({kWagon, kMirror, {"load", kWagon.size, kWagon.at}}, "same-body");
  check_codes({kWagon, kMirror, {"other", kMirror.size, {2.5, -1.4, 2}}}, "");
  check_codes({kWagon, kMirror, {"tail", kWagon.size, kWagon.at, 7}}, "");
  check_codes({kMirror}, "floats, model-size");

  // One body in another unit puts the answer about the vehicle in doubt.
  CHECK(report_of({kWagon, kMirror}).verdict() == Verdict::kClear);
  const SearchReport in_doubt = report_of({{"wagon", kWagon.size, kWagon.at, 0, 1000}, kMirror});
  CHECK(in_doubt.verdict() == Verdict::kUndecided);
  check_equal(in_doubt.doubts(), std::vector<std::string>{"model-unit"});
}
