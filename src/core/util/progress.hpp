#pragma once

#include <cstdint>
#include <string_view>

#include "clearway/error.hpp"

namespace clearway {

/// Receives the progress of a long operation, and may ask it to stop. advance() and
/// stop_requested() may be called from several threads.
class Progress {
 public:
  virtual ~Progress() = default;
  /// Begins a stage of `total` units; total 0 means unknown.
  virtual void begin(std::string_view stage, std::uint64_t total, std::string_view unit) = 0;
  virtual void advance(std::uint64_t units) = 0;
  virtual void end() = 0;
  /// Whether the operation has to finish what is in flight, begin nothing more and throw
  /// Interrupted.
  virtual bool stop_requested() const { return false; }
};

inline void throw_if_stopped(const Progress& progress) {
  if (progress.stop_requested()) throw Interrupted("interrupted");
}

/// A Progress that discards everything.
class NoProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void end() override {}
};

}  // namespace clearway
