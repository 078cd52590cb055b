#pragma once

#include <signal.h>
#include <sys/types.h>

#include <cstdint>
#include <deque>
#include <filesystem>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "campaign/plan.hpp"
#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/store.hpp"
#include "cli/campaign/task_folder.hpp"
#include "cli/run_options.hpp"

namespace clearway::tool {

/// The model of a run, or one body of its vehicle, as far as an estimate needs it.
struct EstimatedModel {
  Box box{};
  std::uint64_t points = 0;
  std::span<const Pose> poses;
};

/// Decides into how many shards runs are divided, by an estimate of their seconds.
class RunEstimate {
 public:
  /// shard_seconds: the time that one shard is to take; 0 divides no run.
  explicit RunEstimate(double shard_seconds) : shard_seconds_(shard_seconds) {}

  bool is_asked_for() const { return shard_seconds_ > 0; }

  /// The number of shards of a run with these models, at least 1. The estimate is for the device
  /// that the run asks for: a GPU, or the CPU with the run's threads, or with one thread where it
  /// names none.
  std::uint32_t shards(const RunOptions& run, const std::vector<EstimatedModel>& models);

 private:
  double shard_seconds_;
  std::optional<Store> store_;  ///< the store of the last run that was estimated
};

/// Works through tasks, `jobs` at a time, each command in a process of its own. To be constructed
/// once, while this process has one thread.
class TaskQueue {
 public:
  /// campaign: the absolute path of its folder. The plan outlives the queue. tries_again: whether
  /// to queue tasks again that were interrupted or that failed with kResource.
  TaskQueue(const campaign::Plan& plan, std::filesystem::path campaign, int jobs, bool tries_again);

  /// Does the tasks. SIGINT and SIGTERM end the running commands and the queue. Returns the exit
  /// code: kInterrupted, or the most urgent one of the tasks.
  int run();

 private:
  struct Work {
    explicit Work(TaskFolder&& of) : folder(std::move(of)) {}
    TaskFolder folder;
    pid_t child = 0;
  };

  void block_signals();
  std::deque<const campaign::Task*>::iterator next_task();
  void check_shards(const campaign::Task& task) const;
  void begin(const campaign::Task& task);
  void start_command(Work& work, std::size_t number);
  void wait();
  void look();
  void handle(int signal);
  void reap();
  void stop();
  void end_command(std::list<Work>::iterator work, int status);
  void end_task(TaskFolder& folder, int code);
  void end(const campaign::Task& task);
  bool is_tried_again(const campaign::Task& task, int code);
  void fail(const campaign::Task& task, int code, const std::string& message);

  const campaign::Plan& plan_;
  std::filesystem::path campaign_;
  std::size_t jobs_;
  std::deque<const campaign::Task*> waiting_;
  std::set<std::size_t> unfinished_;  ///< numbers of the tasks that wait or are worked on
  std::list<Work> working_;
  std::map<const campaign::Task*, int> failures_;
  std::size_t ended_ = 0;
  int code_ = 0;
  bool tries_again_, stopping_ = false, interrupted_ = false;
  sigset_t before_{}, waited_{};
};

}  // namespace clearway::tool
