#pragma once

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "clearway/answer.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "stream/answer_rows.hpp"

namespace clearway {

/// Encoded rows of a table, and what they say in short.
template <typename Rows>
struct WritePiece {
  EncodedRows<Rows> rows;
  TableSummary summary = {};
};

/// Encodes rows, kEncodedRows at a time, on many threads, and hashes and writes them in order.
/// at_once: greatest number of pieces in memory. encode(rows): returns a shared pointer to a piece
/// of sealed rows; done(piece): called for each piece in order. Throws as ResultWriter does, and
/// Interrupted when the progress asks to stop.
template <typename Rows, typename Row, typename Encode, typename Done>
void write_rows(ResultWriter& writer, std::span<const Row> rows, std::size_t at_once,
                Progress& progress, Encode encode, Done done) {
  using Piece = std::shared_ptr<WritePiece<Rows>>;
  std::size_t next = 0;
  const ParallelScope scope;
  const SerialStage input, hashed, output;
  const auto take = piece_of(scope, input, [&](tbb::flow_control& flow) {
    throw_if_stopped(progress);
    const std::size_t first = next;
    next = std::min(rows.size(), first + kEncodedRows);
    if (first == next) flow.stop();
    return rows.subspan(first, next - first);
  });
  const auto encode_rows =
      piece_of(scope, [&](std::span<const Row> piece) -> Piece { return encode(piece); });
  const auto hash = piece_of(scope, hashed, [&](const Piece& piece) {
    writer.hash(piece->rows);
    return piece;
  });
  const auto write = piece_of(scope, output, [&](const Piece& piece) {
    writer.write(piece->rows);
    done(*piece);
    progress.advance(piece->rows.size());
  });
  constexpr auto kInOrder = tbb::filter_mode::serial_in_order;
  scope.begin();
  tbb::parallel_pipeline(
      at_once, tbb::make_filter<void, std::span<const Row>>(kInOrder, take) &
                   tbb::make_filter<std::span<const Row>, Handed<Piece>>(tbb::filter_mode::parallel,
                                                                         encode_rows) &
                   tbb::make_filter<Handed<Piece>, Handed<Piece>>(kInOrder, hash) &
                   tbb::make_filter<Handed<Piece>, void>(kInOrder, write));
}

struct CollisionRow {
  std::uint64_t source;
  std::int32_t q[3];
  std::uint32_t first_pose;  ///< encoded as BodyNumbers does
  std::uint32_t last_pose;
  std::uint8_t certain = 0;  ///< whether the error budget says that it is certainly too close
  std::uint8_t point_class = 0;
};

/// A row with the free point that is nearest to it, where depths are asked for.
struct DeepRow : CollisionRow {
  Depth depth;
};

struct NearRow {
  std::uint64_t source;
  std::int32_t q[3];
  std::uint32_t first_pose;  ///< encoded as BodyNumbers does
  std::uint8_t point_class;
};

struct ClearanceRow {
  std::uint64_t source;
  double distance;
  std::int32_t q[3];
  std::uint32_t pose;  ///< encoded as BodyNumbers does
  std::uint8_t point_class;
};

/// What the encoding has to know besides the rows.
struct RowMeaning {
  const Quantisation& quantisation;
  const ResultHeader& header;
  BodyNumbers numbers;
};

/// Encodes and summarises rows that ascend by source index.
std::shared_ptr<WritePiece<Collisions>> encode_rows(const ResultWriter& writer,
                                                    const RowMeaning& meaning,
                                                    std::span<const CollisionRow> rows);
std::shared_ptr<WritePiece<Collisions>> encode_rows(const ResultWriter& writer,
                                                    const RowMeaning& meaning,
                                                    std::span<const DeepRow> rows);
std::shared_ptr<WritePiece<Nearby>> encode_rows(const ResultWriter& writer,
                                                const RowMeaning& meaning,
                                                std::span<const NearRow> rows);
std::shared_ptr<WritePiece<Clearances>> encode_rows(const ResultWriter& writer,
                                                    const RowMeaning& meaning,
                                                    std::span<const ClearanceRow> rows);

/// Writes a result file at `path`, and returns what its tables say in short: the colliding points,
/// and the clearances if the header asks for them, ascending by source index; then the profile if
/// the header asks for it, and the near points if there is an error budget. chainage: that of every
/// pose, metres, for a profile. Takes at most `memory_bytes`, but no less than least_write_bytes():
/// if the rows exceed them, it makes several passes over the cells that have any, each for the next
/// range of source indices. threads: 0 for all cores. Throws InputError for a damaged cell,
/// ResourceError for a full disk, Interrupted when the progress asks to stop.
TableSummary write_result(const StoreReader& store, const FoundAnswer& answer,
                          const ResultHeader& header, const std::filesystem::path& path,
                          std::uint64_t memory_bytes, Progress& progress,
                          std::span<const double> chainage = {}, int threads = 0,
                          const ResultFindings& findings = {});

/// The tables of a result in memory. A table that the query does not ask for is empty.
struct ResultTables {
  Collisions collisions;
  Clearances clearances;
  ProfileRows profile;
  Nearby near;
  UnseenCubes unseen;
  SweptCells swept;
};

/// Memory in which the rows of a table are brought into order.
class RowMemory {
 public:
  /// Uninitialised memory for rows; what it held before is lost.
  template <typename Row>
  std::span<Row> rows(std::size_t count) {
    if (bytes_ < count * sizeof(Row)) {
      memory_.reset();
      memory_ = std::make_unique_for_overwrite<std::byte[]>(count * sizeof(Row));
      bytes_ = count * sizeof(Row);
    }
    return {reinterpret_cast<Row*>(memory_.get()), count};
  }

  std::uint64_t bytes() const { return bytes_; }

 private:
  std::unique_ptr<std::byte[]> memory_;
  std::size_t bytes_ = 0;
};

/// Fills `tables`, which have no rows, with what write_result() would write. Takes at most
/// `memory_bytes`, but no less than least_write_bytes(), besides the tables themselves; rows are
/// ordered in `memory`. Throws InputError for a damaged cell, Interrupted when the progress asks to
/// stop.
void fill_tables(const StoreReader& store, FoundAnswer answer, const ResultHeader& header,
                 std::uint64_t memory_bytes, Progress& progress, std::span<const double> chainage,
                 int threads, RowMemory& memory, ResultTables& tables);

/// What tables say in short.
TableSummary summary_of(const ResultTables& tables);

/// Writes a file with the bytes that write_result() writes for the same tables. Throws as it does.
void write_tables(const ResultTables& tables, const ResultHeader& header,
                  const ResultFindings& findings, const std::filesystem::path& path);

/// The least memory in which write_result() writes what a query asks for, bytes.
std::uint64_t least_write_bytes(const StoreReader& store, const Query& query);

}  // namespace clearway
