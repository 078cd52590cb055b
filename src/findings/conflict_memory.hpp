#pragma once

#include <cstdint>

namespace clearway {

/// What find_conflicts takes of the memory budget. The checks throw ResourceError with an amount
/// that is enough.
class ConflictMemory {
 public:
  ConflictMemory(std::uint64_t allowed, std::uint64_t points, std::uint64_t poses)
      : allowed_(allowed), points_(points), poses_(poses) {}

  /// Before the points are read: they and their grid.
  void check_points() const;
  /// Before the cells of the grid are kept.
  void check_cells(std::uint64_t cells) const;
  /// Before so many groups and parts are summed up.
  void check_parts(std::uint64_t cells, std::uint64_t parts) const;

 private:
  std::uint64_t fixed() const;
  std::uint64_t with_cells(std::uint64_t cells) const;
  void check(std::uint64_t needed, std::uint64_t enough) const;

  std::uint64_t allowed_, points_, poses_;
};

}  // namespace clearway
