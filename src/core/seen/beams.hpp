#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"
#include "core/seen/brick_map.hpp"
#include "core/seen/cubes.hpp"

namespace clearway {

/// Beams that a search for seen space leaves out, by their number.
struct BeamCounts {
  std::uint64_t without_origin = 0;  ///< points whose scanner's place is not known
  std::uint64_t too_long = 0;        ///< beams of 2^30 steps or more on an axis, or over 1 km

  void add(const BeamCounts& more) {
    without_origin += more.without_origin;
    too_long += more.too_long;
  }
};

/// Whether a beam is too long to be followed. way: its point minus its origin, quanta.
CLEARWAY_HD inline bool is_too_long(const std::int64_t* way, const Quantisation& quantisation,
                                    double most_squared) {
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    if (magnitude(way[k]) >= Beam::kMostQuanta) return true;
    const double length = static_cast<double>(way[k]) * quantisation.scale[k];
    squared += length * length;
  }
  return squared > most_squared;
}

/// What the beams of a store need to be followed, on the host or on a device. Does not own it.
struct BeamsRef {
  BrickMapRef map;
  const std::int64_t* origins;  ///< x, y and z of each origin, quanta
  std::uint32_t origin_count;
  Quantisation quantisation;
  double most_squared;  ///< square of the length above which a beam is left out

  /// Clears what the beam to a point sees. q: the point, quanta. origin: 1 + the index of its
  /// origin; 0 where it has none. Thread safe.
  CLEARWAY_HD void follow(const std::int32_t* q, std::uint32_t origin, BeamCounts& counts) const {
    const std::uint32_t index = origin - 1;  // which for 0 is none
    if (index >= origin_count) {
      ++counts.without_origin;
      return;
    }
    Beam beam{};
    for (int k = 0; k < 3; ++k) {
      beam.origin[k] = origins[3 * std::uint64_t{index} + static_cast<std::uint64_t>(k)];
      beam.way[k] = q[k] - beam.origin[k];
    }
    if (is_too_long(beam.way, quantisation, most_squared)) {
      ++counts.too_long;
    } else if (beam.way[0] != 0 || beam.way[1] != 0 || beam.way[2] != 0) {
      map.see(beam);
    }
  }
};

/// The packed numbers of the origins of a cell's points, as StoreReader::origins() returns them.
using OriginsOfCell = std::function<PackedChunk<std::uint32_t>(std::uint32_t cell)>;

/// The beams of a cloud, the map whose bits they clear, and where the origins of its points are.
struct Beams {
  BeamsRef ref;
  const BrickMap& map;          ///< what ref.map is a view of
  OriginsOfCell origins_of;     ///< may be called by several threads at once
  unsigned origin_minbits = 0;  ///< most bits in which the origins of a cell are packed
};

/// Puts the origins of a page's cells after the page, for a device: a PageChunk for each cell,
/// whose payload is an offset from `to`, and then the payloads. Returns the number of bytes, at
/// most origin_bytes() of these cells.
std::uint64_t stage_origins(const PageRef& page, const OriginsOfCell& origins, std::byte* to);

/// The most bytes that stage_origins() writes for a number of cells, each of `cell_points` points.
/// most_minbits: the most bits in which the origins of a cell are packed.
std::uint64_t origin_bytes(std::uint32_t cells, std::uint32_t cell_points, unsigned most_minbits);

/// A page with the origins of its cells, on the host or on a device.
struct BeamPage {
  PageRef page;
  PageRef origins;  ///< what stage_origins() wrote; its shape is of no meaning

  /// Follows the beam to a point of a cell; none where the cell has no such point.
  CLEARWAY_HD void follow(const BeamsRef& beams, std::uint32_t cell, std::uint32_t point,
                          BeamCounts& counts) const {
    const PageCell& of = page.cell(cell);
    if (point >= of.count) return;
    std::int32_t q[3];
    for (int k = 0; k < 3; ++k) q[k] = page.value(of.chunks[k], point);
    const PageChunk& chunk = reinterpret_cast<const PageChunk*>(origins.begin)[cell];
    beams.follow(q, static_cast<std::uint32_t>(origins.value(chunk, point)), counts);
  }
};

}  // namespace clearway
