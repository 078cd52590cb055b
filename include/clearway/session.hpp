#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "clearway/query.hpp"
#include "clearway/result.hpp"
#include "clearway/search.hpp"
#include "clearway/store.hpp"

/// A session answers many questions about one environment. What one question has opened, started
/// and built stays for the next ones, so that a question of one pose takes milliseconds.
namespace clearway {

/// The machine that a session may use, for all of its questions together.
struct SessionOptions {
  Device device = Device::kAuto;
  std::vector<int> gpus = {};  ///< CUDA's device numbers; empty: the first GPU with room
  int threads = 0;             ///< threads of each question; 0: all cores
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  std::uint64_t device_memory_bytes = 0;  ///< budget on each device; 0: 2 GiB, or what is free
};

/// How one question of a session is asked. The answer depends on none of these options.
struct QuestionOptions {
  Engine engine = Engine::kSweep;
  bool strict = false;                       ///< any warning ends with InputError
  std::vector<Message> input_warnings = {};  ///< as in SearchOptions
  ProgressCallback progress = nullptr;
  MessageCallback message = nullptr;  ///< receives notes, and the warnings that the answer holds
  StopFlag stop = nullptr;
};

/// The answer to a question with its tables in memory. Copies share the tables.
class SessionAnswer : public SearchReport {
 public:
  SessionAnswer();
  ~SessionAnswer();
  SessionAnswer(const SessionAnswer&);
  SessionAnswer(SessionAnswer&&) noexcept;
  SessionAnswer& operator=(const SessionAnswer&);
  SessionAnswer& operator=(SessionAnswer&&) noexcept;

  // Tables that the query does not ask for are empty.
  const Collisions& collisions() const;
  const Clearances& clearances() const;
  const Profile& profile() const;
  const Nearby& near() const;
  const UnseenCubes& unseen() const;

  /// Writes the result file that search() writes for the same question, byte for byte. Throws
  /// UsageError for an output that exists without `overwrite`, ResourceError for a full disk.
  void save(const std::filesystem::path& output, bool overwrite = false) const;

 private:
  friend class Session;
  struct Tables;
  std::shared_ptr<const Tables> tables_;
};

/// An environment that stays open for questions, with the GPUs that were started, the points that
/// are there, and what is looked up of the models that were asked about. Several threads may ask at
/// once. They share the memory of the options: a question waits where its memory is in use by
/// others. A question that fails or is stopped leaves the session as it was.
class Session {
 public:
  /// Throws InputError where the file is not an intact store of this version, ResourceError where
  /// it cannot be read, or where a device is asked for and missing, and UsageError where the
  /// options contradict each other.
  explicit Session(const std::filesystem::path& store, const SessionOptions& options = {});
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  const Store& store() const;
  const SessionOptions& options() const;

  /// Answers a question as search() does, in memory. Throws as search() does, and InputError where
  /// the store's file was replaced or changed since it was opened, or could not be read.
  SessionAnswer search(const Query& query, const QuestionOptions& options = {}) const;

  /// Forgets the models that were asked about, and what else waits for questions on the host and on
  /// GPUs, which gives the memory back.
  void forget_models() const;
  /// Bytes of memory that the session keeps for questions to come, besides the mapped store.
  std::uint64_t kept_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
