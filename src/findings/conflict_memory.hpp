#pragma once

#include <cstdint>

namespace clearway {

/// What find_conflicts() takes of the memory budget. The checks throw ResourceError with an amount
/// that is enough.
class ConflictMemory {
 public:
  ConflictMemory(std::uint64_t allowed, std::uint64_t points, std::uint64_t poses)
      : allowed_(allowed), points_(points), poses_(poses) {}

  /// Called before the points are read: checks the memory of the points and their grid.
  void check_points() const;
  /// Called before the cells of the grid are kept: checks the memory of that many cells.
  void check_cells(std::uint64_t cells) const;
  /// Called before groups are summed up: checks the memory of that many cells and parts.
  void check_parts(std::uint64_t cells, std::uint64_t parts) const;

 private:
  std::uint64_t fixed() const;
  std::uint64_t with_cells(std::uint64_t cells) const;
  void check(std::uint64_t needed, std::uint64_t enough) const;

  std::uint64_t allowed_, points_, poses_;
};

}  // namespace clearway
