#include "search/ignored.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/inside.hpp"
#include "core/messages/messages.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/search_result.hpp"
#include "core/util/format.hpp"
#include "findings/check_conflicts.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "io/scans/length_unit.hpp"
#include "search/checks/question.hpp"

namespace clearway {
namespace {

/// Where a smaller share of the points is left, most of the scan is ignored and not just a part of
/// it.
constexpr double kFewLeft = 0.01;

/// Calls visit(cell, searched) for each cell in which `ignored` may leave out something, from
/// several threads at once. searched: room for the words of the cell's mask.
template <typename Visit>
void for_each_touched(const StoreReader& store, const IgnoredPoints& ignored, const Visit& visit) {
  for_each_parallel(store.cells().size(), [&](std::size_t cell) {
    const auto index = static_cast<std::uint32_t>(cell);
    if (!ignored.touches(index)) return;
    std::vector<std::uint64_t> searched(store.blocks_per_cell());
    visit(index, searched);
  });
}

QueryParameters only_classes(const QueryParameters& query) {
  QueryParameters out;
  out.ignore_classes = query.ignore_classes;
  return out;
}

QueryParameters only_boxes(std::vector<Box> boxes) {
  QueryParameters out;
  out.ignore_boxes = std::move(boxes);
  return out;
}

/// Counts the points that the boxes of `query` leave out and its classes do not.
std::uint64_t count_in_boxes(const StoreReader& store, const QueryParameters& query) {
  const IgnoredPoints all(store, query), classes(store, only_classes(query));
  const IgnoredPoints boxes(store, only_boxes(query.ignore_boxes));
  std::atomic<std::uint64_t> points = 0;
  for_each_touched(store, boxes, [&](std::uint32_t cell, std::vector<std::uint64_t>& searched) {
    const auto coordinates = [&] { return store.peek(cell); };
    const std::uint64_t of_all = all.mask(cell, searched, coordinates);
    points += of_all - (classes.any() ? classes.mask(cell, searched, coordinates) : 0);
  });
  return points;
}

/// The classes as a list of ranges, such as "2" or "2, 5-7".
std::string list_of(const std::vector<std::uint32_t>& classes) {
  std::string text;
  for (const std::string& range : number_ranges(classes)) {
    text += (text.empty() ? "" : ", ") + range;
  }
  return text;
}

void warn_of_classes(const StoreReader& store, const QueryParameters& query,
                     const IgnoredPointCounts& counts, MessageLog& log) {
  std::vector<std::uint32_t> absent, known;
  for (std::size_t i = 0; i < counts.of_classes.size(); ++i) {
    if (counts.of_classes[i] == 0) absent.push_back(query.ignore_classes[i]);
  }
  if (absent.empty()) return;
  const auto& points = store.metadata().classes->points;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (points[i] > 0) known.push_back(i);
  }
  const bool one = absent.size() == 1;
  log.warn("absent-class",
           std::string("no point has ") + (one ? "class " : "one of the classes ") +
               list_of(absent) + ": ignoring " + (one ? "it" : "them") +
               " changes nothing. The environment has " +
               (known.size() == 1 ? "class " : "classes ") + list_of(known),
           {{"classes", static_cast<double>(absent.size())}});
}

void warn_of_boxes(const QueryParameters& query, const IgnoredPointCounts& counts,
                   MessageLog& log) {
  std::vector<Box> empty;
  for (std::size_t i = 0; i < counts.in_boxes.size(); ++i) {
    if (counts.in_boxes[i] == 0) empty.push_back(query.ignore_boxes[i]);
  }
  if (empty.empty()) return;
  const bool one = empty.size() == 1;
  log.warn("empty-box",
           std::string("no point is in the ignored ") + (one ? "box " : "boxes ") +
               boxes_text(empty) + ": ignoring " + (one ? "it" : "them") +
               " changes nothing. Boxes are in the environment's coordinates and unit",
           {{"boxes", static_cast<double>(empty.size())}});
}

}  // namespace

IgnoredPointCounts count_ignored(const StoreReader& store, const QueryParameters& query,
                                 int threads) {
  IgnoredPointCounts counts;
  const auto& classes = store.metadata().classes;
  if (!query.ignore_classes.empty() && !classes) {
    throw UsageError(store.name() +
                     ": its points have no classes to ignore; expected a store of LAS or LAZ "
                     "files with classes, converted by this release");
  }
  for (const std::uint8_t value : query.ignore_classes) {
    counts.of_classes.push_back(classes->points[value]);
    counts.points += classes->points[value];
  }
  if (query.ignore_boxes.empty()) return counts;
  in_threads(threads, [&] {
    for (const Box& box : query.ignore_boxes) {
      counts.in_boxes.push_back(count_in_boxes(store, only_boxes({box})));
    }
    const bool one = query.ignore_boxes.size() == 1 && query.ignore_classes.empty();
    counts.points += one ? counts.in_boxes[0] : count_in_boxes(store, query);
  });
  return counts;
}

void warn_of_ignored(const StoreReader& store, const QueryParameters& query,
                     const IgnoredPointCounts& counts, MessageLog& log) {
  warn_of_classes(store, query, counts, log);
  warn_of_boxes(query, counts, log);
  if (query.ignores_points() && counts.points > 0 && counts.points == store.point_count()) {
    log.warn("all-ignored", "all points of the environment are ignored: nothing is searched");
    return;
  }
  const std::uint64_t left = store.point_count() - counts.points;
  if (query.ignores_points() &&
      static_cast<double>(left) < kFewLeft * static_cast<double>(store.point_count())) {
    log.warn(
        "most-ignored",
        format_count(counts.points) + " of " + format_count(store.point_count()) +
            " points of the environment are ignored, so that only " + format_count(left) +
            (left == 1 ? " is" : " are") + " searched. Ignore a class or a box that holds less",
        {{"ignored", static_cast<double>(counts.points)}, {"left", static_cast<double>(left)}});
  }
}

double above_ground(const StoreReader& store, const Query& query) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const MovingBody& body : moving_bodies(query)) {
    for (const Vec3& p : body.model.vertices) lowest = std::min(lowest, p.z);
  }
  return lowest + ground_height(store.metadata().unit);
}

CellRows high_points(const StoreReader& store, const Query& query, double above, std::uint32_t cell,
                     const CellRows& colliding) {
  if (colliding.count() == 0) return {};
  const std::vector<MovingBody> bodies = moving_bodies(query);
  const BodyNumbers numbers(query);
  const auto q = store.coordinates(cell);
  return points_where(colliding, [&](std::uint32_t i, std::size_t row) {
    const std::uint32_t number = colliding.poses[row];
    const Pose* at = bodies[numbers.body_of(number)].pose_at(numbers.pose_of(number));
    const Vec3 e = position(store.quantisation(), q[0][i], q[1][i], q[2][i]);
    return at != nullptr && pulled_back(*at, e).z > above;
  });
}

void warn_of_colliding_ignored(const Answer& answer, LengthUnit unit, MessageLog& log) {
  if (answer.shard) return;
  const std::uint64_t colliding = answer.ignored_colliding, high = answer.ignored_colliding_high;
  const auto warn = [&](WarningCode code, std::string text, double points) {
    log.warn(code, std::move(text), {{"colliding", points}});
  };
  const std::string of_ignored = " of the " + ignored_text(answer.parameters, answer.ignored);
  if (colliding > answer.colliding_points && !answer.floor_colliding) {
    const std::uint64_t others = answer.colliding_points;
    const std::string searched = others == 0 ? "and no searched point does"
                                             : "but only " + counted(others, "searched point") +
                                                   (others == 1 ? " does" : " do");
    warn("ignored-collide",
         format_count(colliding) + of_ignored + " would collide, " + searched +
             ": the answer may be what was ignored. If they are the ground below the wheels, give "
             "the "
             "vehicle a floor instead of leaving out the ground",
         static_cast<double>(colliding));
  }
  if (high > 0) {
    warn("ignored-high",
         format_count(high) + of_ignored + " would collide more than " +
             length_text(ground_height(unit), unit) +
             " above the model's lowest point, where no ground is: " +
             "the model hits what was ignored. The classes or boxes hold more than the ground",
         static_cast<double>(high));
  }
}

}  // namespace clearway
