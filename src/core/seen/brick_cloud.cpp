#include "core/seen/brick_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <unordered_set>

#include "clearway/error.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

[[noreturn]] void refuse_beyond() {
  throw InputError(
      "a cube that the model sweeps is too far from the scan for 32-bit integers of the store's "
      "scale. Check that path and scan have one frame, or store the scan with a larger scale");
}

/// Twice the middle of a cube in quanta of the store: an integer of the cloud.
std::int32_t doubled_middle(const CubeLattice& lattice, std::size_t axis, std::int32_t cube) {
  const std::int64_t doubled = lattice.side[axis] * (2 * std::int64_t{cube} + 1);
  if (doubled < std::numeric_limits<std::int32_t>::min() ||
      doubled > std::numeric_limits<std::int32_t>::max()) {
    refuse_beyond();
  }
  return static_cast<std::int32_t>(doubled);
}

/// Orders bricks along a Z curve, so that a tree over their order has compact nodes.
struct AlongZ {
  static std::uint32_t lifted(std::int32_t i) {
    return static_cast<std::uint32_t>(i) ^ 0x80000000U;
  }
  bool operator()(const Brick& a, const Brick& b) const {
    int axis = 0;
    std::uint32_t most = 0;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t differ = lifted(a.i[k]) ^ lifted(b.i[k]);
      if (most < differ && most < (most ^ differ)) {
        most = differ;
        axis = k;
      }
    }
    return a.i[axis] < b.i[axis];
  }
};

}  // namespace

BrickCloud::BrickCloud(std::vector<Brick> bricks, const CubeLattice& lattice,
                       const Quantisation& quantisation)
    : bricks_(std::move(bricks)), quantisation_(quantisation) {
  std::sort(bricks_.begin(), bricks_.end(), AlongZ());
  for (double& scale : quantisation_.scale) scale /= 2;
  cells_.reserve(bricks_.size());
  blocks_.reserve(kBrickWords * bricks_.size());
  for (const Brick& brick : bricks_) {
    const auto box_of = [&](std::uint32_t first, std::uint32_t last) {
      const Cube lo = brick.cube(first), hi = brick.cube(last);
      QuantumBox box{};
      for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] = doubled_middle(lattice, k, lo.i[k]);
        box.hi[k] = doubled_middle(lattice, k, hi.i[k]);
      }
      return box;
    };
    const QuantumBox all = box_of(0, kBrickEntries - 1);
    cells_.push_back({kBrickEntries, all});
    for (std::uint32_t word = 0; word < kBrickWords; ++word) {
      blocks_.push_back(encode_block_box(all, box_of(64 * word, 64 * word + 63)));
    }
  }
  const TopNode top{0, static_cast<std::uint32_t>(cells_.size()), 0};
  tree_ = build_cell_tree(std::span(&top, cells_.empty() ? 0 : 1), cells_);
  const Brick zero{};
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<std::int32_t> values;
    for (std::uint32_t entry = 0; entry < kBrickEntries; ++entry) {
      values.push_back(static_cast<std::int32_t>(2 * lattice.side[k] * zero.cube(entry).i[k]));
    }
    append_packed_chunk<std::int32_t>(values, chunks_[k]);
  }
}

std::array<PackedChunk<std::int32_t>, 3> BrickCloud::coordinates(std::uint32_t cell) const {
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  for (std::size_t k = 0; k < 3; ++k) {
    const PackedChunk<std::int32_t> shared(chunks_[k], kBrickEntries);
    chunks[k] = PackedChunk<std::int32_t>::of_payload(shared.payload(), kBrickEntries,
                                                      shared.minbits(), least(cell, k));
  }
  return chunks;
}

std::uint64_t BrickCloud::packed_bytes(std::uint32_t /*cell*/) const {
  return chunks_[0].size() + chunks_[1].size() + chunks_[2].size();
}

std::array<PackedChunk<std::int32_t>, 3> BrickCloud::read_packed(std::uint32_t cell,
                                                                 std::span<std::byte> to) const {
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  for (std::size_t k = 0; k < 3; ++k) {
    std::memcpy(to.data(), chunks_[k].data(), chunks_[k].size());
    const PackedChunk<std::int32_t> read(to.first(chunks_[k].size()), kBrickEntries);
    chunks[k] = PackedChunk<std::int32_t>::of_payload(read.payload(), kBrickEntries, read.minbits(),
                                                      least(cell, k));
    to = to.subspan(chunks_[k].size());
  }
  return chunks;
}

std::uint64_t BrickCloud::allocated_bytes() const {
  return bricks_.capacity() * sizeof(Brick) + cells_.capacity() * sizeof(Cell) +
         tree_.capacity() * sizeof(TreeNode) + blocks_.capacity() * sizeof(BlockBox);
}

namespace {

struct BrickHash {
  std::size_t operator()(const Brick& brick) const { return hash_of(brick); }
};

struct BrickBox {
  std::int32_t lo[3], hi[3];
  friend bool operator==(const BrickBox&, const BrickBox&) = default;
};

/// Collects bricks of boxes in the environment's coordinates.
class BrickCollector {
 public:
  BrickCollector(const CubeLattice& lattice, const Quantisation& quantisation,
                 std::uint64_t most_bytes)
      : lattice_(lattice), quantisation_(quantisation), most_bytes_(most_bytes) {}

  /// Adds the bricks of all cubes whose middles may be in the box.
  void add(const Box& box) {
    BrickBox bricks{};
    for (int k = 0; k < 3; ++k) {
      bricks.lo[k] = brick_of(k, box.lo[k], -1);
      bricks.hi[k] = brick_of(k, box.hi[k], 1);
    }
    if (last_ == bricks) return;  // as at most poses, because steps are shorter than bricks
    last_ = bricks;
    Brick brick{};
    auto& [x, y, z] = brick.i;
    for (x = bricks.lo[0]; x <= bricks.hi[0]; ++x) {
      for (y = bricks.lo[1]; y <= bricks.hi[1]; ++y) {
        for (z = bricks.lo[2]; z <= bricks.hi[2]; ++z) {
          if (bricks_.insert(brick).second) check();
        }
      }
    }
  }

  std::vector<Brick> take() {
    std::vector<Brick> out(bricks_.begin(), bricks_.end());
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  /// The brick of the cube around a coordinate, `more` cubes further on for all rounding.
  std::int32_t brick_of(int axis, double at, int more) const {
    const double quanta = (at - quantisation_.offset[axis]) / quantisation_.scale[axis];
    const double cube = std::floor(quanta / static_cast<double>(lattice_.side[axis])) + more;
    const double brick = std::floor(cube / kBrickCubes);
    // Farther middles are beyond 32 bits, and the sides of bricks are at least 32 quanta.
    if (!(std::abs(brick) < 0x1p27)) refuse_beyond();
    return static_cast<std::int32_t>(brick);
  }

  void check() const {
    constexpr std::uint64_t kNodeBytes = 48;  // of the set
    const std::uint64_t needed =
        bricks_.size() * kNodeBytes + BrickCloud::bytes_for(bricks_.size());
    if (needed <= most_bytes_) return;
    throw ResourceError("the model sweeps more than " + format_count(bricks_.size()) +
                            " blocks of 8 x 8 x 8 cubes, which take more than " +
                            format_size(most_bytes_) + " of memory; larger cubes take less",
                        Remedy::kMoreMemory);
  }

  const CubeLattice& lattice_;
  const Quantisation& quantisation_;
  const std::uint64_t most_bytes_;
  std::optional<BrickBox> last_;
  std::unordered_set<Brick, BrickHash> bricks_;
};

}  // namespace

std::vector<Brick> bricks_along(const Query& query, double radius, const CubeLattice& lattice,
                                const Quantisation& quantisation, std::uint64_t most_bytes) {
  BrickCollector bricks(lattice, quantisation, most_bytes);
  for (const MovingBody& body : moving_bodies(query)) {
    if (body.model.vertices.empty()) continue;
    const Box model = box_of(body.model.vertices);
    std::optional<Box> before;
    for (const Pose& pose : body.poses) {
      const Box here = moved(model, pose).grown(radius);
      bricks.add(before ? here.united(*before) : here);
      if (query.between_poses) before = here;
    }
  }
  return bricks.take();
}

}  // namespace clearway
