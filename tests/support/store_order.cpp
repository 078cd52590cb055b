#include "support/store_order.hpp"

#include <algorithm>

#include "core/cloud/packed_cloud.hpp"

namespace clearway::test {
namespace {

constexpr std::uint64_t kMostInBucket = 2097152;

int longest_side(std::span<const StoredPoint> points, const Quantisation& quantisation) {
  int longest = 0;
  double length = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const auto [lo, hi] =
        std::minmax_element(points.begin(), points.end(),
                            [k](const auto& a, const auto& b) { return a.q[k] < b.q[k]; });
    const double side =
        static_cast<double>(std::int64_t{hi->q[k]} - lo->q[k]) * quantisation.scale[axis];
    if (side > length) {
      length = side;
      longest = axis;
    }
  }
  return longest;
}

class Structure {
 public:
  explicit Structure(const StoreReader& store) : store_(store) {}

  std::vector<std::string> faults() {
    if (!store_.top_tree().empty()) check_top(0);
    for (std::uint32_t cell = 0; cell < store_.cells().size(); ++cell) check_cell(cell);
    return std::move(faults_);
  }

 private:
  struct Part {
    QuantumBox box;
    std::uint64_t points, least_source, greatest_source;
  };

  void expect(bool holds, const std::string& what) {
    if (!holds) faults_.push_back(what);
  }

  Part check_top(std::uint32_t index) {
    const TopNode node = store_.top_tree()[index];
    if (node.right == 0) return check_bucket(node);
    const Part a = check_top(index + 1);
    const Part b = check_top(node.right);
    bool apart = a.greatest_source < b.least_source;
    for (int k = 0; k < 3; ++k) apart = apart || a.box.hi[k] < b.box.lo[k];
    expect(apart, "top node " + std::to_string(index) + ": its parts overlap");
    expect(a.points + b.points > kMostInBucket || store_.metadata().layout != "adaptive",
           "top node " + std::to_string(index) + " is split although it fits a bucket");
    return {a.box.united(b.box), a.points + b.points, std::min(a.least_source, b.least_source),
            std::max(a.greatest_source, b.greatest_source)};
  }

  Part check_bucket(const TopNode& node) {
    Part part{store_.cells()[node.first_cell].box, 0, ~std::uint64_t{0}, 0};
    for (std::uint32_t i = 0; i < node.cell_count; ++i) {
      const Cell& cell = store_.cells()[node.first_cell + i];
      expect(i + 1 == node.cell_count || cell.count == store_.cell_points(),
             "a cell before the bucket's last is not full");
      part.box = part.box.united(cell.box);
      part.points += cell.count;
    }
    for (const StoredPoint& p : points_of_cells(store_, node.first_cell, node.cell_count)) {
      part.least_source = std::min(part.least_source, p.source);
      part.greatest_source = std::max(part.greatest_source, p.source);
    }
    expect(part.points <= kMostInBucket, "a bucket of " + std::to_string(part.points));
    return part;
  }

  void check_cell(std::uint32_t index) {
    const Cell& cell = store_.cells()[index];
    const auto points = points_of_cells(store_, index, 1);
    QuantumBox box = box_of(points[0]);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const BlockBox block = store_.blocks(index)[i / kBlockPoints];
      const QuantumBox own = box_of(points[i]);
      const QuantumBox decoded = decode_block_box(cell.box, block);
      expect(decoded.united(own) == decoded, "a point lies outside its block's box");
      box = box.united(own);
    }
    expect(box == cell.box, "the box of cell " + std::to_string(index));
  }

  static QuantumBox box_of(const StoredPoint& p) {
    return {{p.q[0], p.q[1], p.q[2]}, {p.q[0], p.q[1], p.q[2]}};
  }

  const StoreReader& store_;
  std::vector<std::string> faults_;
};

}  // namespace

void order_plainly(std::span<StoredPoint> points, std::uint64_t cell_points,
                   const Quantisation& quantisation) {
  const std::uint64_t unit = points.size() > cell_points ? cell_points : 64;
  const auto by_source = [](const auto& a, const auto& b) { return a.source < b.source; };
  if (points.size() <= unit) {
    std::sort(points.begin(), points.end(), by_source);
    return;
  }
  const auto axis = static_cast<std::size_t>(longest_side(points, quantisation));
  std::sort(points.begin(), points.end(), [&](const auto& a, const auto& b) {
    return a.q[axis] != b.q[axis] ? a.q[axis] < b.q[axis] : by_source(a, b);
  });
  const std::uint64_t units = (points.size() + unit - 1) / unit;
  const std::uint64_t left = unit * ((units + 1) / 2);
  order_plainly(points.first(left), cell_points, quantisation);
  order_plainly(points.subspan(left), cell_points, quantisation);
}

std::vector<std::string> structure_faults(const StoreReader& store) {
  return Structure(store).faults();
}

}  // namespace clearway::test
