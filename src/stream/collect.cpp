#include "stream/collect.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

#include "core/kd_order.hpp"

namespace clearway {
namespace {

struct Collision {
  std::uint64_t source;
  std::int32_t q[3];
  std::uint32_t first_pose;
};

/// Sorted and written in pieces of this many rows.
constexpr std::size_t kRows = 1 << 16;

/// Calls visit(slot, index in the cell) for every hit of a cell.
template <typename Visit>
void for_each_hit(const Store& store, const HitSet& hits, std::uint32_t cell, Visit visit) {
  const std::uint64_t first_word = std::uint64_t{cell} * store.blocks_per_cell();
  const auto blocks =
      static_cast<std::uint32_t>(divide_up(store.cells()[cell].count, kBlockPoints));
  for (std::uint32_t block = 0; block < blocks; ++block) {
    for (std::uint64_t bits = hits.word(first_word + block); bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
      visit((first_word + block) * kBlockPoints + bit, block * kBlockPoints + bit);
    }
  }
}

bool has_hits(const Store& store, const HitSet& hits, std::uint32_t cell) {
  const std::uint64_t first = std::uint64_t{cell} * store.blocks_per_cell();
  for (std::uint64_t word = first; word < first + store.blocks_per_cell(); ++word) {
    if (hits.word(word) != 0) return true;
  }
  return false;
}

/// The colliding points with the smallest source indices >= `from`, at most `most` of them, sorted.
class RangePass {
 public:
  RangePass(std::uint64_t from, std::size_t most) : from_(from), most_(most) {}

  void add_cell(const Store& store, const HitSet& hits, std::uint32_t cell) {
    const PackedChunk<std::uint64_t> sources = store.sources(cell);
    if (sources.minimum() >= below_) return;
    const auto coordinates = store.coordinates(cell);
    for_each_hit(store, hits, cell, [&](std::uint64_t slot, std::uint32_t i) {
      const std::uint64_t source = sources[i];
      if (source < from_ || source >= below_) return;
      rows_.push_back({source,
                       {coordinates[0][i], coordinates[1][i], coordinates[2][i]},
                       hits.has_first_pose() ? hits.first_pose(slot) : 0});
      if (rows_.size() >= 2 * most_) keep_smallest();
    });
  }

  std::vector<Collision> take() {
    if (rows_.size() > most_) keep_smallest();
    std::sort(rows_.begin(), rows_.end(), by_source);
    return std::move(rows_);
  }

 private:
  static bool by_source(const Collision& a, const Collision& b) { return a.source < b.source; }

  void keep_smallest() {
    const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(most_);
    std::nth_element(rows_.begin(), end, rows_.end(), by_source);
    below_ = end->source;
    rows_.erase(end, rows_.end());
  }

  std::uint64_t from_;
  std::uint64_t below_ = std::numeric_limits<std::uint64_t>::max();
  std::size_t most_;
  std::vector<Collision> rows_;
};

void append_rows(ResultWriter& writer, const std::vector<Collision>& rows,
                 const Quantisation& quantisation, bool first_pose) {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<std::uint32_t> poses;
  for (std::size_t first = 0; first < rows.size(); first += kRows) {
    source.clear();
    xyz.clear();
    poses.clear();
    for (std::size_t i = first; i < std::min(rows.size(), first + kRows); ++i) {
      const Collision& row = rows[i];
      source.push_back(row.source);
      xyz.push_back(position(quantisation, row.q[0], row.q[1], row.q[2]));
      if (first_pose) poses.push_back(row.first_pose);
    }
    writer.append(source, xyz, poses);
  }
}

}  // namespace

void write_collisions(const Store& store, const HitSet& hits, const ResultHeader& header,
                      const std::filesystem::path& path, std::uint64_t memory_bytes,
                      Progress& progress) {
  const std::uint64_t collisions = hits.count();
  const std::size_t most =
      std::max<std::uint64_t>(kRows, memory_bytes / (2 * sizeof(Collision) + sizeof(Collision)));
  std::vector<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    if (has_hits(store, hits, cell)) cells.push_back(cell);
  }
  ResultWriter writer(path, header, collisions);
  progress.begin("write", collisions, "points");
  std::uint64_t from = 0;
  for (std::uint64_t written = 0; written < collisions;) {
    RangePass pass(from, most);
    for (const std::uint32_t cell : cells) pass.add_cell(store, hits, cell);
    const std::vector<Collision> rows = pass.take();
    if (rows.empty()) break;  // finish() reports what is missing
    append_rows(writer, rows, store.quantisation(), header.first_pose);
    written += rows.size();
    from = rows.back().source + 1;
    progress.advance(rows.size());
  }
  writer.finish();
  progress.end();
}

}  // namespace clearway
