#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "findings/conflict_rank.hpp"
#include "findings/grouped_points.hpp"
#include "findings/ledger/judge_ledger.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/scans/requantize.hpp"

namespace clearway {
namespace {

/// The places of a row are thinned to one of each cube of this edge, metres.
constexpr double kCube = 0.05;

/// The points of some conflicts, one of each cube: the first one in the order of the result.
class ThinnedPoints {
 public:
  ThinnedPoints(const GroupedResult& found, const std::vector<std::uint32_t>& conflicts,
                double metre)
      : steps_(found.result.reader().header().quantisation) {
    // A cube is so small that each of its points is within the limit of the one that is kept.
    edge_ = std::min(kCube * metre, found.conflicts.gap / 2);
    for (const std::uint32_t id : conflicts) of_conflict_[id];
    if (conflicts.empty()) return;
    for_each_point(found, [&](const PointRow& point) { add(point); });
  }

  std::vector<QuantumPoint> take(std::uint32_t conflict) {
    return std::move(of_conflict_[conflict].points);
  }

 private:
  struct Kept {
    std::unordered_set<GridCube, GridCubeHash> cubes;
    std::vector<QuantumPoint> points;
  };

  void add(const PointRow& point) {
    const auto kept = of_conflict_.find(point.conflict);
    if (kept == of_conflict_.end()) return;
    const auto along = [&](double x) { return static_cast<std::int64_t>(std::floor(x / edge_)); };
    const Vec3& p = point.xyz;
    if (!kept->second.cubes.insert({along(p.x), along(p.y), along(p.z)}).second) return;
    QuantumPoint& q = kept->second.points.emplace_back();
    // find_conflicts() has refused points that are not of stored integers.
    for (int k = 0; k < 3; ++k) q.q[k] = quantum_at(steps_, k, p[k]).value_or(0);
  }

  const Quantisation& steps_;
  double edge_;
  std::unordered_map<std::uint32_t, Kept> of_conflict_;
};

/// Writes what was judged into the table and the places.
class LedgerWriter {
 public:
  LedgerWriter(const GroupedResult& found, const LedgerJudging& how, Ledger& judged,
               LedgerFiles& files)
      : found_(found), how_(how), judged_(judged), files_(files) {}

  void run() {
    const std::size_t known = judged_.rows.size();
    for (std::size_t row = 0; row < known; ++row) take_row(row);
    for (const LedgerEntry& entry : judged_.conflicts) {
      if (entry.key.empty()) add_row(entry.conflict, LedgerStatus::kNew, "");
    }
    ThinnedPoints points(found_, conflicts_to_write(), how_.metre);
    for (const auto& [row, conflict] : to_write_) write(row, conflict, points.take(conflict));
  }

 private:
  /// Takes what was found at a row that the table has.
  void take_row(std::size_t row) {
    LedgerRow& shown = judged_.rows[row];
    if (shown.shown == LedgerStatus::kGone) {
      files_.places[row]->gone_on = how_.today;
      return set_status(row, LedgerStatus::kResolved);
    }
    if (shown.conflicts.empty()) return;
    if (shown.status == LedgerStatus::kResolved) set_status(row, LedgerStatus::kOpen);
    see(row);
    if (shown.status == LedgerStatus::kAccepted) return;
    // A row has the values of one conflict, so the other parts get rows of their own.
    const std::vector<std::uint32_t> parts = shown.conflicts;
    const auto points = [&](std::uint32_t id) { return found_.conflicts.listed[id - 1].points; };
    const std::uint32_t largest = *std::ranges::max_element(parts, {}, points);
    shown.conflicts = {largest};
    to_write_.emplace_back(row, largest);
    const LedgerStatus status = shown.status;
    const std::string owner = shown.owner;
    for (const std::uint32_t id : parts) {
      if (id != largest && !has_other_row(id, row)) add_row(id, status, owner);
    }
  }

  bool has_other_row(std::uint32_t conflict, std::size_t row) const {
    for (std::size_t i = 0; i < judged_.rows.size(); ++i) {
      const std::vector<std::uint32_t>& ids = judged_.rows[i].conflicts;
      if (i != row && std::ranges::find(ids, conflict) != ids.end()) return true;
    }
    return false;
  }

  void add_row(std::uint32_t conflict, LedgerStatus status, const std::string& owner) {
    const std::size_t row = files_.table.add_row();
    files_.places.emplace_back();
    LedgerRow& shown = judged_.rows.emplace_back();
    shown.key = files_.table.get(row, LedgerColumn::kKey);
    shown.shown = status;
    shown.owner = owner;
    shown.conflicts = {conflict};
    set_status(row, status);
    files_.table.set(row, LedgerColumn::kOwner, owner);
    files_.table.set(row, LedgerColumn::kFirstSeen, how_.today);
    shown.first_seen = text_of(how_.today);
    see(row);
    to_write_.emplace_back(row, conflict);
    LedgerEntry& entry = judged_.conflicts[conflict - 1];
    entry.key = shown.key;
    entry.owner = owner;
  }

  void set_status(std::size_t row, LedgerStatus status) {
    if (judged_.rows[row].status == status &&
        !files_.table.get(row, LedgerColumn::kStatus).empty()) {
      return;  // the cell stays as somebody wrote it
    }
    files_.table.set(row, LedgerColumn::kStatus, std::string(name_of(status)));
    judged_.rows[row].status = status;
  }

  /// Notes that a row was seen. A run of an earlier day, or of an older scan, leaves the later day.
  void see(std::size_t row) {
    const Day day =
        std::max(files_.table.day(row, LedgerColumn::kLastSeen).value_or(Day{}), how_.today);
    files_.table.set(row, LedgerColumn::kLastSeen, day);
    judged_.rows[row].last_seen = text_of(day);
    if (!files_.places[row]) return;
    LedgerPlaces& places = *files_.places[row];
    places.cells.last_seen = day;
    places.scanned =
        std::max(places.scanned, day_of_scan(found_.result.reader().findings().scanned.first));
  }

  std::vector<std::uint32_t> conflicts_to_write() const {
    std::vector<std::uint32_t> ids;
    for (const auto& [row, conflict] : to_write_) ids.push_back(conflict);
    return ids;
  }

  /// Writes places and values of a row that is not accepted.
  void write(std::size_t row, std::uint32_t id, std::vector<QuantumPoint> points) {
    using enum LedgerColumn;
    const Conflict& conflict = found_.conflicts.listed[id - 1];
    const ResultHeader& header = found_.result.reader().header();
    const Vec3 middle = conflict.box.centre(), size = conflict.box.hi - conflict.box.lo;
    LedgerTable& table = files_.table;
    constexpr std::array kMiddle{kX, kY, kZ}, kSize{kSizeX, kSizeY, kSizeZ};
    for (int k = 0; k < 3; ++k) {
      table.set(row, kMiddle[static_cast<std::size_t>(k)], middle[k], 3);
      table.set(row, kSize[static_cast<std::size_t>(k)], size[k], 3);
    }
    table.set(row, kSide, std::string(name_of(conflict.side)));
    table.set(row, kLeast, conflict.least_distance, 4);
    table.set(row, kTrim, rounded_up(least_trim(conflict)), 3);
    LedgerPlaces places;
    places.key = table.get(row, kKey);
    places.cells = {middle, size, *table.day(row, kFirstSeen), {}};
    if (files_.places[row]) places.scanned = files_.places[row]->scanned;
    places.gap = found_.conflicts.gap;
    places.min_points = found_.conflicts.min_points;
    places.values = values_of(conflict);
    places.question = question_of(header);
    places.quantisation = header.quantisation;
    places.quanta = std::move(points);
    files_.places[row] = std::move(places);
    see(row);
    judged_.rows[row].box = conflict.box;
  }

  const GroupedResult& found_;
  const LedgerJudging& how_;
  Ledger& judged_;
  LedgerFiles& files_;
  std::vector<std::pair<std::size_t, std::uint32_t>> to_write_;  ///< rows and their conflicts
};

}  // namespace

void update_ledger(const GroupedResult& found, const LedgerJudging& how, Ledger& judged,
                   LedgerFiles& files) {
  LedgerWriter(found, how, judged, files).run();
  judged.is_updated = true;
}

}  // namespace clearway
