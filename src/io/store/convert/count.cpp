#include "io/store/convert/count.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/store/convert/path_origins.hpp"
#include "io/store/convert/points_hash.hpp"
#include "io/store/convert/read_points.hpp"

namespace clearway {
namespace {

constexpr unsigned kFinestShift = 4;  // log2 of the finest bin's side: 16 quanta
// Log2 of the finest bin's side; points that still coincide in one are counted by source index.
constexpr unsigned kSubShift = 2;
constexpr std::size_t kMostBins = 1 << 17;
constexpr std::size_t kMostSubBins = 1 << 10;  // for each overfull bin
// Coinciding points are counted by ranges of 2^20 source indices.
constexpr unsigned kSourceShift = 20;

/// Number of points of each class.
using ClassCounts = std::array<std::uint64_t, 256>;

/// Sums over all points that the counting pass makes besides the bins.
struct PassSums {
  PointsHash points_hash;
  ClassesHash classes_hash = {};
  ClassCounts classes = {};
  std::uint64_t points = 0;
};

/// Moves what the threads have counted to one counter, which is returned. Pairs are merged in
/// parallel, because a merge goes through all slots of a counter.
BinCounter& gather(tbb::enumerable_thread_specific<BinCounter>& counters) {
  std::vector<BinCounter*> all{&counters.local()};
  for (BinCounter& counter : counters) {
    if (&counter != all.front()) all.push_back(&counter);
  }
  for (std::size_t step = 1; step < all.size(); step *= 2) {
    const std::size_t pairs = (all.size() + step - 1) / (2 * step);
    for_each_parallel(pairs, [&](std::size_t pair) {
      const std::size_t i = 2 * step * pair;
      all[i]->merge(*all[i + step]);
      all[i + step]->clear();
    });
  }
  return *all.front();
}

std::vector<Bin> count_bins(const EnvironmentPass& pass, const Lattice& lattice, PassSums& sums,
                            PlaceSample& places, FileBoxes& boxes, PathOrigins* path,
                            Progress& progress) {
  tbb::enumerable_thread_specific<ClassCounts> classes(ClassCounts{});
  tbb::enumerable_thread_specific<BinCounter> counters(
      [] { return BinCounter(kFinestShift, kMostBins); });
  for_each_batch<PathOrigins::OfBatch>(
      pass,
      [&](const QuantaBatch& batch) {
        const auto running = pass.clocks.measure(Stage::kCount);
        boxes.add(batch);
        BinCounter& counter = counters.local();
        for (const auto& q : batch.quanta) counter.add(lattice(q, 0));
        ClassCounts& counts = classes.local();
        for (const std::uint8_t value : batch.classes) ++counts[value];
        if (batch.classes.empty()) counts[0] += batch.quanta.size();
        progress.advance(batch.quanta.size());
        return path ? path->origins_of(batch) : PathOrigins::OfBatch();
      },
      [&](const QuantaBatch& batch, const PathOrigins::OfBatch& origins) {
        if (path) path->add(batch, origins);
        sums.points_hash.add(batch);
        sums.classes_hash.add(batch);
        places.add(batch);
        sums.points += batch.quanta.size();
      },
      [](const PathOrigins::OfBatch&) {});
  for (const ClassCounts& counts : classes) {
    std::ranges::transform(counts, sums.classes, sums.classes.begin(), std::plus());
  }
  const BinCounter& all = gather(counters);
  if (lattice.regular() && all.shift() > lattice.cube_bits()) {
    throw UsageError("a regular layout: more than " + std::to_string(kMostBins) +
                     " cubes hold points; expected larger cubes");
  }
  return all.bins();
}

/// Counts the points of each overfull bin separately: on a finer grid, or by source indices where
/// the bin cannot be made finer.
class Refinement {
 public:
  explicit Refinement(const std::vector<Bin>& overfull) {
    for (const Bin& bin : overfull) {
      const bool finest = bin.hi[0] - bin.lo[0] <= std::uint64_t{1} << kSubShift;
      parts_.push_back({BinCounter(kSubShift, finest ? 1 : kMostSubBins), finest, {}});
    }
  }

  void add(std::size_t bin, const LatticePoint& point) {
    Part& part = parts_[bin];
    if (part.by_source) {
      ++part.ranges[point[3] >> kSourceShift];
    } else {
      part.counter.add(point);
    }
  }

  void merge(const Refinement& other) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      parts_[i].counter.merge(other.parts_[i].counter);
      for (const auto& [range, count] : other.parts_[i].ranges) parts_[i].ranges[range] += count;
    }
  }

  void append_to(std::vector<Bin>& bins, std::size_t i, const Bin& parent) const {
    if (!parts_[i].by_source) {
      const std::vector<Bin> sub = parts_[i].counter.bins();
      bins.insert(bins.end(), sub.begin(), sub.end());
      return;
    }
    for (const auto& [range, count] : parts_[i].ranges) {
      Bin bin = parent;
      bin.lo[3] = range << kSourceShift;
      bin.hi[3] = (range + 1) << kSourceShift;
      bin.count = count;
      bins.push_back(bin);
    }
  }

 private:
  struct Part {
    BinCounter counter;
    bool by_source;
    std::map<std::uint64_t, std::uint64_t> ranges;
  };
  std::vector<Part> parts_;
};

/// Replaces the overfull bins of `bins` with finer ones, in one more pass over the input.
void refine(const EnvironmentPass& pass, const Lattice& lattice, const SplitTree& tree,
            std::vector<Bin>& bins, Progress& progress) {
  tbb::enumerable_thread_specific<Refinement> counters(
      [&tree] { return Refinement(tree.overfull()); });
  for_each_batch<bool>(
      pass,
      [&](const QuantaBatch& batch) {
        const auto running = pass.clocks.measure(Stage::kCount);
        Refinement& counter = counters.local();
        for (std::size_t i = 0; i < batch.quanta.size(); ++i) {
          const LatticePoint point = lattice(batch.quanta[i], batch.source(i));
          const std::int32_t bin = tree.overfull_at(tree.descend(point));
          if (bin >= 0) counter.add(static_cast<std::size_t>(bin), point);
        }
        progress.advance(batch.quanta.size());
        return true;
      },
      [](const QuantaBatch&, bool) {}, [](bool) {});
  Refinement all(tree.overfull());
  for (const Refinement& counter : counters) all.merge(counter);
  std::erase_if(bins, [](const Bin& bin) { return bin.count > kBucketPoints; });
  for (std::size_t i = 0; i < tree.overfull().size(); ++i) {
    all.append_to(bins, i, tree.overfull()[i]);
  }
}

}  // namespace

CountedEnvironment count_environment(EnvironmentSource& environment, const Lattice& lattice,
                                     PlaceSample& places, FileBoxes& boxes, FileHashes& files,
                                     int threads, StageClocks& clocks, Progress& progress,
                                     PathOrigins* path) {
  CountedEnvironment counted;
  PassSums sums{PointsHash(environment.quantisation())};
  progress.begin("count", environment.declared_points().value_or(0), "points");
  environment.rewind();
  counted.bins = count_bins({environment, threads, &files, clocks, progress}, lattice, sums, places,
                            boxes, path, progress);
  environment.leave_out_times();
  counted.points = sums.points;
  counted.input_points = environment.counts().input_points;
  counted.points_hash = sums.points_hash.digest(counted.input_points);
  if (sums.classes[0] < counted.points) {
    counted.classes = {sums.classes_hash.digest(), sums.classes};
  }
  progress.end();
  for (;;) {
    const SplitTree tree(counted.bins, lattice, environment.quantisation().scale);
    if (tree.overfull().empty()) return counted;
    progress.begin("refine", counted.points, "points");
    environment.rewind();
    refine({environment, threads, nullptr, clocks, progress}, lattice, tree, counted.bins,
           progress);
    progress.end();
  }
}

}  // namespace clearway
