#include "report/shown_points.hpp"

#include <algorithm>
#include <limits>

#include "io/result/answer.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

/// The number of points that each conflict keeps, where there is room.
constexpr std::uint64_t kLeastOfConflict = 300;

/// Picks `kept` of `total` items evenly. next() is called for each item in turn.
class EvenPick {
 public:
  EvenPick(std::uint64_t kept, std::uint64_t total)
      : kept_(std::min(kept, total)), total_(std::max<std::uint64_t>(total, 1)) {}

  bool next() {
    sum_ += kept_;
    if (sum_ < total_) return false;
    sum_ -= total_;
    return true;
  }

 private:
  std::uint64_t kept_, total_, sum_ = 0;
};

/// The picks of colliding points: one for points of no conflict, and then one for each conflict. A
/// single pick for all points where nothing is thinned or conflicts are not known.
std::vector<EvenPick> picks_of(const PointSelection& selection, std::uint64_t collisions) {
  const std::uint64_t most = selection.most_colliding;
  if (selection.conflict_of->empty() || collisions <= most) return {{most, collisions}};
  const auto& listed = selection.conflicts->listed;
  const std::uint64_t least = std::min(kLeastOfConflict, most / (4 * (listed.size() + 1)));
  const double share = static_cast<double>(most) * 3 / 4 / static_cast<double>(collisions);
  const auto pick = [&](std::uint64_t points) {
    const auto even = static_cast<std::uint64_t>(static_cast<double>(points) * share);
    return EvenPick(std::max(least, even), points);
  };
  std::vector<EvenPick> out{pick(selection.conflicts->small_points)};
  for (const Conflict& conflict : listed) out.push_back(pick(conflict.points));
  return out;
}

}  // namespace

ShownPoints read_shown_points(const Result& result, const PageLattice& lattice,
                              const PointSelection& selection, Progress& progress) {
  ShownPoints out;
  const ResultReader& reader = result.reader();
  const std::vector<double>& classes = selection.classes;
  const double radius = result.parameters().radius;
  std::vector<EvenPick> picks = picks_of(selection, result.size());
  EvenPick other_pick(selection.most_others, reader.clearances());
  // A colliding point is at most in the class of the radius.
  const auto take = [&](const Vec3& xyz, double distance, bool collides, EvenPick& pick) {
    std::uint8_t k = 0;
    while (std::size_t{k} + 1 < classes.size() && distance >= classes[k] &&
           !(collides && classes[k] >= radius)) {
      ++k;
    }
    ++out.of_class[k];
    if (!pick.next()) return;
    ++out.shown_class[k];
    out.points.push_back(page_point(lattice, xyz, k));
  };
  progress.begin("points of the result", reader.collisions() + reader.clearances(), "rows");
  CollisionCursor colliding(reader);
  ClearanceCursor measured(reader);
  const auto begin_batch = [&](const auto& cursor) {
    if (cursor.index() > 0) return;
    throw_if_stopped(progress);
    progress.advance(cursor.rows().size());
    summarise(cursor.rows(), out.summary);
  };
  auto wanted = selection.wanted.begin();
  std::size_t row = 0;
  while (!colliding.at_end() || !measured.at_end()) {
    const bool collides =
        measured.at_end() || (!colliding.at_end() && colliding.source() <= measured.source());
    const bool is_measured =
        !collides || (!measured.at_end() && measured.source() == colliding.source());
    if (is_measured) begin_batch(measured);
    const double distance = is_measured ? measured.get(&Clearances::distance) : radius;
    if (collides) {
      begin_batch(colliding);
      const std::uint64_t source = colliding.source();
      const Vec3& xyz = colliding.get(&Collisions::xyz);
      while (wanted != selection.wanted.end() && *wanted < source) ++wanted;
      if (wanted != selection.wanted.end() && *wanted == source) out.places[source] = xyz;
      take(xyz, distance, true, picks[picks.size() > 1 ? (*selection.conflict_of)[row] : 0]);
      ++row;
      colliding.advance();
    } else if (distance < classes.back()) {
      take(measured.get(&Clearances::xyz), distance, false, other_pick);
    }
    if (is_measured) measured.advance();
  }
  progress.end();
  sort_along_curve(out.points);
  return out;
}

}  // namespace clearway
