// Questions of a store of the points near a path: answered as by the whole store, or refused.
#include <fstream>

#include "clearway/clearway.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A trajectory of 4 x 4 matrices.
void write_path(const std::filesystem::path& file, const std::vector<Pose>& poses) {
  std::ofstream out(file);
  out.precision(17);
  for (const Pose& pose : poses) {
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < 3; ++k) out << pose.rotation[3 * row + k] << " ";
      out << pose.translation[row] << " ";
    }
    out << "0 0 0 1\n";
  }
}

/// A scan, the path that a store of it was made for, and that distance.
struct NearScene {
  explicit NearScene(Random& random) {
    std::vector<Quantum> points;
    for (int i = 0; i < 4000; ++i) {
      Quantum q;
      for (std::size_t k = 0; k < 3; ++k) {
        q[k] = static_cast<std::int32_t>(below(random, k == 0 ? 12'000 : 5'000));
      }
      points.push_back(q);
    }
    write_las(folder / "a.las", points, {{0.001, 0.001, 0.001}, {0, 0, 0}});
    within = uniform(random, 0.8, 2.5);
    std::vector<Pose> poses;
    Vec3 at{2, 2.5, 2.5};
    for (std::uint64_t i = 1 + below(random, 40); i > 0; --i) {
      poses.push_back(below(random, 2) == 0 ? random_rotation(random, at) : translation(at));
      at = at + Vec3{uniform(random, 0, 0.4), uniform(random, -0.2, 0.2), 0};
    }
    if (below(random, 4) == 0) drive_back(poses);
    path = poses;
    write_path(folder / "path.txt", path);
    ConvertOptions options{.cell_points = 64, .threads = 2};
    convert({folder / "a.las"}, folder / "all.h5", options);
    options.near = folder / "path.txt";
    options.within = within;
    convert({folder / "a.las"}, folder / "near.h5", options);
  }

  ScratchFolder folder;
  std::vector<Pose> path;
  double within = 0;
};

/// A question about the scene whose poses follow its path closely, or do not.
Query random_question(Random& random, const NearScene& scene) {
  Query query;
  const double size = uniform(random, 0.05, 0.9);
  const Vec3 middle{uniform(random, -0.3, 0.3), 0, 0};
  for (int i = 0; i < 12; ++i) {
    query.model.vertices.push_back(
        middle + random_point(random, {{-size, -size, -size}, {size, size, size}}));
  }
  query.poses = scene.path;
  const double off = below(random, 3) == 0 ? uniform(random, 0, 1.5) : 0;
  for (Pose& pose : query.poses) {
    for (double& value : pose.translation) value += uniform(random, -off, off);
  }
  if (below(random, 4) == 0) stretch(query.poses, {1.3, 0.8, 1});
  query.radius = uniform(random, 0.1, 0.6);
  query.first_pose = below(random, 2) == 0;
  switch (below(random, 5)) {
    case 0:
      query.clearance = uniform(random, 0.1, 1);
      break;
    case 1:
      query.profile = uniform(random, 0.1, 1);
      break;
    case 2:
      query.between_poses = true;
      break;
    case 3:
      query.error_scan = uniform(random, 0, 0.1);
      break;
    default:
      break;
  }
  if (below(random, 4) == 0) query.floor = uniform(random, -0.5, 0.2);
  if (below(random, 4) != 0) return query;
  // The same as two bodies, of which one may be far from the path.
  Body body{.name = "a", .model = query.model, .poses = query.poses, .path_pose = {}};
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) body.path_pose.push_back(i);
  query.bodies = {body, body};
  query.bodies[1].name = "b";
  const double far = uniform(random, 0, 1);
  for (Pose& pose : query.bodies[1].poses) pose.translation[1] += far;
  query.model = {};
  return query;
}

void check_same_tables(const SessionAnswer& found, const SessionAnswer& expected) {
  CHECK(found.collisions().source == expected.collisions().source);
  CHECK((found.collisions().xyz == expected.collisions().xyz));
  CHECK(found.collisions().first_pose == expected.collisions().first_pose);
  CHECK(found.collisions().last_pose == expected.collisions().last_pose);
  CHECK(found.clearances().source == expected.clearances().source);
  CHECK(found.clearances().distance == expected.clearances().distance);
  CHECK(found.clearances().pose == expected.clearances().pose);
  CHECK(found.profile().source == expected.profile().source);
  CHECK(found.profile().distance == expected.profile().distance);
  CHECK(found.near().source == expected.near().source);
}

}  // namespace

TEST_CASE("a store of points near a path answers as the whole store does, or refuses") {
  Random random(20261129);
  int answered = 0, refused = 0;
  for (int i = 0; i < 40; ++i) {
    const NearScene scene(random);
    const Session all(scene.folder / "all.h5", {.threads = 2});
    const Session near(scene.folder / "near.h5", {.threads = 2});
    for (int k = 0; k < 8; ++k) {
      const Query query = random_question(random, scene);
      const SessionAnswer expected = all.search(query);
      INFO("scene " << i << ", question " << k);
      try {
        const SessionAnswer found = near.search(query);
        check_same_tables(found, expected);
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

TEST_CASE("sections and shifts that reach too far are refused, and seen space always") {
  Random random(20261130);
  const NearScene scene(random);
  const Store near(scene.folder / "near.h5");
  SectionParameters asked{.rear = -0.2, .front = 0.2, .window = SectionWindow{-0.2, 0.2, 0, 0.2}};
  const SectionOptions overwriting{.threads = 2, .overwrite = true};
  std::vector<Pose> rigid;
  for (const Pose& pose : scene.path) {
    const auto& at = pose.translation;
    rigid.push_back(translation({at[0], at[1], at[2]}));
  }
  const auto find = [&] { find_section(near, rigid, asked, scene.folder / "s.h5", overwriting); };
  find();
  asked.margin = 1;
  asked.window->y_to = 2.4;
  check_refused<InputError>(find, "the section at pose ... reaches farther");

  Query query;
  query.model.vertices = {{0, 0, 0}};
  query.poses = rigid;
  query.radius = 0.2;
  const Session session(scene.folder / "near.h5", {.threads = 2});
  query.seen = true;
  check_refused<UsageError>([&] { session.search(query); }, "seen space needs the whole scans");
  query.seen = false;
  query.first_pose = true;
  search(near, query, scene.folder / "out.h5");
  const Result result(scene.folder / "out.h5");
  const auto shift = [&](double most) {
    return find_shifts(session, result, query, {}, {.lateral_from = -0.1, .lateral_to = most});
  };
  shift(0.1);
  check_refused<InputError>([&] { shift(4); }, "reaches farther");
}
