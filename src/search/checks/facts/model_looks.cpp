#include "search/checks/facts/model_looks.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "io/models/sample_mesh.hpp"
#include "search/checks/facts/path_facts.hpp"

namespace clearway {
namespace {

/// The share of points that may stand alone, such as antennas.
constexpr double kSomeAlone = 0.01;
/// The greatest number of samples of a surface.
constexpr double kMostSurfaceSamples = 1e5;
constexpr std::size_t kModelSample = 512;
constexpr std::size_t kMeasuredPoints = 16;
constexpr std::size_t kMarks = (1 << 19) - 1;
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

ModelLooks::ModelLooks(const Model& model, double radius, bool for_many)
    : radius_(radius), for_many_(for_many) {
  if (model.is_surface()) {
    const TriangleMesh mesh{model.vertices, model.triangles};
    const double spacing = std::max(spacing_for(mesh, kMostSurfaceSamples), radius);
    form_ = spacing > radius ? ModelForm::kCoarseSurface : ModelForm::kSurface;
    samples_ = sample_mesh(mesh, spacing, "the model");
  }
  box_ = box_of(points(model));
}

const ModelView& ModelLooks::view(const std::vector<Vec3>& points, int axis) const {
  const auto i = static_cast<std::size_t>(axis);
  std::call_once(view_made_[i], [&] { views_[i].emplace(points, box_, axis, 2 * radius_); });
  return *views_[i];
}

const SolidParts& ModelLooks::solids(const Model& model) const {
  std::call_once(solids_made_, [&] { solids_.emplace(model); });
  return *solids_;
}

std::size_t ModelLooks::untouched(const std::vector<Vec3>& points, std::vector<Vec3> places) const {
  if (!for_many_) {
    for (const Vec3& m : points) {
      std::erase_if(places, [&](const Vec3& p) { return collides(m, p, radius_); });
      if (places.empty()) break;
    }
    return places.size();
  }
  std::call_once(tree_made_, [&] { tree_.emplace(points); });
  std::uint32_t guess = 0;
  return static_cast<std::size_t>(std::ranges::count_if(places, [&](const Vec3& p) {
    guess = tree_->nearest(p, guess).element;
    return !collides(tree_->element(guess), p, radius_);
  }));
}

PointsAlone ModelLooks::alone(const std::vector<Vec3>& points) const {
  std::call_once(alone_made_, [&] {
    Neighbours neighbours(points, radius_);
    const std::vector<Vec3> alone = neighbours.find();
    const double share = static_cast<double>(alone.size()) / static_cast<double>(neighbours.size());
    if (share > kSomeAlone) alone_ = {share, largest_spacing(points, alone)};
  });
  return alone_;
}

std::shared_ptr<const ModelLooks> KeptLooks::of(const Model& model, std::uint64_t hash,
                                                double radius) {
  constexpr std::size_t kMost = 16;
  const auto is_same = [&](const Kept& one) { return one.hash == hash && one.radius == radius; };
  {
    const std::lock_guard lock(mutex_);
    const auto kept = std::ranges::find_if(kept_, is_same);
    if (kept != kept_.end()) {
      kept_.splice(kept_.begin(), kept_, kept);
      return kept->looks;
    }
  }
  // Made without the lock, so that questions about other models go on.
  auto made = std::make_shared<const ModelLooks>(model, radius, for_many_);
  const std::lock_guard lock(mutex_);
  kept_.push_front({hash, radius, made});
  if (kept_.size() > kMost) kept_.pop_back();
  return made;
}

}  // namespace clearway
