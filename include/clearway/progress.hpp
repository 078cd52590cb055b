#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearway {

/// How far a stage of a long operation is.
struct ProgressUpdate {
  std::string_view stage;  ///< for people, valid during the call
  std::uint64_t done = 0;
  std::uint64_t total = 0;  ///< 0: not known
  std::string_view unit;    ///< of done and total, valid during the call
  bool finished = false;    ///< the stage ended
};

/// Something to tell people about a call that goes on.
struct Message {
  enum class Severity { kNote, kWarning };
  Severity severity = Severity::kNote;
  std::string code;  ///< of a warning: the same for the same cause, for example "no-poses"
  std::string text;
  std::vector<std::pair<std::string, double>> numbers = {};  ///< those of the text, by name
};

/// How a call is watched. A callback is never called from two threads at once, but from other
/// threads than the caller's too; it must not throw.
using ProgressCallback = std::function<void(const ProgressUpdate&)>;
using MessageCallback = std::function<void(const Message&)>;

/// Set by the caller: the call finishes what is in flight and throws Interrupted.
using StopFlag = const std::atomic<bool>*;

}  // namespace clearway
