// Any bytes as a journal: either it is refused, or what it says belongs to the cloud and the query,
// and a run can continue from it. The first byte chooses query and kind: the bytes of a file, or
// payloads (their size in two bytes before each) of records whose hashes are right.
#include "io/result/journal.hpp"

#include <cstring>
#include <optional>

#include "memory_file.hpp"
#include "stream/search_journal.hpp"
#include "support/clouds.hpp"
#include "support/engines/answer_sets.hpp"
#include "support/memory_cloud.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

enum Kind : std::uint8_t { kFirstPose = 1, kClearance = 2, kPayloads = 4, kProfile = 8 };

constexpr double kNever = 1e9;  // seconds
const JournalIdentity kIdentity{{"query", "any"}};

/// A cloud of three cells, the last of 22 points.
const MemoryCloud& cloud() {
  static const MemoryCloud cloud(cube_cloud(150, -4000, 4000, 3), kMillimetres, {64, 0});
  return cloud;
}

Query query_of(std::uint8_t kind) {
  static const std::vector<Pose> poses(300);
  Query query;
  query.poses = poses;
  query.first_pose = (kind & kFirstPose) != 0;
  query.clearance = (kind & kClearance) != 0 ? 0.3 : 0;
  query.profile = (kind & kProfile) != 0 ? 0.3 : 0;
  return query;
}

void write_payloads(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  ::unlink(path.c_str());
  JournalWriter writer = JournalWriter::create(path, kIdentity, kNever);
  while (bytes.size() >= 2) {
    std::uint16_t size;
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes = bytes.subspan(sizeof size);
    JournalRecord record;
    for (const std::uint8_t byte : bytes.first(std::min<std::size_t>(size, bytes.size()))) {
      record.put(byte);
    }
    bytes = bytes.subspan(std::min<std::size_t>(size, bytes.size()));
    writer.append(record);
  }
}

void require(bool condition) {
  if (!condition) std::abort();
}

void check_result(const SearchResult& answer, const Query& query) {
  for (std::uint64_t slot = 0; slot < cloud().entry_count(); ++slot) {
    if (answer.hits.contains(slot)) {
      require(cloud().is_used(slot));
      if (query.first_pose) require(answer.hits.first_pose(slot) < query.poses.size());
    }
    if (query.clearance > 0 && answer.clearances.at(slot).found()) {
      require(cloud().is_used(slot) && answer.clearances.at(slot).squared >= 0);
      require(answer.clearances.at(slot).pose < query.poses.size());
    }
  }
  for (std::uint64_t pose = 0; pose < answer.profile.poses(); ++pose) {
    const ProfilePoint point = answer.profile.at(pose);
    if (!point.found()) continue;
    require(cloud().is_used(point.entry) && point.squared >= 0);
    require(cloud().source(point.entry) == point.source);
  }
}

bool same(const SearchResult& a, const SearchResult& b, const Query& query) {
  for (std::uint64_t slot = 0; slot < cloud().entry_count(); ++slot) {
    if (a.hits.contains(slot) != b.hits.contains(slot)) return false;
    if (query.first_pose && a.hits.first_pose(slot) != b.hits.first_pose(slot)) return false;
    if (query.clearance > 0 && a.clearances.at(slot) != b.clearances.at(slot)) return false;
  }
  for (std::uint64_t pose = 0; pose < a.profile.poses(); ++pose) {
    if (a.profile.at(pose) != b.profile.at(pose)) return false;
  }
  return true;
}

SearchResult restored(const SearchJournal& journal, const Query& query) {
  SearchResult answer = empty_result(cloud(), query);
  if (query.profile > 0) journal.restore(answer.profile);
  return result_of(journal.rows(), cloud(), std::move(answer.profile));
}

/// The first cell whose colliding points are not known; their number if all are.
std::uint32_t first_unanswered(SearchJournal& journal) {
  std::uint32_t cell = 0;
  while (cell < cloud().cells().size() && journal.rows().answered(cell, PointQuestion::kHits)) {
    ++cell;
  }
  return cell;
}

/// Restores a journal that could be opened and continues from it; nothing of that may be refused.
void go_on(const std::filesystem::path& path, const JournalReader& read, SearchJournal& journal,
           const Query& query) {
  const SearchResult before = restored(journal, query);
  check_result(before, query);
  const CellRows none{.words = std::vector<std::uint64_t>(cloud().blocks_per_cell())};
  const std::uint32_t open = first_unanswered(journal);
  if (open == cloud().cells().size()) return;
  journal.rows().add(open, {{PointQuestion::kHits, none}});
  const JournalReader again(path);
  require(again.torn().empty() && again.records() == read.records() + 1);
  require(again.identity() == read.identity());
  const SearchJournal longer(path, kIdentity, &again, cloud(), query, kNever);
  require(longer.rows().answered(open, PointQuestion::kHits));
  require(same(restored(longer, query), before, query));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::uint8_t kind = data[0];
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const Query query = query_of(kind);
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
  return 0;
}
