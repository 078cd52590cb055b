#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/result/column_hashes.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Consecutive collisions of a result. first_pose, body and last_pose are empty where the result
/// has none.
struct ResultRows {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<std::uint32_t> first_pose;
  std::vector<std::uint32_t> body = {};
  std::vector<std::uint32_t> last_pose = {};

  std::size_t size() const { return source.size(); }
};

/// Consecutive rows of a result's clearances. xyz and body are empty where the result has none.
struct ClearanceRows {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<double> distance;
  std::vector<std::uint32_t> pose;
  std::vector<std::uint32_t> body = {};

  std::size_t size() const { return source.size(); }
};

/// Consecutive rows of a result's profile, one per pose.
struct ProfileRows {
  std::vector<double> distance;
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<double> chainage;
  std::vector<double> squared = {};  ///< squared distances; empty unless the file is a part

  std::size_t size() const { return distance.size(); }
};

/// Reads a result's collisions front to back in constant memory, batch_rows at a time; batches of
/// kBatchRows are read by many threads, smaller ones by one. The reader must outlive the stream.
class ResultRowStream {
 public:
  static constexpr std::size_t kBatchRows = 1 << 16;  ///< whole chunks of every dataset

  explicit ResultRowStream(const ResultReader& reader, std::size_t batch_rows = kBatchRows)
      : reader_(reader), batch_rows_(batch_rows) {}

  /// Fills `rows` with the next rows. At the end it leaves none and returns false. Throws
  /// InputError as the reader does, also where sources do not ascend from one batch to the next,
  /// and at the end where the rows do not match the recorded hash.
  bool read(ResultRows& rows);

 private:
  const ResultReader& reader_;
  const std::size_t batch_rows_;
  std::uint64_t next_ = 0;
  std::uint64_t last_source_ = 0;
  /// Hashes of source, xyz, first_pose and body of the rows read so far.
  std::array<Xxh64Stream, 4> columns_;
  Xxh64Stream last_poses_;
};

/// Reads a result's clearances front to back in the way of ResultRowStream; no rows where it has
/// none.
class ClearanceRowStream {
 public:
  explicit ClearanceRowStream(const ResultReader& reader,
                              std::size_t batch_rows = ResultRowStream::kBatchRows)
      : reader_(reader), batch_rows_(batch_rows) {}

  /// Fills `rows` with the next clearances, with the results and exceptions of
  /// ResultRowStream::read().
  bool read(ClearanceRows& rows);

 private:
  const ResultReader& reader_;
  const std::size_t batch_rows_;
  std::uint64_t next_ = 0;
  std::uint64_t last_source_ = 0;
  std::array<Xxh64Stream, 5> columns_;  ///< hashes of the columns of the rows read so far
};

/// Reads a result's profile front to back in the way of ResultRowStream; no rows where it has none.
class ProfileRowStream {
 public:
  explicit ProfileRowStream(const ResultReader& reader,
                            std::size_t batch_rows = ResultRowStream::kBatchRows)
      : reader_(reader), batch_rows_(batch_rows) {}

  /// Fills `rows` with the next rows of the profile, with the results and exceptions of
  /// ResultRowStream::read(), except that chainages, not sources, are checked from one batch to the
  /// next.
  bool read(ProfileRows& rows);

 private:
  const ResultReader& reader_;
  const std::size_t batch_rows_;
  std::uint64_t next_ = 0;
  double last_chainage_ = 0;
  std::array<Xxh64Stream, 5> columns_;  ///< hashes of the columns of the rows read so far
};

}  // namespace clearway
