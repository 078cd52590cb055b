#include "io/files/xxh64.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <cinttypes>
#include <cstdio>

namespace clearway {

std::uint64_t xxh64(std::span<const std::byte> bytes) {
  return XXH64(bytes.data(), bytes.size(), 0);
}

std::string hash_text(std::uint64_t hash) {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016" PRIx64, hash);
  return digits.data();
}

struct Xxh64Stream::State {
  XXH64_state_t xxhash;
};

Xxh64Stream::Xxh64Stream() : state_(std::make_unique<State>()) { XXH64_reset(&state_->xxhash, 0); }
Xxh64Stream::~Xxh64Stream() = default;
Xxh64Stream::Xxh64Stream(const Xxh64Stream& other)
    : state_(std::make_unique<State>(*other.state_)) {}
Xxh64Stream& Xxh64Stream::operator=(const Xxh64Stream& other) {
  *state_ = *other.state_;
  return *this;
}

void Xxh64Stream::update(std::span<const std::byte> bytes) {
  XXH64_update(&state_->xxhash, bytes.data(), bytes.size());
}

std::uint64_t Xxh64Stream::digest() const { return XXH64_digest(&state_->xxhash); }

}  // namespace clearway
