#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "clearway/error.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/hdf5/stored_chunk.hpp"
#include "io/system/xxh64.hpp"

namespace clearway {

/// Reads rows of several columns together. The thread that calls HDF5 reads their chunks, and many
/// threads then check, decode and hash these. run() tells only whether all is well; to find out
/// what is wrong, the caller reads the rows again one after the other, so that messages are always
/// the same.
class ParallelRead {
 public:
  /// Reads the chunks of rows from `first`, which begins a chunk, as many as `out` has. check(first
  /// row, values) throws InputError for rows that are wrong and is thread safe. Returns false where
  /// the chunks cannot be read.
  template <typename Number, typename Value, typename Check>
  bool add(const hdf5::Rows<Number>& dataset, std::uint64_t first, std::span<Value> out,
           Xxh64Stream& hash, Check check) {
    Chunks& chunks = chunks_.emplace_back();
    if (!dataset.read_chunks(first, out.size(), chunks)) return false;
    const std::uint64_t rows = dataset.chunk_rows();
    columns_.emplace_back([&chunks, out, &hash] {
      std::size_t left = out.size_bytes();
      for (const std::vector<std::byte>& chunk : chunks) {
        const std::size_t used = std::min(left, chunk.size() - hdf5::kChecksumBytes);
        hash.update(std::span(chunk).first(used));
        left -= used;
      }
    });
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      const std::size_t from = i * rows;
      const std::span<Value> part = out.subspan(from, std::min(rows, out.size() - from));
      pieces_.emplace_back([&chunk = chunks[i], part, check, row = first + from] {
        if (!hdf5::is_sealed(chunk)) return false;
        std::memcpy(part.data(), chunk.data(), part.size_bytes());
        return passes(check, row, std::span<const Value>(part));
      });
    }
    return true;
  }

  /// Whether all rows are intact and pass their checks. If so, the rows and the hashes are
  /// complete.
  bool run() const;

 private:
  using Chunks = std::vector<std::vector<std::byte>>;

  template <typename Check, typename Value>
  static bool passes(const Check& check, std::uint64_t row, std::span<const Value> values) {
    try {
      check(row, values);
    } catch (const InputError&) {
      return false;
    }
    return true;
  }

  std::deque<Chunks> chunks_;  // a deque, because the tasks keep references to its elements
  std::vector<std::function<bool()>> pieces_;
  // Tasks that hash one column each, run once all pieces are intact.
  std::vector<std::function<void()>> columns_;
};

}  // namespace clearway
