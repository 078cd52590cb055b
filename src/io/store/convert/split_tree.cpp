#include "io/store/convert/split_tree.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"

namespace clearway {
namespace {

Bin united(const Bin* first, const Bin* last) {
  Bin box = *first;
  for (const Bin* bin = first + 1; bin != last; ++bin) {
    for (std::size_t k = 0; k < 4; ++k) {
      box.lo[k] = std::min(box.lo[k], bin->lo[k]);
      box.hi[k] = std::max(box.hi[k], bin->hi[k]);
    }
    box.count += bin->count;
  }
  return box;
}

/// The plane across `axis` that cuts no bin and halves the points best. A multiple of 2^face_bits
/// must separate the bins on its two sides, so that cubes stay whole. Sorts the bins along the
/// axis.
std::optional<std::uint64_t> best_cut(Bin* first, Bin* last, std::size_t axis, std::uint64_t points,
                                      unsigned face_bits) {
  std::sort(first, last, [axis](const Bin& a, const Bin& b) {
    return a.lo[axis] != b.lo[axis] ? a.lo[axis] < b.lo[axis] : a.lo < b.lo;
  });
  std::optional<std::uint64_t> best;
  std::uint64_t least_imbalance = ~std::uint64_t{0};
  std::uint64_t left = first->count;
  std::uint64_t reach = first->hi[axis];
  for (const Bin* bin = first + 1; bin != last; ++bin) {
    const std::uint64_t right = points - left;
    const std::uint64_t imbalance = left > right ? left - right : right - left;
    const bool between = bin->lo[axis] >> face_bits > (reach - 1) >> face_bits;
    if (between && imbalance < least_imbalance) {
      least_imbalance = imbalance;
      best = bin->lo[axis];
    }
    left += bin->count;
    reach = std::max(reach, bin->hi[axis]);
  }
  return best;
}

}  // namespace

SplitTree::SplitTree(std::vector<Bin>& bins, const Lattice& lattice, const double (&scale)[3])
    : lattice_(lattice), scale_{scale[0], scale[1], scale[2]} {
  if (!bins.empty()) add(bins.data(), bins.data() + bins.size(), false);
}

bool SplitTree::within_one_cube(const Bin* first, const Bin* last) const {
  if (!lattice_.regular()) return true;
  const Bin box = united(first, last);
  for (std::size_t k = 0; k < 3; ++k) {
    if (box.lo[k] >> lattice_.cube_bits() != (box.hi[k] - 1) >> lattice_.cube_bits()) return false;
  }
  return true;
}

SplitTree::Plane SplitTree::best_plane(Bin* first, Bin* last) const {
  const Bin box = united(first, last);
  std::array<std::size_t, 3> axes{0, 1, 2};
  const auto side = [&](std::size_t k) {
    return static_cast<double>(box.hi[k] - box.lo[k]) * scale_[k];
  };
  std::stable_sort(axes.begin(), axes.end(),
                   [&](std::size_t a, std::size_t b) { return side(a) > side(b); });
  // Cubes are separated from each other before anything within one is.
  const unsigned face_bits = within_one_cube(first, last) ? 0 : lattice_.cube_bits();
  for (const std::size_t axis : {axes[0], axes[1], axes[2], std::size_t{3}}) {
    if (const auto at = best_cut(first, last, axis, box.count, face_bits)) {
      return {static_cast<int>(axis), *at};
    }
  }
  throw std::logic_error("bins of the counting grid overlap");
}

void SplitTree::add(Bin* first, Bin* last, bool in_unit) {
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  overfull_at_.push_back(-1);
  const std::uint64_t count = std::accumulate(
      first, last, std::uint64_t{0}, [](std::uint64_t n, const Bin& bin) { return n + bin.count; });
  nodes_[self].count = count;
  if (count <= kBucketPoints && !in_unit) {
    nodes_[self].unit = static_cast<std::int32_t>(units_.size());
    units_.push_back(self);
    in_unit = true;
  }
  if (count <= kBucketPoints && within_one_cube(first, last)) return;
  if (last - first == 1) {
    overfull_at_[self] = static_cast<std::int32_t>(overfull_.size());
    overfull_.push_back(*first);
    return;
  }
  const Plane plane = best_plane(first, last);
  nodes_[self].axis = plane.axis;
  nodes_[self].plane = plane.at;
  Bin* middle = std::partition(first, last, [&plane](const Bin& bin) {
    return bin.lo[static_cast<std::size_t>(plane.axis)] < plane.at;
  });
  add(first, middle, in_unit);
  nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
  add(middle, last, in_unit);
}

std::vector<TopNode> SplitTree::top_nodes(std::uint32_t cell_points) const {
  std::vector<TopNode> top(nodes_.size());
  // Children follow their parents in the order, so cells are summed from the back.
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const std::uint32_t right = nodes_[i].right;
    const std::uint64_t cells = right == 0
                                    ? divide_up(nodes_[i].count, cell_points)
                                    : std::uint64_t{top[i + 1].cell_count} + top[right].cell_count;
    if (cells > 0xFFFFFFFFU) throw ResourceError("more than 2^32 cells", Remedy::kMoreCellPoints);
    top[i] = {0, static_cast<std::uint32_t>(cells), right};
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (top[i].right == 0) continue;
    top[i + 1].first_cell = top[i].first_cell;
    top[top[i].right].first_cell = top[i].first_cell + top[i + 1].cell_count;
  }
  return top;
}

}  // namespace clearway
