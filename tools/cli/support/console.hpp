#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "clearway/progress.hpp"
#include "core/util/progress.hpp"

namespace clearway::tool {

/// Writes to standard output and flushes. Throws ResourceError where that fails.
void print(std::string_view text);

/// Opens standard descriptors that are closed, because otherwise an output file would get such a
/// descriptor, and what is printed would be written into it. Reading and printing through them then
/// fail, but messages are lost silently.
void occupy_standard_descriptors();

bool stop_requested();
/// The flag that stop_requested() reads.
const std::atomic<bool>& stop_flag();

/// Does the work of a command on `output`. SIGINT and SIGTERM ask it to stop (stop_requested());
/// where it then throws Interrupted, the message names the output and gives `advice`. Where it has
/// not ended kGraceSeconds later, the advice goes to standard error and the process ends with exit
/// code 5, as if killed. A second signal ends it at once in the same way. To be called once.
void run_stoppable(const std::filesystem::path& output, const std::string& advice,
                   const std::function<void()>& work);

inline constexpr unsigned kGraceSeconds = 4;

/// The advice of commands that keep nothing of what they began.
inline constexpr const char* kStartsAgain = "the same command starts it again";

/// Sends the log to standard error: plain lines with a level.
void start_log();

/// Shows progress with rate and time left on standard error where that is a terminal, and nothing
/// elsewhere. Asks to stop when a signal did.
class ConsoleProgress final : public Progress {
 public:
  ConsoleProgress();
  /// Ends the line of a stage that an error or a signal left unfinished.
  ~ConsoleProgress() override;
  void begin(std::string_view stage, std::uint64_t total, std::string_view unit) override;
  void advance(std::uint64_t units) override;
  void end() override;
  bool stop_requested() const override;
  /// Shows the progress that a library call reports by callbacks.
  void update(const ProgressUpdate& update);

 private:
  using Clock = std::chrono::steady_clock;
  void draw_when_due();
  void draw(Clock::time_point now);

  bool terminal_;
  bool is_drawn_ = false;  ///< whether the terminal shows a line of the stage
  std::mutex mutex_;
  std::string stage_, unit_;
  std::uint64_t total_ = 0, done_ = 0;
  Clock::time_point start_, drawn_;
};

/// Logs a note or a warning of the library.
void log_message(const Message& message);

/// Makes log_message() log no message twice, for a command whose steps read the same files.
void log_messages_once();

/// Sends progress and messages of a library call to the terminal and makes the call stop when a
/// signal asks to.
template <typename Options>
void watch_call(Options& call, ConsoleProgress& progress) {
  call.progress = [&progress](const ProgressUpdate& update) { progress.update(update); };
  call.message = log_message;
  call.stop = &stop_flag();
}

}  // namespace clearway::tool
