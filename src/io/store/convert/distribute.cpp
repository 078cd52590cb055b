#include "io/store/convert/distribute.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/store/convert/origin_table.hpp"
#include "io/store/convert/points_hash.hpp"
#include "io/store/convert/read_points.hpp"
#include "io/store/convert/withheld_cubes.hpp"

namespace clearway {
namespace {

/// The sum of a 64-bit mix of each point, which does not depend on their order. A file of which the
/// system has lost a part, or in which bytes have changed, has another one.
std::uint64_t sum_of(std::span<const DistributedPoint> points) {
  std::uint64_t sum = 0;
  for (const DistributedPoint& point : points) {
    std::uint64_t mix = 0x9E3779B97F4A7C15;
    const auto add = [&mix](std::uint64_t value) {
      mix = (mix ^ value) * 0xBF58476D1CE4E5B9;
      mix ^= mix >> 31;
    };
    add(static_cast<std::uint32_t>(point.q[0]) |
        std::uint64_t{static_cast<std::uint32_t>(point.q[1])} << 32);
    add(static_cast<std::uint32_t>(point.q[2]) | std::uint64_t{point.source[0]} << 32);
    add(point.source[1]);
    sum += mix;
  }
  return sum;
}

}  // namespace

Distribution::Distribution(const SplitTree& tree, std::vector<File> files, std::uint64_t first_byte)
    : files_(std::move(files)) {
  for (const std::uint32_t node : tree.units()) counts_.push_back(tree.nodes()[node].count);
  if (files_.empty()) {
    for (const std::uint64_t count : counts_) memory_.emplace_back(count);
    return;
  }
  sums_.resize(units());
  std::vector<std::uint64_t> ends(files_.size(), first_byte);
  for (std::size_t unit = 0; unit < units(); ++unit) {
    const std::size_t file = unit % files_.size();
    places_.push_back({file, ends[file]});
    ends[file] += counts_[unit] * sizeof(DistributedPoint);
    temporary_bytes_ += counts_[unit] * sizeof(DistributedPoint);
  }
  for (std::size_t file = 0; file < files_.size(); ++file) files_[file].reserve(ends[file]);
}

void Distribution::put(std::size_t unit, std::uint64_t first,
                       std::span<const DistributedPoint> points) {
  if (files_.empty()) {
    std::copy(points.begin(), points.end(),
              memory_[unit].room().begin() + static_cast<std::ptrdiff_t>(first));
    return;
  }
  const auto& [file, byte] = places_[unit];
  files_[file].write_at(byte + first * sizeof(DistributedPoint), std::as_bytes(points));
  std::atomic_ref(sums_[unit]).fetch_add(sum_of(points), std::memory_order_relaxed);
}

/// The points of a unit as its file has them; nullopt where these do not have the sum.
std::optional<UnitPoints> Distribution::points_in_file(std::size_t unit, std::uint64_t sum) const {
  const auto& [file, byte] = places_[unit];
  const std::uint64_t bytes = counts_[unit] * sizeof(DistributedPoint);
  if (byte + bytes > files_[file].size_bytes()) return std::nullopt;
  UnitPoints points(std::make_unique<MappedFile>(files_[file], byte, bytes));
  if (sum_of(points.span()) != sum) return std::nullopt;
  return points;
}

bool Distribution::take_over(std::vector<std::uint64_t> sums) {
  if (files_.empty() || sums.size() != units()) return false;
  std::atomic<bool> whole = true;
  for_each_parallel(units(), [&](std::size_t unit) {
    if (whole && !points_in_file(unit, sums[unit])) whole = false;
  });
  if (whole) sums_ = std::move(sums);
  return whole;
}

UnitPoints Distribution::take(std::size_t unit) {
  if (files_.empty()) return std::move(memory_[unit]);
  std::optional<UnitPoints> points = points_in_file(unit, sums_[unit]);
  if (!points) {
    throw ResourceError(
        files_[places_[unit].file].name() + ": does not hold the points that were written into it",
        Remedy::kResume);
  }
  return std::move(*points);
}

void Distribution::close_files() {
  std::vector<File> files = std::exchange(files_, {});
  for_each_parallel(files.size(), [&](std::size_t i) { const File closed(std::move(files[i])); });
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

void distribute(EnvironmentSource& environment, const CountedEnvironment& counted,
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
        if (withheld) withheld->add(batch.withheld_cubes);
      },
      [&](GroupedBatch& grouped) {
        const auto running = clocks.measure(Stage::kDistribute);
        for (const auto& [unit, begin, end, first] : grouped.groups) {
          const auto points = std::span(grouped.points).subspan(begin, end - begin);
          distribution.put(unit, first, points);
        }
        progress.advance(grouped.points.size());
        grouped.points = {};
      });
  order.finish();
  const bool same_classes = has_classes == counted.classes.has_value() &&
                            (!has_classes || classes.digest() == counted.classes->hash);
  if (hash.digest(environment.counts().input_points) != counted.points_hash || !same_classes) {
    refuse_change(environment);
  }
}

}  // namespace clearway
