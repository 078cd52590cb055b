#pragma once

#include <cstdint>
#include <string_view>

namespace clearway {

/// Receives the progress of a long operation. advance() may be called from several threads.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage of `total` units starts; total 0 means unknown.
  virtual void begin(std::string_view stage, std::uint64_t total, std::string_view unit) = 0;
  virtual void advance(std::uint64_t units) = 0;
  virtual void end() = 0;
};

/// Discards everything.
class NoProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void end() override {}
};

}  // namespace clearway
