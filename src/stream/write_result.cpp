#include "stream/write_result.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "core/query/body_numbers.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/answer.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "stream/gather_rows.hpp"

namespace clearway {
namespace {

// The rows of each table: the question that they answer, and the table that they are put into.

struct CollisionRow {
  static constexpr PointQuestion kQuestion = PointQuestion::kHits;
  static constexpr auto kTable = &ResultTables::collisions;

  std::uint64_t source;
  std::int32_t q[3];
  std::uint32_t first_pose;  ///< encoded as BodyNumbers does
  std::uint32_t last_pose;
  std::uint8_t certain;  ///< whether the error budget says that it is certainly too close
  std::uint8_t point_class;
};

/// A row with the free point that is nearest to it, where depths are asked for.
struct DeepRow : CollisionRow {
  Depth depth;
};

struct NearRow {
  static constexpr PointQuestion kQuestion = PointQuestion::kNear;
  static constexpr auto kTable = &ResultTables::near;

  std::uint64_t source;
  std::int32_t q[3];
  std::uint32_t first_pose;  ///< encoded as BodyNumbers does
  std::uint8_t point_class;
};

struct ClearanceRow {
  static constexpr PointQuestion kQuestion = PointQuestion::kClearances;
  static constexpr auto kTable = &ResultTables::clearances;

  std::uint64_t source;
  double distance;
  std::int32_t q[3];
  std::uint32_t pose;  ///< encoded as BodyNumbers does
  std::uint8_t point_class;
};

template <typename Row>
using TableOf = std::remove_reference_t<decltype(std::declval<ResultTables&>().*Row::kTable)>;

/// What the encoding has to know besides the rows.
struct RowMeaning {
  const Quantisation& quantisation;
  const ResultHeader& header;
  BodyNumbers numbers;
};

/// Visits the rows in short pieces, so that their columns stay in a core's cache.
template <typename Row, typename Visit>
void for_each_strip(std::span<const Row> rows, Visit visit) {
  constexpr std::size_t kStrip = 1 << 12;
  for (std::size_t first = 0; first < rows.size(); first += kStrip) {
    visit(rows.subspan(first, std::min(kStrip, rows.size() - first)));
  }
}

/// Gives a column this many rows, whatever their values are.
struct SizeColumn {
  std::size_t size;

  template <typename Value, typename ValueOf>
  void operator()(std::vector<Value>& column, ValueOf) const {
    column.resize(size);
  }
};

/// Sets the values of some rows in a column that has room for them.
template <typename Row>
struct SetColumn {
  std::span<const Row> rows;
  std::size_t first;  ///< where the first of the rows is in the column

  template <typename Value, typename ValueOf>
  void operator()(std::vector<Value>& column, ValueOf value_of) const {
    std::ranges::transform(rows, column.begin() + static_cast<std::ptrdiff_t>(first), value_of);
  }
};

Vec3 xyz_of(const Quantisation& quantisation, const std::int32_t (&q)[3]) {
  return position(quantisation, q[0], q[1], q[2]);
}

// put_columns() calls put(column, value_of) for every column that a table has by its meaning;
// value_of(row) is the value of a row there.

template <typename Columns, typename Put>
void put_classes(const RowMeaning& meaning, Columns& columns, Put put) {
  if (!meaning.header.has_classes()) return;
  put(columns.point_class, [](const auto& row) { return row.point_class; });
}

/// The columns that colliding points and near ones have in common: which point it is, and by which
/// body at which pose the model first comes so close to it.
template <typename Columns, typename Put>
void put_touched_columns(const RowMeaning& meaning, Columns& columns, Put put) {
  put(columns.source, [](const auto& row) { return row.source; });
  put(columns.xyz, [&](const auto& row) { return xyz_of(meaning.quantisation, row.q); });
  if (meaning.header.first_pose) {
    put(columns.first_pose,
        [&](const auto& row) { return meaning.numbers.pose_of(row.first_pose); });
  }
  if (meaning.header.has_first_bodies()) {
    put(columns.body, [&](const auto& row) { return meaning.numbers.body_of(row.first_pose); });
  }
  put_classes(meaning, columns, put);
}

const Depth& depth_of(const DeepRow& row) { return row.depth; }
/// Rows without a depth are those of results that do not have the columns.
Depth depth_of(const CollisionRow&) { return {}; }

template <typename Put>
void put_columns(const RowMeaning& meaning, Collisions& columns, Put put) {
  put_touched_columns(meaning, columns, put);
  if (meaning.header.first_pose) {
    put(columns.last_pose, [](const CollisionRow& row) { return row.last_pose; });
  }
  if (meaning.header.budget) {
    put(columns.certain, [](const CollisionRow& row) { return row.certain; });
  }
  if (meaning.header.depth) {
    put(columns.depth, [](const auto& row) { return depth_of(row).distance; });
    put(columns.depth_source, [](const auto& row) { return depth_of(row).source; });
  }
}

template <typename Put>
void put_columns(const RowMeaning& meaning, Nearby& columns, Put put) {
  put_touched_columns(meaning, columns, put);
}

template <typename Put>
void put_columns(const RowMeaning& meaning, Clearances& columns, Put put) {
  put(columns.source, [](const ClearanceRow& row) { return row.source; });
  put(columns.xyz, [&](const ClearanceRow& row) { return xyz_of(meaning.quantisation, row.q); });
  put(columns.distance, [](const ClearanceRow& row) { return row.distance; });
  put(columns.pose, [&](const ClearanceRow& row) { return meaning.numbers.pose_of(row.pose); });
  if (!meaning.header.bodies.empty()) {
    put(columns.body, [&](const ClearanceRow& row) { return meaning.numbers.body_of(row.pose); });
  }
  put_classes(meaning, columns, put);
}

/// Encoded rows of a table, and what they say in short.
template <typename Rows>
struct WritePiece {
  EncodedRows<Rows> rows;
  TableSummary summary = {};
};

/// Encodes and summarises rows that ascend by source index.
template <typename Row, typename Rows = TableOf<Row>>
std::shared_ptr<WritePiece<Rows>> encode(const ResultWriter& writer, const RowMeaning& meaning,
                                         std::span<const Row> rows) {
  auto out = std::make_shared<WritePiece<Rows>>(WritePiece<Rows>{writer.new_rows<Rows>()});
  Rows columns;
  for_each_strip(rows, [&](std::span<const Row> strip) {
    put_columns(meaning, columns, SizeColumn{strip.size()});
    put_columns(meaning, columns, SetColumn<Row>{strip, 0});
    out->rows.add(columns);
    summarise(columns, out->summary);
  });
  out->rows.seal();
  return out;
}

/// Encodes rows, kPieceRows at a time, on many threads, and writes them in order.
/// at_once: greatest number of pieces in memory. Throws as ResultWriter does, and Interrupted when
/// the progress asks to stop.
template <typename Row>
void write_rows(ResultWriter& writer, const RowMeaning& meaning, std::span<const Row> rows,
                std::size_t at_once, Progress& progress, TableSummary& summary) {
  using Piece = std::shared_ptr<WritePiece<TableOf<Row>>>;
  std::size_t next = 0;
  const ParallelScope scope;
  const SerialStage input, output;
  const auto take = piece_of(scope, input, [&](tbb::flow_control& flow) {
    throw_if_stopped(progress);
    const std::size_t first = next;
    next = std::min(rows.size(), first + kPieceRows);
    if (first == next) flow.stop();
    return rows.subspan(first, next - first);
  });
  const auto encoded = piece_of(
      scope, [&](std::span<const Row> piece) -> Piece { return encode(writer, meaning, piece); });
  const auto write = piece_of(scope, output, [&](const Piece& piece) {
    writer.write(piece->rows);
    add_summary(piece->summary, summary);
    progress.advance(piece->rows.size());
  });
  constexpr auto kInOrder = tbb::filter_mode::serial_in_order;
  scope.begin();
  tbb::parallel_pipeline(at_once, tbb::make_filter<void, std::span<const Row>>(kInOrder, take) &
                                      tbb::make_filter<std::span<const Row>, Handed<Piece>>(
                                          tbb::filter_mode::parallel, encoded) &
                                      tbb::make_filter<Handed<Piece>, void>(kInOrder, write));
}

/// Number of poses that are written at a time.
constexpr std::uint64_t kPoses = 1 << 14;

/// The classes of a cell's points by their index in it; 0 where the store has none.
auto classes_of(const StoreReader& store, std::uint32_t cell) {
  std::optional<PackedChunk<std::uint8_t>> classes;
  if (store.has_classes()) classes = store.classes(cell);
  return [classes](std::uint32_t i) { return classes ? (*classes)[i] : std::uint8_t{0}; };
}

/// Memory for rows that the file's writer buffers, and for what the profile is written from.
constexpr std::uint64_t kWriterBytes = std::uint64_t{12} << 20;

/// Bytes that a piece of kPieceRows encoded rows takes in memory.
constexpr std::uint64_t kPieceBytes = std::uint64_t{3} << 20;

/// Least number of rows of a pass. With fewer, a part might not fit beside what is left of the part
/// before.
constexpr std::size_t kLeastRows = kPieceRows + SourceParts::kMostRows;

/// Least memory with which one thread gathers.
constexpr std::uint64_t kLeastThreadBytes = std::uint64_t{1} << 20;

std::uint64_t thread_bytes(const StoreReader& store, const Query& query) {
  return CellParts::most_bytes(store) + 16 * SourceParts(store).count() +
         AnswerRows::most_cell_bytes(store, query);
}

/// The number of rows for which another thread pays.
constexpr std::uint64_t kRowsOfThread = std::uint64_t{1} << 14;

/// How a table is written in the given memory.
struct WritePlan {
  std::size_t rows;    ///< greatest number of rows of a pass
  std::size_t pieces;  ///< number of encoded pieces under way
  int threads;         ///< number of threads that gather
  bool copies;         ///< whether each of them may copy a part to order it
};

template <typename Row>
WritePlan plan_of(const StoreReader& store, const Query& query, std::uint64_t table_rows,
                  std::uint64_t memory_bytes) {
  const int threads = static_cast<int>(std::min<std::uint64_t>(
      tbb::this_task_arena::max_concurrency(), 1 + table_rows / kRowsOfThread));
  const std::uint64_t left = std::max(memory_bytes, least_write_bytes(store, query)) - kWriterBytes;
  const std::uint64_t for_thread = thread_bytes(store, query);
  WritePlan plan{};
  plan.pieces = std::clamp<std::uint64_t>(left / 4 / kPieceBytes, 1, 2 * threads);
  plan.threads = static_cast<int>(std::clamp<std::uint64_t>(left / 8 / for_thread, 1, threads));
  const std::uint64_t copies = plan.threads * SourceParts::kMostRows * sizeof(Row);
  plan.copies = copies <= left / 4;
  const std::uint64_t used =
      plan.pieces * kPieceBytes + plan.threads * for_thread + (plan.copies ? copies : 0);
  plan.rows = std::max<std::uint64_t>(kLeastRows, (left - std::min(left, used)) / sizeof(Row));
  return plan;
}

/// The end of the parts, from `first` on, that together have no more than `most` rows.
std::size_t end_of_pass(const StoreReader& store, const std::vector<std::uint64_t>& counts,
                        std::size_t first, std::size_t most) {
  std::size_t end = first;
  for (std::uint64_t rows = 0; end < counts.size(); ++end) {
    rows += counts[end];
    if (rows > most) break;
  }
  if (end == first) refuse(store.name(), "two points have the same source index");
  return end;
}

/// Brings the points of a result into the order of their source indices, and hands out the rows of
/// each table in passes.
class ResultRows {
 public:
  /// chainage: that of every pose, metres, for a profile. All references outlive it.
  ResultRows(const StoreReader& store, const FoundAnswer& answer, const RowMeaning& meaning,
             std::uint64_t memory_bytes, RowMemory& memory, std::span<const double> chainage,
             Progress& progress)
      : store_(store),
        answer_(*answer.rows),
        profile_(answer.profile),
        meaning_(meaning),
        memory_bytes_(memory_bytes),
        memory_(memory),
        chainage_(chainage),
        progress_(progress) {}

  /// Hands out the rows of all tables, one table after another. take(rows, first, pieces): takes
  /// the rows of a table from row `first` on, of which at most so many encoded pieces may be under
  /// way. take_profile(rows, first): the same for the profile. Throws InputError for a damaged
  /// cell, Interrupted when the progress asks to stop.
  template <typename Take, typename TakeProfile>
  void for_each(Take take, TakeProfile take_profile) {
    for_collisions(take);
    for_clearances(take);
    if (meaning_.header.profile > 0) for_profile(take_profile);
    for_near(take);
  }

 private:
  /// Hands out the colliding points, as DeepRow where depths are asked for and otherwise as
  /// CollisionRow.
  template <typename Take>
  void for_collisions(Take take) {
    const LastPoses last_poses(answer_.query());
    const auto rows_of = [&](std::uint32_t cell, const CellRows& hits) {
      return [&, q = store_.coordinates(cell), class_at = classes_of(store_, cell),
              last = found_in(cell, PointQuestion::kLast),
              certain = found_in(cell, PointQuestion::kCertain)](std::uint64_t source,
                                                                 std::uint32_t i, std::size_t row) {
        const std::uint32_t touched = hits.poses.empty() ? 0 : hits.poses[row];
        const std::uint32_t first = meaning_.numbers.pose_of(touched);
        const std::size_t backward = last.row_of(i);
        return CollisionRow{source,
                            {q[0][i], q[1][i], q[2][i]},
                            touched,
                            backward == RowFinder::kNone
                                ? first
                                : last_poses.of(first, last.rows().poses[backward]),
                            certain.row_of(i) != RowFinder::kNone,
                            class_at(i)};
      };
    };
    if (!meaning_.header.depth) return gather<CollisionRow>(rows_of, take);
    gather<DeepRow>(
        [&](std::uint32_t cell, const CellRows& hits) {
          return [row_of = rows_of(cell, hits), depths = found_in(cell, PointQuestion::kDepths)](
                     std::uint64_t source, std::uint32_t i, std::size_t row) {
            const std::size_t depth = depths.row_of(i);
            const CellRows& found = depths.rows();
            return DeepRow{row_of(source, i, row),
                           depth == RowFinder::kNone
                               ? Depth()
                               : Depth{found.distances[depth], found.sources[depth]}};
          };
        },
        take);
  }

  template <typename Take>
  void for_near(Take take) {
    const auto rows_of = [&](std::uint32_t cell, const CellRows& near) {
      return [&, q = store_.coordinates(cell), class_at = classes_of(store_, cell)](
                 std::uint64_t source, std::uint32_t i, std::size_t row) {
        return NearRow{source,
                       {q[0][i], q[1][i], q[2][i]},
                       near.poses.empty() ? 0 : near.poses[row],
                       class_at(i)};
      };
    };
    gather<NearRow>(rows_of, take);
  }

  template <typename Take>
  void for_clearances(Take take) {
    const auto rows_of = [&](std::uint32_t cell, const CellRows& clearances) {
      return [&, q = store_.coordinates(cell), class_at = classes_of(store_, cell)](
                 std::uint64_t source, std::uint32_t i, std::size_t row) {
        return ClearanceRow{source,
                            signed_root(clearances.distances[row]),
                            {q[0][i], q[1][i], q[2][i]},
                            clearances.poses[row],
                            class_at(i)};
      };
    };
    gather<ClearanceRow>(rows_of, take);
  }

  /// Hands out the nearest points of all poses; a part of a result has the squares, too.
  template <typename Take>
  void for_profile(Take take) const {
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    ProfileRows rows;
    for (std::uint64_t first = 0; first < profile_.poses(); first += kPoses) {
      throw_if_stopped(progress_);
      const std::uint64_t end = std::min(profile_.poses(), first + kPoses);
      clear_rows(rows);
      for (std::uint64_t pose = first; pose < end; ++pose) {
        const ProfilePoint point = profile_.at(pose);
        const auto cell = static_cast<std::uint32_t>(point.entry / store_.cell_entries());
        const auto index = static_cast<std::uint32_t>(point.entry % store_.cell_entries());
        rows.distance.push_back(signed_root(point.squared));
        rows.source.push_back(point.source);
        rows.xyz.push_back(point.found() ? store_.position_of(cell, index)
                                         : Vec3{kNowhere, kNowhere, kNowhere});
        if (store_.has_classes()) {
          rows.point_class.push_back(point.found() ? store_.class_of(cell, index) : 0);
        }
        rows.chainage.push_back(chainage_[pose]);
        if (meaning_.header.part) rows.squared.push_back(point.squared);
      }
      take(rows, first);
    }
  }

  RowFinder found_in(std::uint32_t cell, PointQuestion question) const {
    return RowFinder(answer_.read(cell, question));
  }

  /// Gathers the rows of a table in passes, each with a multiple of kPieceRows rows except the
  /// last.
  template <typename Row, typename RowsOf, typename Take>
  void gather(RowsOf rows_of, Take take) {
    const std::uint64_t found = answer_.points(Row::kQuestion);
    if (found == 0) return;  // a store without points has no parts to plan for
    const WritePlan plan = plan_of<Row>(store_, answer_.query(), found, memory_bytes_);
    tbb::task_arena arena(plan.threads);
    std::optional<GatherRows<Row>> gather;
    arena.execute([&] { gather.emplace(store_, answer_, Row::kQuestion, progress_); });
    const std::vector<std::uint64_t>& counts = gather->counts();
    const std::size_t most = std::min<std::uint64_t>(plan.rows, found);
    const std::uint64_t largest =
        std::min(SourceParts::kMostRows, *std::max_element(counts.begin(), counts.end()));
    const std::uint64_t copied = plan.copies ? plan.threads * largest : 0;
    const std::span<Row> all = memory_.rows<Row>(most + copied);
    const std::span<Row> rows = all.first(most), copies = all.subspan(most);
    std::uint64_t taken = 0;
    std::size_t kept = 0;  // number of rows of the last pass that are kept, at the front
    for (std::size_t first = 0; first < counts.size();) {
      const std::size_t end = end_of_pass(store_, counts, first, most - kept);
      std::size_t count = kept;
      for (std::size_t part = first; part < end; ++part) count += counts[part];
      arena.execute(
          [&] { gather->gather(first, end, rows.subspan(kept, count - kept), copies, rows_of); });
      const std::size_t whole = end == counts.size() ? count : count - count % kPieceRows;
      take(std::span<const Row>(rows.first(whole)), taken, plan.pieces);
      taken += whole;
      std::copy(rows.begin() + static_cast<std::ptrdiff_t>(whole),
                rows.begin() + static_cast<std::ptrdiff_t>(count), rows.begin());
      kept = count - whole;
      first = end;
    }
  }

  const StoreReader& store_;
  const AnswerRows& answer_;
  const ProfileSet& profile_;
  const RowMeaning& meaning_;
  std::uint64_t memory_bytes_;
  RowMemory& memory_;
  std::span<const double> chainage_;
  Progress& progress_;
};

RowMeaning meaning_of(const StoreReader& store, const ResultHeader& header) {
  return {store.quantisation(), header, BodyNumbers(header.bodies.size())};
}

TableSummary write_tables(const StoreReader& store, const FoundAnswer& answer,
                          const ResultHeader& header, const std::filesystem::path& path,
                          std::uint64_t memory_bytes, Progress& progress,
                          std::span<const double> chainage, const ResultFindings& findings) {
  TableSummary summary;
  RowMemory memory;
  const RowMeaning meaning = meaning_of(store, header);
  const std::uint64_t collisions = answer.rows->points(PointQuestion::kHits);
  const std::uint64_t clearances = answer.rows->points(PointQuestion::kClearances);
  const std::uint64_t near = answer.rows->points(PointQuestion::kNear);
  ResultWriter writer(path, header, collisions, clearances, near,
                      answer.unseen ? answer.unseen->size() : 0, answer.swept.size());
  progress.begin("write", collisions + clearances + near, "points");
  ResultRows(store, answer, meaning, memory_bytes, memory, chainage, progress)
      .for_each(
          [&](const auto& rows, std::uint64_t, std::size_t pieces) {
            write_rows(writer, meaning, rows, pieces, progress, summary);
          },
          [&](const ProfileRows& rows, std::uint64_t first) {
            writer.append(rows);
            summarise(rows, summary, first);
          });
  if (answer.unseen) {
    writer.append(*answer.unseen);
    writer.append(answer.swept);
  }
  writer.finish(findings);
  progress.end();
  return summary;
}

}  // namespace

TableSummary write_result(const StoreReader& store, const FoundAnswer& answer,
                          const ResultHeader& header, const std::filesystem::path& path,
                          std::uint64_t memory_bytes, Progress& progress,
                          std::span<const double> chainage, int threads,
                          const ResultFindings& findings) {
  if (threads == 0) threads = tbb::this_task_arena::max_concurrency();
  return ThreadLimit(threads).run([&] {
    return write_tables(store, answer, header, path, memory_bytes, progress, chainage, findings);
  });
}

void fill_tables(const StoreReader& store, FoundAnswer answer, const ResultHeader& header,
                 std::uint64_t memory_bytes, Progress& progress, std::span<const double> chainage,
                 int threads, RowMemory& memory, ResultTables& tables) {
  const RowMeaning meaning = meaning_of(store, header);
  const auto keep = [&]<typename Row>(std::span<const Row> rows, std::uint64_t first, std::size_t) {
    TableOf<Row>& table = tables.*Row::kTable;
    if (first == 0) put_columns(meaning, table, SizeColumn{answer.rows->points(Row::kQuestion)});
    using Range = tbb::blocked_range<std::size_t>;
    for_each_parallel(Range(0, rows.size(), kRowsOfThread), [&](const Range& part) {
      const std::span<const Row> of = rows.subspan(part.begin(), part.size());
      put_columns(meaning, table, SetColumn<Row>{of, first + part.begin()});
    });
  };
  if (threads == 0) threads = tbb::this_task_arena::max_concurrency();
  ThreadLimit(threads).run([&] {
    ResultRows(store, answer, meaning, memory_bytes, memory, chainage, progress)
        .for_each(keep, [&](const ProfileRows& rows, std::uint64_t) {
          append_rows(rows, tables.profile);
        });
  });
  if (answer.unseen) {
    tables.unseen = std::move(*answer.unseen);
    tables.swept = std::move(answer.swept);
  }
}

TableSummary summary_of(const ResultTables& tables) {
  TableSummary summary;
  summarise(tables.collisions, summary);
  summarise(tables.clearances, summary);
  summarise(tables.profile, summary);
  summarise(tables.near, summary);
  return summary;
}

void write_tables(const ResultTables& tables, const ResultHeader& header,
                  const ResultFindings& findings, const std::filesystem::path& path) {
  ResultWriter writer(path, header, tables.collisions.size(), tables.clearances.size(),
                      tables.near.size(), tables.unseen.size(), tables.swept.size());
  writer.append(tables.collisions);
  if (header.clearance > 0) writer.append(tables.clearances);
  if (header.profile > 0) writer.append(tables.profile);
  if (header.budget) writer.append(tables.near);
  if (header.seen) {
    writer.append(tables.unseen);
    writer.append(tables.swept);
  }
  writer.finish(findings);
}

std::uint64_t least_write_bytes(const StoreReader& store, const Query& query) {
  // The rows of all parts are counted once, and once again while they are put in place.
  return kWriterBytes + kPieceBytes + std::max(kLeastThreadBytes, thread_bytes(store, query)) +
         24 * SourceParts(store).count() +
         kLeastRows * std::max(sizeof(CollisionRow), sizeof(ClearanceRow));
}

}  // namespace clearway
