#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "search/checks/checks.hpp"
#include "search/checks/facts/path_cover.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

constexpr std::size_t kModelSample = 512;
constexpr std::size_t kMeasuredPoints = 16;
constexpr std::size_t kMarks = (1 << 19) - 1;
/// The share of points that may stand alone, such as antennas.
constexpr double kSomeAlone = 0.01;

/// Finds which points of a sample of the model have no other model point within the radius, in one
/// pass over the model. The surroundings of the sample are in a table of cubes as wide as the
/// radius.
class Neighbours {
 public:
  Neighbours(const std::vector<Vec3>& model, double radius)
      : model_(model), radius_(radius), per_radius_(1 / radius) {
    for (const std::uint32_t i : spread_poses(model.size(), kModelSample))
      sample_.push_back(model[i]);
    alone_.assign(sample_.size(), true);
    fill();
  }

  /// The points of the sample that stand alone. Stops early where they are as few as is allowed,
  /// and may then return too many.
  std::vector<Vec3> find() {
    std::size_t left = sample_.size();
    const auto enough = static_cast<std::size_t>(kSomeAlone * static_cast<double>(left));
    for (const Vec3& p : model_) {
      const std::uint64_t place = key(cube(p.x), cube(p.y), cube(p.z));
      if (!marked_[place % marked_.size()]) continue;
      const auto near = cubes_.find(place);
      if (near == cubes_.end()) continue;
      for (const std::uint32_t i : near->second) {
        if (!alone_[i] || sample_[i] == p || !collides(p, sample_[i], radius_)) continue;
        alone_[i] = false;
        --left;
      }
      if (left <= enough) break;
    }
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < sample_.size(); ++i) {
      if (alone_[i]) out.push_back(sample_[i]);
    }
    return out;
  }

  std::size_t size() const { return sample_.size(); }

 private:
  std::int64_t cube(double x) const {
    constexpr double kMost = 1e15;
    const double cubes = std::clamp(x * per_radius_, -kMost, kMost);
    const auto whole = static_cast<std::int64_t>(cubes);
    return whole - (cubes < static_cast<double>(whole) ? 1 : 0);
  }

  /// A key of a cube. Different cubes may share one, because their points are compared by distance
  /// anyway.
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u ^
           static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fu ^
           static_cast<std::uint64_t>(z) * 0x165667b19e3779f9u;
  }

  void fill() {
    for (std::uint32_t i = 0; i < sample_.size(); ++i) {
      const Vec3& p = sample_[i];
      for (int n = 0; n < 27; ++n) {
        const std::uint64_t place =
            key(cube(p.x) + n % 3 - 1, cube(p.y) + n / 3 % 3 - 1, cube(p.z) + n / 9 - 1);
        marked_[place % marked_.size()] = true;
        auto& cube_of = cubes_[place];
        if (cube_of.empty() || cube_of.back() != i) cube_of.push_back(i);
      }
    }
  }

  const std::vector<Vec3>& model_;
  double radius_, per_radius_;
  std::vector<Vec3> sample_;
  std::vector<bool> alone_;
  /// Marks cubes by their key modulo kMarks, which rules out most points.
  std::vector<bool> marked_ = std::vector<bool>(kMarks);
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cubes_;
};

/// The largest distance from a sample of `alone` to the nearest other model point.
double largest_spacing(const std::vector<Vec3>& model, const std::vector<Vec3>& alone) {
  std::vector<Vec3> some;
  for (const std::uint32_t i : spread_poses(alone.size(), kMeasuredPoints))
    some.push_back(alone[i]);
  std::vector<double> nearest(some.size(), kInfinity);
  for (const Vec3& p : model) {
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (!(p == some[i])) nearest[i] = std::min(nearest[i], squared_distance(p, some[i]));
    }
  }
  return std::sqrt(*std::max_element(nearest.begin(), nearest.end()));
}

}  // namespace

void check_model_spacing(const Question& question, MessageLog& log) {
  if (Sides(question.model).longest == 0) return;  // the model is a single place
  Neighbours neighbours(question.query.model.vertices, question.query.radius);
  const std::vector<Vec3> alone = neighbours.find();
  const double share = static_cast<double>(alone.size()) / static_cast<double>(neighbours.size());
  if (share <= kSomeAlone) return;
  const double largest = largest_spacing(question.query.model.vertices, alone);
  log.warn("model-spacing",
           share_text(share) + " of the model's points are farther than the radius of " +
               length_text(question.query.radius, question.unit) +
               " from their nearest neighbour, up to " + length_text(largest, question.unit) +
               ": things can pass between them without a collision. Take a denser model",
           {{"share", share}, {"largest", largest}});
}

}  // namespace clearway
