// What a vehicle of several bodies warns of.
#include <algorithm>
#include <functional>
#include <set>

#include "clearway/clearway.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"
#include "support/road_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A vehicle of a wagon and a mirror on a sound road, and the messages of reading it.
struct Asked {
  std::vector<Pose> path = road_path(15, 85, 0.08);
  std::vector<Body> bodies;
  std::vector<Message> read;

  Asked() {
    add("wagon", box_model(6, 2, 3), {0, 0, 0.3});
    add("mirror", box_model(0.2, 0.2, 0.4), {2.5, 1.2, 2});
  }

  void add(const std::string& name, Model model, const Vec3& at) {
    for (Vec3& p : model.vertices) p = p + at;
    Body body{.name = name, .model = std::move(model), .poses = path, .path_pose = {}};
    for (std::uint32_t i = 0; i < path.size(); ++i) body.path_pose.push_back(i);
    bodies.push_back(std::move(body));
  }
};

}  // namespace

TEST_CASE("a vehicle is warned of as a whole") {
  const ScratchFolder folder;
  road_along(road_path(0, 100, 0.1)).convert_to(folder / "road.h5");
  const Store store(folder / "road.h5");
  struct Row {
    const char* what;
    std::function<void(Asked&)> change;
    std::set<std::string> codes;
  };
  for (const Row& row : {Row{"a wagon with a mirror", [](Asked&) {}, {}},
                         Row{"a copied body",
                             [](Asked& a) {
                               a.bodies.push_back(a.bodies[0]);
                               a.bodies[2].name = "load";
                             },
                             {"same-body"}},
                         Row{"two mirrors",
                             [](Asked& a) {
                               a.add("other", box_model(0.2, 0.2, 0.4), {2.5, -1.4, 2});
                             },
                             {}},
                         Row{"two bodies with one model at other poses",
                             [](Asked& a) {
                               a.bodies.push_back(a.bodies[0]);
                               a.bodies[2].name = "tail";
                               for (Pose& pose : a.bodies[2].poses) pose.translation[0] -= 7;
                             },
                             {}},
                         Row{"a mirror alone",
                             [](Asked& a) { a.bodies.erase(a.bodies.begin()); },
                             {"floats", "model-size"}}}) {
    INFO(row.what);
    Asked asked;
    row.change(asked);
    Query query({}, asked.path, {.radius = 0.1});
    query.bodies = asked.bodies;
    const SearchReport report = search(
        store, query, folder / "result.h5",
        {.device = Device::kCpu, .threads = 2, .overwrite = true, .input_warnings = asked.read});
    std::set<std::string> codes;
    for (const Message& warning : report.warnings) codes.insert(warning.code);
    CHECK(codes == row.codes);
  }
}

TEST_CASE("one body in another unit puts the answer about the vehicle in doubt") {
  const ScratchFolder folder;
  road_along(road_path(0, 100, 0.1)).convert_to(folder / "road.h5");
  const Store store(folder / "road.h5");
  for (const double factor : {1000.0, 1.0}) {
    Asked asked;
    for (Vec3& p : asked.bodies[0].model.vertices) p = {factor * p.x, factor * p.y, factor * p.z};
    Query query({}, asked.path, {.radius = 0.1});
    query.bodies = asked.bodies;
    const SearchReport report = search(store, query, folder / "result.h5",
                                       {.device = Device::kCpu, .threads = 2, .overwrite = true});
    CHECK(report.verdict() == (factor > 1 ? Verdict::kUndecided : Verdict::kClear));
    check_equal(report.doubts(),
                factor > 1 ? std::vector<std::string>{"model-unit"} : std::vector<std::string>{});
  }
}
