#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

#include "campaign/task_state.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/file.hpp"

namespace clearway::tool {

/// Added to the number of the signal that ended a process, to make an exit code as a shell does.
inline constexpr int kSignalled = 128;

/// The locked folder of a task that this process works on, and the state that is written there.
class TaskFolder {
 public:
  /// Makes the folder and takes its lock; removes what earlier tries left of other questions and
  /// inputs. Throws ResourceError where another process works on the task, InputError where the
  /// file of the result is damaged.
  TaskFolder(const campaign::Task& task, const std::filesystem::path& campaign);

  const campaign::Task& task() const { return task_; }
  const std::filesystem::path& path() const { return path_; }
  int lock_descriptor() const { return lock_.descriptor(); }
  /// Whether another process finished the task before the lock was taken, so that nothing is to be
  /// done.
  bool is_done() const { return done_; }

  std::filesystem::path log() const { return path_ / "log.txt"; }
  /// The file for what `clearway run` prints.
  std::filesystem::path run_output() const { return path_ / "run.json"; }

  /// To be called before each command, so that errors in the log can be distinguished from those of
  /// earlier commands. number: from 0.
  void begin_command(std::size_t number);
  std::size_t command() const { return command_; }

  /// Writes how the try ended, for status and report, and returns the state as written. The lock is
  /// held as long as the object lives. code: an exit code, or kSignalled plus the signal that
  /// killed.
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
