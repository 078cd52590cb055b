#include <algorithm>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/section.hpp"
#include "core/geometry/inside.hpp"
#include "core/query/ignored_points.hpp"
#include "core/section/section_lattice.hpp"
#include "core/util/format.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "io/files/xxh64.hpp"
#include "io/paths/content_hash.hpp"
#include "io/store/store_reader.hpp"
#include "search/section.hpp"

namespace clearway {
namespace {

/// A place to be searched, seen from its pose of the load.
struct Look {
  PullBack frame;
  std::uint32_t column, row;
};

/// Bounds of where the points of a box lie in the frame of a pose, wider than their rounding.
Box bounds_of(const PullBack& frame, const Box& box, double slack) {
  const Vec3 middle = frame.apply(box.centre());
  Box out{middle, middle};
  for (int axis = 0; axis < 3; ++axis) {
    double half = slack;
    for (int k = 0; k < 3; ++k) {
      half += std::abs(frame.rows[axis][k] / frame.determinant) * (box.hi[k] - box.lo[k]) / 2;
    }
    out.lo[axis] -= half;
    out.hi[axis] += half;
  }
  return out;
}

/// A point of the cloud, by its cell and its index there.
struct Found {
  std::uint64_t source;
  std::uint32_t cell, index;
};

/// One call of section_witnesses().
class WitnessSearch {
 public:
  WitnessSearch(const SectionData& section, const StoreReader& store, const std::vector<Pose>& path,
                std::span<const SectionPlace> places)
      : store_(store),
        lattice_(lattice_of(section)),
        slack_(2 * section.rounding),
        ignored_(store, ignored_by(section.parameters)) {
    const Body load = load_of_section(path, section.parameters, nullptr);
    for (const SectionPlace& place : places) looks_.push_back(look_of(place, load));
  }

  std::vector<std::optional<SectionWitness>> run() {
    found_.resize(looks_.size());
    in_all_threads([&] {
      for_each_parallel(store_.cells().size(),
                        [&](std::size_t i) { search_cell(static_cast<std::uint32_t>(i)); });
    });
    std::vector<std::optional<SectionWitness>> out(looks_.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (found_[i]) out[i] = witness_of(*found_[i]);
    }
    return out;
  }

 private:
  std::optional<Look> look_of(const SectionPlace& place, const Body& load) const {
    const double column = place.cell[0] - lattice_.j_from, row = place.cell[1] - lattice_.k_from;
    const auto at = std::ranges::lower_bound(load.path_pose, place.pose);
    if (at == load.path_pose.end() || *at != place.pose || !(column >= 0) || !(row >= 0) ||
        column >= lattice_.columns || row >= lattice_.rows) {
      return std::nullopt;
    }
    const Pose& pose = load.poses[static_cast<std::size_t>(at - load.path_pose.begin())];
    return Look{PullBack(pose), static_cast<std::uint32_t>(column),
                static_cast<std::uint32_t>(row)};
  }

  /// Whether a point of the box may lie in the cell that is looked for.
  bool may_hold(const Look& look, const Box& box) const {
    const Box there = bounds_of(look.frame, box, slack_);
    if (there.hi.x < lattice_.x_from || there.lo.x > lattice_.x_to) return false;
    SectionRect rect;
    return lattice_.cover(there.lo.y, there.hi.y, there.lo.z, there.hi.z, rect) &&
           look.column >= rect.column_from && look.column <= rect.column_to &&
           look.row >= rect.row_from && look.row <= rect.row_to;
  }

  void search_cell(std::uint32_t cell) {
    const Box box = position_box(store_.quantisation(), store_.cells()[cell].box);
    std::vector<std::size_t> wanted;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      if (looks_[i] && may_hold(*looks_[i], box)) wanted.push_back(i);
    }
    if (wanted.empty() || ignored_.skips(cell)) return;
    const auto chunks = store_.coordinates(cell);
    std::vector<std::uint64_t> searched(store_.blocks_per_cell(), ~std::uint64_t{0});
    if (ignored_.any() && ignored_.touches(cell)) {
      ignored_.mask(cell, searched, [&] { return chunks; });
    }
    const auto blocks =
        static_cast<std::uint32_t>(divide_up(store_.cells()[cell].count, kBlockPoints));
    for (std::uint32_t block = 0; block < blocks; ++block) {
      const Box of_block = box_of_block(cell, block, box);
      std::vector<std::size_t> here;
      for (const std::size_t i : wanted) {
        if (may_hold(*looks_[i], of_block)) here.push_back(i);
      }
      if (!here.empty()) search_block(cell, block, chunks, searched[block], here);
    }
  }

  /// The box of a block, widened by two of its steps, because block boxes are rounded.
  Box box_of_block(std::uint32_t cell, std::uint32_t block, const Box& of_cell) const {
    const BlockBox& steps = store_.blocks()[std::uint64_t{cell} * store_.blocks_per_cell() + block];
    Box box;
    for (int k = 0; k < 3; ++k) {
      const double step = (of_cell.hi[k] - of_cell.lo[k]) / static_cast<double>(kBlockBoxSteps);
      box.lo[k] = of_cell.lo[k] + (steps.lo[k] - 2.0) * step;
      box.hi[k] = of_cell.lo[k] + (steps.hi[k] + 2.0) * step;
    }
    return box;
  }

  void search_block(std::uint32_t cell, std::uint32_t block,
                    const std::array<PackedChunk<std::int32_t>, 3>& chunks, std::uint64_t searched,
                    std::span<const std::size_t> here) {
    const std::uint32_t first = block * kBlockPoints;
    const std::uint32_t end = std::min(first + kBlockPoints, store_.cells()[cell].count);
    for (std::uint32_t index = first; index < end; ++index) {
      if ((searched >> (index - first) & 1) == 0) continue;
      const Vec3 point =
          position(store_.quantisation(), chunks[0][index], chunks[1][index], chunks[2][index]);
      for (const std::size_t i : here) {
        std::uint32_t column, row;
        if (!lattice_.find(looks_[i]->frame.apply(point), column, row)) continue;
        if (column == looks_[i]->column && row == looks_[i]->row) take(i, cell, index);
      }
    }
  }

  void take(std::size_t i, std::uint32_t cell, std::uint32_t index) {
    const std::uint64_t source = store_.source_of(cell, index);
    const std::scoped_lock lock(mutex_);
    if (!found_[i] || source < found_[i]->source) found_[i] = Found{source, cell, index};
  }

  SectionWitness witness_of(const Found& found) const {
    SectionWitness witness;
    witness.source = found.source;
    witness.xyz = store_.position_of(found.cell, found.index);
    if (store_.has_classes()) witness.point_class = store_.class_of(found.cell, found.index);
    return witness;
  }

  const StoreReader& store_;
  const SectionLattice lattice_;
  const double slack_;
  const IgnoredPoints ignored_;
  std::vector<std::optional<Look>> looks_;
  std::vector<std::optional<Found>> found_;
  std::mutex mutex_;
};

void check_hash(const char* what, std::uint64_t given, std::uint64_t of_section, Remedy remedy) {
  if (given == of_section) return;
  throw InputError("the section was found for another " + std::string(what) + " (hash " +
                       hash_text(of_section) + ", given " + hash_text(given) + ")",
                   remedy);
}

}  // namespace

void check_path_of(const SectionData& section, std::span<const Pose> path) {
  check_hash("trajectory", hash_of_trajectory(path), section.trajectory_hash,
             Remedy::kSameTrajectory);
}

std::vector<std::optional<SectionWitness>> section_witnesses(const SectionData& section,
                                                             const Store& store,
                                                             const std::vector<Pose>& path,
                                                             std::span<const SectionPlace> places) {
  check_hash("environment", store.reader().metadata().points_hash, section.environment_hash,
             Remedy::kSameEnvironment);
  check_path_of(section, path);
  return WitnessSearch(section, store.reader(), path, places).run();
}

}  // namespace clearway
