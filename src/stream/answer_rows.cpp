#include "stream/answer_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/query/body_numbers.hpp"

namespace clearway {
namespace {

/// The values that a question has of each point.
struct RowColumns {
  bool poses = false, distances = false, sources = false;
};

struct QuestionFacts {
  const char* name;
  bool (*is_asked)(const Query&);
  RowColumns columns = {};
  bool first_poses = false;  ///< whether its rows have poses where first poses are asked for
};

bool has_budget(const Query& query) { return query.has_budget(); }
bool ignores_points(const Query& query) { return query.ignores_points(); }

/// What is known of each question, in the order of PointQuestion.
constexpr std::array<QuestionFacts, kQuestions> kFacts{{
    {.name = "hits", .is_asked = [](const Query&) { return true; }, .first_poses = true},
    {"clearances",
     [](const Query& query) { return query.clearance > 0; },
     {.poses = true, .distances = true}},
    {"last", [](const Query& query) { return query.first_pose; }, {.poses = true}},
    {"certain", has_budget},
    {.name = "near", .is_asked = has_budget, .first_poses = true},
    {"below", [](const Query& query) { return has_floor(query); }},
    {"ignored", ignores_points},
    {"ignored_high", ignores_points},
    {"depths",
     [](const Query& query) { return query.depth; },
     {.distances = true, .sources = true}},
}};

RowColumns columns_of(const Query& query, PointQuestion question) {
  const QuestionFacts& facts = kFacts[index_of(question)];
  RowColumns columns = facts.columns;
  columns.poses = columns.poses || (facts.first_poses && query.first_pose);
  return columns;
}

template <typename Visit>
void for_each_asked(const Query& query, Visit visit) {
  for (std::size_t i = 0; i < kQuestions; ++i) {
    if (kFacts[i].is_asked(query)) visit(static_cast<PointQuestion>(i));
  }
}

std::uint64_t bytes_of(const CellRows& rows) {
  return rows.words.size() * (sizeof(std::uint64_t) + JournalRecord::kMostCountBytes) +
         JournalRecord::kMostCountBytes + rows.poses.size() * sizeof(std::uint32_t) +
         rows.distances.size() * sizeof(double) + rows.sources.size() * sizeof(std::uint64_t);
}

/// Puts the words that are not 0, each with its distance from the one before, then the columns.
void put_rows(JournalRecord& record, const CellRows& rows) {
  record.put_count(rows.words.size() -
                   static_cast<std::uint64_t>(std::ranges::count(rows.words, 0)));
  std::size_t next = 0;
  for (std::size_t block = 0; block < rows.words.size(); ++block) {
    if (rows.words[block] == 0) continue;
    record.put_count(block - next);
    record.put(rows.words[block]);
    next = block + 1;
  }
  record.put_bytes(std::as_bytes(std::span(rows.poses)));
  record.put_bytes(std::as_bytes(std::span(rows.distances)));
  record.put_bytes(std::as_bytes(std::span(rows.sources)));
}

template <typename Value>
void take_column(JournalPayload& payload, bool has, std::uint64_t count,
                 std::vector<Value>& column) {
  if (!has || count == 0) return;
  const std::span<const std::byte> bytes = payload.take_bytes(count * sizeof(Value));
  column.resize(count);
  std::memcpy(column.data(), bytes.data(), bytes.size());
}

/// Whether a depth is a distance and a source, or neither of the two.
bool is_depth(double distance, std::uint64_t source) {
  if (std::isnan(distance)) return source == Depth::kNoPoint;
  return distance >= 0 && std::isfinite(distance) && source != Depth::kNoPoint;
}

/// Takes the bits of a block of a cell. Refuses none, and points that the cell does not have.
std::uint64_t take_points(JournalPayload& payload, const Cell& cell, std::uint64_t block) {
  const auto bits = payload.take<std::uint64_t>();
  const std::uint64_t first = block * kBlockPoints;
  const std::uint64_t points = cell.count > first ? cell.count - first : 0;
  if (bits == 0 || (points < kBlockPoints && bits >> points != 0)) {
    payload.refuse("points that the store does not have");
  }
  return bits;
}

}  // namespace

bool is_square(const Query& query, double squared) {
  return std::isfinite(squared) && (squared >= 0 || has_solids(query));
}

std::vector<PointQuestion> questions_in(JournalPayload& payload) {
  const std::uint64_t count = payload.take_count();
  if (count > kQuestions) payload.refuse("more questions than there are");
  std::vector<PointQuestion> questions;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto question = payload.take<std::uint8_t>();
    if (question >= kQuestions) payload.refuse("a question that is unknown");
    questions.push_back(static_cast<PointQuestion>(question));
  }
  return questions;
}

const char* name_of(PointQuestion question) { return kFacts[index_of(question)].name; }

CellRows hit_rows(const PackedCloud& cloud, const PageResult& page, std::size_t index) {
  const auto hits = part_of_cell(page.hits, index, cloud.blocks_per_cell());
  const auto first_poses = part_of_cell(page.first_poses, index, cloud.cell_entries());
  CellRows rows{.words = {hits.begin(), hits.end()}};
  if (first_poses.empty()) return rows;
  rows.poses.reserve(rows.count());
  rows.for_each(
      [&](std::uint32_t point, std::size_t) { rows.poses.push_back(first_poses[point]); });
  return rows;
}

CellRows clearance_rows(const PackedCloud& cloud, const PageResult& page, std::size_t index) {
  const auto clearances = part_of_cell(page.clearances, index, cloud.cell_entries());
  CellRows rows{.words = std::vector<std::uint64_t>(clearances.size() / kBlockPoints)};
  for (std::size_t i = 0; i < clearances.size(); ++i) {
    if (clearances[i].found()) rows.words[i / kBlockPoints] |= std::uint64_t{1} << i % kBlockPoints;
  }
  const std::uint64_t count = rows.count();
  rows.poses.reserve(count);
  rows.distances.reserve(count);
  rows.for_each([&](std::uint32_t point, std::size_t) {
    rows.poses.push_back(clearances[point].pose);
    rows.distances.push_back(clearances[point].squared);
  });
  return rows;
}

CellRows without(const CellRows& rows, const CellRows& others) {
  std::vector<std::uint32_t> poses;
  CellRows out = points_where(rows, [&](std::uint32_t point, std::size_t row) {
    const bool is_left = !others.contains(point);
    if (is_left && !rows.poses.empty()) poses.push_back(rows.poses[row]);
    return is_left;
  });
  out.poses = std::move(poses);
  return out;
}

std::uint64_t RowsInMemory::keep(JournalRecord& record) {
  const std::span<const std::byte> payload = record.payload();
  const std::lock_guard lock(mutex_);
  const std::uint64_t bytes = bytes_ + payload.size() + sizeof(records_[0]);
  if (grow_) grow_(bytes);
  records_.emplace_back(payload.begin(), payload.end());
  bytes_ = bytes;
  record.clear();
  return kNoRows + records_.size();
}

JournalPayload RowsInMemory::read(std::uint64_t place, std::vector<std::byte>&) const {
  const std::lock_guard lock(mutex_);
  return {records_[place - kNoRows - 1], "rows in memory"};  // which no further record moves
}

std::uint64_t RowsInMemory::allocated_bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

AnswerRows::AnswerRows(const PackedCloud& cloud, const Query& query, RowStorage& storage)
    : cloud_(cloud),
      query_(query),
      storage_(storage),
      pose_end_(static_cast<std::uint32_t>(BodyNumbers(query).end(query.poses.size()))) {
  for_each_asked(query, [&](PointQuestion question) {
    places_[index_of(question)].resize(cloud.cells().size());
  });
}

void AnswerRows::add(std::uint32_t cell, const std::vector<Part>& parts) {
  JournalRecord record;
  std::uint64_t bytes = 1 + 2 * JournalRecord::kMostCountBytes;
  for (const Part& part : parts) bytes += 1 + bytes_of(part.rows);
  record.reserve(bytes);
  record.put(JournalRecordKind::kCell);
  record.put_count(parts.size());
  for (const Part& part : parts) record.put(part.question);
  record.put_count(cell);
  for (const Part& part : parts) put_rows(record, part.rows);
  const std::uint64_t place = storage_.keep(record);
  for (const Part& part : parts) set_place(cell, part.question, part.rows.count(), place);
}

void AnswerRows::set_place(std::uint32_t cell, PointQuestion question, std::uint64_t points,
                           std::uint64_t place) {
  std::uint64_t& known = places_[index_of(question)][cell];
  if (known != RowStorage::kUnanswered) return;
  known = points > 0 ? place : RowStorage::kNoRows;
  points_[index_of(question)] += points;
}

std::vector<PointQuestion> AnswerRows::take_questions(JournalPayload& payload) const {
  if (payload.take<JournalRecordKind>() != JournalRecordKind::kCell) {
    payload.refuse("is not of a cell");
  }
  std::vector<PointQuestion> questions = questions_in(payload);
  for (const PointQuestion question : questions) {
    if (!asks(question)) payload.refuse("a question that was not asked");
  }
  return questions;
}

std::uint32_t AnswerRows::take_cell(JournalPayload& payload) const {
  const std::uint64_t cell = payload.take_count();
  if (cell >= cloud_.cells().size()) payload.refuse("a cell that the store does not have");
  return static_cast<std::uint32_t>(cell);
}

CellRows AnswerRows::take_rows(JournalPayload& payload, std::uint32_t cell,
                               PointQuestion question) const {
  CellRows rows;
  for (std::uint64_t words = payload.take_count(); words > 0; --words) {
    const std::uint64_t skipped = payload.take_count();
    const std::uint64_t next = rows.words.size();
    if (skipped >= cloud_.blocks_per_cell() - next) payload.refuse("a block past its cell's end");
    const std::uint64_t bits = take_points(payload, cloud_.cells()[cell], next + skipped);
    rows.words.resize(next + skipped);
    rows.words.push_back(bits);
  }
  const RowColumns columns = columns_of(query_, question);
  const std::uint64_t count = rows.count();
  take_column(payload, columns.poses, count, rows.poses);
  take_column(payload, columns.distances, count, rows.distances);
  take_column(payload, columns.sources, count, rows.sources);
  if (std::ranges::any_of(rows.poses, [&](std::uint32_t pose) { return pose >= pose_end_; })) {
    payload.refuse("a pose past the trajectory's end");
  }
  for (std::size_t i = 0; i < rows.distances.size(); ++i) {
    const double distance = rows.distances[i];
    if (!(columns.sources ? is_depth(distance, rows.sources[i]) : is_square(query_, distance))) {
      payload.refuse("a distance that is none");
    }
  }
  return rows;
}

void AnswerRows::note(JournalPayload payload, std::uint64_t place) {
  const std::vector<PointQuestion> questions = take_questions(payload);
  const std::uint32_t cell = take_cell(payload);
  for (const PointQuestion question : questions) {
    set_place(cell, question, take_rows(payload, cell, question).count(), place);
  }
  if (!payload.at_end()) payload.refuse("longer than what it holds");
}

CellRows AnswerRows::read(std::uint32_t cell, PointQuestion question) const {
  if (!asks(question) || places_of(question)[cell] <= RowStorage::kNoRows) return {};
  std::vector<std::byte> bytes;
  JournalPayload payload = storage_.read(places_of(question)[cell], bytes);
  const std::vector<PointQuestion> questions = take_questions(payload);
  if (take_cell(payload) != cell) payload.refuse("of another cell than it was");
  for (const PointQuestion found : questions) {
    CellRows rows = take_rows(payload, cell, found);
    if (found == question) return rows;
  }
  payload.refuse("without the question that it answered");
}

std::vector<std::uint32_t> AnswerRows::cells(PointQuestion question) const {
  std::vector<std::uint32_t> cells;
  const std::vector<std::uint64_t>& places = places_of(question);
  for (std::uint32_t cell = 0; cell < places.size(); ++cell) {
    if (places[cell] > RowStorage::kNoRows) cells.push_back(cell);
  }
  return cells;
}

std::uint64_t AnswerRows::bytes(const PackedCloud& cloud, const Query& query) {
  std::uint64_t bytes = 0;
  for_each_asked(query,
                 [&](PointQuestion) { bytes += cloud.cells().size() * sizeof(std::uint64_t); });
  return bytes;
}

std::uint64_t AnswerRows::most_cell_bytes(const PackedCloud& cloud, const Query& query) {
  const std::uint64_t words =
      cloud.blocks_per_cell() * (2 * sizeof(std::uint64_t) + JournalRecord::kMostCountBytes);
  std::uint64_t bytes = 0;
  for_each_asked(query, [&](PointQuestion question) {
    const RowColumns columns = columns_of(query, question);
    const std::uint64_t values = (columns.poses ? sizeof(std::uint32_t) : 0) +
                                 (columns.distances ? sizeof(double) : 0) +
                                 (columns.sources ? sizeof(std::uint64_t) : 0);
    bytes += words + 2 * cloud.cell_entries() * values;
  });
  return bytes + 256;
}

}  // namespace clearway
