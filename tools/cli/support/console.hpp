#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "clearway/progress.hpp"
#include "cli/support/signals.hpp"
#include "core/util/progress.hpp"

namespace clearway::tool {

/// Sends the log to standard error: plain lines with a level.
void start_log();

/// Shows progress with rate and time left on standard error where that is a terminal, and nothing
/// elsewhere. Asks to stop when a signal did (cli/support/signals.hpp).
class ConsoleProgress final : public Progress {
 public:
  ConsoleProgress();
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
  std::mutex mutex_;
  std::string stage_, unit_;
  std::uint64_t total_ = 0, done_ = 0;
  Clock::time_point start_, drawn_;
};

/// Logs a note or a warning of the library.
void log_message(const Message& message);

/// Sends progress and messages of a library call to the terminal and makes the call stop when a
/// signal asks to.
template <typename Options>
void watch_call(Options& call, ConsoleProgress& progress) {
  call.progress = [&progress](const ProgressUpdate& update) { progress.update(update); };
  call.message = log_message;
  call.stop = &stop_flag();
}

}  // namespace clearway::tool
