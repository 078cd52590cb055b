#include "io/store/convert/distribute.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/xxh64.hpp"
#include "io/store/convert/conversion_journal.hpp"
#include "io/store/convert/origin_table.hpp"
#include "io/store/convert/points_hash.hpp"
#include "io/store/convert/read_points.hpp"
#include "io/store/convert/withheld_cubes.hpp"

namespace clearway {
Distribution::Distribution(const SplitTree& tree, std::vector<File> files, std::uint64_t first_byte)
    : files_(std::move(files)) {
  for (const std::uint32_t node : tree.units()) counts_.push_back(tree.nodes()[node].count);
  if (files_.empty()) {
    for (const std::uint64_t count : counts_) memory_.emplace_back(count);
    return;
  }
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
}

void Distribution::get(std::size_t unit, std::uint64_t first,
                       std::span<DistributedPoint> points) const {
  const auto& [file, byte] = places_[unit];
  files_[file].read_at(byte + first * sizeof(DistributedPoint), std::as_writable_bytes(points));
}

UnitPoints Distribution::take(std::size_t unit) {
  if (files_.empty()) return std::move(memory_[unit]);
  const auto& [file, byte] = places_[unit];
  return UnitPoints(
      std::make_unique<MappedFile>(files_[file], byte, counts_[unit] * sizeof(DistributedPoint)));
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
  DistributedBatch kept;  ///< what the journal is to keep of it
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

  /// Takes the places of a batch that is distributed already.
  void pass_over(const DistributedBatch& batch) {
    for (const auto& group : batch.groups) next_[group.unit] += group.points;
  }

  std::uint64_t placed() const {
    return std::accumulate(next_.begin(), next_.end(), std::uint64_t{0});
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

std::size_t count_whole(const Distribution& distribution, std::span<const DistributedBatch> batches,
                        std::size_t first_unit) {
  std::vector<std::vector<std::uint64_t>> firsts;
  std::vector<std::uint64_t> next(distribution.units());
  const auto fits = [&](const DistributedBatch::Group& group) {
    return group.unit < distribution.units() &&
           next[group.unit] + group.points <= distribution.points(group.unit);
  };
  for (const DistributedBatch& batch : batches) {
    std::vector<std::uint64_t> of_batch;
    for (const DistributedBatch::Group& group : batch.groups) {
      if (!fits(group)) break;
      of_batch.push_back(next[group.unit]);
      next[group.unit] += group.points;
    }
    if (of_batch.size() < batch.groups.size()) break;
    firsts.push_back(std::move(of_batch));
  }
  std::atomic<std::size_t> whole = firsts.size();
  for_each_parallel(firsts.size(), [&](std::size_t i) {
    if (i >= whole) return;
    std::vector<DistributedPoint> points;
    for (std::size_t k = 0; k < batches[i].groups.size(); ++k) {
      const DistributedBatch::Group& group = batches[i].groups[k];
      if (group.unit < first_unit) continue;
      points.resize(group.points);
      distribution.get(group.unit, firsts[i][k], points);
      if (xxh64(std::as_bytes(std::span(points))) == group.hash) continue;
      std::size_t least = whole;
      while (i < least && !whole.compare_exchange_weak(least, i)) {
      }
      return;
    }
  });
  return whole;
}

void count_places(const Distribution& distribution, PlaceCounter& places, OriginTable* origins,
                  std::span<const DistributedBatch> batches) {
  if (!places.any() && origins == nullptr) return;
  std::vector<std::uint64_t> next(distribution.units());
  std::vector<DistributedPoint> points;
  for (const DistributedBatch& distributed : batches) {
    for (const DistributedBatch::Group& group : distributed.groups) {
      points.resize(group.points);
      distribution.get(group.unit, next[group.unit], points);
      next[group.unit] += group.points;
      if (origins != nullptr) origins->count(points);
      QuantaBatch batch;
      batch.first_source = points.front().source_index();
      for (const DistributedPoint& point : points) {
        batch.quanta.push_back({point.q[0], point.q[1], point.q[2]});
        batch.offsets.push_back(
            static_cast<std::uint32_t>(point.source_index() - batch.first_source));
      }
      places.add(batch);
    }
  }
}

void distribute(EnvironmentSource& environment, const CountedHashes& counted,
                const Lattice& lattice, const SplitTree& tree, PlaceCounter& places,
                Distribution& distribution, int threads, StageClocks& clocks, Progress& progress,
                OriginTable* origins, WithheldCubes* withheld, ConversionJournal* journal) {
  const Grouper group(lattice, tree);
  PointsHash hash(environment.quantisation());
  ClassesHash classes;
  bool has_classes = false;
  Places order(environment, distribution);
  // go_on_from() rewinds, and keeps how many points the files before its place have.
  if (journal == nullptr || journal->batches().empty()) environment.rewind();
  const auto keep_hashes = [&](JournalValues values) { values.add(hash, classes, has_classes); };
  std::uint64_t begun = 0;
  BatchWatch watch;
  if (journal != nullptr) {
    for (const DistributedBatch& batch : journal->batches()) {
      order.pass_over(batch);
      if (withheld) withheld->add(batch.withheld_cubes);
    }
    begun = journal->batches().size();
    journal->go_on_after_batches(begun);
    if (begun > 0) {
      const DistributedBatch& last = journal->batches().back();
      JournalPayload payload(last.hashes, "the hashes of the points");
      keep_hashes(JournalValues(payload));
      environment.go_on_from(last.position, last.counts);
      progress.advance(order.placed());
    }
    watch.begun = [&] { journal->begin_batch(++begun); };
  }
  for_each_batch<GroupedBatch>(
      {environment, threads, nullptr, clocks, progress, watch},
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
        if (journal == nullptr) return;
        grouped.kept.position = environment.noted_position();
        grouped.kept.counts = environment.counts();
        grouped.kept.withheld_cubes = batch.withheld_cubes;
        JournalRecord hashes;
        keep_hashes(JournalValues(hashes));
        const std::span<const std::byte> bytes = hashes.payload();
        grouped.kept.hashes.assign(bytes.begin(), bytes.end());
      },
      [&](GroupedBatch& grouped) {
        const auto running = clocks.measure(Stage::kDistribute);
        for (const auto& [unit, begin, end, first] : grouped.groups) {
          const auto points = std::span(grouped.points).subspan(begin, end - begin);
          distribution.put(unit, first, points);
          if (journal == nullptr) continue;
          grouped.kept.groups.push_back({unit, end - begin, xxh64(std::as_bytes(points))});
        }
        progress.advance(grouped.points.size());
        grouped.points = {};
      },
      [&](GroupedBatch& grouped) {
        if (journal != nullptr) journal->keep_batch(grouped.kept);
      });
  order.finish();
  const bool same_classes =
      has_classes ? classes.digest() == counted.classes : !counted.classes.has_value();
  if (hash.digest(environment.input_points()) != counted.points || !same_classes) {
    refuse_change(environment);
  }
}

}  // namespace clearway
