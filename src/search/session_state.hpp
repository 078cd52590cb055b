#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "clearway/ignored.hpp"
#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "clearway/store.hpp"
#include "core/messages/messages.hpp"
#include "core/util/progress.hpp"
#include "search/checks/facts/model_looks.hpp"
#include "search/devices.hpp"
#include "search/kept_models.hpp"
#include "search/kept_on_gpus.hpp"
#include "stream/spare_tables.hpp"

namespace clearway {

/// The steps in which a question takes memory for what it finds.
inline constexpr std::uint64_t kMemoryStep = std::uint64_t{8} << 20;

/// Memory that questions of several threads share.
class SharedMemory {
 public:
  explicit SharedMemory(std::uint64_t bytes) : bytes_(bytes) {}

  /// Changes how much there is, also for those who wait. Shares that were taken stay.
  void set_bytes(std::uint64_t bytes);

  /// Bytes that a question has until it ends.
  class Share {
   public:
    explicit Share(SharedMemory& memory) : memory_(memory) {}
    ~Share();
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

    /// Waits until so many bytes are free, and takes them; or all bytes, where more are asked for.
    /// Does nothing after the first time. Throws Interrupted when the progress asks to stop.
    void take(std::uint64_t bytes, const Progress& progress);

    /// Takes what is missing to so many bytes, in steps, without waiting. Returns whether the share
    /// has as many now.
    bool grow(std::uint64_t bytes);

   private:
    SharedMemory& memory_;
    std::uint64_t taken_ = 0;
  };

 private:
  std::mutex mutex_;
  std::condition_variable given_back_;
  std::uint64_t bytes_;
  std::uint64_t in_use_ = 0;
};

/// What searches of one store share: the models' indexes, the GPUs, the memory. A single search has
/// one of its own. Thread safe.
class SessionState {
 public:
  /// options: those of the machine. Checks that the threads can be started. Throws ResourceError.
  SessionState(const Store& store, const SearchOptions& options, KeptModels::Kept kept);

  const Store& store() const { return store_; }
  KeptModels& models() { return models_; }
  KeptLooks& looks() { return looks_; }
  SharedMemory& memory() { return memory_; }
  SharedMemory& device_memory() { return device_memory_; }  ///< of each GPU
  KeptOnGpus& kept_on_gpus() { return kept_on_gpus_; }
  SpareTables& spare() { return *spare_; }
  /// Keeps the memory of an answer's tables that is no longer needed, also where the session ends
  /// before the answer does.
  std::shared_ptr<SpareTables> shared_spare() { return spare_; }
  bool is_session() const { return models_.is_session(); }
  /// Forgets the models, what is on the GPUs, and memory that is kept for questions to come.
  void forget() {
    models_.forget_all();
    kept_on_gpus_.forget_all();
    spare_->forget_all();
  }
  /// Bytes of memory on the host that is kept for questions to come.
  std::uint64_t kept_bytes() const { return models_.allocated_bytes() + spare_->bytes(); }

  /// The start of the GPUs, which is begun where that has not been done; null where none is
  /// started, as by start_devices().
  std::shared_ptr<const DeviceStart> start(const SearchOptions& options);
  /// As start(), but always starts what the options name.
  std::shared_ptr<const DeviceStart> start_surely(const SearchOptions& options);
  /// Whether GPUs were chosen, so that a search need not wait for their start.
  bool has_gpus() const;
  /// The GPUs, chosen at the first call, which waits for their start, and once more where the
  /// process can no longer use one of them. waited: gets the seconds of that, and stays as it is at
  /// other calls.
  DeviceChoice gpus(const SearchOptions& options, const MessageLog& log, double& waited);

  /// How many points a query leaves out of the store: count_ignored(), remembered.
  IgnoredPointCounts ignored(const QueryParameters& query, int threads);

 private:
  const Store& store_;
  const SearchOptions options_;
  KeptModels models_;
  KeptLooks looks_;
  SharedMemory memory_;
  SharedMemory device_memory_{0};
  KeptOnGpus kept_on_gpus_;
  const std::shared_ptr<SpareTables> spare_;
  mutable std::mutex mutex_;  ///< of the GPUs
  std::shared_ptr<const DeviceStart> started_;
  std::optional<DeviceChoice> gpus_;
  std::mutex ignored_mutex_;                   ///< held while ignored points are counted
  std::optional<QueryParameters> ignored_of_;  ///< the lists that ignored_ is about
  IgnoredPointCounts ignored_;
};

}  // namespace clearway
