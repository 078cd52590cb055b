#include "report/shown_points.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "findings/row_pieces.hpp"
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

/// The rows of a table of points that are at hand, some of which were looked at already.
template <typename Rows>
class RowsAtHand {
 public:
  explicit RowsAtHand(const ResultReader& result) : stream_(result) {}

  /// Reads the next rows once all of those at hand were looked at. Returns whether it read any.
  bool read_on() {
    if (begin_ < rows_.size()) return false;
    begin_ = 0;
    stream_.read(rows_);
    return rows_.size() > 0;
  }

  bool at_end() const { return begin_ == rows_.size(); }
  const Rows& rows() const { return rows_; }
  std::size_t begin() const { return begin_; }
  std::uint64_t last_source() const { return rows_.source.back(); }
  /// The index of the first row, of those that were not looked at, whose source is above a source.
  std::size_t above(std::uint64_t source) const {
    const auto from = rows_.source.begin() + static_cast<std::ptrdiff_t>(begin_);
    return static_cast<std::size_t>(std::upper_bound(from, rows_.source.end(), source) -
                                    rows_.source.begin());
  }
  void look_up_to(std::size_t end) { begin_ = end; }

 private:
  RowStream<Rows> stream_;
  Rows rows_;
  std::size_t begin_ = 0;
};

class PointReader {
 public:
  PointReader(const Result& result, const PageLattice& lattice, const PointSelection& selection)
      : result_(result.reader()),
        radius_(result.parameters().radius),
        lattice_(lattice),
        selection_(selection),
        picks_(picks_of(selection, result.size())),
        other_pick_(selection.most_others, result_.clearances()),
        colliding_(result_),
        measured_(result_) {}

  ShownPoints read(Progress& progress) {
    progress.begin("points of the result", result_.collisions() + result_.clearances(), "rows");
    while (true) {
      throw_if_stopped(progress);
      if (colliding_.read_on()) summarise(colliding_.rows(), out_.summary);
      if (measured_.read_on()) summarise(measured_.rows(), out_.summary);
      if (colliding_.at_end() && measured_.at_end()) break;
      // The rows of both tables up to a source that both have at hand, or are past.
      std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
      if (!colliding_.at_end()) last = std::min(last, colliding_.last_source());
      if (!measured_.at_end()) last = std::min(last, measured_.last_source());
      progress.advance(look_up_to(colliding_.above(last), measured_.above(last)));
    }
    progress.end();
    sort_along_curve(out_.points);
    return std::move(out_);
  }

 private:
  /// The class of what is not shown among the others.
  static constexpr std::uint8_t kNone = 255;

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

  /// Takes the rows up to these indices, which have the same last source. Returns their number.
  std::size_t look_up_to(std::size_t colliding_end, std::size_t measured_end) {
    classify(colliding_end, measured_end);
    note_wanted(colliding_end);
    const std::size_t colliding = colliding_end - colliding_.begin();
    const std::size_t measured = measured_end - measured_.begin();
    pick(colliding_, class_of_colliding_, [&](std::size_t i) -> EvenPick& {
      return picks_[picks_.size() > 1 ? (*selection_.conflict_of)[row_ + i] : 0];
    });
    row_ += colliding;
    pick(measured_, class_of_other_, [&](std::size_t) -> EvenPick& { return other_pick_; });
    colliding_.look_up_to(colliding_end);
    measured_.look_up_to(measured_end);
    return colliding + measured;
  }

  /// The part of a column from the first row that was not looked at to `end`.
  template <typename Rows>
  static std::span<const std::uint64_t> sources(const RowsAtHand<Rows>& of, std::size_t end) {
    return std::span(of.rows().source).subspan(of.begin(), end - of.begin());
  }

  /// The classes of rows. class_at(i, there): the class of row i of `of`, where `there` is the
  /// index of its source in `other`, or nothing where that lacks it.
  template <typename ClassAt>
  static std::vector<std::uint8_t> classes_of(std::span<const std::uint64_t> of,
                                              std::span<const std::uint64_t> other,
                                              const ClassAt& class_at) {
    std::vector<std::uint8_t> out(of.size());
    in_pieces(of.size(), [&](std::size_t first, std::size_t end) {
      auto at = std::ranges::lower_bound(other, of[first]);
      for (std::size_t i = first; i < end; ++i) {
        while (at != other.end() && *at < of[i]) ++at;
        const bool is_there = at != other.end() && *at == of[i];
        out[i] = class_at(i, is_there ? std::optional(at - other.begin()) : std::nullopt);
      }
    });
    return out;
  }

  void classify(std::size_t colliding_end, std::size_t measured_end) {
    const auto colliding = sources(colliding_, colliding_end);
    const auto measured = sources(measured_, measured_end);
    const double* const distance = measured_.rows().distance.data() + measured_.begin();
    class_of_colliding_ = classes_of(colliding, measured, [&](std::size_t, auto there) {
      return class_of(there ? distance[*there] : radius_, true);
    });
    class_of_other_ = classes_of(measured, colliding, [&](std::size_t i, auto there) {
      const bool is_shown = !there && distance[i] < selection_.classes.back();
      return is_shown ? class_of(distance[i], false) : kNone;
    });
  }

  /// Notes the places of the points that are asked for.
  void note_wanted(std::size_t colliding_end) {
    const auto source = sources(colliding_, colliding_end);
    if (source.empty()) return;
    for (; wanted_ < selection_.wanted.size() && selection_.wanted[wanted_] <= source.back();
         ++wanted_) {
      const auto at = std::ranges::lower_bound(source, selection_.wanted[wanted_]);
      if (*at != selection_.wanted[wanted_]) continue;
      const auto i = static_cast<std::size_t>(at - source.begin());
      out_.places[*at] = colliding_.rows().xyz[colliding_.begin() + i];
    }
  }

  /// Adds points of rows that were not looked at. pick_of(i): what picks among those like row i.
  template <typename Rows, typename PickOf>
  void pick(const RowsAtHand<Rows>& rows, std::span<const std::uint8_t> classes,
            const PickOf& pick_of) {
    const auto xyz = std::span(rows.rows().xyz).subspan(rows.begin());
    picked_.clear();
    for (std::size_t i = 0; i < classes.size(); ++i) {
      if (classes[i] == kNone) continue;
      ++out_.of_class[classes[i]];
      if (!pick_of(i).next()) continue;
      ++out_.shown_class[classes[i]];
      picked_.push_back(static_cast<std::uint32_t>(i));
    }
    const std::size_t before = out_.points.size();
    out_.points.resize(before + picked_.size());
    in_pieces(picked_.size(), [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        out_.points[before + i] = page_point(lattice_, xyz[picked_[i]], classes[picked_[i]]);
      }
    });
  }

  const ResultReader& result_;
  const double radius_;
  const PageLattice& lattice_;
  const PointSelection& selection_;
  std::vector<EvenPick> picks_;
  EvenPick other_pick_;
  RowsAtHand<Collisions> colliding_;
  RowsAtHand<Clearances> measured_;
  std::vector<std::uint8_t> class_of_colliding_, class_of_other_;
  std::vector<std::uint32_t> picked_;  ///< of the rows that are looked at
  std::size_t row_ = 0, wanted_ = 0;
  ShownPoints out_;
};

}  // namespace

ShownPoints read_shown_points(const Result& result, const PageLattice& lattice,
                              const PointSelection& selection, Progress& progress) {
  return PointReader(result, lattice, selection).read(progress);
}

}  // namespace clearway
