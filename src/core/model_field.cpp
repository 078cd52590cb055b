#include "core/model_field.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

/// The coarse lattice reaches this many of its steps beyond the model.
constexpr double kMarginSteps = 3;
/// A voxel is no smaller than this many spacings of the model's points, between half the radius and
/// twice the radius.
constexpr double kVoxelSpacings = 1.5;
constexpr std::uint64_t kCoarseNodeBytes = 8;

/// For a reach the coarse lattice is wider, up to this many nodes. Coarse bounds are close from
/// kCloseSteps coarse steps on: at a distance d they miss at most 3/8 step^2 / d.
constexpr double kMostWideNodes = 1 << 18;
constexpr double kCloseSteps = 2;

/// Not above the true square: one rounding to float and a few in double are taken off.
float rounded_down(double squared) {
  return std::nextafterf(static_cast<float>(squared * (1 - 1e-12)), 0.0F);
}

double length(const Vec3& v) { return std::sqrt(squared_length(v.x, v.y, v.z)); }

/// Position within a lattice: the cell of x and the fractions in it, clamped to [0, 1].
struct Place {
  std::uint32_t cell[3];
  double fraction[3];
};

/// sum w_k f_k over the corners of a cell, corner (0, 0, 0) first.
template <typename At>
double interpolated(const double (&f)[3], At at) {
  const auto along_x = [&](int y, int z) { return (1 - f[0]) * at(0, y, z) + f[0] * at(1, y, z); };
  const auto along_y = [&](int z) { return (1 - f[1]) * along_x(0, z) + f[1] * along_x(1, z); };
  return (1 - f[2]) * along_y(0) + f[2] * along_y(1);
}

/// d_M^2(x) - |x|^2 is a minimum of linear functions of x, hence concave: the interpolation of d^2
/// exceeds d^2 by at most step^2 sum f (1 - f). `slack` covers the rounding of all of it.
double concave_bound(double mean, const double (&f)[3], double step) {
  const double bend = f[0] * (1 - f[0]) + f[1] * (1 - f[1]) + f[2] * (1 - f[2]);
  const double excess = step * step * bend;
  return std::max(0.0, mean - excess - (mean + excess) * (64 * kUnitRoundoff));
}

}  // namespace

ModelField::ModelField(const ModelTree& tree, double radius, const ModelFieldOptions& options,
                       int threads)
    : tree_(tree) {
  if (threads == 0) threads = omp_get_max_threads();
  choose_voxel(radius, options);
  for (;; voxel_ *= 2) {
    lay_out(margin_steps(options.reach));
    fill_coarse(options.reach > 0, threads);
    const double band = this->band(radius, options.reach);
    const std::uint64_t bytes = mark_bricks(band, threads) * kBrickNodes * 8;
    if (bytes <= options.most_bytes) break;
  }
  fill_bricks(threads);
}

void ModelField::choose_voxel(double radius, const ModelFieldOptions& options) {
  const Box& box = tree_.box();
  const Vec3 extent{box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
  const double wanted = std::clamp(kVoxelSpacings * tree_.spacing(), radius / 2, 2 * radius);
  // A field much finer than the model's points, or than their rounding, serves nobody.
  const double least = 1e-7 * (length(extent) + length(box.hi) + length(box.lo)) + 1e-100;
  voxel_ = options.voxel > 0 ? options.voxel : std::max(wanted, least);
  const auto coarse_bytes = [&] {
    double nodes = 1;
    for (int k = 0; k < 3; ++k) {
      nodes *= extent[k] / (kBrick * voxel_) + 2 * kMarginSteps + 2;
    }
    return nodes * static_cast<double>(kCoarseNodeBytes);
  };
  while (coarse_bytes() > static_cast<double>(options.most_bytes) / 4) voxel_ *= 2;
}

/// How far from the model bricks are needed.
double ModelField::band(double radius, double reach) const {
  return std::max(radius, std::min(reach, kCloseSteps * coarse_)) + 2 * voxel_;
}

double ModelField::margin_steps(double reach) const {
  const Box& box = tree_.box();
  const double step = kBrick * voxel_;
  const auto nodes = [&](double margin) {
    double product = 1;
    for (int k = 0; k < 3; ++k) product *= (box.hi[k] - box.lo[k]) / step + 2 * margin + 2;
    return product;
  };
  double margin = kMarginSteps;
  while (margin * step < reach && nodes(margin + 1) <= kMostWideNodes) ++margin;
  return margin;
}

void ModelField::lay_out(double margin) {
  coarse_ = kBrick * voxel_;
  const Box& box = tree_.box();
  for (int k = 0; k < 3; ++k) {
    origin_[k] = box.lo[k] - margin * coarse_;
    size_[k] =
        static_cast<std::uint32_t>(std::ceil((box.hi[k] - box.lo[k]) / coarse_ + 2 * margin)) + 1;
  }
}

Vec3 ModelField::coarse_node(std::uint32_t ix, std::uint32_t iy, std::uint32_t iz) const {
  return {origin_.x + ix * coarse_, origin_.y + iy * coarse_, origin_.z + iz * coarse_};
}

void ModelField::fill_coarse(bool with_nearest, int threads) {
  coarse_squared_.assign(std::size_t{size_[0]} * size_[1] * size_[2], 0);
  coarse_nearest_.assign(with_nearest ? coarse_squared_.size() : 0, 0);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (std::uint32_t iz = 0; iz < size_[2]; ++iz) {
    std::uint32_t near = 0;
    std::size_t at = std::size_t{iz} * size_[1] * size_[0];
    for (std::uint32_t iy = 0; iy < size_[1]; ++iy) {
      for (std::uint32_t ix = 0; ix < size_[0]; ++ix) {
        const ModelTree::Nearest nearest = tree_.nearest(coarse_node(ix, iy, iz), near);
        near = nearest.point;
        if (with_nearest) coarse_nearest_[at] = near;
        coarse_squared_[at++] = rounded_down(nearest.squared_distance);
      }
    }
  }
}

/// Numbers the coarse cells in which a distance of at most `band` can occur.
std::uint64_t ModelField::mark_bricks(double band, int threads) {
  const double half_diagonal = coarse_ * std::sqrt(0.75) * (1 + 1e-9);
  brick_of_.assign(coarse_squared_.size(), kNoBrick);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (std::uint32_t iz = 0; iz < size_[2] - 1; ++iz) {
    std::uint32_t near = 0;
    for (std::uint32_t iy = 0; iy + 1 < size_[1]; ++iy) {
      for (std::uint32_t ix = 0; ix + 1 < size_[0]; ++ix) {
        const std::size_t at = (std::size_t{iz} * size_[1] + iy) * size_[0] + ix;
        if (std::sqrt(coarse_squared_[at]) > band + 2 * half_diagonal) continue;
        const Vec3 node = coarse_node(ix, iy, iz);
        const Vec3 centre{node.x + coarse_ / 2, node.y + coarse_ / 2, node.z + coarse_ / 2};
        const ModelTree::Nearest nearest = tree_.nearest(centre, near);
        near = nearest.point;
        if (std::sqrt(nearest.squared_distance) <= band + half_diagonal) brick_of_[at] = 0;
      }
    }
  }
  std::uint32_t bricks = 0;
  for (std::uint32_t& brick : brick_of_) {
    if (brick == 0) brick = bricks++;
  }
  return bricks;
}

void ModelField::fill_bricks(int threads) {
  std::vector<std::size_t> cells;
  for (std::size_t at = 0; at < brick_of_.size(); ++at) {
    if (brick_of_[at] != kNoBrick) cells.push_back(at);
  }
  distances_.resize(cells.size() * kBrickNodes);
  nearest_.resize(cells.size() * kBrickNodes);
#pragma omp parallel for schedule(dynamic, 4) num_threads(threads)
  for (std::size_t brick = 0; brick < cells.size(); ++brick) {
    const std::size_t cell = cells[brick];
    const Vec3 corner = coarse_node(static_cast<std::uint32_t>(cell % size_[0]),
                                    static_cast<std::uint32_t>(cell / size_[0] % size_[1]),
                                    static_cast<std::uint32_t>(cell / size_[0] / size_[1]));
    std::size_t at = brick * kBrickNodes;
    for (std::uint32_t z = 0; z <= kBrick; ++z) {
      for (std::uint32_t y = 0; y <= kBrick; ++y) {
        for (std::uint32_t x = 0; x <= kBrick; ++x, ++at) {
          // The nearest of the node before, along x and at the start of a row along y or z.
          const std::size_t back = x > 0   ? 1
                                   : y > 0 ? kBrick + 1
                                   : z > 0 ? (kBrick + 1) * (kBrick + 1)
                                           : 0;
          const std::uint32_t near = back > 0 ? nearest_[at - back] : 0;
          const Vec3 node{corner.x + x * voxel_, corner.y + y * voxel_, corner.z + z * voxel_};
          const ModelTree::Nearest nearest = tree_.nearest(node, near);
          distances_[at] = rounded_down(nearest.squared_distance);
          nearest_[at] = nearest.point;
        }
      }
    }
  }
}

/// place: in coarse steps from the origin, anywhere.
std::uint32_t ModelField::near_coarse_node(const double (&place)[3]) const {
  if (coarse_nearest_.empty()) return kNone;
  std::size_t at = 0;
  for (int k = 2; k >= 0; --k) {
    const double last = size_[k] - 1;
    const double node = place[k] > 0 ? std::min(place[k] + 0.5, last) : 0;
    at = at * size_[k] + static_cast<std::size_t>(node);
  }
  return coarse_nearest_[at];
}

ModelField::Bounds ModelField::bounds(const Vec3& x) const {
  double place[3];
  std::uint32_t cell[3];
  for (int k = 0; k < 3; ++k) place[k] = (x[k] - origin_[k]) / coarse_;
  for (int k = 0; k < 3; ++k) {
    if (!(place[k] >= 0 && place[k] < size_[k] - 1)) {
      return {least_squared_distance(tree_.box(), x), near_coarse_node(place)};
    }
  }
  const double whole[3] = {place[0], place[1], place[2]};
  for (int k = 0; k < 3; ++k) {
    cell[k] = static_cast<std::uint32_t>(place[k]);
    place[k] -= cell[k];
  }
  const std::size_t at = (std::size_t{cell[2]} * size_[1] + cell[1]) * size_[0] + cell[0];
  const std::uint32_t brick = brick_of_[at];
  if (brick == kNoBrick) {
    const float* corner = coarse_squared_.data() + at;
    const std::size_t row = size_[0], layer = std::size_t{size_[0]} * size_[1];
    const double mean = interpolated(place, [&](int i, int j, int k) {
      return static_cast<double>(corner[i + j * row + k * layer]);
    });
    return {concave_bound(mean, place, coarse_), near_coarse_node(whole)};
  }
  std::uint32_t fine[3], round[3];
  for (int k = 0; k < 3; ++k) {
    place[k] *= kBrick;
    fine[k] = std::min(static_cast<std::uint32_t>(place[k]), kBrick - 1);
    place[k] -= fine[k];
    round[k] = fine[k] + (place[k] >= 0.5 ? 1 : 0);
  }
  constexpr std::uint32_t kRow = kBrick + 1;
  const std::size_t first = std::size_t{brick} * kBrickNodes;
  const float* corner = distances_.data() + first + (fine[2] * kRow + fine[1]) * kRow + fine[0];
  const double mean = interpolated(place, [&](int i, int j, int k) {
    return static_cast<double>(corner[(static_cast<std::uint32_t>(k) * kRow + j) * kRow + i]);
  });
  return {concave_bound(mean, place, voxel_),
          nearest_[first + (round[2] * kRow + round[1]) * kRow + round[0]]};
}

std::uint64_t ModelField::allocated_bytes() const {
  return (coarse_squared_.capacity() + distances_.capacity()) * sizeof(float) +
         (coarse_nearest_.capacity() + brick_of_.capacity() + nearest_.capacity()) *
             sizeof(std::uint32_t);
}

}  // namespace clearway
