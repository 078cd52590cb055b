#include "clearway/search.hpp"

#include <tbb/task_arena.h>

#include <cmath>
#include <memory>

#include "clearway/error.hpp"
#include "core/geometry/point_box.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/callback_progress.hpp"
#include "core/util/stopwatch.hpp"
#include "io/result/result_rows.hpp"
#include "io/system/pending_file.hpp"
#include "io/trajectory/content_hash.hpp"
#include "search/check_query.hpp"
#include "search/checks/query_warnings.hpp"
#include "search/choice/choose_engine.hpp"
#include "search/devices.hpp"
#include "search/kdtree_search.hpp"
#include "search/kinds/cuda_kind.hpp"
#include "search/kinds/grid_kind.hpp"
#include "search/kinds/sweep_kind.hpp"
#include "search/page_search.hpp"
#include "search/run_journal.hpp"
#include "search/threads.hpp"
#include "stream/write_result.hpp"

namespace clearway {
namespace {

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
        header_(header()) {
    if (!options.overwrite && !options.resume) pending_.refuse_existing();
  }

  SearchReport run() {
    check();
    report_sizes();
    if (journal_.already_done(store_, header_, progress_)) {
      report_finished();
    } else {
      resolve_device();
      publish(find());
    }
    report_.seconds.total = total_.seconds();
    return std::move(report_);
  }

 private:
  ResultHeader header() const {
    const StoreMetadata& metadata = store_.metadata();
    return {query_,
            metadata.input_points,
            metadata.points_hash,
            query_.model.size(),
            hash_of_model(query_.model),
            query_.poses.size(),
            hash_of_trajectory(query_.poses),
            query_.tolerance > 0 ? name_of(chosen_engine(options_)) : "",
            options_.float_precision,
            metadata.quantisation,
            metadata.crs_wkt,
            false,
            query_.model.empty() ? Box{} : box_of(query_.model)};
  }

  /// Before anything is searched, and of a result that is there already too.
  void check() {
    for (const Message& told : options_.input_warnings) {
      if (told.severity == Message::Severity::kWarning) report_.warnings.push_back(told);
    }
    check_sizes(query_);
    warn_of_query(store_, query_, log_);
    if (options_.strict) refuse_warnings(report_.warnings);
  }

  void report_sizes() {
    report_.environment_points = store_.point_count();
    report_.model_points = query_.model.size();
    report_.poses = query_.poses.size();
    report_.cells_total = store_.cells().size();
  }

  /// The result that was there already.
  void report_finished() {
    const ResultReader result(journal_.output());
    report_.was_finished = true;
    report_.colliding_points = result.collisions();
    report_.clearance_points = result.clearances();
    ProfileRowStream profile(result);
    std::uint32_t pose = 0;
    for (ProfileRows rows; profile.read(rows);) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        report_pose(pose++, rows.distance[i], rows.source[i]);
      }
    }
  }

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
    const DeviceChoice device = choose_device(options_, log_);
    if (options_.threads == 0) options_.threads = tbb::this_task_arena::max_concurrency();
    check_threads(options_.threads);
    choose_engine(store_, query_, journal_.earlier_engine(), device.is_cuda(), options_, report_,
                  log_);
    report_.engine = options_.engine;
    report_.searches = report_.poses * report_.model_points;
    report_.seconds.context = device.context_seconds;
    Found found = options_.engine == Engine::kKdtree
                      ? search_kdtree(store_, query_, options_, open_journal(), progress_, report_)
                      : find_on_pages(device);
    report_.resumed_cells = journal_.earlier().cells;
    report_.resumed_poses = journal_.earlier().poses;
    return found;
  }

  /// A GPU that was not asked for and proves too small, or fails, before the journal is open gives
  /// way to the CPU.
  Found find_on_pages(const DeviceChoice& device) {
    try {
      return find_on(device);
    } catch (const ResourceError& error) {
      if (open_ != nullptr || !device.fallback_allowed) throw;
      log_.note(std::string("the CPU is taken: ") + error.what());
    }
    return find_on({});
  }

  Found find_on(const DeviceChoice& device) {
    report_.device = device.is_cuda() ? Device::kCuda : Device::kCpu;
    report_.device_name = device.name;
    if (!device.fallback_allowed) open_journal();  // what is refused is so before it is planned
    const std::unique_ptr<PageEngineKind> kind = kind_on(device);
    return search_pages(
        store_, query_, options_.memory_bytes, *kind,
        [this]() -> SearchJournal& { return open_journal(); }, progress_, report_, log_);
  }

  std::unique_ptr<PageEngineKind> kind_on([[maybe_unused]] const DeviceChoice& device) const {
#ifdef CLEARWAY_CUDA
    if (device.is_cuda()) return cuda_kind(store_, query_, options_, device);
#endif
    if (options_.engine == Engine::kGrid) {
      return std::make_unique<CpuGridKind>(store_, query_, options_);
    }
    return std::make_unique<CpuSweepKind>(store_, query_, options_);
  }

  SearchJournal& open_journal() {
    if (open_ == nullptr) {
      open_ = &journal_.open(store_, query_, header_, report_.engine, report_.device);
    }
    return *open_;
  }

  void publish(const Found& found) {
    const Stopwatch write;
    try {
      const std::vector<double> chainage =
          query_.profile > 0 ? chainage_of(query_.poses) : std::vector<double>();
      write_result(store_, found.result, header_, pending_.partial(), found.write_bytes, progress_,
                   chainage);
      pending_.publish();
    } catch (const ResourceError& error) {
      throw ResourceError(error.what(), Remedy::kResume);
    }
    journal_.remove_after_publication();
    const StoreReader::Touched touched = store_.touched();
    report_.cells_read = touched.cells;
    report_.bytes_read = touched.bytes;
    report_.colliding_points = found.result.hits.count();
    report_.clearance_points = found.result.clearances.count();
    report_profile(found.result.profile);
    report_.seconds.write = write.seconds();
  }

  void report_profile(const ProfileSet& profile) {
    for (std::uint32_t pose = 0; pose < profile.poses(); ++pose) {
      const ProfilePoint& point = profile.at(pose);
      report_pose(pose, std::sqrt(point.squared), point.source);
    }
  }

  void report_pose(std::uint32_t pose, double distance, std::uint64_t source) {
    if (std::isinf(distance)) return;
    ++report_.profile_poses;
    if (report_.least && report_.least->distance <= distance) return;
    report_.least = {distance, pose, source};
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
  const ResultHeader header_;
  SearchJournal* open_ = nullptr;
};

}  // namespace

const char* name_of(Engine engine) {
  switch (engine) {
    case Engine::kSweep:
      return "sweep";
    case Engine::kGrid:
      return "grid";
    case Engine::kKdtree:
      return "kdtree";
    case Engine::kAuto:
      break;
  }
  return "auto";
}

const char* name_of(Device device) {
  switch (device) {
    case Device::kCpu:
      return "cpu";
    case Device::kCuda:
      return "cuda";
    case Device::kAuto:
      break;
  }
  return "auto";
}

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
  refuse_overwriting(output, {store.path()});
  return Search(store, query, output, options).run();
}

}  // namespace clearway
