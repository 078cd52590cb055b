#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// How much of some cubes lies in each cell of the model's three cross-sections, in which the model
/// is seen along its x, y or z axis. Rows ascend by cell.
struct SweptCells {
  /// The axis along which the model is seen (0 is x), and the cell along the other two axes in
  /// their order. Cell i reaches from i to i + 1 times the side of a cube.
  std::vector<std::array<std::int32_t, 3>> cell;
  /// How much of the cubes lies in the cell; 4,096 are a whole cube.
  std::vector<std::uint64_t> parts;

  std::size_t size() const { return cell.size(); }
  friend bool operator==(const SweptCells&, const SweptCells&) = default;
};

/// Shares cubes among the cells of the cross-sections. Each is taken for an upright square around
/// its middle, so that cubes that lie askew to the path do not make a pattern. A place counts in
/// whole 64ths of a side, so that sums are exact and no order of work can change them.
class CrossSections {
 public:
  static constexpr std::int64_t kSteps = 64;                               ///< of a side
  static constexpr std::uint64_t kParts = std::uint64_t{kSteps} * kSteps;  ///< of a cube

  /// side: of a cell and of the cubes, metres.
  explicit CrossSections(double side) : side_(side) {}

  /// Adds a cube. middle: its place in the frame of the pose that reaches it, metres. A cube whose
  /// place is not finite, or that is a million sides away or more, is left out.
  void add(const Vec3& middle);
  void add(const CrossSections& other);

  /// All cells that hold a part of a cube, ascending.
  SweptCells cells() const;
  std::uint64_t bytes() const { return places_.size() * sizeof(Place); }

 private:
  /// A place of the hash table; free where it has no parts.
  struct Place {
    std::uint64_t key = 0, parts = 0;
  };

  void add(std::uint64_t key, std::uint64_t parts);
  void grow();

  double side_;
  std::vector<Place> places_;  ///< none, or a power of two
  std::size_t used_ = 0;
};

}  // namespace clearway
