#include "io/merge/merge_memory.hpp"

#include <algorithm>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/result/result_rows.hpp"

namespace clearway {
namespace {

/// Bytes of the program and of what the writer holds back.
constexpr std::uint64_t kFixedBytes = std::uint64_t{32} << 20;
/// Bytes of an open file: its metadata in HDF5.
constexpr std::uint64_t kFileBytes = std::uint64_t{512} << 10;
/// Most bytes of a dataset's chunks that HDF5 caches.
constexpr std::uint64_t kCacheBytes = std::uint64_t{1} << 20;

constexpr std::size_t kLeastRows = 1 << 10;

/// Bytes of a row in the widest table of points, and of a row of the profile.
constexpr std::uint64_t kPointBytes = 48, kPoseBytes = 56;

std::uint64_t cached_bytes(std::uint64_t rows, std::initializer_list<std::uint64_t> value_bytes) {
  std::uint64_t bytes = 0;
  for (const std::uint64_t one : value_bytes) bytes += std::min(kCacheBytes, rows * one);
  return bytes;
}

std::uint64_t needed_bytes(const PartSet& set, std::size_t batch_rows) {
  std::uint64_t bytes = kFixedBytes + 4 * batch_rows * kPoseBytes;
  for (const ResultReader& part : set.parts()) {
    const std::uint64_t rows = std::max(part.collisions(), part.clearances());
    bytes += kFileBytes + cached_bytes(part.collisions(), {8, 24, 4, 4}) +
             cached_bytes(part.clearances(), {8, 24, 8, 4}) +
             cached_bytes(part.profile_rows(), {8, 8, 24, 8, 8}) +
             std::min<std::uint64_t>(batch_rows, rows) * kPointBytes;
  }
  return bytes;
}

}  // namespace

std::size_t batch_rows_of(const PartSet& set, std::uint64_t memory_bytes) {
  for (std::size_t rows = ResultRowStream::kBatchRows; rows >= kLeastRows; rows /= 2) {
    if (needed_bytes(set, rows) <= memory_bytes) return rows;
  }
  const std::uint64_t needed = needed_bytes(set, kLeastRows);
  throw ResourceError(format_size(memory_bytes) + " of memory is too little: to merge " +
                          std::to_string(set.parts().size()) + " parts needs " +
                          format_size(needed),
                      Remedy::kMoreMemory, static_cast<double>(needed));
}

}  // namespace clearway
