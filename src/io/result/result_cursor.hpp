#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "io/result/result_rows.hpp"

namespace clearway {

/// Steps through the rows of a result, ascending by source. The reader must outlive the cursor.
/// Functions throw as the row streams do; all but at_end() may be called only before the end.
template <typename Stream, typename Rows>
class ResultCursor {
 public:
  explicit ResultCursor(const ResultReader& reader,
                        std::size_t batch_rows = ResultRowStream::kBatchRows)
      : stream_(reader, batch_rows) {
    stream_.read(rows_);
  }

  bool at_end() const { return rows_.size() == 0; }
  std::uint64_t source() const { return rows_.source[at_]; }
  void advance() {
    if (++at_ < rows_.size()) return;
    at_ = 0;
    stream_.read(rows_);
  }

 protected:
  Stream stream_;
  Rows rows_;
  std::size_t at_ = 0;
};

class RowCursor : public ResultCursor<ResultRowStream, ResultRows> {
 public:
  using ResultCursor::ResultCursor;
  Vec3 xyz() const { return rows_.xyz[at_]; }
  std::optional<std::uint32_t> first_pose() const {
    return rows_.first_pose.empty() ? std::nullopt : std::optional(rows_.first_pose[at_]);
  }
  std::optional<std::uint32_t> last_pose() const {
    return rows_.last_pose.empty() ? std::nullopt : std::optional(rows_.last_pose[at_]);
  }
  /// The body that touches the point at its first pose.
  std::optional<std::uint32_t> body() const {
    return rows_.body.empty() ? std::nullopt : std::optional(rows_.body[at_]);
  }
};

class ClearanceCursor : public ResultCursor<ClearanceRowStream, ClearanceRows> {
 public:
  using ResultCursor::ResultCursor;
  /// Only where the result has coordinates of clearances.
  Vec3 xyz() const { return rows_.xyz[at_]; }
  double distance() const { return rows_.distance[at_]; }
  std::uint32_t pose() const { return rows_.pose[at_]; }
  std::optional<std::uint32_t> body() const {
    return rows_.body.empty() ? std::nullopt : std::optional(rows_.body[at_]);
  }
};

/// Advances two cursors together to their ends. For each source index it calls only_in_a, only_in_b
/// or in_both, before the cursors move on.
template <typename Cursor, typename OnlyA, typename OnlyB, typename Both>
void merge_rows(Cursor& a, Cursor& b, OnlyA only_in_a, OnlyB only_in_b, Both in_both) {
  while (!a.at_end() || !b.at_end()) {
    if (b.at_end() || (!a.at_end() && a.source() < b.source())) {
      only_in_a();
      a.advance();
    } else if (a.at_end() || b.source() < a.source()) {
      only_in_b();
      b.advance();
    } else {
      in_both();
      a.advance();
      b.advance();
    }
  }
}

}  // namespace clearway
