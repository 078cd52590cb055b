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
  std::string_view stage;  ///< name of the stage for the user, valid during the call
  std::uint64_t done = 0;
  std::uint64_t total = 0;  ///< 0 if not known
  std::string_view unit;    ///< unit of done and total, valid during the call
  bool finished = false;    ///< whether the stage has ended
};

/// Consecutive poses of the path, from the first to the last one.
struct PoseRange {
  std::uint32_t first = 0, last = 0;

  friend bool operator==(const PoseRange&, const PoseRange&) = default;
};

/// A note or a warning to the user about a running call.
struct Message {
  enum class Severity { kNote, kWarning };
  Severity severity = Severity::kNote;
  std::string code;  ///< for a warning: the same code for the same cause, for example "no-poses"
  std::string text;
  /// Numbers that occur in the text, by name
  std::vector<std::pair<std::string, double>> numbers = {};
  /// The stretches of the path that the message is about, ascending and apart from each other;
  /// empty for a message about the whole question
  std::vector<PoseRange> stretches = {};
  /// The name of the one body that the message is about; empty where it is about several or about
  /// the whole question. Files do not hold it.
  std::string body = {};
};

/// Callbacks that watch a call. They are never called from two threads at once, but may be called
/// from threads other than the caller's; they must not throw.
using ProgressCallback = std::function<void(const ProgressUpdate&)>;
using MessageCallback = std::function<void(const Message&)>;

/// Flag that the caller sets to stop a call: the call finishes what is in flight and throws
/// Interrupted.
using StopFlag = const std::atomic<bool>*;

}  // namespace clearway
