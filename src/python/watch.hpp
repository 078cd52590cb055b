#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"
#include "python/python.hpp"

namespace clearway::python {

/// A ProgressUpdate that outlives the call that it was given to.
struct KeptProgress {
  std::string stage, unit;
  std::uint64_t done = 0, total = 0;
  bool finished = false;
};

/// A long call of the library, watched from Python. The work is done on a thread of its own, and
/// only the calling thread runs Python: every 50 ms it passes what is new to the callbacks, looks
/// at the stop flag, and lets Python handle signals, so that Ctrl-C raises KeyboardInterrupt. An
/// exception that is raised there stops the work; once the work has ended in order, the
/// exception leaves run(). The threads of OpenMP belong to the thread of the work and end with it,
/// so that a process may search after fork().
class Watch {
 public:
  /// given: the arguments of the call, of which `progress` and `message` are callables or None, and
  /// `stop` is None or an object with is_set(), such as a threading.Event. Not every call has
  /// `message`. options: get what watches the call.
  template <typename Options>
  Watch(const py::kwargs& given, Options& options)
      : progress_(given["progress"]),
        message_(given.contains("message") ? py::object(given["message"]) : py::none()),
        stop_(given["stop"]) {
    options.progress = [this](const ProgressUpdate& update) { keep(update); };
    options.stop = &stopped_;
    if constexpr (requires { options.message; }) {
      options.message = [this](const Message& message) { keep(message); };
    }
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Runs `work` on the other thread and returns what it returns, or throws what it throws. `work`
  /// must not touch Python.
  template <typename Work>
  auto run(Work work) {
    std::optional<std::invoke_result_t<Work>> result;
    std::exception_ptr thrown;
    run_thread([&] {
      try {
        result.emplace(work());
      } catch (...) {
        thrown = std::current_exception();
      }
    });
    if (raised_) throw py::error_already_set(*std::exchange(raised_, std::nullopt));
    if (thrown) std::rethrow_exception(thrown);
    return std::move(*result);
  }

 private:
  struct News {
    std::vector<KeptProgress> progress = {};
    std::vector<Message> messages = {};
    bool done = false;
  };

  void keep(const ProgressUpdate& update);
  void keep(const Message& message);
  void run_thread(const std::function<void()>& work);
  void finish();
  News next_news();
  void pass_on(const News& news);
  void look();
  /// Calls a function that may raise. The first exception is kept and stops the work.
  template <typename Call>
  void guarded(Call call);

  const py::object progress_, message_, stop_;
  std::atomic<bool> stopped_ = false;
  std::optional<py::error_already_set> raised_;

  std::mutex mutex_;
  std::condition_variable changed_;
  News news_;  // guarded by the mutex
};

}  // namespace clearway::python
