#include "io/result/result_rows.hpp"

#include <algorithm>

#include "clearway/error.hpp"

namespace clearway {
namespace {

void check_ascending(const ResultReader& reader, const char* dataset, std::uint64_t row,
                     std::uint64_t last_source, std::uint64_t source) {
  if (row == 0 || source > last_source) return;
  throw InputError(reader.name() + ": " + dataset + ", row " + std::to_string(row) +
                   ": expected an index above the row before");
}

template <typename Values>
void add(Xxh64Stream& column, const Values& values) {
  column.update(std::as_bytes(std::span(values)));
}

void check_hash(const ResultReader& reader, const char* group, std::span<const Xxh64Stream> columns,
                std::uint64_t expected) {
  ColumnHashes hashes;
  for (const Xxh64Stream& column : columns) hashes.add_digest(column.digest());
  if (hashes.digest() == expected) return;
  throw InputError(reader.name() + ": /" + group +
                   ": its rows are damaged (their hash is not the one recorded)");
}

void check_order(const ResultReader& reader, std::uint64_t first, const ResultRows& rows) {
  for (std::size_t i = 0; i < rows.last_pose.size(); ++i) {
    if (rows.last_pose[i] >= rows.first_pose[i]) continue;
    throw InputError(reader.name() + ": /collisions/last_pose, row " + std::to_string(first + i) +
                     ": expected a pose that is not before the first one");
  }
}

}  // namespace

bool ResultRowStream::read(ResultRows& rows) {
  const std::size_t count = std::min<std::uint64_t>(batch_rows_, reader_.collisions() - next_);
  const bool first_pose = reader_.header().first_pose;
  rows.source.resize(count);
  rows.xyz.resize(count);
  rows.first_pose.resize(first_pose ? count : 0);
  const bool body = reader_.header().has_first_bodies();
  rows.body.resize(body ? count : 0);
  const bool last_pose = reader_.header().last_pose;
  rows.last_pose.resize(last_pose ? count : 0);
  if (count == 0) {
    check_hash(reader_, "collisions",
               std::span(columns_).first(body         ? 4
                                         : first_pose ? 3
                                                      : 2),
               reader_.collisions_hash());
    if (last_pose && last_poses_.digest() != reader_.last_pose_hash()) {
      throw InputError(reader_.name() +
                       ": /collisions/last_pose: its rows are damaged (their hash is not the one "
                       "recorded)");
    }
    return false;
  }
  reader_.read_collisions(next_, rows.source, rows.xyz, rows.first_pose, columns_);
  if (body) {
    reader_.read_first_body(next_, rows.body);
    add(columns_[3], rows.body);
  }
  if (last_pose) {
    reader_.read_last_pose(next_, rows.last_pose);
    add(last_poses_, rows.last_pose);
    check_order(reader_, next_, rows);
  }
  check_ascending(reader_, "/collisions/source", next_, last_source_, rows.source.front());
  last_source_ = rows.source.back();
  next_ += count;
  return true;
}

bool ClearanceRowStream::read(ClearanceRows& rows) {
  const std::size_t count = std::min<std::uint64_t>(batch_rows_, reader_.clearances() - next_);
  const bool has_xyz = reader_.header().has_clearance_xyz();
  rows.source.resize(count);
  rows.xyz.resize(has_xyz ? count : 0);
  rows.distance.resize(count);
  rows.pose.resize(count);
  const bool body = !reader_.header().bodies.empty();
  rows.body.resize(body ? count : 0);
  const auto columns = std::span(columns_).first(body ? 5 : 4).subspan(has_xyz ? 0 : 1);
  if (count == 0) {
    if (reader_.header().clearance > 0) {
      check_hash(reader_, "clearance", columns, reader_.clearances_hash());
    }
    return false;
  }
  // A file of version 2 has no xyz, so its hash is of three columns.
  reader_.read_clearances(next_, rows.source, rows.xyz, rows.distance, rows.pose, columns);
  if (body && reader_.header().clearance > 0) {
    reader_.read_clearance_body(next_, rows.body);
    add(columns_[4], rows.body);
  }
  check_ascending(reader_, "/clearance/source", next_, last_source_, rows.source.front());
  last_source_ = rows.source.back();
  next_ += count;
  return true;
}

bool ProfileRowStream::read(ProfileRows& rows) {
  const std::size_t count = std::min<std::uint64_t>(batch_rows_, reader_.profile_rows() - next_);
  rows.distance.resize(count);
  rows.source.resize(count);
  rows.xyz.resize(count);
  rows.chainage.resize(count);
  const bool is_part = reader_.header().part.has_value();
  rows.squared.resize(is_part ? count : 0);
  if (count == 0) {
    if (reader_.header().profile > 0) {
      check_hash(reader_, "profile", std::span(columns_).first(is_part ? 5 : 4),
                 reader_.profile_hash());
    }
    return false;
  }
  reader_.read_profile(next_, rows.distance, rows.source, rows.xyz, rows.chainage);
  if (is_part) reader_.read_profile_squared(next_, rows.squared);
  add(columns_[0], rows.distance);
  add(columns_[1], rows.source);
  add(columns_[2], rows.xyz);
  add(columns_[3], rows.chainage);
  add(columns_[4], rows.squared);
  if (rows.chainage.front() < last_chainage_) {
    throw InputError(reader_.name() + ": /profile/chainage, row " + std::to_string(next_) +
                     ": expected metres, not below the row before");
  }
  last_chainage_ = rows.chainage.back();
  next_ += count;
  return true;
}

}  // namespace clearway
