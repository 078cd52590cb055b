#include "io/result_rows.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace clearway {

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
  if (next_ > 0 && rows.source.front() <= last_source_) {
    throw InputError(reader_.name() + ": /collisions/source, row " + std::to_string(next_) +
                     ": expected an index above the row before");
  }
  last_source_ = rows.source.back();
  next_ += count;
  return true;
}

}  // namespace clearway
