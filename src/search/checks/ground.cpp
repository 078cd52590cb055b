#include "search/checks/ground.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "search/checks/question.hpp"

namespace clearway {
namespace {

/// The search below one body.
class Column {
 public:
  Column(const PackedCloud& cloud, const Box& body, const Pose& pose)
      : cloud_(cloud), body_(body), pose_(pose), place_(moved(body, pose)) {
    const Box environment = position_box(cloud.quantisation(), cloud.tree()[0].box);
    place_.lo.z = std::min(place_.lo.z, environment.lo.z);
  }

  std::optional<double> height() {
    const std::span<const TreeNode> tree = cloud_.tree();
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
      const std::uint32_t node = open.back();
      open.pop_back();
      if (!may_matter(position_box(cloud_.quantisation(), tree[node].box))) continue;
      if (tree[node].right != 0) {
        open.push_back(tree[node].right);
        open.push_back(node + 1);
      } else if (!look_into(tree[node].first_cell)) {
        return 0;
      }
    }
    return height_;
  }

 private:
  bool may_matter(const Box& box) const { return gap(box, place_) == 0; }

  /// False: a point is in the body.
  bool look_into(std::uint32_t cell) {
    const Cell& here = cloud_.cells()[cell];
    std::optional<Chunks> chunks;
    for (std::uint32_t first = 0; first < here.count; first += kBlockPoints) {
      const std::uint64_t at =
          std::uint64_t{cell} * cloud_.blocks_per_cell() + first / kBlockPoints;
      const QuantumBox block = decode_block_box(here.box, cloud_.blocks()[at]);
      if (!may_matter(position_box(cloud_.quantisation(), block))) continue;
      if (!chunks) chunks = cloud_.peek(cell);
      const std::uint32_t count = std::min<std::uint32_t>(kBlockPoints, here.count - first);
      if (!look_at(*chunks, first, count)) return false;
    }
    return true;
  }

  using Chunks = std::array<PackedChunk<std::int32_t>, 3>;

  bool look_at(const Chunks& chunks, std::uint32_t first, std::uint32_t count) {
    std::array<std::array<std::int32_t, kBlockPoints>, 3> quanta{};
    for (std::size_t k = 0; k < 3; ++k) {
      chunks[k].decode(first, std::span(quanta[k]).first(count));
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 p =
          in_model(position(cloud_.quantisation(), quanta[0][i], quanta[1][i], quanta[2][i]));
      const bool in_column = p.x >= body_.lo.x && p.x <= body_.hi.x && p.y >= body_.lo.y &&
                             p.y <= body_.hi.y && p.z <= body_.hi.z;
      if (!in_column) continue;
      if (p.z >= body_.lo.z) return false;
      const double height = body_.lo.z - p.z;
      height_ = std::min(height_.value_or(height), height);
    }
    return true;
  }

  /// Of a rotation; good enough for one that stretches.
  Vec3 in_model(const Vec3& p) const {
    const Vec3 d = difference(p, translation_of(pose_));
    const double* r = pose_.rotation;
    return {r[0] * d.x + r[3] * d.y + r[6] * d.z, r[1] * d.x + r[4] * d.y + r[7] * d.z,
            r[2] * d.x + r[5] * d.y + r[8] * d.z};
  }

  const PackedCloud& cloud_;
  const Box& body_;
  const Pose& pose_;
  Box place_;
  std::optional<double> height_;
};

}  // namespace

std::optional<double> Ground::height_of(const Box& body, const Pose& pose) const {
  return Column(cloud_, body, pose).height();
}

}  // namespace clearway
