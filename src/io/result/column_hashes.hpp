#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/system/xxh64.hpp"

namespace clearway {

/// One hash of several datasets, in the order in which they are added: XXH64 of their XXH64s. A
/// dataset's fletcher32 does not notice a chunk that was overwritten with zeros, checksum and all.
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
