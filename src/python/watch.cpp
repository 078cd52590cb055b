#include "python/watch.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <system_error>
#include <utility>

#include "core/util/threads.hpp"

namespace clearway::python {
namespace {

constexpr std::chrono::milliseconds kLook{50};

/// The stop flags of all calls that are under way in this process.
struct Calls {
  std::mutex mutex;
  std::condition_variable changed;
  std::map<std::atomic<bool>*, pid_t> stops;  // a forked process also has those of its parent
  bool ending = false;
};

Calls& calls() {
  static auto* all = new Calls;  // never deleted, because threads may use it until the process ends
  return *all;
}

/// Stops the calls that are under way, and waits until they have ended. Called when Python ends, so
/// that threads for which Python does not wait end in order before the libraries that they use.
void end_calls() {
  const py::gil_scoped_release released;
  Calls& all = calls();
  std::unique_lock lock(all.mutex);
  all.ending = true;
  for (const auto& [stop, process] : all.stops) *stop = true;
  all.changed.wait(lock, [&] {
    return std::ranges::none_of(all.stops, [](const auto& s) { return s.second == getpid(); });
  });
}

/// A thread that is joined however its scope is left.
class Joined {
 public:
  Joined(std::atomic<bool>& stop, const std::function<void()>& work) : stop_(stop) {
    Calls& all = calls();
    const std::lock_guard lock(all.mutex);
    if (all.ending) stop_ = true;
    try {
      thread_ = std::thread(work);
    } catch (const std::system_error& error) {
      refuse_threads(2, error.what());
    }
    all.stops[&stop_] = getpid();
  }
  Joined(const Joined&) = delete;
  Joined& operator=(const Joined&) = delete;
  ~Joined() {
    stop_ = true;
    thread_.join();
    Calls& all = calls();
    const std::lock_guard lock(all.mutex);
    all.stops.erase(&stop_);
    all.changed.notify_all();
  }

 private:
  std::atomic<bool>& stop_;
  std::thread thread_;
};

}  // namespace

void Watch::keep(const ProgressUpdate& update) {
  const std::lock_guard lock(mutex_);
  // While a stage is not finished, a new update takes the place of the one before it.
  if (!news_.progress.empty() && !news_.progress.back().finished) news_.progress.pop_back();
  news_.progress.push_back({std::string(update.stage), std::string(update.unit), update.done,
                            update.total, update.finished});
}

void Watch::keep(const Message& message) {
  const std::lock_guard lock(mutex_);
  news_.messages.push_back(message);
}

void Watch::finish() {
  {
    const std::lock_guard lock(mutex_);
    news_.done = true;
  }
  changed_.notify_one();
}

void Watch::run_thread(const std::function<void()>& work) {
  guarded([&] { look(); });
  const Joined thread(stopped_, [this, &work] {
    work();
    finish();
  });
  for (bool done = false; !done;) {
    const News news = next_news();
    done = news.done;
    guarded([&] { pass_on(news); });
    guarded([&] { look(); });
  }
}

Watch::News Watch::next_news() {
  return without_gil([this] {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kLook, [this] { return news_.done; });
    return std::exchange(news_, {.done = news_.done});
  });
}

void Watch::pass_on(const News& news) {
  if (raised_) return;
  if (!message_.is_none()) {
    for (const Message& message : news.messages) message_(message);
  }
  if (!progress_.is_none()) {
    for (const KeptProgress& update : news.progress) progress_(update);
  }
}

void Watch::look() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (!stop_.is_none() && stop_.attr("is_set")().cast<bool>()) stopped_ = true;
}

template <typename Call>
void Watch::guarded(Call call) {
  try {
    call();
  } catch (py::error_already_set& error) {
    stopped_ = true;
    if (!raised_) raised_.emplace(std::move(error));
  }
}

void add_watch() { py::module_::import("atexit").attr("register")(py::cpp_function(end_calls)); }

}  // namespace clearway::python
