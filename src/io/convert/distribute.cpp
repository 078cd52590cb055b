#include "io/convert/distribute.hpp"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <memory>
#include <span>

#include "clearway/error.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/convert/count/count.hpp"
#include "io/convert/points_hash.hpp"

namespace clearway {
namespace {

/// A batch's points grouped by unit, each group in source order.
struct GroupedBatch {
  struct Group {
    std::uint32_t unit;
    std::uint32_t begin, end;
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
      const auto& q = batch.quanta[i];
      const std::uint64_t source = batch.source(i);
      out.points[ends[unit[i]]++] = {
          {q[0], q[1], q[2]},
          {static_cast<std::uint32_t>(source), static_cast<std::uint32_t>(source >> 32)}};
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

/// Appends each unit's points to its region of the file through a buffer a unit.
class RegionWriter {
 public:
  RegionWriter(const EnvironmentSource& environment, Distribution& out, std::uint64_t buffer_points)
      : environment_(environment),
        out_(out),
        next_(out.first.begin(), out.first.end() - 1),
        buffers_(next_.size()),
        buffer_points_(buffer_points) {}

  void append(const GroupedBatch& batch) {
    for (const GroupedBatch::Group& group : batch.groups) {
      append(group.unit, std::span(batch.points).subspan(group.begin, group.end - group.begin));
    }
  }

  void finish() {
    for (std::uint32_t unit = 0; unit < next_.size(); ++unit) {
      flush(unit);
      if (next_[unit] != out_.first[unit + 1]) refuse_change(environment_);
    }
  }

 private:
  void append(std::uint32_t unit, std::span<const DistributedPoint> points) {
    auto& buffer = buffers_[unit];
    buffer.insert(buffer.end(), points.begin(), points.end());
    if (buffer.size() >= buffer_points_) flush(unit);
  }

  void flush(std::uint32_t unit) {
    auto& buffer = buffers_[unit];
    if (buffer.size() > out_.first[unit + 1] - next_[unit]) refuse_change(environment_);
    out_.file.write_at(next_[unit] * sizeof(DistributedPoint), std::as_bytes(std::span(buffer)));
    next_[unit] += buffer.size();
    buffer.clear();
    if (buffer.capacity() > 2 * buffer_points_) buffer.shrink_to_fit();
  }

  const EnvironmentSource& environment_;
  Distribution& out_;
  std::vector<std::uint64_t> next_;
  std::vector<std::vector<DistributedPoint>> buffers_;
  std::uint64_t buffer_points_;
};

/// Reads batches into the hash, groups several at a time, and writes them in their order.
void run_stages(EnvironmentSource& environment, PointsHash& hash, const Grouper& group,
                PlaceCounter& places, RegionWriter& writer, int threads, StageClocks& clocks,
                Progress& progress) {
  using Batch = std::shared_ptr<QuantaBatch>;
  using Grouped = std::shared_ptr<GroupedBatch>;
  const ParallelScope scope;
  const SerialStage input, output;
  const auto read = piece_of(scope, input, [&](tbb::flow_control& flow) {
    throw_if_stopped(progress);
    auto batch = std::make_shared<QuantaBatch>();
    if (read_measured(environment, *batch, clocks)) {
      const auto running = clocks.measure(Stage::kHash);
      hash.add(*batch);
    } else {
      flow.stop();
    }
    return batch;
  });
  const auto grouped = piece_of(scope, [&](const Batch& batch) {
    const auto running = clocks.measure(Stage::kGroup);
    places.add(*batch);
    return std::make_shared<GroupedBatch>(group(*batch));
  });
  const auto write = piece_of(scope, output, [&](const Grouped& batch) {
    const auto running = clocks.measure(Stage::kDistribute);
    writer.append(*batch);
    progress.advance(batch->points.size());
  });
  constexpr auto serial = tbb::filter_mode::serial_in_order;
  constexpr auto parallel = tbb::filter_mode::parallel;
  scope.begin();
  tbb::parallel_pipeline(2 * static_cast<std::size_t>(threads),
                         tbb::make_filter<void, Handed<Batch>>(serial, read) &
                             tbb::make_filter<Handed<Batch>, Handed<Grouped>>(parallel, grouped) &
                             tbb::make_filter<Handed<Grouped>, void>(serial, write));
}

}  // namespace

Distribution distribute(EnvironmentSource& environment, std::uint64_t points_hash,
                        const Lattice& lattice, const SplitTree& tree, PlaceCounter& places,
                        const std::filesystem::path& temporary_folder, std::uint64_t buffer_bytes,
                        int threads, StageClocks& clocks, Progress& progress) {
  Distribution out{File::create_temporary(temporary_folder), {0}};
  for (const std::uint32_t node : tree.units()) {
    out.first.push_back(out.first.back() + tree.nodes()[node].count);
  }
  const std::uint64_t points = out.first.back();
  out.file.reserve(points * sizeof(DistributedPoint));
  const std::uint64_t units = std::max<std::uint64_t>(1, tree.units().size());
  RegionWriter writer(environment, out,
                      std::clamp<std::uint64_t>(
                          buffer_bytes / units / (2 * sizeof(DistributedPoint)), 64, 1 << 15));
  const Grouper group(lattice, tree);
  PointsHash hash(environment.quantisation());

  progress.begin("distribute", points, "points");
  environment.rewind();
  run_stages(environment, hash, group, places, writer, threads, clocks, progress);
  writer.finish();
  if (hash.digest(environment.input_points()) != points_hash) refuse_change(environment);
  progress.end();
  return out;
}

}  // namespace clearway
