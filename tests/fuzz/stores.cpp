// Any bytes as a store, a result, a journal, or a packed chunk; and a sound store with other
// values.
#include <hdf5.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <new>
#include <optional>

#include "core/page/page.hpp"
#include "fuzz.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/check_results.hpp"
#include "io/result/journal.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "io/store/verify_store.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "stream/search_journal.hpp"
#include "support/change_header.hpp"
#include "support/clouds.hpp"
#include "support/engines/answer_sets.hpp"
#include "support/memory_cloud.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using AxisValues = std::array<std::vector<std::int32_t>, 3>;

/// Stages a page of one cell, in memory of exactly its size, and requires these values in it.
void check_staged_cell(const PackedCloud& cloud, std::uint32_t cell, const AxisValues& values) {
  const std::array<PlannedCell, 1> planned{PlannedCell{cell, {0}}};
  const std::uint64_t bytes = page_shape(cloud, planned).bytes();
  constexpr std::align_val_t kAlignment{kPageAlignment};
  const auto free = [=](std::byte* page) { ::operator delete[](page, kAlignment); };
  const std::unique_ptr<std::byte[], decltype(free)> page(
      static_cast<std::byte*>(::operator new[](bytes, kAlignment)), free);
  const PageRef staged{page.get(), stage_page(cloud, planned, {page.get(), bytes})};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 0; i < cloud.cell_points(); ++i) {
      require(staged.value(staged.cell(0).chunks[axis], i) == values[axis][i]);
    }
  }
}

/// Opens a store and reads everything in it, as `verify`, `run` and the search of cells do.
void read_store(const std::filesystem::path& path) {
  const StoreReader store(path);
  NoProgress progress;
  verify_store(store, progress);
  store.fingerprint();
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    may_refuse([&] {
      const auto chunks = store.coordinates(cell);
      AxisValues values;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        values[axis].resize(store.cell_points());
        chunks[axis].decode(0, values[axis]);
      }
      check_staged_cell(store, cell, values);
    });
  }
}

void read_store_bytes(Bytes bytes) {
  const MemoryFile file(bytes);
  may_refuse([&] { read_store(file.path()); });
}

void read_result_bytes(Bytes bytes) {
  const MemoryFile file(bytes);
  may_refuse([&] {
    NoProgress progress;
    verify_result(ResultReader(file.path()), progress);
  });
}

/// A cloud of one cell whose x, y and z are the same packed bytes.
class OneCellCloud final : public PackedCloud {
 public:
  using Chunk = PackedChunk<std::int32_t>;

  OneCellCloud(std::span<const std::byte> chunk, std::uint32_t count)
      : chunk_(chunk), cell_{count, {}}, blocks_(divide_up(count, kBlockPoints)) {}

  std::uint64_t point_count() const override { return cell_.count; }
  std::uint32_t cell_points() const override { return cell_.count; }
  const Quantisation& quantisation() const override { return quantisation_; }
  std::span<const Cell> cells() const override { return {&cell_, 1}; }
  std::span<const TreeNode> tree() const override { return {&node_, 1}; }
  BlockBoxes blocks(std::uint32_t) const override {
    return BlockBoxes(std::as_bytes(std::span(blocks_)));
  }
  std::array<Chunk, 3> coordinates(std::uint32_t) const override {
    const Chunk chunk(chunk_, cell_.count);
    return {chunk, chunk, chunk};
  }
  std::uint64_t packed_bytes(std::uint32_t) const override { return 3 * chunk_.size(); }
  std::array<Chunk, 3> read_packed(std::uint32_t, std::span<std::byte> to) const override {
    std::array<Chunk, 3> chunks;
    for (Chunk& chunk : chunks) {
      std::copy(chunk_.begin(), chunk_.end(), to.begin());
      chunk = Chunk(to.first(chunk_.size()), cell_.count);
      to = to.subspan(chunk_.size());
    }
    return chunks;
  }
  std::uint64_t source_of(std::uint32_t, std::uint32_t index) const override { return index; }

 private:
  std::span<const std::byte> chunk_;
  Cell cell_;
  TreeNode node_{0, 1, 0, {}};
  Quantisation quantisation_{{1, 1, 1}, {0, 0, 0}};
  std::vector<BlockBox> blocks_;
};

template <typename Value>
std::vector<Value> check_decoding(std::span<const std::byte> bytes, std::uint32_t count) {
  const PackedChunk<Value> chunk(bytes, count);
  const auto again =
      PackedChunk<Value>::of_payload(chunk.payload(), count, chunk.minbits(), chunk.minimum());
  std::vector<Value> values(count), from_third(count);
  chunk.decode(0, values);
  for (std::uint32_t i = 0; i < count; ++i) {
    require(chunk[i] == values[i] && again[i] == values[i]);
  }
  if (count > 3) {
    chunk.decode(3, std::span(from_third).subspan(3));
    require(std::equal(values.begin() + 3, values.end(), from_third.begin() + 3));
  }
  return values;
}

/// A packed chunk: either it is refused, or every way to decode it gives the same values. The first
/// two bytes are the number of values.
void read_chunk_bytes(Bytes input) {
  if (input.size() < 2) return;
  const std::uint32_t count = 1 + input[0] + 256u * (input[1] % 8);
  // The bytes lie in a block of exactly their size, so that a read past its end is seen.
  const std::size_t size = input.size() - 2;
  const auto copy = std::make_unique<std::byte[]>(size);
  std::memcpy(copy.get(), input.data() + 2, size);
  const std::span<const std::byte> bytes(copy.get(), size);
  may_refuse([&] { check_decoding<std::uint64_t>(bytes, count); });
  may_refuse([&] {
    const auto values = check_decoding<std::int32_t>(bytes, count);
    check_staged_cell(OneCellCloud(bytes, count), 0, {values, values, values});
  });
}

/// A change of a store: the thing with this number, where in it, and the value put there.
struct Edit {
  static constexpr std::size_t kBytes = 11;
  unsigned what;
  std::uint16_t where = 0;
  std::uint64_t value = 0;

  explicit Edit(Bytes bytes) : what(bytes[0] % (kThings + 1)) {
    std::memcpy(&where, &bytes[1], 2);
    std::memcpy(&value, &bytes[3], 8);
  }
  static constexpr const char* kColumns[] = {"cells/count", "cells/box",   "cells/address",
                                             "cells/bytes", "cells/xxh64", "blocks/bytes",
                                             "tree/nodes"};
  static constexpr const char* kFacts[] = {
      "point_count", "input_points", "cell_points", "points_hash", "scale",    "offset",
      "length_unit", "layout",       "steps",       "sources",     "warnings", "columns"};
  /// Values of columns, their rows, and facts; one more stands for the packed chunks.
  static constexpr unsigned kThings = 2 * std::size(kColumns) + std::size(kFacts);

  bool is_of_chunk() const { return what == kThings; }
};

std::string bytes_of_column(const std::filesystem::path& path, const char* name,
                            std::size_t& row_bytes) {
  const OpenDataset dataset(open_to_change(path), name);
  row_bytes = dataset.row_bytes();
  return dataset.bytes();
}

void edit_column(const std::filesystem::path& path, const char* name, const Edit& edit) {
  std::size_t row = 0;
  std::string values = bytes_of_column(path, name, row);
  if (values.empty()) return;
  const std::size_t size = std::min<std::size_t>(row, sizeof edit.value);
  std::memcpy(values.data() + edit.where % (values.size() / size) * size, &edit.value, size);
  change_column(path, name, values);
}

/// Gives a column other rows, of which those that it had not are zero.
void resize_column(const std::filesystem::path& path, const char* name, const Edit& edit) {
  constexpr std::uint64_t kMost = 1 << 12;
  std::size_t row = 0;
  std::string values = bytes_of_column(path, name, row);
  values.resize(edit.value % kMost * row);
  change_column(path, name, values);
}

void edit_fact(const std::filesystem::path& path, const char* name, const Edit& edit) {
  change_header(path, [&](Json& header) {
    Json& fact = header[name];
    if (edit.where % 8 == 0) {
      header.erase(name);
    } else if (fact.is_structured() && !fact.empty() && edit.where % 8 != 1) {
      *std::next(fact.begin(), edit.where % static_cast<std::ptrdiff_t>(fact.size())) = edit.value;
    } else if (edit.where % 2 == 0) {
      fact = std::bit_cast<double>(edit.value);
    } else {
      fact = edit.value;
    }
  });
}

/// A sound store with cells of 64 points, the last of 44.
struct SoundStore {
  SoundStore() {
    // HDF5 is to keep the memory that it frees: it would give back a file's tables, which have
    // 600 KiB, each time.
    H5set_free_list_limits(-1, -1, -1, -1, -1, -1);
    const ScratchFolder folder;
    write_las(folder / "a.las", cube_cloud(300, -4000, 4000, 3));
    convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5"));
    bytes = bytes_of(folder / "a.h5");
    chunks = StoreReader(folder / "a.h5").chunks();
  }

  std::string bytes;
  ChunkIndexes chunks;
};

/// Sets the hashes of the chunks of a group to those of `bytes`.
void rehash_chunks(const std::filesystem::path& path, std::string_view bytes, const char* group,
                   const ChunkIndex& index) {
  std::vector<std::uint64_t> hashes = index.xxh64;
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    hashes[i] = xxh64(std::as_bytes(std::span(bytes.substr(index.address[i], index.bytes[i]))));
  }
  change_column(path, std::string(group) + "/xxh64", hashes);
}

/// A sound store whose hashes hold but whose numbers are arbitrary, so that nothing but the numbers
/// is wrong with it. The bytes are a list of edits.
void edit_store(Bytes input) {
  static const SoundStore sound;
  std::vector<Edit> edits;
  for (; input.size() >= Edit::kBytes && edits.size() < 8; input = input.subspan(Edit::kBytes)) {
    edits.emplace_back(input);
  }
  std::string bytes = sound.bytes;
  for (const Edit& edit : edits) {
    if (!edit.is_of_chunk()) continue;
    const ChunkIndex& index = sound.chunks[edit.where % 5 == 0 ? 1 : 0];
    const std::size_t chunk = edit.where % index.bytes.size();
    const std::size_t at = edit.where / index.bytes.size() % (index.bytes[chunk] - 8);
    std::memcpy(bytes.data() + index.address[chunk] + at, &edit.value, 8);
  }
  const MemoryFile file(bytes);
  if (bytes != sound.bytes) {
    rehash_chunks(file.path(), bytes, "cells", sound.chunks[0]);
    rehash_chunks(file.path(), bytes, "blocks", sound.chunks[1]);
  }
  // Facts come last, because the columns are listed among them.
  std::ranges::stable_sort(edits, {}, &Edit::what);
  for (const Edit& edit : edits) {
    if (edit.is_of_chunk()) continue;
    constexpr unsigned kColumns = std::size(Edit::kColumns);
    const char* name = edit.what < 2 * kColumns ? Edit::kColumns[edit.what % kColumns]
                                                : Edit::kFacts[edit.what - 2 * kColumns];
    const auto act = edit.what < kColumns       ? edit_column
                     : edit.what < 2 * kColumns ? resize_column
                                                : edit_fact;
    act(file.path(), name, edit);
  }
  may_refuse([&] { read_store(file.path()); });
}

enum JournalKind : std::uint8_t { kFirstPose = 1, kClearance = 2, kPayloads = 4, kProfile = 8 };

constexpr double kNever = 1e9;  // seconds
const JournalIdentity kIdentity{{"query", "any"}};

/// A cloud of three cells, the last of 22 points.
const MemoryCloud& cloud() {
  static const MemoryCloud cloud(cube_cloud(150, -4000, 4000, 3), kMillimetres, {64, 0});
  return cloud;
}

void write_payloads(const std::filesystem::path& path, Bytes bytes) {
  ::unlink(path.c_str());
  JournalWriter writer = JournalWriter::create(path, kIdentity, kNever);
  while (bytes.size() >= 2) {
    const std::size_t size = std::min(bytes[0] + std::size_t{256} * bytes[1], bytes.size() - 2);
    JournalRecord record;
    for (const std::uint8_t byte : bytes.subspan(2, size)) record.put(byte);
    writer.append(record);
    bytes = bytes.subspan(2 + size);
  }
}

/// What the answer says of each point and of each pose, after checks that it belongs to the cloud.
std::vector<std::array<double, 4>> checked(const SearchResult& answer, const Query& query) {
  std::vector<std::array<double, 4>> all;
  for (std::uint64_t slot = 0; slot < cloud().entry_count(); ++slot) {
    std::array<double, 4>& one = all.emplace_back();
    const bool hit = answer.hits.contains(slot);
    if (hit) one[0] = 1 + (query.first_pose ? answer.hits.first_pose(slot) : 0);
    require(one[0] <= static_cast<double>(query.poses.size()));
    const bool near = query.clearance > 0 && answer.clearances.at(slot).found();
    if (near) {
      const auto& clearance = answer.clearances.at(slot);
      one[1] = clearance.squared;
      one[2] = 1 + clearance.pose;
      require(clearance.squared >= 0 && clearance.pose < query.poses.size());
    }
    require(cloud().is_used(slot) || !(hit || near));
  }
  for (std::uint64_t pose = 0; pose < answer.profile.poses(); ++pose) {
    const ProfilePoint point = answer.profile.at(pose);
    if (!point.found()) continue;
    require(cloud().is_used(point.entry) && point.squared >= 0);
    require(cloud().source(point.entry) == point.source);
    all.push_back({static_cast<double>(pose), static_cast<double>(point.entry), point.squared});
  }
  return all;
}

SearchResult restored(const SearchJournal& journal, const Query& query) {
  SearchResult answer = empty_result(cloud(), query);
  if (query.profile > 0) journal.restore(answer.profile);
  return result_of(journal.rows(), cloud(), std::move(answer.profile));
}

/// Restores a journal that could be opened and continues from it; nothing of that may be refused.
void go_on(const std::filesystem::path& path, const JournalReader& read, SearchJournal& journal,
           const Query& query) {
  const auto before = checked(restored(journal, query), query);
  const CellRows none{.words = std::vector<std::uint64_t>(cloud().blocks_per_cell())};
  std::uint32_t open = 0;  // the first cell whose colliding points are not known
  while (open < cloud().cells().size() && journal.rows().answered(open, PointQuestion::kHits)) {
    ++open;
  }
  if (open == cloud().cells().size()) return;
  journal.rows().add(open, {{PointQuestion::kHits, none}});
  const JournalReader again(path);
  require(again.torn().empty() && again.records() == read.records() + 1);
  require(again.identity() == read.identity());
  const SearchJournal longer(path, kIdentity, &again, cloud(), query, kNever);
  require(longer.rows().answered(open, PointQuestion::kHits));
  require(checked(restored(longer, query), query) == before);
}

/// A journal: either it is refused, or what it says belongs to the cloud and the query, and a run
/// can continue from it. The first byte chooses query and kind: the bytes of a file, or payloads
/// (their size in two bytes before each) of records whose hashes are right.
void read_journal_bytes(Bytes input) {
  static const std::vector<Pose> poses(300);
  if (input.empty()) return;
  const std::uint8_t kind = input[0];
  const Bytes bytes = input.subspan(1);
  Query query;
  query.poses = poses;
  query.first_pose = (kind & kFirstPose) != 0;
  query.clearance = (kind & kClearance) != 0 ? 0.3 : 0;
  query.profile = (kind & kProfile) != 0 ? 0.3 : 0;
  const MemoryFile file(bytes);
  if ((kind & kPayloads) != 0) write_payloads(file.path(), bytes);
  std::optional<JournalReader> read;
  std::optional<SearchJournal> journal;
  may_refuse([&] {
    is_journal(file.path());
    read.emplace(file.path());
    if (!read->identity()) return;
    difference(*read->identity(), kIdentity);
    may_refuse([&] { answered_cells(*read); });
    journal.emplace(file.path(), kIdentity, &*read, cloud(), query, kNever);
  });
  if (journal) go_on(file.path(), *read, *journal, query);
}

const bool kAdded = add_targets({{"journal", read_journal_bytes},
                                 {"packed_chunk", read_chunk_bytes},
                                 {"result", read_result_bytes},
                                 {"store", read_store_bytes},
                                 {"store_values", edit_store}});

}  // namespace
