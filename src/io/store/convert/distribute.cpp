#include "io/store/convert/distribute.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "clearway/error.hpp"
#include "io/store/convert/origin_table.hpp"
#include "io/store/convert/points_hash.hpp"
#include "io/store/convert/read_points.hpp"
#include "io/store/convert/withheld_cubes.hpp"

namespace clearway {
namespace {

UnitPoints room_for(std::size_t count) {
  return {std::make_unique_for_overwrite<DistributedPoint[]>(count), count};
}

}  // namespace

Distribution::Distribution(const SplitTree& tree,
                           const std::optional<std::filesystem::path>& folder, std::size_t files) {
  for (const std::uint32_t node : tree.units()) counts_.push_back(tree.nodes()[node].count);
  if (!folder) {
    for (const std::uint64_t count : counts_) memory_.push_back(room_for(count));
    return;
  }
  files = std::min(files, units());
  std::vector<std::uint64_t> bytes(files);
  for (std::size_t unit = 0; unit < units(); ++unit) {
    const std::size_t file = unit % files;
    places_.push_back({file, bytes[file]});
    bytes[file] += counts_[unit] * sizeof(DistributedPoint);
    temporary_bytes_ += counts_[unit] * sizeof(DistributedPoint);
  }
  for (const std::uint64_t size : bytes) {
    files_.push_back(File::create_temporary(*folder));
    files_.back().reserve(size);
  }
}

void Distribution::put(std::size_t unit, std::uint64_t first,
                       std::span<const DistributedPoint> points) {
  if (files_.empty()) {
    std::copy(points.begin(), points.end(), memory_[unit].points.get() + first);
    return;
  }
  const auto& [file, byte] = places_[unit];
  files_[file].write_at(byte + first * sizeof(DistributedPoint), std::as_bytes(points));
}

UnitPoints Distribution::take(std::size_t unit) {
  if (files_.empty()) return std::move(memory_[unit]);
  UnitPoints all = room_for(counts_[unit]);
  const auto& [file, byte] = places_[unit];
  files_[file].read_at(byte, std::as_writable_bytes(std::span(all.points.get(), all.count)));
  return all;
}

namespace {

/// A batch's points grouped by unit, each group in source order.
struct GroupedBatch {
  struct Group {
    std::uint32_t unit;
    std::uint32_t begin, end;
    std::uint64_t first = 0;  ///< index of its first point among the unit's points
  };
  std::vector<DistributedPoint> points;
  std::vector<Group> groups;
};

class Grouper {
 public:
  Grouper(const Lattice& lattice, const SplitTree& tree) : lattice_(lattice), tree_(tree) {}

  GroupedBatch operator()(const QuantaBatch& batch) const {
    const std::size_t n = batch.quanta.size();
    std::vector<std::uint32_t> unit(n);
    std::vector<std::uint32_t> ends(tree_.units().size() + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t node = tree_.descend(lattice_(batch.quanta[i], batch.source(i)));
      unit[i] = static_cast<std::uint32_t>(tree_.nodes()[node].unit);
      ++ends[unit[i] + 1];
    }
    GroupedBatch out;
    for (std::uint32_t u = 0; u + 1 < ends.size(); ++u) {
      if (ends[u + 1] > 0) out.groups.push_back({u, ends[u], ends[u] + ends[u + 1]});
      ends[u + 1] += ends[u];
    }
    out.points.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint8_t point_class = batch.classes.empty() ? std::uint8_t{0} : batch.classes[i];
      out.points[ends[unit[i]]++] =
          DistributedPoint::of(batch.quanta[i], batch.source(i), point_class);
    }
    return out;
  }

 private:
  const Lattice& lattice_;
  const SplitTree& tree_;
};

[[noreturn]] void refuse_change(const EnvironmentSource& environment) {
  environment.refuse_changed();
  throw InputError("the input changed between two passes over it, expected the same points");
}

/// Assigns every group its place, batch by batch in order.
class Places {
 public:
  Places(const EnvironmentSource& environment, const Distribution& distribution)
      : environment_(environment), distribution_(distribution), next_(distribution.units()) {}

  void assign(GroupedBatch& batch) {
    for (GroupedBatch::Group& group : batch.groups) {
      group.first = next_[group.unit];
      next_[group.unit] += group.end - group.begin;
      if (next_[group.unit] > distribution_.points(group.unit)) refuse_change(environment_);
    }
  }

  void finish() const {
    for (std::size_t unit = 0; unit < next_.size(); ++unit) {
      if (next_[unit] != distribution_.points(unit)) refuse_change(environment_);
    }
  }

 private:
  const EnvironmentSource& environment_;
  const Distribution& distribution_;
  std::vector<std::uint64_t> next_;  // next place in each unit
};

}  // namespace

void distribute(EnvironmentSource& environment, const CountedHashes& counted,
                const Lattice& lattice, const SplitTree& tree, PlaceCounter& places,
                Distribution& distribution, int threads, StageClocks& clocks, Progress& progress,
                OriginTable* origins, WithheldCubes* withheld) {
  const Grouper group(lattice, tree);
  PointsHash hash(environment.quantisation());
  ClassesHash classes;
  bool has_classes = false;
  Places order(environment, distribution);
  environment.rewind();
  for_each_batch<GroupedBatch>(
      {environment, threads, nullptr, clocks, progress},
      [&](const QuantaBatch& batch) {
        const auto running = clocks.measure(Stage::kGroup);
        places.add(batch);
        return group(batch);
      },
      [&](const QuantaBatch& batch, GroupedBatch& grouped) {
        hash.add(batch);
        classes.add(batch);
        has_classes |= !batch.classes.empty();
        order.assign(grouped);
        if (origins) origins->count(batch);
        if (withheld) withheld->add(batch);
      },
      [&](const GroupedBatch& grouped) {
        const auto running = clocks.measure(Stage::kDistribute);
        for (const auto& [unit, begin, end, first] : grouped.groups) {
          distribution.put(unit, first, std::span(grouped.points).subspan(begin, end - begin));
        }
        progress.advance(grouped.points.size());
      });
  order.finish();
  const bool same_classes =
      has_classes ? classes.digest() == counted.classes : !counted.classes.has_value();
  if (hash.digest(environment.input_points()) != counted.points || !same_classes) {
    refuse_change(environment);
  }
}

}  // namespace clearway
