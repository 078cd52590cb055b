#include "search/ignored/colliding_ignored.hpp"

#include <algorithm>
#include <atomic>
#include <bit>

#include "core/cloud/kd_order.hpp"
#include "core/geometry/inside.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/body_pose.hpp"
#include "core/query/hit_set.hpp"
#include "core/query/ignored_text.hpp"
#include "core/util/format.hpp"
#include "io/formats/length_unit.hpp"
#include "search/checks/words.hpp"
#include "search/page_budget.hpp"
#include "stream/run_pages.hpp"

namespace clearway {
namespace {

/// The height in metres above the model's lowest point from which on an ignored point is
/// suspicious. Ground and rails are lower, and are ignored because the model stands on them; nobody
/// wants to ignore what the model hits further up.
constexpr double kHigh = 0.5;

/// kHigh in the environment's unit. Where the unit is unknown, or is no length, metres are assumed.
double high_in(LengthUnit unit) {
  const double metres = metres_of(unit);
  return metres > 0 ? kHigh / metres : kHigh;
}

/// Tells how high points are in the frame of the body that touches them.
class Heights {
 public:
  Heights(const StoreReader& store, const Query& query)
      : store_(store), query_(query), numbers_(query) {
    bool any = false;
    const auto lower_to = [&](const std::vector<Vec3>& model) {
      for (const Vec3& p : model) {
        if (!any || p.z < lowest_) lowest_ = p.z;
        any = true;
      }
    };
    lower_to(query.model.vertices);
    for (const Body& body : query.bodies) lower_to(body.model.vertices);
    limit_ = high_in(store.metadata().unit);
  }

  /// Whether a point is well above the model's lowest point at the pose at which it is first
  /// touched. number: the number that BodyNumbers gives that pose and body.
  bool is_high(const Vec3& e, std::uint32_t number) const {
    const std::uint32_t pose = numbers_.pose_of(number);
    const Pose* of = query_.bodies.empty() ? &query_.poses[pose]
                                           : pose_at(query_.bodies[numbers_.body_of(number)], pose);
    return of != nullptr && pulled_back(*of, e).z - lowest_ > limit_;
  }

  /// Counts the high points among the points of a cell that collide, which hits marks.
  std::uint64_t count(std::uint32_t cell, std::span<const std::uint64_t> hits,
                      std::span<const std::uint32_t> first_poses) const {
    const auto q = store_.coordinates(cell);
    std::uint64_t high = 0;
    for (std::size_t block = 0; block < hits.size(); ++block) {
      for (std::uint64_t open = hits[block]; open != 0; open &= open - 1) {
        const auto i = block * kBlockPoints + static_cast<unsigned>(std::countr_zero(open));
        const auto at = static_cast<std::uint32_t>(i);
        const Vec3 e = position(store_.quantisation(), q[0][at], q[1][at], q[2][at]);
        high += is_high(e, first_poses[i]) ? 1 : 0;
      }
    }
    return high;
  }

 private:
  const StoreReader& store_;
  const Query& query_;
  const BodyNumbers numbers_;
  double lowest_ = 0, limit_ = 0;
};

}  // namespace

Query query_of_ignored(const Query& query) {
  Query out = query;
  out.first_pose = true;
  out.clearance = out.profile = out.tolerance = 0;
  return out;
}

CollidingIgnored count_colliding_ignored(const StoreReader& store, const Query& query,
                                         std::uint64_t memory_bytes, PageEngineKind& kind,
                                         const ShardCells* only, Progress& progress) {
  PageBudget budget(store, query, query, 0, memory_bytes, kind, only,
                    IgnoredPoints::Search::kIgnored);
  budget.find();
  throw_if_stopped(progress);
  PageEngines engines = kind.make(budget.layout());
  const std::vector<PlannedPage> pages =
      paginate(store, budget.cells(), budget.layout().page_bytes, budget.layout().cells, true);
  std::vector<PageEngine*> lanes;
  for (const auto& engine : engines) lanes.push_back(engine.get());
  const Heights heights(store, query);
  std::atomic<std::uint64_t> points = 0, high = 0;
  const CollectPage count = [&](std::span<const PlannedCell> cells, const PageResult& found) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto hits = part_of_cell(found.hits, i, store.blocks_per_cell());
      const std::uint32_t colliding = IgnoredPoints::count(hits);
      if (colliding == 0) continue;
      points += colliding;
      high += heights.count(cells[i].cell, hits,
                            part_of_cell(found.first_poses, i, store.cell_entries()));
    }
  };
  StageTimes times;
  run_pages(store, budget.cells(), pages, lanes,
            {.stage = "ignored", .ignored = budget.ignored(), .threads = kind.needs().threads},
            count, progress, times);
  SearchReport taken;
  const MessageCallback silent;
  std::vector<Message> none;
  kind.report_search({lanes.data(), lanes.size()}, taken, MessageLog(silent, none));
  kind.end(std::move(engines)).clear();
  return {points, high, budget.needed_bytes(), taken.peak_device_bytes};
}

void warn_of_colliding_ignored(const Answer& answer, bool model_is_cut, LengthUnit unit,
                               MessageLog& log) {
  if (!answer.ignored_colliding || answer.shard) return;
  const std::uint64_t colliding = *answer.ignored_colliding;
  const std::uint64_t high = answer.ignored_colliding_high.value_or(0);
  const auto warn = [&](const char* code, std::string text, double points) {
    log.warn(code, std::move(text), {{"colliding", points}});
  };
  const std::string of_ignored = " of the " + ignored_text(answer.parameters, answer.ignored);
  if (colliding > answer.colliding_points && !model_is_cut) {
    warn("ignored-collide",
         format_count(colliding) + of_ignored + " would collide, but only " +
             counted(answer.colliding_points, "searched point") +
             (answer.colliding_points == 1 ? " does" : " do") +
             ": the answer may be what was ignored. If they are the ground below the wheels, leave "
             "the lowest part of the model out instead of the ground",
         static_cast<double>(colliding));
  }
  if (high > 0) {
    warn("ignored-high",
         format_count(high) + of_ignored + " would collide more than " +
             length_text(high_in(unit), unit) +
             " above the model's lowest point, where no ground is: " +
             "the model hits what was ignored. Ignore the ground alone",
         static_cast<double>(high));
  }
}

}  // namespace clearway
