#include "core/sweep/tolerance.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "core/geometry/rigid.hpp"
#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// How much a distance may grow by thinning, in metres: the tolerance less what the roundings of
/// the predicate need. Below 0 if the tolerance is smaller than these.
double thinning_budget(const Query& query, double tolerance, const Box& model) {
  double errors = 16 * kUnitRoundoff * query.radius + 1e-150;
  // Twice the error of a triangle (docs/design/numerics.md, "Triangles").
  if (query.model.is_surface()) {
    double stretch = 0;
    for (const Pose& pose : query.poses) stretch = std::max(stretch, greatest_stretch_bound(pose));
    errors += kUnitRoundoff * (16 * query.radius + 322 * stretch * 2 * half_diagonal(model));
  }
  return tolerance - errors;
}

/// Greatest distance between two model points that no pose moves farther apart than `most`,
/// roundings included; not above 0 if nothing is left for them.
double cover_of(double most, std::span<const Pose> poses, const Vec3& reach) {
  double stretch = 0, rounding = 0;
  for (const Pose& pose : poses) {
    stretch = std::max(stretch, greatest_stretch_bound(pose));
    rounding = std::max(rounding, transform_rounding(reach, pose));
  }
  return (most - 2 * std::sqrt(3.0) * 1.01 * rounding) / (stretch * kRoundedUp);
}

/// A run of poses, from `first` on, that one of them may stand for. Where the motion is smooth it
/// is twice as long as a run that its first pose stands for. Each pose is compared at most three
/// times.
class PoseRun {
 public:
  PoseRun(std::span<const Pose> poses, std::size_t first, const Box& model, double most_motion)
      : poses_(poses), model_(model), most_motion_(most_motion), kept_(first) {
    end_ = end_of_run();
    kept_ = end_ - 1;
    if (stands_for_all_from(first)) {
      end_ = end_of_run();
    } else {
      kept_ = first;
    }
  }

  std::size_t kept() const { return kept_; }
  std::size_t end() const { return end_; }

 private:
  bool stands_for(std::size_t kept, std::size_t dropped) const {
    return poses_[kept] == poses_[dropped] ||
           displacement_bound(model_, poses_[kept], poses_[dropped]) <= most_motion_;
  }

  std::size_t end_of_run() const {
    std::size_t end = kept_ + 1;
    while (end < poses_.size() && stands_for(kept_, end)) ++end;
    return end;
  }

  bool stands_for_all_from(std::size_t first) const {
    for (std::size_t i = first; i < kept_; ++i) {
      if (!stands_for(kept_, i)) return false;
    }
    return true;
  }

  std::span<const Pose> poses_;
  const Box& model_;
  double most_motion_;
  std::size_t kept_, end_ = 0;
};

/// The points kept so far, in the cells of a grid. Cells share buckets, so a bucket may name points
/// of several cells.
class KeptPoints {
 public:
  KeptPoints(std::span<const Vec3> model, double cover)
      : points_(model), origin_(box_of(model).lo), cover_(std::max(cover, 0.0)) {
    squared_cover_ = cover > 0 ? cover * cover * (1 - 16 * kUnitRoundoff) : -1;
    first_.assign(std::bit_ceil(model.size()), kNone);
    next_.assign(model.size(), kNone);
  }

  bool covers(std::uint32_t point) const {
    const Vec3& m = points_[point];
    double lo[3], hi[3];
    for (int k = 0; k < 3; ++k) {
      lo[k] = cell_along(k, m[k] - cover_);
      hi[k] = cell_along(k, m[k] + cover_);
    }
    // The ball meets at most two cells along an axis.
    for (int corner = 0; corner < 8; ++corner) {
      if ((corner & 1 && lo[0] == hi[0]) || (corner & 2 && lo[1] == hi[1]) ||
          (corner & 4 && lo[2] == hi[2])) {
        continue;
      }
      const std::size_t bucket = bucket_of(corner & 1 ? hi[0] : lo[0], corner & 2 ? hi[1] : lo[1],
                                           corner & 4 ? hi[2] : lo[2]);
      for (std::uint32_t i = first_[bucket]; i != kNone; i = next_[i]) {
        if (points_[i] == m || squared_distance(points_[i], m) <= squared_cover_) return true;
      }
    }
    return false;
  }

  void add(std::uint32_t point) {
    const Vec3& m = points_[point];
    const std::size_t bucket =
        bucket_of(cell_along(0, m.x), cell_along(1, m.y), cell_along(2, m.z));
    next_[point] = first_[bucket];
    first_[bucket] = point;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// Number of the cell along an axis. Cells are so large that most balls of radius `cover` lie in
  /// one, yet hold few kept points.
  double cell_along(int axis, double at) const {
    return cover_ > 0 ? std::floor((at - origin_[axis]) / (4 * cover_)) : at;
  }

  std::size_t bucket_of(double x, double y, double z) const {
    std::uint64_t hash = 0;
    for (const double along : {x, y, z}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(along + 0.0)) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
    return hash & (first_.size() - 1);
  }

  std::span<const Vec3> points_;
  Vec3 origin_;
  double cover_;
  double squared_cover_;
  std::vector<std::uint32_t> first_;  ///< for each bucket, its first point
  std::vector<std::uint32_t> next_;   ///< for each point, the next one of its bucket
};

template <typename Value>
std::vector<Value> parts_of(const std::vector<Value>& values,
                            const std::vector<std::uint32_t>& indices) {
  std::vector<Value> out;
  out.reserve(indices.size());
  for (const std::uint32_t i : indices) out.push_back(values[i]);
  return out;
}

}  // namespace

double search_radius(double radius, double tolerance) {
  if (!(tolerance > 0)) return radius;
  return std::max(radius, (radius + tolerance) * (1 - 8 * kUnitRoundoff));
}

std::vector<std::uint32_t> kept_poses(std::span<const Pose> poses, const Box& model,
                                      double most_motion) {
  std::vector<std::uint32_t> kept;
  for (std::size_t first = 0; first < poses.size();) {
    const PoseRun run(poses, first, model, most_motion);
    kept.push_back(static_cast<std::uint32_t>(run.kept()));
    first = run.end();
  }
  return kept;
}

std::vector<std::uint32_t> kept_points(std::span<const Vec3> model, double cover) {
  std::vector<std::uint32_t> out;
  KeptPoints kept(model, cover);
  for (std::uint32_t i = 0; i < model.size(); ++i) {
    if (kept.covers(i)) continue;
    kept.add(i);
    out.push_back(i);
  }
  return out;
}

ThinnedQuery::ThinnedQuery(const Query& query, double tolerance) : query_({}, {}, query) {
  const Box box = box_of(query.model.vertices);
  const double half = thinning_budget(query, tolerance, box) / 2;
  query_.poses = parts_of(query.poses, kept_poses(query.poses, box, half));
  if (query.model.is_surface()) {  // a surface has few triangles, so all are kept
    query_.model.vertices = query.model.vertices;
    query_.model.triangles = query.model.triangles;
    return;
  }
  const double cover = cover_of(half, query_.poses, reach_of(box));
  query_.model.vertices = parts_of(query.model.vertices, kept_points(query.model.vertices, cover));
}

}  // namespace clearway
