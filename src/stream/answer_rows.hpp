#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "clearway/seen.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/search_result.hpp"
#include "core/seen/cross_sections.hpp"
#include "core/util/lane_bits.hpp"
#include "io/result/journal.hpp"

namespace clearway {

/// A question that a search asks of the points of each cell (docs/design/pipeline.md, "Rows").
enum class PointQuestion : std::uint8_t {
  kHits,         ///< which points collide, with their first poses where these are asked for
  kClearances,   ///< which are below the clearance asked for, with their least squared distances
  kLast,         ///< of the points that collide: their first poses in reverse order of the poses
  kCertain,      ///< of the points that collide: those that are certainly too close
  kNear,         ///< which do not collide but may be too close, with first poses where asked for
  kBelow,        ///< which would collide without floors and are not judged
  kIgnored,      ///< which of the ignored points would collide
  kIgnoredHigh,  ///< those of them that are first touched high above the model's lowest point
  kDepths        ///< of the points that collide: the nearest free point, and its distance
};
inline constexpr std::size_t kQuestions = 9;
/// The number of a question, below kQuestions.
constexpr std::size_t index_of(PointQuestion question) {
  return static_cast<std::size_t>(question);
}

/// The name of a question, such as "hits".
const char* name_of(PointQuestion question);

/// The kind of a record in a search's journal; its first byte.
enum class JournalRecordKind : std::uint8_t { kCell = 1, kProfile = 2 };

/// Whether this can be the square of a distance, which is below 0 for a point inside solids.
bool is_square(const Query& query, double squared);

/// Takes the questions that the record of a cell answers, which stand after its kind.
std::vector<PointQuestion> questions_in(JournalPayload& payload);

/// Points of one cell, and values of each of them in the order of the points. A column that the
/// question does not have is empty.
struct CellRows {
  std::vector<std::uint64_t> words = {};  ///< bit i of word w is point 64 w + i
  std::vector<std::uint32_t> poses = {};  ///< encoded as BodyNumbers does
  std::vector<double> distances = {};     ///< squared, except those of depths
  std::vector<std::uint64_t> sources = {};

  std::uint64_t count() const {
    std::uint64_t points = 0;
    for (const std::uint64_t word : words) points += static_cast<unsigned>(std::popcount(word));
    return points;
  }
  /// The points of a block as bits.
  std::uint64_t word(std::size_t block) const { return block < words.size() ? words[block] : 0; }

  bool contains(std::uint32_t point) const {
    return (word(point / kBlockPoints) >> point % kBlockPoints & 1) != 0;
  }

  /// Calls visit(point, row) for each point, in order.
  template <typename Visit>
  void for_each(Visit visit) const {
    std::size_t row = 0;
    for (std::size_t block = 0; block < words.size(); ++block) {
      for_each_bit(words[block], [&](std::uint32_t bit) {
        visit(static_cast<std::uint32_t>(block * kBlockPoints + bit), row++);
      });
    }
  }
};

/// The points that collide in cell `index` of a page, with their first poses where it has these.
CellRows hit_rows(const PackedCloud& cloud, const PageResult& page, std::size_t index);
/// The points that have a clearance in cell `index` of a page.
CellRows clearance_rows(const PackedCloud& cloud, const PageResult& page, std::size_t index);
/// The rows whose points `others` does not have, with their poses alone.
CellRows without(const CellRows& rows, const CellRows& others);
/// The points for which keep(point, row) is true, without their values.
template <typename Keep>
CellRows points_where(const CellRows& rows, Keep keep) {
  CellRows out{.words = std::vector<std::uint64_t>(rows.words.size())};
  rows.for_each([&](std::uint32_t point, std::size_t row) {
    if (keep(point, row))
      out.words[point / kBlockPoints] |= std::uint64_t{1} << point % kBlockPoints;
  });
  return out;
}

/// Finds the rows of points that are asked for in ascending order.
class RowFinder {
 public:
  explicit RowFinder(CellRows rows) : rows_(std::move(rows)), before_(rows_.words.size() + 1) {
    for (std::size_t block = 0; block < rows_.words.size(); ++block) {
      before_[block + 1] =
          before_[block] + static_cast<std::uint32_t>(std::popcount(rows_.words[block]));
    }
  }
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  const CellRows& rows() const { return rows_; }
  /// The row of a point, or kNone.
  std::size_t row_of(std::uint32_t point) const {
    const std::uint64_t word = rows_.word(point / kBlockPoints);
    const std::uint64_t bit = std::uint64_t{1} << point % kBlockPoints;
    if ((word & bit) == 0) return kNone;
    return before_[point / kBlockPoints] + static_cast<unsigned>(std::popcount(word & (bit - 1)));
  }

 private:
  CellRows rows_;
  std::vector<std::uint32_t> before_;  ///< number of rows before each block
};

/// Where records of rows are kept.
class RowStorage {
 public:
  virtual ~RowStorage() = default;
  /// Keeps a record, which is empty afterwards, and returns its place, which is above kNoRows.
  /// Thread safe.
  virtual std::uint64_t keep(JournalRecord& record) = 0;
  /// The payload of a record that was kept; it may be in `bytes`. Thread safe.
  virtual JournalPayload read(std::uint64_t place, std::vector<std::byte>& bytes) const = 0;

  /// Places that no record has.
  static constexpr std::uint64_t kUnanswered = 0, kNoRows = 1;
};

/// Keeps records in memory.
class RowsInMemory final : public RowStorage {
 public:
  /// grow: called before more memory is taken, with the bytes that are then taken in all; what it
  /// throws leaves keep(). None: takes what it needs.
  explicit RowsInMemory(std::function<void(std::uint64_t bytes)> grow = nullptr)
      : grow_(std::move(grow)) {}

  std::uint64_t keep(JournalRecord& record) override;
  JournalPayload read(std::uint64_t place, std::vector<std::byte>& bytes) const override;
  std::uint64_t allocated_bytes() const;

 private:
  const std::function<void(std::uint64_t)> grow_;
  mutable std::mutex mutex_;
  std::deque<std::vector<std::byte>> records_;
  std::uint64_t bytes_ = 0;
};

/// What a search has found, cell by cell and question by question, wherever it is kept: knows for
/// each cell and question where its record is. Different cells may be added at the same time.
class AnswerRows {
 public:
  /// A question and what was found.
  struct Part {
    PointQuestion question;
    CellRows rows;
  };

  /// All outlive it.
  AnswerRows(const PackedCloud& cloud, const Query& query, RowStorage& storage);

  /// Keeps what was found in a cell in one record. A cell without rows is finished too.
  void add(std::uint32_t cell, const std::vector<Part>& parts);
  /// Notes a record that the storage has at `place`, and checks all of it. Throws InputError where
  /// it is not of this cloud and query.
  void note(JournalPayload payload, std::uint64_t place);

  /// Whether the question has been answered for the cell.
  bool answered(std::uint32_t cell, PointQuestion question) const {
    return places_of(question)[cell] != RowStorage::kUnanswered;
  }
  /// What was found in a cell; nothing where the question was not asked. Throws InputError where
  /// the record is damaged.
  CellRows read(std::uint32_t cell, PointQuestion question) const;

  /// Number of points that a question has found in all cells.
  std::uint64_t points(PointQuestion question) const { return points_[index_of(question)]; }
  /// The cells in which a question has found any, ascending.
  std::vector<std::uint32_t> cells(PointQuestion question) const;
  const Query& query() const { return query_; }
  bool asks(PointQuestion question) const { return !places_of(question).empty(); }

  /// Memory for the places of records, bytes.
  static std::uint64_t bytes(const PackedCloud& cloud, const Query& query);
  /// Greatest memory of the rows of one cell with all values of one question, and the bytes of
  /// their record.
  static std::uint64_t most_cell_bytes(const PackedCloud& cloud, const Query& query);

 private:
  const std::vector<std::uint64_t>& places_of(PointQuestion question) const {
    return places_[index_of(question)];
  }
  void set_place(std::uint32_t cell, PointQuestion question, std::uint64_t points,
                 std::uint64_t place);
  CellRows take_rows(JournalPayload& payload, std::uint32_t cell, PointQuestion question) const;
  std::vector<PointQuestion> take_questions(JournalPayload& payload) const;
  std::uint32_t take_cell(JournalPayload& payload) const;

  const PackedCloud& cloud_;
  const Query& query_;
  RowStorage& storage_;
  const std::uint32_t pose_end_;  ///< end of the numbers of poses and bodies
  /// For each question the place of the record of each cell. A question that is not asked has none.
  std::array<std::vector<std::uint64_t>, kQuestions> places_;
  std::array<std::atomic<std::uint64_t>, kQuestions> points_{};
};

/// What a search has found, as it is written.
struct FoundAnswer {
  const AnswerRows* rows = nullptr;
  ProfileSet profile = {};  ///< no poses unless asked for
  /// Set after a search for seen space, if that was asked for
  std::optional<UnseenCubes> unseen = {};
  SweptCells swept = {};  ///< of the same search
};

}  // namespace clearway
