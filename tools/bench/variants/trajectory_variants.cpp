#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "bench/measure/publish.hpp"
#include "bench/variants/variants.hpp"
#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"
#include "io/files/input_error.hpp"
#include "io/paths/trajectory_file.hpp"
#include "scene/random.hpp"

namespace clearway::bench {
namespace {

namespace fs = std::filesystem;

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

void write_poses(const fs::path& in, const fs::path& out, const std::vector<Pose>& poses) {
  NoProgress progress;
  publish(in, out, [&](const File& file) { write_trajectory(poses, file, progress); });
}

/// Applies change(pose, index) to each pose and writes the poses.
template <typename Change>
void write_changed(const fs::path& in, const fs::path& out, Change change) {
  auto poses = read_trajectory(in, {.allow_non_rigid = true});
  for (std::size_t i = 0; i < poses.size(); ++i) change(poses[i], i);
  write_poses(in, out, poses);
}

void turn(Pose& pose, const Eigen::Vector3d& rotation_vector) {
  const Eigen::AngleAxisd rotation(rotation_vector.norm(), rotation_vector.normalized());
  Eigen::Map<RowMajor> matrix(pose.rotation);
  matrix = (rotation.toRotationMatrix() * matrix).eval();
}

void check_sigma(double sigma) {
  if (sigma >= 0 && std::isfinite(sigma)) return;
  throw UsageError("noise of " + format_number(sigma) + "; expected 0 or more");
}

}  // namespace

void write_every_nth_pose(const fs::path& in, const fs::path& out, std::uint64_t n) {
  if (n == 0) throw UsageError("every 0th pose; expected 1 or more");
  const auto poses = read_trajectory(in, {.allow_non_rigid = true});
  std::vector<Pose> kept;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i % n == 0 || i + 1 == poses.size()) kept.push_back(poses[i]);
  }
  write_poses(in, out, kept);
}

void write_first_poses(const fs::path& in, const fs::path& out, std::uint64_t parts) {
  if (parts == 0) throw UsageError("the first of 0 parts of a path; expected 1 or more");
  auto poses = read_trajectory(in, {.allow_non_rigid = true});
  poses.resize((poses.size() + parts - 1) / parts);
  write_poses(in, out, poses);
}

void write_shifted_poses(const fs::path& in, const fs::path& out, const Vec3& shift) {
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(shift[k])) {
      throw UsageError("a shift of " + format_number(shift[k]) + " m; expected a finite length");
    }
  }
  write_changed(in, out, [&](Pose& pose, std::size_t) {
    for (int k = 0; k < 3; ++k) pose.translation[k] += shift[k];
  });
}

void write_noisy_poses(const fs::path& in, const fs::path& out, double sigma_m, double sigma_rad,
                       std::uint64_t seed) {
  check_sigma(sigma_m);
  check_sigma(sigma_rad);
  const scene::Random random(seed, 0);
  const auto normal = [&random](std::uint64_t counter) {
    return scene::Random::to_normal(random.bits(counter));
  };
  write_changed(in, out, [&](Pose& pose, std::size_t i) {
    Eigen::Vector3d rotation_vector;
    for (int k = 0; k < 3; ++k) {
      pose.translation[k] += sigma_m * normal(6 * i + k);
      rotation_vector[k] = sigma_rad * normal(6 * i + 3 + k);
    }
    turn(pose, rotation_vector);
  });
}

void write_turning_poses(const fs::path& in, const fs::path& out, std::uint64_t count) {
  if (count < 2) throw UsageError("fewer than two poses to turn; expected 2 or more");
  const auto poses = read_trajectory(in, {.allow_non_rigid = true});
  std::vector<Pose> turned(count, poses[poses.size() / 2]);
  for (std::uint64_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    const Eigen::AngleAxisd about_z(2 * std::numbers::pi * share, Eigen::Vector3d::UnitZ());
    Eigen::Map<RowMajor> matrix(turned[i].rotation);
    matrix = (matrix * about_z.toRotationMatrix()).eval();
  }
  write_poses(in, out, turned);
}

void write_to_and_fro(const fs::path& in, const fs::path& out, int passes, double sigma_m,
                      std::uint64_t seed) {
  check_sigma(sigma_m);
  const scene::Random random(seed, 0);
  auto poses = read_trajectory(in, {.allow_non_rigid = true});
  std::vector<Pose> all;
  for (int pass = 0; pass < passes; ++pass) {
    const std::size_t first = all.size();
    all.insert(all.end(), poses.begin(), poses.end());
    std::reverse(poses.begin(), poses.end());
    for (int k = 0; k < 3; ++k) {
      const double shift = sigma_m * scene::Random::to_normal(random.bits(3 * pass + k));
      for (std::size_t i = first; i < all.size(); ++i) all[i].translation[k] += shift;
    }
  }
  write_poses(in, out, all);
}

void write_poses_aside(const fs::path& in, const fs::path& out, double metres) {
  write_changed(in, out, [&](Pose& pose, std::size_t) {
    for (int k = 0; k < 3; ++k) pose.translation[k] += metres * pose.rotation[3 * k + 1];
  });
}

void write_non_rigid_poses(const fs::path& in, const fs::path& out, double stretch) {
  if (!(stretch > -1 && std::isfinite(stretch))) {
    throw UsageError("a stretch of " + format_number(stretch) + "; expected more than -1");
  }
  write_changed(in, out, [&](Pose& pose, std::size_t) {
    for (int row = 0; row < 3; ++row) pose.rotation[3 * row] *= 1 + stretch;
  });
}

}  // namespace clearway::bench
