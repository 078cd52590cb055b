#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/result/column_hashes.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Consecutive rows of a result. first_pose, body and last_pose are empty where the result has
/// none.
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

/// Consecutive rows of a result's profile, a row a pose.
struct ProfileRows {
  std::vector<double> distance;
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<double> chainage;
  std::vector<double> squared = {};  ///< of a part only

  std::size_t size() const { return distance.size(); }
};

/// A result's rows front to back in constant memory, so many at a time: with fewer than kBatchRows
/// in one thread. The reader outlives the stream.
class ResultRowStream {
 public:
  static constexpr std::size_t kBatchRows = 1 << 16;  ///< whole chunks of every dataset

  explicit ResultRowStream(const ResultReader& reader, std::size_t batch_rows = kBatchRows)
      : reader_(reader), batch_rows_(batch_rows) {}

  /// Fills `rows` with the next ones; false, and no rows, at the end. Throws InputError as
  /// the reader does, also where sources do not ascend from one batch to the next, and at the end
  /// where the rows are not those that their hash is of.
  bool read(ResultRows& rows);

 private:
  const ResultReader& reader_;
  const std::size_t batch_rows_;
  std::uint64_t next_ = 0;
  std::uint64_t last_source_ = 0;
  std::array<Xxh64Stream, 4> columns_;  ///< of the rows read
  Xxh64Stream last_poses_;
};

/// The same for its clearances; no rows where it has none.
class ClearanceRowStream {
 public:
  explicit ClearanceRowStream(const ResultReader& reader,
                              std::size_t batch_rows = ResultRowStream::kBatchRows)
      : reader_(reader), batch_rows_(batch_rows) {}

  /// As ResultRowStream's.
  bool read(ClearanceRows& rows);

 private:
  const ResultReader& reader_;
  const std::size_t batch_rows_;
  std::uint64_t next_ = 0;
  std::uint64_t last_source_ = 0;
  std::array<Xxh64Stream, 5> columns_;  ///< of the rows read
};

/// The same for its profile, of which the chainage ascends; no rows where it has none.
class ProfileRowStream {
 public:
  explicit ProfileRowStream(const ResultReader& reader,
                            std::size_t batch_rows = ResultRowStream::kBatchRows)
      : reader_(reader), batch_rows_(batch_rows) {}

  /// As ResultRowStream's.
  bool read(ProfileRows& rows);

 private:
  const ResultReader& reader_;
  const std::size_t batch_rows_;
  std::uint64_t next_ = 0;
  double last_chainage_ = 0;
  std::array<Xxh64Stream, 5> columns_;  ///< of the rows read
};

}  // namespace clearway
