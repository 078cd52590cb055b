#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"
#include "io/result/journal.hpp"

namespace clearway {

/// Writes values into a record, or reads them from one: both by the same calls, so that what is
/// kept is listed once. A struct lists its own by a member `template <typename Values> void
/// keep(Values& values)`, which calls values.add(). Numbers, and structs and arrays of numbers, are
/// kept as they are in memory.
class JournalValues {
 public:
  explicit JournalValues(JournalRecord& record) : record_(&record) {}
  explicit JournalValues(JournalPayload& payload) : payload_(&payload) {}

  template <typename... All>
  void add(All&... values) {
    (one(values), ...);
  }

 private:
  template <typename Value>
  void one(Value& value) {
    if constexpr (requires { value.keep(*this); }) {
      value.keep(*this);
    } else {
      static_assert(std::is_trivially_copyable_v<Value>);
      if (record_ != nullptr) {
        record_->put(value);
      } else {
        value = payload_->take<Value>();
      }
    }
  }

  void one(std::string& text) {
    if (record_ != nullptr) {
      record_->put_text(text);
    } else {
      text = payload_->take_text();
    }
  }

  template <typename Value>
  void one(std::vector<Value>& values) {
    std::size_t count = length(values.size());
    if constexpr (is_plain<Value>) {
      if (record_ != nullptr) {
        record_->put_bytes(std::as_bytes(std::span(values)));
        return;
      }
      const auto bytes = payload_->take_bytes(bytes_of(count, sizeof(Value)));
      values.resize(count);
      if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
    } else {
      if (payload_ != nullptr) values.clear();
      for (std::size_t i = 0; i < count; ++i) {
        if (payload_ != nullptr) {
          if (payload_->at_end()) payload_->refuse("it ends too early");
          values.emplace_back();
        }
        one(values[i]);
      }
    }
  }

  template <typename Value>
  void one(std::optional<Value>& value) {
    std::uint8_t there = value.has_value() ? 1 : 0;
    one(there);
    if (payload_ != nullptr) value.reset();
    if (there == 0) return;
    if (payload_ != nullptr) value.emplace();
    one(*value);
  }

  template <typename First, typename Second>
  void one(std::pair<First, Second>& value) {
    add(value.first, value.second);
  }

  void one(Message& message) {
    add(message.severity, message.code, message.text, message.numbers, message.stretches,
        message.body);
  }

  template <typename Value>
  static constexpr bool is_plain =
      std::is_trivially_copyable_v<Value> && !requires(Value & value, JournalValues& values) {
    value.keep(values);
  };

  std::size_t length(std::size_t count) {
    if (payload_ != nullptr) return payload_->take_count();
    record_->put_count(count);
    return count;
  }

  std::size_t bytes_of(std::size_t count, std::size_t size) const {
    if (count > kMostPayloadBytes / size) payload_->refuse("a list that is too long");
    return count * size;
  }

  JournalRecord* record_ = nullptr;
  JournalPayload* payload_ = nullptr;
};

}  // namespace clearway
