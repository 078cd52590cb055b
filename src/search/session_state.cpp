#include "search/session_state.hpp"

#include <algorithm>
#include <chrono>

#include "clearway/error.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/thread_limit.hpp"
#include "search/ignored.hpp"

namespace clearway {

SharedMemory::Share::~Share() {
  if (taken_ == 0) return;
  {
    const std::lock_guard lock(memory_.mutex_);
    memory_.in_use_ -= taken_;
  }
  memory_.given_back_.notify_all();
}

void SharedMemory::set_bytes(std::uint64_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    bytes_ = bytes;
  }
  given_back_.notify_all();
}

void SharedMemory::Share::take(std::uint64_t bytes, const Progress& progress) {
  constexpr std::chrono::milliseconds kLook{50};  // how often the wish to stop is looked at
  if (taken_ > 0 || bytes == 0) return;
  std::unique_lock lock(memory_.mutex_);
  // There may be more or less memory after each wait.
  const auto wanted = [&] { return std::min(bytes, memory_.bytes_); };
  while (memory_.in_use_ + wanted() > memory_.bytes_) {
    throw_if_stopped(progress);
    memory_.given_back_.wait_for(lock, kLook);
  }
  taken_ = wanted();
  memory_.in_use_ += taken_;
}

bool SharedMemory::Share::grow(std::uint64_t bytes) {
  if (bytes <= taken_) return true;
  const std::lock_guard lock(memory_.mutex_);
  const std::uint64_t free = memory_.bytes_ - std::min(memory_.bytes_, memory_.in_use_);
  const std::uint64_t more = std::min(std::max(bytes - taken_, kMemoryStep), free);
  if (taken_ + more < bytes) return false;
  taken_ += more;
  memory_.in_use_ += more;
  return true;
}

namespace {

/// The share of a session's memory that models of earlier questions may keep.
constexpr std::uint64_t kModelsShare = 4;
/// The share of its memory that the tables of answers that are gone may keep.
constexpr std::uint64_t kSpareShare = 32;

}  // namespace

SessionState::SessionState(const Store& store, const SearchOptions& options, KeptModels::Kept kept)
    : store_(store),
      options_(options),
      models_(kept, options.memory_bytes / kModelsShare),
      looks_(models_.is_session()),
      memory_(options.memory_bytes),
      kept_on_gpus_(store.reader()),
      spare_(std::make_shared<SpareTables>(options.memory_bytes / kSpareShare)) {
  check_threads(threads_or_all(options.threads));
}

std::shared_ptr<const DeviceStart> SessionState::start(const SearchOptions& options) {
  const std::lock_guard lock(mutex_);
  if (options.started) started_ = options.started;
  if (!started_) started_ = start_devices(options, &store_);
  return started_;
}

std::shared_ptr<const DeviceStart> SessionState::start_surely(const SearchOptions& options) {
  const std::lock_guard lock(mutex_);
  if (!started_) started_ = std::make_shared<DeviceStart>(options);
  return started_;
}

bool SessionState::has_gpus() const {
  const std::lock_guard lock(mutex_);
  return gpus_.has_value();
}

DeviceChoice SessionState::gpus(const SearchOptions& options, const MessageLog& log,
                                double& waited) {
  const std::lock_guard lock(mutex_);
  if (gpus_ && still_works(*gpus_)) return *gpus_;
  if (gpus_) {
    kept_on_gpus_.forget_all();
    gpus_.reset();
  }
  const Stopwatch waiting;
  started_->wait();
  const DeviceChoice& chosen = gpus_.emplace(choose_device(options, log));
  waited = waiting.seconds();
  return chosen;
}

IgnoredPointCounts SessionState::ignored(const QueryParameters& query, int threads) {
  QueryParameters lists;
  lists.ignore_classes = query.ignore_classes;
  lists.ignore_boxes = query.ignore_boxes;
  if (!lists.ignores_points()) return {};
  const std::lock_guard lock(ignored_mutex_);
  if (ignored_of_ != lists) {
    ignored_of_.reset();
    ignored_ = count_ignored(store_.reader(), lists, threads);
    ignored_of_ = std::move(lists);
  }
  return ignored_;
}

}  // namespace clearway
