#include "core/sweep/field/model_field.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "core/sweep/field/brick_nearest.hpp"
#include "core/sweep/field/brick_triangles.hpp"

namespace clearway {
namespace {

/// Margin of the coarse lattice around the model, in its own steps.
constexpr double kMarginSteps = 3;
/// Least voxel in spacings of the model's points; the result is kept between half the radius and
/// twice the radius.
constexpr double kVoxelSpacings = 1.5;
constexpr std::uint64_t kCoarseNodeBytes = 8;
/// Greatest number of coarse nodes for a surface, because each takes a search for the nearest
/// triangle, of some microseconds.
constexpr double kMostSurfaceNodes = 1 << 17;
/// Number of voxels for a surface, which has no spacing to go by; more if their size is close to
/// the radius. This many cost about as much as the exact tests that finer voxels would save
/// (measured).
constexpr double kSurfaceVoxels = 1 << 19;
/// Number of nodes up to which a lattice costs next to nothing, so that its voxel is halved down to
/// what the spacing of the model's points justifies.
constexpr double kCheapNodes = 1 << 17;

/// Greatest number of nodes up to which the coarse lattice is widened for a reach. Coarse bounds
/// are close at kCloseSteps coarse steps or more: at a distance d they miss at most 3/8 step^2 / d.
constexpr double kMostWideNodes = 1 << 18;
constexpr double kCloseSteps = 2;

}  // namespace

ModelField::ModelField(const ModelTree& tree, double radius, const ModelFieldOptions& options,
                       int threads)
    : ModelField(&tree, tree.box(), tree.spacing(), radius, options, threads) {}

/// The spacing is 0, because a surface has no spacing between points that would make a finer field
/// useless.
ModelField::ModelField(const TriangleTree& tree, double radius, const ModelFieldOptions& options,
                       int threads)
    : ModelField(&tree, tree.box(), 0, radius, options, threads) {}

ModelField::ModelField(Tree tree, const Box& model, double spacing, double radius,
                       const ModelFieldOptions& options, int threads)
    : tree_(tree), model_(model), by_need_(options.by_need) {
  if (threads == 0) threads = omp_get_max_threads();
  if (options.solids != nullptr) inside_.emplace(*options.solids);
  choose_voxel(spacing, radius, options);
  for (;; voxel_ *= 2) {
    lay_out(margin_steps(options.reach));
    fill_coarse(options.reach > 0, threads);
    const double band = this->band(radius, options.reach);
    bricks_ = mark_bricks(band, threads);
    if (bricks_ * brick_bytes() <= options.most_bytes) break;
  }
  if (inside_) inside_->lay_out(size_, origin_, coarse_, brick_of_, bricks_);
  distances_ = std::make_unique_for_overwrite<float[]>(std::size_t{bricks_} * kBrickNodes);
  nearest_ = std::make_unique_for_overwrite<std::uint32_t[]>(std::size_t{bricks_} * kBrickNodes);
  if (!by_need_) make_all(threads);
}

void ModelField::choose_voxel(double spacing, double radius, const ModelFieldOptions& options) {
  const Box& box = model_;
  const Vec3 extent = box.size();
  const double of_points = kVoxelSpacings * spacing;
  const auto nodes_of = [&](double voxel) {
    const double around = 2 * radius + 4 * voxel;
    return (extent.x + around) * (extent.y + around) * (extent.z + around) / std::pow(voxel, 3);
  };
  double chosen = std::clamp(of_points, radius / 2, 2 * radius);
  if (is_surface()) {
    const double around = 2 * radius;
    const double volume = (extent.x + around) * (extent.y + around) * (extent.z + around);
    chosen = std::clamp(std::cbrt(volume / kSurfaceVoxels), radius / 4, 2 * radius);
  }
  while (options.cheaply_finer && chosen / 2 >= of_points && nodes_of(chosen / 2) <= kCheapNodes) {
    chosen /= 2;
  }
  const double wanted = chosen / options.fineness;
  // A field much finer than the model's points, or than their rounding, is of no use.
  const double least = 1e-7 * (length(extent) + length(box.hi) + length(box.lo)) + 1e-100;
  voxel_ = std::max(options.voxel > 0 ? options.voxel : wanted, least);
  const auto coarse_bytes = [&] {
    double nodes = 1;
    for (int k = 0; k < 3; ++k) {
      nodes *= extent[k] / (kBrick * voxel_) + 2 * kMarginSteps + 2;
    }
    return nodes * static_cast<double>(kCoarseNodeBytes);
  };
  double most = static_cast<double>(options.most_bytes) / 4;
  if (is_surface()) most = std::min(most, kMostSurfaceNodes * kCoarseNodeBytes);
  while (coarse_bytes() > most) voxel_ *= 2;
}

/// The distance from the model up to which bricks are needed, metres.
double ModelField::band(double radius, double reach) const {
  return std::max(radius, std::min(reach, kCloseSteps * coarse_)) + 2 * voxel_;
}

double ModelField::margin_steps(double reach) const {
  const Box& box = model_;
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
  margin_ = (margin + 1) * coarse_;
  const Box& box = model_;
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
  std::visit([&](const auto* tree) { fill_coarse_from(*tree, with_nearest, threads); }, tree_);
}

template <typename Element>
void ModelField::fill_coarse_from(const ModelTreeOf<Element>& tree, bool with_nearest,
                                  int threads) {
  coarse_squared_.assign(std::size_t{size_[0]} * size_[1] * size_[2], 0);
  coarse_nearest_.assign(with_nearest ? coarse_squared_.size() : 0, 0);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (std::uint32_t iz = 0; iz < size_[2]; ++iz) {
    std::uint32_t near = 0;
    std::size_t at = std::size_t{iz} * size_[1] * size_[0];
    for (std::uint32_t iy = 0; iy < size_[1]; ++iy) {
      for (std::uint32_t ix = 0; ix < size_[0]; ++ix) {
        const auto nearest = tree.nearest(coarse_node(ix, iy, iz), near);
        near = nearest.element;
        if (with_nearest) coarse_nearest_[at] = near;
        coarse_squared_[at++] = rounded_down(nearest.squared_distance);
      }
    }
  }
}

/// Numbers the coarse cells in which a distance of at most `band` can occur, and returns how many
/// there are.
std::uint32_t ModelField::mark_bricks(double band, int threads) {
  brick_of_.assign(coarse_squared_.size(), kNoBrick);
  std::visit([&](const auto* tree) { mark_bricks_from(*tree, band, threads); }, tree_);
  std::uint32_t bricks = 0;
  for (std::uint32_t& brick : brick_of_) {
    if (brick == 0) brick = kToBeMade | bricks++;
  }
  return bricks;
}

template <typename Element>
void ModelField::mark_bricks_from(const ModelTreeOf<Element>& tree, double band, int threads) {
  const double half_diagonal = coarse_ * std::sqrt(0.75) * (1 + 1e-9);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (std::uint32_t iz = 0; iz < size_[2] - 1; ++iz) {
    std::uint32_t near = 0;
    for (std::uint32_t iy = 0; iy + 1 < size_[1]; ++iy) {
      for (std::uint32_t ix = 0; ix + 1 < size_[0]; ++ix) {
        const std::size_t at = (std::size_t{iz} * size_[1] + iy) * size_[0] + ix;
        if (std::sqrt(coarse_squared_[at]) > band + 2 * half_diagonal) continue;
        const Vec3 node = coarse_node(ix, iy, iz);
        const Vec3 centre{node.x + coarse_ / 2, node.y + coarse_ / 2, node.z + coarse_ / 2};
        const auto nearest = tree.nearest(centre, near);
        near = nearest.element;
        if (std::sqrt(nearest.squared_distance) <= band + half_diagonal) brick_of_[at] = 0;
      }
    }
  }
}

void ModelField::make_all(int threads) {
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads)
  for (std::size_t cell = 0; cell < brick_of_.size(); ++cell) {
    if (brick_of_[cell] != kNoBrick) make_brick(cell);
  }
}

void ModelField::make_brick(std::size_t cell) const {
  const std::atomic_ref state(brick_of_[cell]);
  const std::uint32_t brick = state.load(std::memory_order_relaxed) & kBrickNumber;
  const std::size_t first = std::size_t{brick} * kBrickNodes;
  const Vec3 corner = coarse_node(static_cast<std::uint32_t>(cell % size_[0]),
                                  static_cast<std::uint32_t>(cell / size_[0] % size_[1]),
                                  static_cast<std::uint32_t>(cell / size_[0] / size_[1]));
  float* const squared = distances_.get() + first;
  std::uint32_t* const nearest = nearest_.get() + first;
  if (const auto* points = std::get_if<const ModelTree*>(&tree_)) {
    BrickNearest(**points).find(corner, voxel_, squared, nearest);
  } else {
    BrickTriangles(*std::get<const TriangleTree*>(tree_)).find(corner, voxel_, squared, nearest);
  }
  if (inside_) inside_->make_brick(brick, corner, voxel_, squared);
  state.store(brick, std::memory_order_release);
}

/// Returns the brick of a cell, made by the thread that asks first. Other threads wait, because
/// what they find must not depend on who was first.
std::uint32_t ModelField::made_brick(std::size_t cell) const {
  const std::atomic_ref state(brick_of_[cell]);
  std::uint32_t seen = state.load(std::memory_order_acquire);
  if ((seen & kBeingMade) == 0 && (seen & kToBeMade) != 0 &&
      state.compare_exchange_strong(seen, seen | kBeingMade, std::memory_order_acquire)) {
    make_brick(cell);
  }
  while (((seen = state.load(std::memory_order_acquire)) & kToBeMade) != 0) {
    std::this_thread::yield();
  }
  return seen;
}

std::uint64_t ModelField::made_bricks() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(brick_of_, [](std::uint32_t state) {
    return state != kNoBrick && (state & kToBeMade) == 0;
  }));
}

std::uint32_t make_brick_of(const ModelField& field, std::size_t cell) {
  return field.made_brick(cell);
}

/// Upper bound, in metres, on the rounding error of a node's position plus that of the distance it
/// holds, the root of its stored square (docs/design/numerics.md, "Model field").
double ModelField::node_error() const {
  const Vec3 extent = model_.size();
  const double of_place = 8 * (length(model_.hi) + length(model_.lo) + margin_);
  const double of_surface = is_surface() ? 161 * length(extent) : 0;
  return kUnitRoundoff * (of_place + of_surface);
}

ModelFieldRef ModelField::ref() const {
  return {.model = model_,
          .coarse = coarse_,
          .voxel = voxel_,
          .per_metre = 1 / coarse_,
          .coarse_slack = 64 * kUnitRoundoff + node_error() / coarse_,
          .fine_slack = 64 * kUnitRoundoff + node_error() / voxel_,
          .origin = origin_,
          .size = {size_[0], size_[1], size_[2]},
          .bricks = static_cast<std::uint32_t>(bricks()),
          .coarse_squared = coarse_squared_.data(),
          .coarse_nearest = coarse_nearest_.empty() ? nullptr : coarse_nearest_.data(),
          .brick_of = brick_of_.data(),
          .distances = distances_.get(),
          .nearest = nearest_.get(),
          .by_need = by_need_ ? this : nullptr,
          .inside = inside_ ? inside_->ref() : FieldInsideRef{}};
}

ModelFieldRef ModelField::ref_as_made() const {
  ModelFieldRef made = ref();
  made.by_need = nullptr;
  return made;
}

std::uint64_t ModelField::allocated_bytes() const {
  return coarse_squared_.capacity() * sizeof(float) +
         (coarse_nearest_.capacity() + brick_of_.capacity()) * sizeof(std::uint32_t) +
         bricks_ * kBrickBytes + (inside_ ? inside_->allocated_bytes() : 0);
}

std::uint64_t ModelField::brick_bytes() const {
  return kBrickBytes + (inside_ ? FieldInside::kBrickBytes : 0);
}

}  // namespace clearway
