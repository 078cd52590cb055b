#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/geometry/model_tree.hpp"
#include "core/geometry/triangle_packet.hpp"
#include "core/sweep/field/brick_part.hpp"
#include "core/sweep/field/model_field_ref.hpp"

namespace clearway {

/// Finds the nearest triangles of all nodes of a brick together, as BrickNearest does with points.
/// Allocates some 200 kB.
class BrickTriangles {
 public:
  /// tree: not empty; it must outlive this object.
  explicit BrickTriangles(const TriangleTree& tree) : tree_(tree) {}

  /// Finds for each node [z][y][x] the squared distance, rounded down to float, and a nearest
  /// triangle (ModelFieldRef::kBrickNodes of both). corner: the brick's first node; voxel: metres
  /// from a node to the next.
  void find(const Vec3& corner, double voxel, float* squared, std::uint32_t* nearest);

 private:
  static constexpr std::uint32_t kMostPackets = 64;
  static constexpr std::uint32_t kLevels = 3;  ///< levels of parts: 9, 5 and 3 nodes along an axis

  /// Candidate triangles of a part in packets, all full but the last; none if there are too many.
  struct Candidates {
    std::array<TrianglePacket, kMostPackets> packets;
    std::uint32_t count = 0;  ///< number of triangles

    std::uint32_t packet_count() const {
      return (count + TrianglePacket::kMost - 1) / TrianglePacket::kMost;
    }
    /// The packet with room for one more triangle; null if there is no room.
    TrianglePacket* room() {
      return count == kMostPackets * TrianglePacket::kMost
                 ? nullptr
                 : &packets[count / TrianglePacket::kMost];
    }
    void close();
  };

  void find_in(const BrickPart& part, const Candidates* among, std::uint32_t level);
  void gather(const BrickPlace& place, Candidates& out);
  static void narrow(const BrickPlace& place, const Candidates& among, Candidates& out);
  void find_among(const BrickPart& part, const Candidates& among);
  void find_in_tree(const BrickPart& part);

  const TriangleTree& tree_;
  BrickLattice lattice_{};
  BrickNodes nodes_;
  std::uint32_t near_ = 0;  ///< a triangle near the last place, from which searches begin
  /// The candidates of the part at work on each level; on the heap, as stacks may be small.
  std::unique_ptr<Candidates[]> kept_ = std::make_unique_for_overwrite<Candidates[]>(kLevels);
};

}  // namespace clearway
