// Questions of a store of the points near a path: answered as by the whole store, or refused.
#include "core/util/progress.hpp"
#include "io/paths/trajectory_file.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/questions.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A scan, and a store of what is near a path.
struct NearScene {
  explicit NearScene(Random& random) : scan(random(), true) {
    path = AskedScan::path(random, 1 + below(random, 40));
    within = uniform(random, 0.5, 1.2);
    NoProgress quiet;
    write_trajectory(path, File::create(scan.folder / "path.txt"), quiet);
    ConvertOptions how{.cell_points = 64};
    how.near = scan.folder / "path.txt";
    how.within = within;
    store = scan.converted("near.h5", how);
  }

  AskedScan scan;
  std::vector<Pose> path;
  double within = 0;
  std::filesystem::path store;
};

/// A random question along the path of the scene, whose poses follow it closely or do not.
Query question_along(Random& random, const NearScene& scene) {
  Query query = scene.scan.question(random).query;
  query.depth = false;  // needs the whole scans
  query.poses = scene.path;
  const double off = below(random, 3) == 0 ? uniform(random, 0, 1) : 0;
  for (Pose& pose : query.poses) {
    for (double& value : pose.translation) value += uniform(random, -off, off);
  }
  if (below(random, 4) == 0) stretch(query.poses, {1.3, 0.8, 1});
  query.radius = uniform(random, 0.02, 0.4);
  const std::vector<Body> follow_path = three_bodies(random, query.poses, false);
  for (std::size_t i = 0; i < query.bodies.size(); ++i) {
    query.bodies[i].poses = follow_path[i].poses;
    query.bodies[i].path_pose = follow_path[i].path_pose;
  }
  return query;
}

}  // namespace

TEST_CASE("a store of points near a path answers truly, or refuses") {
  Random random(20261129);
  int answered = 0, refused = 0;
  for (int i = 0; i < 16; ++i) {
    const NearScene scene(random);
    const Session all(scene.scan.store, {.threads = 2}), near(scene.store, {.threads = 2});
    for (int k = 0; k < 12; ++k) {
      const Query query = question_along(random, scene);
      INFO("scene " << i << ", question " << k);
      try {
        const SessionAnswer found = near.search(query), whole = all.search(query);
        check_tables({whole.collisions(), whole.near(), whole.clearances(), {whole.profile(), {}}},
                     found.collisions(), found.near(), found.clearances(), found.profile());
        ++answered;
      } catch (const InputError& error) {
        check_says(
            error.what(),
            "holds only points within ... points which were left out could change the answer");
        CHECK(error.remedy() == Remedy::kWiderCorridor);
        CHECK(error.amount() > scene.within);
        ++refused;
      }
    }
  }
  CHECK(answered > 40);
  CHECK(refused > 40);
}

TEST_CASE("sections and shifts that reach too far are refused, seen space and depths always") {
  Random random(20261130);
  const NearScene scene(random);
  const Store near(scene.store);
  SectionParameters asked{.rear = -0.2, .front = 0.2, .window = SectionWindow{-0.2, 0.2, 0, 0.2}};
  std::vector<Pose> rigid;
  for (const Pose& pose : scene.path) rigid.push_back(translation(pose.position()));
  const auto find = [&] {
    find_section(near, rigid, asked, scene.scan.folder / "s.h5", {.threads = 2, .overwrite = true});
  };
  find();
  asked.margin = 1;
  asked.window->y_to = 2.4;
  check_refused<InputError>(find, "the section at pose ... reaches farther");

  Query query({{0, 0, 0}}, rigid, {.radius = 0.2});
  const Session session(scene.store, {.threads = 2});
  query.seen = true;
  check_refused<UsageError>([&] { session.search(query); }, "seen space needs the whole scans");
  query.seen = false;
  query.depth = true;
  check_refused<UsageError>([&] { session.search(query); }, "--near");
  query.depth = false;
  query.first_pose = true;
  search(near, query, scene.scan.folder / "out.h5");
  const Result result(scene.scan.folder / "out.h5");
  const auto shift = [&](double most) {
    return find_shifts(session, result, query, {}, {.lateral_from = -0.1, .lateral_to = most});
  };
  shift(0.1);
  check_refused<InputError>([&] { shift(4); }, "reaches farther");
}
