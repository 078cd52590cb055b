#include "findings/conflict_memory.hpp"

#include <algorithm>

#include "clearway/conflicts.hpp"
#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "findings/colliding_points.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/join_cells.hpp"
#include "findings/tally.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kProgram = std::uint64_t{32} << 20;  // includes the reader's buffers
constexpr std::uint64_t kMostPoints = 0xffff'fffe;

/// Bytes of a cell: what the grid holds of it, its set, its group, and the count of its points.
constexpr std::uint64_t kBytesOfCell = CellGrid::kBytesOfCell + 3 * sizeof(std::uint32_t);
/// Bytes of a point once it is in the grid, including its source, first and last pose, body and
/// part.
constexpr std::uint64_t kBytesOfSortedPoint = CellGrid::kBytesOfPoint + sizeof(std::uint64_t) +
                                              3 * sizeof(std::uint32_t) + 1 + kJoinBytesOfPoint;
constexpr std::uint64_t kBytesOfUnsortedPoint =
    CollidingPoints::kBytesOfPoint + CellGrid::kBytesOfPoint;
/// Bytes of a part and its conflict, which counts twice because vectors grow to twice their size.
constexpr std::uint64_t kBytesOfPart = sizeof(Tally) + 2 * sizeof(Conflict) + 32;

}  // namespace

std::uint64_t ConflictMemory::fixed() const {
  return kProgram + poses_ * (sizeof(Pose) + sizeof(double) + sizeof(std::uint32_t));
}

std::uint64_t ConflictMemory::with_cells(std::uint64_t cells) const {
  return fixed() + cells * kBytesOfCell +
         points_ * std::max(kBytesOfUnsortedPoint, kBytesOfSortedPoint);
}

void ConflictMemory::check_points() const {
  if (points_ > kMostPoints) {
    throw UsageError(format_count(points_) + " colliding points; conflicts are made of up to " +
                     format_count(kMostPoints));
  }
  check(fixed() + points_ * kBytesOfUnsortedPoint, with_cells(points_));
}

void ConflictMemory::check_cells(std::uint64_t cells) const {
  check(with_cells(cells), with_cells(cells));
}

void ConflictMemory::check_parts(std::uint64_t cells, std::uint64_t parts) const {
  if (parts > kMostPoints) {
    throw UsageError(format_count(parts) + " conflicts; expected fewer than " +
                     format_count(kMostPoints));
  }
  const std::uint64_t needed = with_cells(cells) + parts * kBytesOfPart;
  check(needed, needed);
}

void ConflictMemory::check(std::uint64_t needed, std::uint64_t enough) const {
  if (needed <= allowed_) return;
  throw ResourceError(format_size(allowed_) + " of memory is too little: the conflicts of " +
                          counted(points_, "point") + " need at least " + format_size(needed),
                      Remedy::kMoreMemory, static_cast<double>(enough));
}

}  // namespace clearway
