#include "report/shown_points.hpp"

#include <algorithm>

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

class PointReader {
 public:
  PointReader(const Result& result, const PageLattice& lattice, const PointSelection& selection)
      : result_(result.reader()),
        radius_(result.parameters().radius),
        lattice_(lattice),
        selection_(selection),
        picks_(picks_of(selection, result.size())),
        other_pick_(selection.most_others, result_.clearances()) {}

  ShownPoints read(Progress& progress) {
    const std::uint64_t rows = result_.collisions() + result_.clearances();
    progress.begin("points of the result", rows, "rows");
    CollisionCursor row(result_);
    ClearanceCursor clearance(result_);
    std::uint64_t done = 0;
    while (!row.at_end() || !clearance.at_end()) {
      const bool collides =
          !row.at_end() && (clearance.at_end() || row.source() <= clearance.source());
      const bool measured =
          !clearance.at_end() && (!collides || row.source() == clearance.source());
      if (collides) summarise_batch(row);
      if (measured) summarise_batch(clearance);
      if (collides) add_colliding(row, measured ? clearance.get(&Clearances::distance) : radius_);
      if (measured && !collides) add_other(clearance);
      if (collides) row.advance();
      if (measured) clearance.advance();
      if ((++done & 0xffff) == 0) {
        throw_if_stopped(progress);
        progress.advance(0x10000);
      }
    }
    progress.end();
    sort_along_curve(out_.points);
    return std::move(out_);
  }

 private:
  /// The class of a distance. A colliding point is at most in the class of the radius; one that has
  /// no distance is given the radius as its distance.
  std::uint8_t class_of(double distance, bool collides) const {
    std::uint8_t k = 0;
    while (std::size_t{k} + 1 < selection_.classes.size() && distance >= selection_.classes[k] &&
           !(collides && selection_.classes[k] >= radius_)) {
      ++k;
    }
    return k;
  }

  /// Summarises the rows around a cursor when it comes to the first of them.
  template <typename Rows>
  void summarise_batch(const RowCursor<Rows>& cursor) {
    if (!cursor.at_end() && cursor.index() == 0) summarise(cursor.rows(), out_.summary);
  }

  void add_colliding(const CollisionCursor& row, double distance) {
    const std::uint8_t k = class_of(distance, true);
    const std::size_t at = row_++;
    ++out_.of_class[k];
    while (wanted_ < selection_.wanted.size() && selection_.wanted[wanted_] < row.source()) {
      ++wanted_;
    }
    if (wanted_ < selection_.wanted.size() && selection_.wanted[wanted_] == row.source()) {
      out_.places[row.source()] = row.get(&Collisions::xyz);
    }
    const std::size_t conflict = picks_.size() > 1 ? (*selection_.conflict_of)[at] : 0;
    if (!picks_[conflict].next()) return;
    ++out_.shown_class[k];
    out_.points.push_back(page_point(lattice_, row.get(&Collisions::xyz), k));
  }

  void add_other(const ClearanceCursor& clearance) {
    if (clearance.get(&Clearances::distance) >= selection_.classes.back()) return;
    const std::uint8_t k = class_of(clearance.get(&Clearances::distance), false);
    ++out_.of_class[k];
    if (other_pick_.next()) {
      ++out_.shown_class[k];
      out_.points.push_back(page_point(lattice_, clearance.get(&Clearances::xyz), k));
    }
  }

  const ResultReader& result_;
  const double radius_;
  const PageLattice& lattice_;
  const PointSelection& selection_;
  std::vector<EvenPick> picks_;
  EvenPick other_pick_;
  std::size_t row_ = 0, wanted_ = 0;
  ShownPoints out_;
};

}  // namespace

ShownPoints read_shown_points(const Result& result, const PageLattice& lattice,
                              const PointSelection& selection, Progress& progress) {
  return PointReader(result, lattice, selection).read(progress);
}

}  // namespace clearway
