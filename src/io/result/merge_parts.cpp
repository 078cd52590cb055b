#include "io/result/merge_parts.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/answer.hpp"
#include "io/result/check_results.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

const Shard& shard_of(const ResultReader& part) { return part.header().part->shard; }

std::string part_text(const ResultReader& part) { return in_words(shard_of(part)); }

ResultReader open_part(const std::filesystem::path& file) {
  ResultReader part(file, Parts::kAccepted);
  if (!part.header().part) {
    refuse(part.name(), "is a whole result; expected a part, as clearway run --shard writes it");
  }
  return part;
}

/// Why two files are not parts of one result; empty where they are.
std::string difference_of(const ResultReader& part, const ResultReader& other) {
  const ResultHeader &a = part.header(), &b = other.header();
  if (a.part->shard.count != b.part->shard.count) {
    return "is " + part_text(part) + ", but " + other.name() + " is " + part_text(other);
  }
  if (environment_text(a) != environment_text(b)) {
    return "is of another environment than " + other.name() + ": " + environment_text(a) +
           ", not " + environment_text(b);
  }
  const auto differences = query_differences(a, b);
  if (!differences.empty()) {
    const QueryDifference& first = differences.front();
    return "answers another question than " + other.name() + ": " + first.what + " is " + first.a +
           ", not " + first.b;
  }
  if (a.question() != b.question()) return "answers another question than " + other.name();
  if (a.part->division != b.part->division) {
    return "divides the work otherwise than " + other.name() +
           ": the stores differ, or the versions of clearway; run the parts with the same";
  }
  return "";
}

/// Numbers in words: "2" or "2, 5-7", with "..." after many.
std::string numbers_text(const std::vector<std::uint32_t>& numbers) {
  constexpr std::size_t kMostRanges = 10;
  const std::vector<std::string> ranges = number_ranges(numbers);
  std::string text;
  for (std::size_t i = 0; i < std::min(ranges.size(), kMostRanges); ++i) {
    text += (i == 0 ? "" : ", ") + ranges[i];
  }
  return ranges.size() > kMostRanges ? text + ", ..." : text;
}

void refuse_missing(const std::vector<ResultReader>& parts) {
  const std::uint32_t count = shard_of(parts.front()).count;
  std::vector<std::uint32_t> missing;
  auto part = parts.begin();
  for (std::uint32_t number = 1; number <= count; ++number) {
    if (part != parts.end() && shard_of(*part).number == number) {
      ++part;
    } else {
      missing.push_back(number);
    }
  }
  if (missing.empty()) return;
  throw InputError((missing.size() == 1 ? "part " : "parts ") + numbers_text(missing) + " of " +
                   std::to_string(count) + (missing.size() == 1 ? " is missing" : " are missing") +
                   "; " + parts.front().name() + " is " + part_text(parts.front()));
}

}  // namespace

PartSet::PartSet(const std::vector<std::filesystem::path>& files) {
  if (files.empty()) throw UsageError("no parts to merge");
  require_open_files(files.size(), "to merge " + std::to_string(files.size()) + " parts");
  for (const std::filesystem::path& file : files) {
    parts_.push_back(open_part(file));
    const std::string differs = difference_of(parts_.back(), parts_.front());
    if (!differs.empty()) refuse(parts_.back().name(), differs);
  }
  std::ranges::stable_sort(parts_, {},
                           [](const ResultReader& part) { return shard_of(part).number; });
  const auto twice = std::ranges::adjacent_find(
      parts_, {}, [](const ResultReader& part) { return shard_of(part).number; });
  if (twice != parts_.end()) {
    const std::string& name = (twice + 1)->name();
    const std::string once = "; give each part once";
    if (name == twice->name()) refuse(name, "is given twice" + once);
    refuse(name, "is " + part_text(*twice) + ", and so is " + twice->name() + once);
  }
  refuse_missing(parts_);
  header_ = parts_.front().header();
  header_.part.reset();
  for (const ResultReader& part : parts_) {
    double& metres = header_.notes.model_spacing;
    metres = std::max(metres, part.header().notes.model_spacing);
  }
}

std::vector<PartWarning> PartSet::warnings() const {
  std::vector<PartWarning> all;
  for (const ResultReader& part : parts_) {
    std::vector<Message> of_part;  // each once
    add_warnings(part.findings().warnings, of_part);
    for (const Message& warning : of_part) {
      auto known = std::ranges::find_if(
          all, [&](const PartWarning& other) { return say_the_same(warning, other); });
      if (known == all.end()) known = all.insert(all.end(), PartWarning{warning, 0});
      unite_stretches(warning, *known);
      ++known->parts;
    }
  }
  return all;
}

std::uint64_t PartSet::collisions() const {
  std::uint64_t rows = 0;
  for (const ResultReader& part : parts_) rows += part.collisions();
  return rows;
}

std::uint64_t PartSet::near() const {
  std::uint64_t rows = 0;
  for (const ResultReader& part : parts_) rows += part.near();
  return rows;
}

std::uint64_t PartSet::clearances() const {
  std::uint64_t rows = 0;
  for (const ResultReader& part : parts_) rows += part.clearances();
  return rows;
}

ResultFindings PartSet::findings() const {
  ResultFindings out;
  for (const ResultReader& part : parts_) {
    add_warnings(part.findings().warnings, out.warnings);
    if (!out.scanned.known()) out.scanned = part.findings().scanned;
    out.withheld_points = part.findings().withheld_points;  // the same of each part
    if (!out.searched) out.searched = part.findings().searched;
    if (out.without_bodies.empty()) out.without_bodies = part.findings().without_bodies;
    if (const auto& below = part.findings().floor_colliding) {
      out.floor_colliding = out.floor_colliding.value_or(0) + *below;
    }
    out.ignored_colliding += part.findings().ignored_colliding;
    out.ignored_colliding_high += part.findings().ignored_colliding_high;
  }
  return out;
}

Answer PartSet::answer() const {
  Answer answer = answer_of(header_);
  add_findings(findings(), answer);
  answer.colliding_points = collisions();
  answer.near_points = near();
  answer.clearance_points = clearances();
  return answer;
}

namespace {

/// Bytes of the program, of the rows that the writer buffers, and of chunks that threads check.
constexpr std::uint64_t kFixedBytes = std::uint64_t{32} << 20;
/// Bytes of an open file: its metadata in HDF5.
constexpr std::uint64_t kFileBytes = std::uint64_t{512} << 10;
constexpr std::size_t kLeastRows = 1 << 10;

/// Bytes of the values of a row, with all columns.
template <typename Rows>
std::uint64_t row_bytes() {
  std::uint64_t bytes = 0;
  for_each_column<Rows>(
      [&](const auto& column) { bytes += sizeof(typename std::decay_t<decltype(column)>::Value); });
  return bytes;
}

std::uint64_t needed_bytes(const PartSet& set, std::size_t batch_rows) {
  std::uint64_t bytes = kFixedBytes + 4 * batch_rows * row_bytes<ProfileRows>();
  const std::uint64_t point_bytes = std::max(row_bytes<Collisions>(), row_bytes<Clearances>());
  std::uint64_t space_bytes = 0;
  for (const ResultReader& part : set.parts()) {
    const std::uint64_t rows = std::max({part.collisions(), part.clearances(), part.near()});
    bytes += kFileBytes + std::min<std::uint64_t>(batch_rows, rows) * point_bytes;
    space_bytes = std::max(space_bytes, part.rows<UnseenCubes>() * row_bytes<UnseenCubes>() +
                                            part.rows<SweptCells>() * row_bytes<SweptCells>());
  }
  // The cubes of all parts so far, those of one more, and what both have in common.
  return bytes + 3 * space_bytes;
}

/// Number of rows of each part that merging holds at once, a power of two, chosen so that it takes
/// at most `memory_bytes`. Throws ResourceError where even the fewest rows are too many.
std::size_t batch_rows_of(const PartSet& set, std::uint64_t memory_bytes) {
  for (std::size_t rows = kBatchRows; rows >= kLeastRows; rows /= 2) {
    if (needed_bytes(set, rows) <= memory_bytes) return rows;
  }
  const std::uint64_t needed = needed_bytes(set, kLeastRows);
  throw ResourceError(format_size(memory_bytes) + " of memory is too little: to merge " +
                          std::to_string(set.parts().size()) + " parts needs " +
                          format_size(needed),
                      Remedy::kMoreMemory, static_cast<double>(needed));
}

/// Number of rows that are given to the writer at once.
constexpr std::size_t kRows = 1 << 12;

/// Calls visit(cursor) for every row of all cursors, ascending by source.
template <typename Cursor, typename Visit>
void for_each_row(const PartSet& set, std::deque<Cursor>& cursors, Visit visit) {
  using Head = std::pair<std::uint64_t, std::size_t>;  // source and part
  std::priority_queue<Head, std::vector<Head>, std::greater<>> heads;
  for (std::size_t part = 0; part < cursors.size(); ++part) {
    if (!cursors[part].at_end()) heads.emplace(cursors[part].source(), part);
  }
  while (!heads.empty()) {
    const auto [source, part] = heads.top();
    heads.pop();
    if (!heads.empty() && heads.top().first == source) {
      refuse(set.parts()[heads.top().second].name(), "has source point " + std::to_string(source) +
                                                         ", as " + set.parts()[part].name() +
                                                         " has; they are no parts of one result");
    }
    const std::uint64_t next =
        heads.empty() ? std::numeric_limits<std::uint64_t>::max() : heads.top().first;
    Cursor& cursor = cursors[part];
    do {
      visit(cursor);
      cursor.advance();
    } while (!cursor.at_end() && cursor.source() < next);
    if (!cursor.at_end()) heads.emplace(cursor.source(), part);
  }
}

class PartMerge {
 public:
  PartMerge(const PartSet& set, const std::optional<MergedSpace>& space,
            const std::filesystem::path& path, std::size_t batch_rows,
            const ResultFindings& findings, Progress& progress, TableSummary& summary)
      : set_(set),
        space_(space),
        findings_(findings),
        batch_rows_(batch_rows),
        progress_(progress),
        summary_(summary),
        writer_(path, set.header(), set.collisions(), set.clearances(), set.near(),
                space ? space->unseen.size() : 0, space ? space->swept.size() : 0) {}

  void run() {
    summary_ = {};
    progress_.begin("merge", set_.collisions() + set_.clearances() + set_.near(), "points");
    merge_points<Collisions>();
    if (Table<Clearances>::is_in(set_.header())) merge_points<Clearances>();
    if (Table<ProfileRows>::is_in(set_.header())) merge_profile();
    if (Table<Nearby>::is_in(set_.header())) merge_points<Nearby>();
    if (space_) {
      writer_.append(space_->unseen);
      writer_.append(space_->swept);
    }
    writer_.finish(findings_);
    progress_.end();
  }

 private:
  /// Merges a table of points, of which each is in one part.
  template <typename Rows>
  void merge_points() {
    std::deque<RowCursor<Rows>> cursors;
    for (const ResultReader& part : set_.parts()) cursors.emplace_back(part, batch_rows_);
    Rows rows;
    const auto flush = [&] {
      throw_if_stopped(progress_);
      writer_.append(rows);
      summarise(rows, summary_);
      progress_.advance(rows.size());
      clear_rows(rows);
    };
    for_each_row(set_, cursors, [&](const RowCursor<Rows>& row) {
      append_row(set_.header(), row.rows(), row.index(), rows);
      if (rows.size() == kRows) flush();
    });
    flush();
  }

  /// Merges the profiles: for each pose the part with the least squared distance, and of several
  /// the one with the smallest source.
  void merge_profile() {
    std::deque<RowStream<ProfileRows>> streams;
    for (const ResultReader& part : set_.parts()) streams.emplace_back(part, batch_rows_);
    std::uint64_t first = 0;
    for (ProfileRows best, rows; streams.front().read(best); first += best.size()) {
      for (std::size_t part = 1; part < streams.size(); ++part) {
        streams[part].read(rows);
        if (rows.chainage != best.chainage) {
          refuse(set_.parts()[part].name(),
                 "/profile/chainage differs from that of " + set_.parts().front().name());
        }
        keep_nearer(rows, best);
      }
      best.squared.clear();  // only parts have them
      writer_.append(best);
      summarise(best, summary_, first);
      throw_if_stopped(progress_);
    }
  }

  static void keep_nearer(const ProfileRows& rows, ProfileRows& best) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const bool nearer = rows.squared[i] < best.squared[i] ||
                          (rows.squared[i] == best.squared[i] && rows.source[i] < best.source[i]);
      if (!nearer) continue;
      for_each_column<ProfileRows>([&](const auto& column) {
        const auto& values = rows.*column.values;
        if (!values.empty()) (best.*column.values)[i] = values[i];
      });
    }
  }

  const PartSet& set_;
  const std::optional<MergedSpace>& space_;
  const ResultFindings& findings_;
  const std::size_t batch_rows_;
  Progress& progress_;
  TableSummary& summary_;
  ResultWriter writer_;
};

}  // namespace

void check_merge_memory(const PartSet& set, std::uint64_t memory_bytes) {
  batch_rows_of(set, memory_bytes);
}

void merge_parts(const PartSet& set, const std::optional<MergedSpace>& space,
                 const std::filesystem::path& path, std::uint64_t memory_bytes,
                 const ResultFindings& findings, Progress& progress, TableSummary& summary) {
  PartMerge(set, space, path, batch_rows_of(set, memory_bytes), findings, progress, summary).run();
}

}  // namespace clearway
