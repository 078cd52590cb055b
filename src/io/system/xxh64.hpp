#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

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
  void update(std::span<const std::byte> bytes);
  std::uint64_t digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
