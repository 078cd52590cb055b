#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace clearway {

/// XXH64 with seed 0.
std::uint64_t xxh64(std::span<const std::byte> bytes);

/// The 16 hexadecimal digits of a hash, for messages.
std::string hash_text(std::uint64_t hash);

/// XXH64 with seed 0 over bytes that arrive in pieces.
class Xxh64Stream {
 public:
  Xxh64Stream();
  ~Xxh64Stream();
  Xxh64Stream(const Xxh64Stream& other);
  Xxh64Stream& operator=(const Xxh64Stream& other);
  void update(std::span<const std::byte> bytes);
  std::uint64_t digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

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
