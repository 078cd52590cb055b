#include "io/result_rows.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace clearway {
namespace {

void check_ascending(const ResultReader& reader, const char* dataset, std::uint64_t row,
                     std::uint64_t last_source, std::uint64_t source) {
  if (row == 0 || source > last_source) return;
  throw InputError(reader.name() + ": " + dataset + ", row " + std::to_string(row) +
                   ": expected an index above the row before");
}

}  // namespace

bool ResultRowStream::read(ResultRows& rows) {
  const std::size_t count = std::min<std::uint64_t>(kBatchRows, reader_.collisions() - next_);
  const bool first_pose = reader_.header().first_pose;
  rows.source.resize(count);
  rows.xyz.resize(count);
  rows.first_pose.resize(first_pose ? count : 0);
  if (count == 0) return false;
  reader_.read_source(next_, rows.source);
  reader_.read_xyz(next_, rows.xyz);
  if (first_pose) reader_.read_first_pose(next_, rows.first_pose);
  check_ascending(reader_, "/collisions/source", next_, last_source_, rows.source.front());
  last_source_ = rows.source.back();
  next_ += count;
  return true;
}

bool ClearanceRowStream::read(ClearanceRows& rows) {
  const std::size_t count =
      std::min<std::uint64_t>(ResultRowStream::kBatchRows, reader_.clearances() - next_);
  rows.source.resize(count);
  rows.distance.resize(count);
  rows.pose.resize(count);
  if (count == 0) return false;
  reader_.read_clearances(next_, rows.source, rows.distance, rows.pose);
  check_ascending(reader_, "/clearance/source", next_, last_source_, rows.source.front());
  last_source_ = rows.source.back();
  next_ += count;
  return true;
}

}  // namespace clearway
