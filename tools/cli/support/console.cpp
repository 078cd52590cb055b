#include "cli/support/console.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <set>

#include "clearway/error.hpp"
#include "cli/support/program.hpp"
#include "io/files/file.hpp"

namespace clearway::tool {

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw system_failure("standard output: cannot write", errno);
  }
}

void occupy_standard_descriptors() {
  constexpr std::array<int, 3> kModes{O_WRONLY, O_RDONLY, O_RDWR};
  for (int descriptor = 0; descriptor < 3; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    if (::open("/dev/null", kModes[descriptor]) != descriptor) {
      throw ResourceError("/dev/null: cannot open: " + std::string(std::strerror(errno)));
    }
  }
}

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

namespace {

constexpr auto kRedraw = std::chrono::milliseconds(100);

std::string short_number(double value) {
  const char* suffixes[] = {"", " k", " M", " G"};
  int suffix = 0;
  for (; value >= 1000 && suffix < 3; ++suffix) value /= 1000;
  char text[32];
  std::snprintf(text, sizeof text, "%.3g%s", value, suffixes[suffix]);
  return text;
}

std::string short_time(double seconds) {
  char text[32];
  const long whole = std::lround(seconds);
  std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  return text;
}

/// The width of the terminal at standard error, asked anew because it can change at any time.
std::size_t terminal_columns() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* columns = std::getenv("COLUMNS");
  const long number = columns != nullptr ? std::strtol(columns, nullptr, 10) : 0;
  constexpr long kUsual = 80;
  return static_cast<std::size_t>(number > 0 ? number : kUsual);
}

/// The first text that leaves the terminal's last column free, because some terminals wrap there.
/// Where none does, the last text, cut.
std::string first_that_fits(std::initializer_list<std::string> texts) {
  const std::size_t room = terminal_columns() - 1;
  for (const std::string& text : texts) {
    if (text.size() <= room) return text;
  }
  return std::data(texts)[texts.size() - 1].substr(0, room);
}

}  // namespace

void start_log() {
  spdlog::drop("clearway");  // a forked process may have inherited a log
  auto logger = spdlog::stderr_logger_mt("clearway");
  logger->set_pattern("%l: %v");
  spdlog::set_default_logger(std::move(logger));
}

ConsoleProgress::ConsoleProgress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

ConsoleProgress::~ConsoleProgress() {
  if (is_drawn_) std::fputs("\n", stderr);
}

void ConsoleProgress::begin(std::string_view stage, std::uint64_t total, std::string_view unit) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  unit_ = unit;
  total_ = total;
  done_ = 0;
  start_ = drawn_ = Clock::now();
}

void ConsoleProgress::advance(std::uint64_t units) {
  const std::lock_guard lock(mutex_);
  done_ += units;
  draw_when_due();
}

void ConsoleProgress::draw_when_due() {
  const auto now = Clock::now();
  if (terminal_ && now - drawn_ >= kRedraw) draw(now);
}

void ConsoleProgress::update(const ProgressUpdate& update) {
  if (update.finished) return end();
  if (update.done == 0) return begin(update.stage, update.total, update.unit);
  const std::lock_guard lock(mutex_);
  done_ = update.done;
  draw_when_due();
}

void ConsoleProgress::end() {
  const std::lock_guard lock(mutex_);
  if (is_drawn_) std::fputs("\r\033[K", stderr);
  is_drawn_ = false;
}

bool ConsoleProgress::stop_requested() const { return tool::stop_requested(); }

void ConsoleProgress::draw(Clock::time_point now) {
  drawn_ = now;
  is_drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double rate = static_cast<double>(done_) / std::max(seconds, 1e-9);
  const std::string speed = ", " + short_number(rate) + " " + unit_ + "/s";
  const std::string done = short_number(static_cast<double>(done_));
  std::string line;
  if (total_ > 0) {
    const double share = static_cast<double>(done_) / static_cast<double>(total_);
    const double left =
        static_cast<double>(total_ - std::min(done_, total_)) / std::max(rate, 1e-9);
    const std::string of = " of " + short_number(static_cast<double>(total_)) + " " + unit_;
    const std::string percent = std::to_string(static_cast<int>(100 * share)) + " %";
    const std::string time = ", " + short_time(left) + " left";
    line = first_that_fits({stage_ + ": " + done + of + ", " + percent + speed + time,
                            stage_ + ": " + done + of + ", " + percent + time,
                            stage_ + ": " + percent + time, stage_ + ": " + percent, percent});
  } else {
    line = first_that_fits(
        {stage_ + ": " + done + " " + unit_ + speed, stage_ + ": " + done + " " + unit_, done});
  }
  std::fprintf(stderr, "\r%s\033[K", line.c_str());
}

namespace {

/// The messages that were logged; nothing where messages may be repeated.
std::optional<std::set<std::string>> logged;
std::mutex logged_mutex;

bool is_repeated(const Message& message) {
  const std::lock_guard lock(logged_mutex);
  return logged && !logged->insert(message.text).second;
}

}  // namespace

void log_messages_once() {
  const std::lock_guard lock(logged_mutex);
  logged.emplace();
}

void log_message(const Message& message) {
  if (is_repeated(message)) return;
  const bool warning = message.severity == Message::Severity::kWarning;
  spdlog::log(warning ? spdlog::level::warn : spdlog::level::info, "{}{}", message.text,
              advice_on(message));
}

}  // namespace clearway::tool
