#include "cli/support/signals.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>

#include "clearway/error.hpp"
#include "cli/support/exit_code.hpp"

namespace clearway::tool {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

// Written before the handlers are installed; they only read it.
std::string last_words;

// Handlers call what POSIX lists as async-signal-safe, and lock-free atomics.

void end_now(int) {
  [[maybe_unused]] const auto written =
      ::write(STDERR_FILENO, last_words.data(), last_words.size());
  ::_exit(kInterrupted);
}

void ask_to_stop(int signal) {
  if (stop.exchange(true)) end_now(signal);
  ::alarm(kGraceSeconds);
}

void install(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigaction(signal, &action, nullptr);
}

/// Whether a signal is ignored. Commands in the background of a shell without job control start
/// with SIGINT ignored, and keep ignoring it.
bool is_ignored(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

void stop_on_signals(const std::string& advice) {
  last_words = "error: interrupted before the work in flight was finished; " + advice + "\n";
  install(SIGALRM, end_now);
  for (const int signal : {SIGINT, SIGTERM}) {
    if (!is_ignored(signal)) install(signal, ask_to_stop);
  }
}

}  // namespace

const std::atomic<bool>& stop_flag() { return stop; }

bool stop_requested() { return stop.load(std::memory_order_relaxed); }

void run_stoppable(const std::filesystem::path& output, const std::string& advice,
                   const std::function<void()>& work) {
  stop_on_signals(advice);
  try {
    work();
  } catch (const Interrupted&) {
    throw Interrupted(output.string() + ": interrupted; " + advice);
  }
}

}  // namespace clearway::tool
