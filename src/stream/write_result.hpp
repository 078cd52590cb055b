#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "clearway/answer.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "stream/answer_rows.hpp"

namespace clearway {

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
