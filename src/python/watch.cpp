#include "python/watch.hpp"

#include <chrono>
#include <utility>

namespace clearway::python {
namespace {

constexpr std::chrono::milliseconds kLook{50};

/// Joins the thread however this scope is left.
class Joined {
 public:
  Joined(std::thread thread, std::atomic<bool>& stop) : thread_(std::move(thread)), stop_(stop) {}
  Joined(const Joined&) = delete;
  Joined& operator=(const Joined&) = delete;
  ~Joined() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::thread thread_;
  std::atomic<bool>& stop_;
};

}  // namespace

Watch::Watch(py::object progress, py::object message, py::object stop)
    : progress_(std::move(progress)), message_(std::move(message)), stop_(std::move(stop)) {}

void Watch::keep(const ProgressUpdate& update) {
  const std::lock_guard lock(mutex_);
  // Of a stage that goes on only the last is told.
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
  const Joined thread(std::thread([this, &work] {
                        work();
                        finish();
                      }),
                      stopped_);
  for (bool done = false; !done;) {
    const News news = next_news();
    done = news.done;
    guarded([&] { tell(news); });
    guarded([&] { look(); });
  }
}

Watch::News Watch::next_news() {
  const py::gil_scoped_release released;
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kLook, [this] { return news_.done; });
  return std::exchange(news_, {.done = news_.done});
}

void Watch::tell(const News& news) {
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

}  // namespace clearway::python
