#include "clearway/search.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "clearway/error.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/callback_progress.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "io/system/pending_file.hpp"
#include "search/check_query.hpp"
#include "search/checks/query_warnings.hpp"
#include "search/choice/choose_engine.hpp"
#include "search/choice/device_estimate.hpp"
#include "search/counts/report_counts.hpp"
#include "search/device_start.hpp"
#include "search/devices.hpp"
#include "search/ignored/count_ignored.hpp"
#include "search/kdtree_search.hpp"
#include "search/kinds/body_kind.hpp"
#include "search/kinds/cuda_kind.hpp"
#include "search/kinds/grid_kind.hpp"
#include "search/kinds/sweep_kind.hpp"
#include "search/page_search.hpp"
#include "search/result_header.hpp"
#include "search/run_journal.hpp"
#include "search/shard/shard_cells.hpp"
#include "search/threads.hpp"
#include "stream/write_result.hpp"

namespace clearway {
namespace {

/// A GPU is not to be had, which has been told.
struct NoGpu {};

/// One call of search(), step by step.
class Search {
 public:
  Search(const Store& store, const Query& query, const std::filesystem::path& output,
         const SearchOptions& options)
      : store_(store.reader()),
        query_(query),
        options_(options),
        progress_(options_.progress, options_.stop),
        log_(options_.message, report_.warnings),
        pending_(output, true),
        journal_(pending_, output, options_, log_),
        header_(result_header(store_, query_, options_)) {
    if (!options.overwrite && !options.resume) pending_.refuse_existing();
    if (!options_.started) options_.started = start_devices(options_, &store);
  }

  SearchReport run() {
    check();
    report_sizes(store_, query_, report_);
    report_.ignored = header_.ignored;
    divide();
    if (journal_.already_done(store_, header_, progress_)) {
      report_finished(ResultReader(journal_.output(), Parts::kAccepted), report_);
    } else {
      resolve_device();
      Found found = find();
      publish(found);
      const Stopwatch ending;
      found.engine_end.clear();
      report_.seconds.end_wait = ending.seconds();
    }
    report_.seconds.total = total_.seconds();
    return std::move(report_);
  }

 private:
  /// Before anything is searched, and of a result that is there already too.
  void check() {
    for (const Message& told : options_.input_warnings) {
      if (told.severity == Message::Severity::kWarning) report_.warnings.push_back(told);
    }
    check_sizes(query_);
    warn_of_query(store_, query_, log_);
    warn_of_ignored(store_, header_, header_.ignored, log_);
    if (options_.strict) refuse_warnings(report_.warnings);
  }

  /// Of a shard, which cells it has.
  void divide() {
    if (!options_.shard) return;
    throw_if_stopped(progress_);
    shard_.emplace(store_, query_, *options_.shard, threads_or_all(options_.threads),
                   options_.memory_bytes);
    header_.part = shard_->part();
    report_.shard = options_.shard;
    report_.shard_share = shard_->share();
  }

  const ShardCells* only() const { return shard_ ? &*shard_ : nullptr; }

  /// Device kAuto goes on where the run that is resumed was.
  void resolve_device() {
    const Device earlier = journal_.earlier_device();
    if (options_.device == Device::kAuto && options_.gpus.empty() && earlier != Device::kAuto) {
      options_.device = earlier;
      if (earlier == Device::kCpu) options_.device_memory_bytes = 0;
    }
    throw_if_stopped(progress_);
  }

  Found find() {
    options_.threads = threads_or_all(options_.threads);
    const bool gpu = gpu_pays() && may_take_gpus(options_);
    check_threads(options_.threads);
    if (gpu && !options_.started) options_.started = std::make_shared<DeviceStart>(options_);
    choose_engine(store_, query_, journal_.earlier_engine(), gpu, options_, report_, log_);
    report_.engine = options_.engine;
    Found found =
        options_.engine == Engine::kKdtree
            ? search_kdtree(store_, query_, only(), options_, open_journal(), progress_, report_)
            : find_on_pages(gpu);
    report_.resumed_cells = journal_.earlier().cells;
    report_.resumed_poses = journal_.earlier().poses;
    return found;
  }

  /// By estimate, where neither device was asked for.
  bool gpu_pays() {
#ifdef CLEARWAY_CUDA
    const bool other = options_.engine == Engine::kGrid || options_.engine == Engine::kKdtree;
    if (!fallback_allowed(options_) || other) return true;
    report_.estimate =
        estimate_devices(workloads_of(store_, query_), query_, options_.engine, options_.threads);
    const auto [cpu, cuda] = *report_.estimate;
    if (cpu > cuda) return true;
    log_.note("the CPU is taken: by estimate it needs " + format_brief(cpu) +
              " s, a GPU with its start " + format_brief(cuda) + " s");
    return false;
#else
    return true;  // what is asked for in vain is refused later
#endif
  }

  /// A GPU that was not asked for and proves too small, or fails, before the journal is open gives
  /// way to the CPU.
  Found find_on_pages(bool gpu) {
    if (!gpu) return find_on(Device::kCpu);
    try {
      return find_on(Device::kCuda);
    } catch (const NoGpu&) {
    } catch (const ResourceError& error) {
      if (open_ != nullptr || !fallback_allowed(options_)) throw;
      log_.note(std::string("the CPU is taken: ") + error.what());
    }
    return find_on(Device::kCpu);
  }

  Found find_on(Device device) {
    report_.device = device;
    report_.device_name = DeviceChoice().name;
    // What is refused is so before it is planned.
    if (device == Device::kCpu || !fallback_allowed(options_)) open_journal();
    const std::unique_ptr<PageEngineKind> kind = kind_on(device);
    return search_pages(
        store_, query_, options_.memory_bytes, *kind, only(),
        [this]() -> SearchJournal& { return open_journal(); }, progress_, report_, log_);
  }

  std::unique_ptr<PageEngineKind> kind_on([[maybe_unused]] Device device) {
#ifdef CLEARWAY_CUDA
    if (device == Device::kCuda) {
      const OpenGpus open = [this] { return open_gpus(); };
      if (!query_.bodies.empty()) return cuda_body_kind(store_, query_, options_, open);
      return cuda_kind(store_, query_, options_, open);
    }
#endif
    if (!query_.bodies.empty()) return cpu_body_kind(store_, query_, options_);
    if (options_.engine == Engine::kGrid) {
      return std::make_unique<CpuGridKind>(store_, query_, options_);
    }
    return cpu_sweep_kind(store_, query_, options_);
  }

  /// Where the search needs them: they have been starting meanwhile. Throws NoGpu.
  DeviceChoice open_gpus() {
    if (gpus_) return *gpus_;
    const Stopwatch waiting;
    options_.started->wait();
    DeviceChoice choice = choose_device(options_, log_);
    report_.seconds.context_wait = waiting.seconds();
    report_.seconds.context = std::max(options_.started->seconds(), waiting.seconds());
    if (!choice.is_cuda()) throw NoGpu();
    report_.device_name = choice.name;
    gpus_ = choice;
    return choice;
  }

  SearchJournal& open_journal() {
    if (open_ == nullptr) {
      open_ = &journal_.open(store_, query_, header_, report_.engine, report_.device);
    }
    return *open_;
  }

  void publish(const Found& found) {
    const Stopwatch write;
    describe_part();
    try {
      const std::vector<double> chainage =
          query_.profile > 0 ? chainage_of(query_.poses) : std::vector<double>();
      report_written(write_result(store_, found.result, header_, pending_.partial(),
                                  found.write_bytes, progress_, chainage, options_.threads),
                     found.result.profile, report_);
      pending_.publish();
    } catch (const ResourceError& error) {
      throw ResourceError(error.what(), Remedy::kResume);
    }
    journal_.remove_after_publication();
    const StoreReader::Touched touched = store_.touched();
    report_.cells_read = touched.cells;
    report_.ignored_looked_at = found.result.ignored_points;
    report_.bytes_read = touched.bytes;
    report_.seconds.write = write.seconds();
  }

  /// What merging parts asks of them: how an answer that is not exact was computed, and what was
  /// warned of.
  void describe_part() {
    if (!header_.part) return;
    header_.part->warnings = report_.warnings;
    if (header_.is_exact()) return;
    header_.part->device = name_of(report_.device);
    header_.part->field_voxel = report_.field_voxel;
    header_.part->grid_cell = report_.grid_cell;
  }

  const Stopwatch total_;
  const StoreReader& store_;
  const Query& query_;
  SearchOptions options_;  ///< as resolved so far
  SearchReport report_;
  CallbackProgress progress_;
  MessageLog log_;
  PendingFile pending_;
  RunJournal journal_;
  ResultHeader header_;
  std::optional<ShardCells> shard_;
  std::optional<DeviceChoice> gpus_;  ///< once they are open
  SearchJournal* open_ = nullptr;
};

}  // namespace

void check_search(const QueryParameters& query, const std::filesystem::path& output,
                  const SearchOptions& options) {
  check_query(query, options);
  PendingFile pending(output, true);
  const MessageCallback silent;
  std::vector<Message> none;
  MessageLog log(silent, none);
  const RunJournal journal(pending, output, options, log);
  if (!options.overwrite && !options.resume) pending.refuse_existing();
}

SearchReport search(const Store& store, const Query& query, const std::filesystem::path& output,
                    const SearchOptions& options) {
  check_query(query, options);
  check_bodies(query, options);
  if (query.is_surface()) check_surface(query, options);
  if (query.is_solid()) check_solid(query);
  refuse_overwriting(output, {store.path()});
  return Search(store, query, output, options).run();
}

}  // namespace clearway
