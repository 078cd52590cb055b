#include "stream/spare_tables.hpp"

#include <new>

#include "io/result/tables.hpp"

namespace clearway {
namespace {

template <typename Rows>
std::uint64_t bytes_of_rows(const Rows& rows) {
  std::uint64_t bytes = 0;
  for_each_column<Rows>([&](const auto& column) {
    const auto& values = rows.*column.values;
    bytes += values.capacity() * sizeof(values[0]);
  });
  return bytes;
}

std::uint64_t bytes_of(const ResultTables& tables) {
  return bytes_of_rows(tables.collisions) + bytes_of_rows(tables.clearances) +
         bytes_of_rows(tables.profile) + bytes_of_rows(tables.near);
}

std::uint64_t bytes_of(const RowMemory& rows) { return rows.bytes(); }

}  // namespace

template <typename Kept>
Kept SpareTables::take(std::vector<Kept>& from) {
  const std::lock_guard lock(mutex_);
  if (from.empty()) return {};
  Kept one = std::move(from.back());
  from.pop_back();
  bytes_ -= bytes_of(one);
  return one;
}

template <typename Kept>
void SpareTables::keep(Kept one, std::vector<Kept>& in) {
  const std::uint64_t more = bytes_of(one);
  const std::lock_guard lock(mutex_);
  if (more == 0 || bytes_ + more > most_bytes_) return;
  try {
    in.push_back(std::move(one));
  } catch (const std::bad_alloc&) {
    return;  // it is freed, which is what memory that is scarce needs
  }
  bytes_ += more;
}

ResultTables SpareTables::take_tables() { return take(tables_); }

void SpareTables::keep(ResultTables tables) {
  clear_rows(tables.collisions);
  clear_rows(tables.clearances);
  clear_rows(tables.profile);
  clear_rows(tables.near);
  tables.unseen = {};
  tables.swept = {};
  keep(std::move(tables), tables_);
}

RowMemory SpareTables::take_rows() { return take(rows_); }
void SpareTables::keep(RowMemory rows) { keep(std::move(rows), rows_); }

void SpareTables::forget_all() {
  const std::lock_guard lock(mutex_);
  tables_.clear();
  rows_.clear();
  bytes_ = 0;
}

std::uint64_t SpareTables::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace clearway
