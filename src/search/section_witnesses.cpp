#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/section.hpp"
#include "core/cloud/scan_points.hpp"
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

/// One call of section_witnesses().
class WitnessSearch {
 public:
  WitnessSearch(const SectionData& section, const StoreReader& store, const std::vector<Pose>& path,
                std::span<const SectionPlace> places)
      : store_(store),
        lattice_(lattice_of(section)),
        slack_(2 * section.rounding),
        ignored_(store, ignored_by(section.parameters)),
        load_(load_of_section(path, section.parameters, nullptr)),
        places_(places) {}

  std::vector<std::optional<SectionWitness>> run() const {
    std::vector<std::optional<SectionWitness>> out(places_.size());
    in_all_threads([&] {
      for_each_parallel(out.size(), [&](std::size_t i) { out[i] = witness_of(places_[i]); });
    });
    return out;
  }

 private:
  /// The point with the smallest source that blocks the cell of the place at its pose.
  std::optional<SectionWitness> witness_of(const SectionPlace& place) const {
    const double column = place.cell[0] - lattice_.j_from, row = place.cell[1] - lattice_.k_from;
    const auto at = std::ranges::lower_bound(load_.path_pose, place.pose);
    if (at == load_.path_pose.end() || *at != place.pose || !(column >= 0) || !(row >= 0) ||
        column >= lattice_.columns || row >= lattice_.rows || store_.cells().empty()) {
      return std::nullopt;
    }
    const Pose& pose = load_.poses[static_cast<std::size_t>(at - load_.path_pose.begin())];
    const double g = lattice_.cell, y = place.cell[0] * g, z = place.cell[1] * g;
    const Box region = Box{{lattice_.x_from, y, z}, {lattice_.x_to, y + g, z + g}}.grown(slack_);
    std::optional<SectionWitness> witness;
    std::map<std::uint32_t, std::vector<std::uint64_t>> masks;  // of cells
    const auto is_ignored = [&](std::uint32_t cell, std::uint32_t index) {
      if (!ignored_.any()) return false;
      std::vector<std::uint64_t>& searched = masks[cell];
      if (searched.empty()) {
        searched.resize(store_.blocks_per_cell());
        ignored_.mask(cell, searched, [&] { return store_.peek(cell); });
      }
      return (searched[index / kBlockPoints] >> index % kBlockPoints & 1) == 0;
    };
    constexpr auto kAllBlocks = std::numeric_limits<std::uint32_t>::max();
    const auto look = [&](const Vec3& point, std::uint32_t cell, std::uint32_t index) {
      std::uint32_t j = 0, k = 0;
      if (!lattice_.find(point, j, k) || j != column || k != row) return true;
      const std::uint64_t source = store_.source_of(cell, index);
      if ((witness && witness->source <= source) || is_ignored(cell, index)) return true;
      witness = SectionWitness{.source = source, .xyz = store_.position_of(cell, index)};
      if (store_.has_classes()) witness->point_class = store_.class_of(cell, index);
      return true;
    };
    ScanPoints(store_, kAllBlocks).visit(region, pose, look);
    return witness;
  }

  const StoreReader& store_;
  const SectionLattice lattice_;
  const double slack_;
  const IgnoredPoints ignored_;
  const Body load_;
  const std::span<const SectionPlace> places_;
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
