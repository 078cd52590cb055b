#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "stream/write_result.hpp"

namespace clearway {

/// Memory of tables that nobody needs any more, for the tables of further answers: the system takes
/// longer to give memory to a process than rows take to be written. Thread safe.
class SpareTables {
 public:
  /// most_bytes: tables beyond them are not kept.
  explicit SpareTables(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// Tables without rows, which may have memory for some.
  ResultTables take_tables();
  void keep(ResultTables tables);

  /// Memory in which rows are ordered; it may be too small.
  RowMemory take_rows();
  void keep(RowMemory rows);

  void forget_all();
  /// Bytes of what is kept.
  std::uint64_t bytes() const;

 private:
  template <typename Kept>
  Kept take(std::vector<Kept>& from);
  template <typename Kept>
  void keep(Kept one, std::vector<Kept>& in);

  const std::uint64_t most_bytes_;
  mutable std::mutex mutex_;
  std::vector<ResultTables> tables_;
  std::vector<RowMemory> rows_;
  std::uint64_t bytes_ = 0;
};

}  // namespace clearway
