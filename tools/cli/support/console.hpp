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

/// A progress bar with rate and time left on standard error where that is a terminal; nothing
/// elsewhere. Asks to stop when a signal did (cli/signals.hpp).
class ConsoleProgress final : public Progress {
 public:
  ConsoleProgress();
  void begin(std::string_view stage, std::uint64_t total, std::string_view unit) override;
  void advance(std::uint64_t units) override;
  void end() override;
  bool stop_requested() const override;
  /// Of a library call that tells how far it is by callbacks.
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

/// Progress and messages of a library call go to the terminal; it stops when a signal asks to.
template <typename Options>
void watch_call(Options& call, ConsoleProgress& progress) {
  call.progress = [&progress](const ProgressUpdate& update) { progress.update(update); };
  call.message = log_message;
  call.stop = &stop_flag();
}

}  // namespace clearway::tool
