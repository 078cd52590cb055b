#include "support/scenes.hpp"

#include <cmath>
#include <utility>

namespace clearway {

double uniform(Random& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

std::uint64_t below(Random& random, std::uint64_t end) {
  return std::uniform_int_distribution<std::uint64_t>(0, end - 1)(random);
}

Vec3 random_point(Random& random, const Box& box) {
  Vec3 p{};
  for (int k = 0; k < 3; ++k) p[k] = box.lo[k] + (box.hi[k] - box.lo[k]) * uniform(random, 0, 1);
  return p;
}

std::vector<Vec3> random_points(Random& random, const Box& box, std::size_t count) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(random_point(random, box));
  return points;
}

Vec3 random_direction(Random& random) {
  std::normal_distribution<double> normal;
  Vec3 d{};
  double length = 0;
  while (length < 1e-3) {
    d = {normal(random), normal(random), normal(random)};
    length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
  }
  return {d.x / length, d.y / length, d.z / length};
}

Pose rotation(const Vec3& a, double angle, const Vec3& by) {
  const double c = std::cos(angle), s = std::sin(angle), v = 1 - c;
  return {{c + a.x * a.x * v, a.x * a.y * v - a.z * s, a.x * a.z * v + a.y * s,
           a.y * a.x * v + a.z * s, c + a.y * a.y * v, a.y * a.z * v - a.x * s,
           a.z * a.x * v - a.y * s, a.z * a.y * v + a.x * s, c + a.z * a.z * v},
          {by.x, by.y, by.z}};
}

Pose random_rotation(Random& random, const Vec3& by) {
  return rotation(random_direction(random), uniform(random, -3.2, 3.2), by);
}

Pose translation(const Vec3& by) { return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {by.x, by.y, by.z}}; }

Pose printed_with_six_digits(Pose pose) {
  for (double& value : pose.rotation) value = std::round(value * 1e6) / 1e6;
  for (double& value : pose.translation) value = std::round(value * 1e6) / 1e6;
  return pose;
}

Pose stretched(Pose pose, const Vec3& by) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.rotation[3 * row + column] *= by[column];
  }
  return pose;
}

void print_with_six_digits(std::vector<Pose>& poses) {
  for (Pose& pose : poses) pose = printed_with_six_digits(pose);
}

void stretch(std::vector<Pose>& poses, const Vec3& by) {
  for (Pose& pose : poses) pose = stretched(pose, by);
}

void drive_back(std::vector<Pose>& poses) {
  const std::vector<Pose> there = poses;
  poses.insert(poses.end(), there.rbegin(), there.rend());
}

void stop_at(std::vector<Pose>& poses, std::ptrdiff_t pose, std::size_t times) {
  const Pose copy = poses[static_cast<std::size_t>(pose)];
  poses.insert(poses.begin() + pose, times, copy);
}

void repeat_each(std::vector<Pose>& poses, std::size_t times) {
  const std::vector<Pose> once = std::exchange(poses, {});
  for (const Pose& pose : once) poses.insert(poses.end(), times, pose);
}

std::vector<Pose> smooth_path(Random& random, const Box& box, std::size_t count) {
  const Vec3 from = random_point(random, box);
  const Vec3 to = random_point(random, box);
  const Vec3 axis = random_direction(random);
  const double start = uniform(random, -3, 3);
  const double turn = uniform(random, -2, 2);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(count);
    const Vec3 at{from.x + (to.x - from.x) * t, from.y + (to.y - from.y) * t,
                  from.z + (to.z - from.z) * t};
    poses.push_back(rotation(axis, start + turn * t, at));
  }
  return poses;
}

std::vector<Pose> slow_path(int count, double bend) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double s = i / (count / 5.0), angle = bend * s / 5;
    Pose pose = translation({s - 2.5, bend * s * s / 50, 0.25});
    pose.rotation[0] = pose.rotation[4] = std::cos(angle);
    pose.rotation[3] = std::sin(angle);
    pose.rotation[1] = -pose.rotation[3];
    poses.push_back(pose);
  }
  return poses;
}

std::vector<Pose> random_slow_path(Random& random, std::size_t count) {
  const auto maybe = [&](double most) {
    return below(random, 2) == 0 ? 0 : uniform(random, -most, most);
  };
  const Vec3 speed{0.025 * uniform(random, -1, 1), maybe(0.01), maybe(0.005)};
  const Vec3 swing{maybe(1), maybe(0.3), maybe(0.5)};
  const double bend = maybe(4e-5), turn = maybe(0.02), far = maybe(0.7), roll = maybe(0.3);
  const double pace = uniform(random, 0.02, 0.2), tremble = maybe(0.004), jump = maybe(1.5);
  const std::size_t pause = below(random, 3) == 0 ? 50 : 1, leg = 20 + below(random, 100);
  const double away = below(random, 6) == 0 ? 1000 : 0;
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<double>(i - i % pause);
    const double s = t - static_cast<double>(count) / 2, angle = turn * t;
    const double along[3] = {std::cos(angle), std::sin(angle), 0};
    Vec3 at{0.2, 0.3, 0.3};
    for (int k = 0; k < 3; ++k) {
      at[k] += s * speed[k] + std::sin(pace * t) * swing[k] + far * along[k];
    }
    at.y += bend * s * s + tremble * static_cast<double>(i % 7);
    if (i / leg % 2 == 1) at.x += jump + (i / leg == 3 ? away : 0);
    Pose pose = rotation({0, 0, 1}, angle, at);
    const double c = std::cos(roll * std::sin(0.2 * t)), r = std::sin(roll * std::sin(0.2 * t));
    for (int row = 0; row < 3; ++row) {  // rolls about x before it turns about z
      const double y = pose.rotation[3 * row + 1], z = pose.rotation[3 * row + 2];
      pose.rotation[3 * row + 1] = c * y + r * z;
      pose.rotation[3 * row + 2] = c * z - r * y;
    }
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace clearway
