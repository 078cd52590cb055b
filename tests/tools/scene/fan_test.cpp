#include "scene/scanning/fan.hpp"

#include <cmath>
#include <optional>

#include "scene/vector.hpp"
#include "support/catch.hpp"

using namespace clearway::scene;

namespace {

/// The distance along a ray to a prism of a straight path, by slabs in three dimensions.
std::optional<double> distance_to(const Prism& prism, const PathPoint& from, double s, double v,
                                  double w) {
  const double c = prism.turn.cosine, d = prism.turn.sine;
  const double x = from.s - prism.s, y = from.v - prism.v;
  const double start[] = {c * x + d * y, c * y - d * x, from.w - (prism.bottom + prism.top) / 2};
  const double ray[] = {c * s + d * v, c * v - d * s, w};
  const double half[] = {prism.half_length, prism.half_width, (prism.top - prism.bottom) / 2};
  double enter = -1e30, leave = 1e30;
  for (int k = 0; k < 3; ++k) {
    const double a = (-half[k] - start[k]) / ray[k], b = (half[k] - start[k]) / ray[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (prism.round) {
    const double radius = prism.half_length, a = s * s + v * v, b = x * s + y * v;
    const double square = b * b - a * (x * x + y * y - radius * radius);
    if (square <= 0) return {};
    const double w0 = (-half[2] - start[2]) / w, w1 = (half[2] - start[2]) / w;
    enter = std::max(std::min(w0, w1), (-b - std::sqrt(square)) / a);
    leave = std::min(std::max(w0, w1), (-b + std::sqrt(square)) / a);
  }
  if (enter > leave || enter <= 0) return {};
  return enter;
}

std::vector<Prism> random_prisms(Dice& dice, const PathPoint& scanner) {
  std::vector<Prism> out;
  while (out.size() < 60) {
    Prism prism{.s = dice.between(-6, 6),
                .v = dice.between(-6, 6),
                .half_length = dice.between(0.1, 1.5),
                .half_width = dice.between(0.1, 1.5),
                .bottom = dice.between(-1, 4),
                .top = 0,
                .turn = sine_cosine(dice.between(-2, 2)),
                .round = dice.chance(0.3)};
    prism.top = prism.bottom + dice.between(0.05, 2);
    const bool around = std::abs(prism.s - scanner.s) < 2.2 &&
                        std::abs(prism.v - scanner.v) < 2.2 && prism.bottom < scanner.w + 0.1 &&
                        prism.top > scanner.w - 0.1;
    if (!around) out.push_back(prism);
  }
  return out;
}

}  // namespace

TEST_CASE("a fan meets the nearest prism, as a search over all finds it") {
  Dice dice(5, 5);
  const Random jitter(1, 1);
  int met = 0;
  for (int round = 0; round < 60; ++round) {
    const PathPoint scanner{dice.between(-0.5, 0.5), dice.between(-0.5, 0.5), 1.5};
    const SineCosine azimuth = sine_cosine(dice.between(0, 2 * kPi));
    const std::vector<Prism> prisms = random_prisms(dice, scanner);
    std::vector<Rectangle> rectangles;
    cut_prisms(prisms, scanner, azimuth, rectangles);
    Fan fan;
    const double begin = round % 2 == 0 ? 0 : 0.9, end = round % 3 == 0 ? 2 * kPi : 3;
    fan.aim(begin, end, 500, jitter, 500 * static_cast<std::uint64_t>(round));
    for (const Rectangle& rectangle : rectangles) fan.meet_rectangle(rectangle);
    for (std::size_t k = 0; k < fan.size(); ++k) {
      double nearest = 1e30;
      for (const Prism& prism : prisms) {
        const auto distance = distance_to(prism, scanner, fan.ray_h(k) * azimuth.cosine,
                                          fan.ray_h(k) * azimuth.sine, fan.ray_w(k));
        if (distance && *distance < nearest) nearest = *distance;
      }
      const double found = fan.inverse_distance(k) > 0 ? 1 / fan.inverse_distance(k) : 1e30;
      CHECK(found == Approx(nearest).epsilon(1e-9));
      if (found < 1e30) ++met;
    }
  }
  CHECK(met > 5000);
}

TEST_CASE("a fan meets the walls of a room where they stand") {
  const Room room{.begin_s = 0, .walls = {{0, -1, 0}, {0, 1, 5}, {1, 0, 4}, {-1, 0, 3}}};
  const PathPoint scanner{10, 1, 2};
  Fan fan;
  fan.aim(0, 2 * kPi, 1000, Random(1, 1), 0);
  const SineCosine azimuth = sine_cosine(1.1);
  fan.meet_room(room, scanner, azimuth);
  for (std::size_t k = 0; k < fan.size(); ++k) {
    const double t = 1 / fan.inverse_distance(k);
    const double v = scanner.v + t * fan.ray_h(k) * azimuth.sine, w = scanner.w + t * fan.ray_w(k);
    CHECK(v < 4 + 1e-9);
    CHECK(v > -3 - 1e-9);
    CHECK(w < 5 + 1e-9);
    CHECK(w > -1e-9);
    const double slack = std::min({4 - v, v + 3, 5 - w, w});
    CHECK(slack == Approx(0).margin(1e-9));
    const Wall* wall = fan.wall(k);
    REQUIRE(wall != nullptr);
    CHECK(wall->normal_v * v + wall->normal_w * w == Approx(wall->distance).margin(1e-9));
  }
}

TEST_CASE("an open room may be left upwards") {
  const Room room{.begin_s = 0, .walls = {{0, -1, 1}}, .open = true};
  Fan fan;
  fan.aim(0, 2 * kPi, 100, Random(1, 1), 0);
  fan.meet_room(room, {0, 0, 2}, {0, 1});
  for (std::size_t k = 0; k < fan.size(); ++k) {
    CHECK((fan.inverse_distance(k) > 0) == (fan.ray_w(k) < 0));
  }
}
