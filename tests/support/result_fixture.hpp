#pragma once

#include <cstring>

#include "clearway/result.hpp"
#include "io/result/result.hpp"
#include "support/scratch_folder.hpp"

namespace clearway::test {

/// A header of a large environment, far from the origin, with unlike axes.
ResultHeader sample_header(bool first_pose);

/// Makes `count` rows with gaps, negative quanta and first poses above 2^31.
Collisions sample_rows(const ResultHeader& header, std::size_t count);

/// Gives rows depths, and sets them in the header; every third has no free point.
void add_sample_depths(ResultHeader& header, Collisions& rows);

Clearances sample_clearances(const ResultHeader& header, std::size_t count);

/// A profile of header.poses poses, of which every fifth has no point.
ProfileRows sample_profile(const ResultHeader& header);

/// The rows `from` to `from + count - 1`.
template <typename Rows>
Rows part_of(const Rows& rows, std::size_t from, std::size_t count) {
  Rows out;
  for_each_column<Rows>([&](const auto& column) {
    if ((rows.*column.values).empty()) return;
    const auto begin = (rows.*column.values).begin() + static_cast<std::ptrdiff_t>(from);
    (out.*column.values).assign(begin, begin + static_cast<std::ptrdiff_t>(count));
  });
  return out;
}

/// Writes a result, with append() calls of `step` rows each.
void write_result(const std::filesystem::path& path, const ResultHeader& header,
                  const Collisions& rows, std::size_t step = 1000,
                  const Clearances& clearances = {}, const ProfileRows& profile = {});

/// Reads a table from front to back.
template <typename Rows = Collisions>
Rows read_rows(const ResultReader& reader) {
  Rows all, batch;
  for (RowStream<Rows> stream(reader); stream.read(batch);) append_rows(batch, all);
  return all;
}

/// Whether two tables have the same columns, bit by bit, so that NaN equals NaN.
template <typename Rows>
bool same_table(const Rows& a, const Rows& b) {
  bool same = true;
  for_each_column<Rows>([&](const auto& column) {
    const auto& x = a.*column.values;
    const auto& y = b.*column.values;
    same = same && x.size() == y.size() &&
           std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0;
  });
  return same;
}

}  // namespace clearway::test
