#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

#include "campaign/task_state.hpp"
#include "core/util/stopwatch.hpp"
#include "io/system/file.hpp"

namespace clearway::tool {

/// What a shell says of a process that a signal ended, beside the signal.
inline constexpr int kSignalled = 128;

/// A task that this process is at work on: its folder, locked, and the state that is told there.
class TaskFolder {
 public:
  /// Makes the folder, and takes its lock; removes what is there of other questions and inputs.
  /// Throws ResourceError where another process is at work on the task, InputError where the file
  /// of the result is damaged.
  TaskFolder(const campaign::Task& task, const std::filesystem::path& campaign);

  const campaign::Task& task() const { return task_; }
  const std::filesystem::path& path() const { return path_; }
  int lock_descriptor() const { return lock_.descriptor(); }
  /// Whether another process finished it before the lock was taken: nothing is to be done.
  bool is_done() const { return done_; }

  std::filesystem::path log() const { return path_ / "log.txt"; }
  /// What clearway run prints.
  std::filesystem::path run_output() const { return path_ / "run.json"; }

  /// To be called before each command: what it then tells is its own.
  void begin_command(std::size_t number);
  std::size_t command() const { return command_; }

  /// How the try ended, for status and report; the lock goes with the object. code: an exit code,
  /// or 128 and the signal that killed. Gives the state as written.
  const campaign::TaskState& end(int code);

 private:
  void remove_others();
  void remove_of_other_inputs(const std::optional<campaign::TaskState>& earlier);
  void refuse_damaged_result();
  std::string last_error() const;
  void judge_result();
  void judge_refusal(int code);
  void refuse_changed_inputs(const std::string& details);

  const campaign::Task& task_;
  std::filesystem::path path_;
  File lock_;
  bool done_ = false;
  campaign::TaskState state_;
  std::size_t command_ = 0;
  std::uint64_t log_begin_ = 0;
  Stopwatch time_;
};

}  // namespace clearway::tool
