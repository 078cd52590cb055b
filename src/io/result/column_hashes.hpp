#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/system/xxh64.hpp"

namespace clearway {

/// One hash of several datasets: XXH64 over the XXH64 of each, in the order in which they are
/// added. It finds damage that a dataset's fletcher32 misses, such as a chunk overwritten with
/// zeros together with its checksum.
class ColumnHashes {
 public:
  template <typename Values>
  void add(const Values& values) {
    add_digest(xxh64(std::as_bytes(std::span(values))));
  }
  void add_digest(std::uint64_t digest) { digests_.push_back(digest); }
  std::uint64_t digest() const { return xxh64(std::as_bytes(std::span(digests_))); }

 private:
  std::vector<std::uint64_t> digests_;
};

}  // namespace clearway
