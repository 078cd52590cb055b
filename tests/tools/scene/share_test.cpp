#include <cmath>
#include <unordered_map>
#include <vector>

#include "scene/vector.hpp"
#include "support/catch.hpp"
#include "tools/scene/made_scene.hpp"

using namespace clearway;
using namespace clearway::scene;

namespace {

constexpr double kRadius = 0.1;

/// The model's points sorted into cubes of side kRadius, in the model's own frame.
class ModelCubes {
 public:
  explicit ModelCubes(const std::vector<Vec3>& model) {
    for (const Vec3& m : model) {
      cubes_[key(m, 0, 0, 0)].push_back(m);
      reach_ = std::max(reach_, std::sqrt(squared_length(m.x, m.y, m.z)));
    }
  }

  double reach() const { return reach_ + kRadius; }

  bool touches(const Vec3& p) const {
    for (int i = 0; i < 27; ++i) {
      const auto cube = cubes_.find(key(p, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
      if (cube == cubes_.end()) continue;
      for (const Vec3& m : cube->second) {
        if (collides(p, m, kRadius)) return true;
      }
    }
    return false;
  }

 private:
  static std::int64_t key(const Vec3& p, int dx, int dy, int dz) {
    const auto cube = [](double x) { return static_cast<std::int64_t>(std::floor(x / kRadius)); };
    return ((cube(p.x) + dx) * 4096 + cube(p.y) + dy) * 4096 + cube(p.z) + dz;
  }

  std::unordered_map<std::int64_t, std::vector<Vec3>> cubes_;
  double reach_ = 0;
};

Vec3 pulled_back(const Pose& pose, const Vec3& e) {
  const double* r = pose.rotation;
  const Vec3 d{e.x - pose.translation[0], e.y - pose.translation[1], e.z - pose.translation[2]};
  return {r[0] * d.x + r[3] * d.y + r[6] * d.z, r[1] * d.x + r[4] * d.y + r[7] * d.z,
          r[2] * d.x + r[5] * d.y + r[8] * d.z};
}

std::vector<Vec3> colliding_points(const test::MadeScene& made) {
  const ModelCubes model(made.model);
  const double reach = model.reach() * model.reach();
  std::vector<Vec3> hits;
  for (const Vec3& e : made.environment) {
    for (const Pose& pose : made.poses) {
      const double dx = e.x - pose.translation[0], dy = e.y - pose.translation[1];
      if (dx * dx + dy * dy > reach) continue;
      if (model.touches(pulled_back(pose, e))) {
        hits.push_back(e);
        break;
      }
    }
  }
  return hits;
}

double colliding_share(const test::MadeScene& made) {
  return static_cast<double>(colliding_points(made).size()) /
         static_cast<double>(made.environment.size());
}

}  // namespace

// With few poses and few points, the share is a little lower and less certain than at full size.
TEST_CASE("as many points collide as in the paper's table 1, about") {
  CHECK(colliding_share(test::made_scene(Kind::kHall, {8000, 20000, 1000})) ==
        Approx(0.045).margin(0.014));
  CHECK(colliding_share(test::made_scene(Kind::kPlant, {8000, 20000, 2000})) ==
        Approx(0.075).margin(0.018));
  CHECK(colliding_share(test::made_scene(Kind::kMine, {8000, 50000, 2000})) ==
        Approx(0.044).margin(0.014));
  CHECK(colliding_share(test::made_scene(Kind::kTunnel, {8000, 28622, 2000})) ==
        Approx(0.086).margin(0.02));
}

TEST_CASE("the lorry passes through the village but for a sign and a parked van") {
  const auto road = make_scene(Kind::kRoad, {1, 1, 1}, 1);
  const Vec3 sign = road->path.to_world({70, 1.7, 4}), van = road->path.to_world({214, 2.6, 1.3});
  std::size_t at_sign = 0, at_van = 0, elsewhere = 0;
  for (const Vec3& p : colliding_points(test::made_scene(Kind::kRoad, {300000, 100000, 500}))) {
    ++(length(p - sign) < 1.5 ? at_sign : length(p - van) < 4 ? at_van : elsewhere);
  }
  CHECK(at_sign > 5);
  CHECK(at_van > 100);
  CHECK(elsewhere == 0);
}
