#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "clearway/unseen.hpp"
#include "core/geometry/axes.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/query/body_numbers.hpp"
#include "core/seen/cross_sections.hpp"
#include "core/seen/cubes.hpp"
#include "core/trajectory/chainage.hpp"
#include "findings/row_pieces.hpp"
#include "findings/touched_first.hpp"
#include "findings/unseen_lattice.hpp"
#include "io/paths/content_hash.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

constexpr Box kNothing{
    {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
     std::numeric_limits<double>::infinity()},
    {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
     -std::numeric_limits<double>::infinity()}};

bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// One call of find_unseen_groups(), step by step.
class GroupSearch {
 public:
  GroupSearch(const Result& result, const std::vector<Pose>& poses, const ConflictOptions& options,
              const SeenSummary& seen)
      : result_(result),
        header_(result.reader().header()),
        poses_(poses),
        options_(options),
        seen_(seen),
        lattice_(lattice_of_unseen(header_, seen)),
        cubes_(result.unseen()),
        chainage_(chainage_of(poses)) {}

  UnseenGroups run() {
    out_.path_length = chainage_.empty() ? 0 : chainage_.back();
    find_model_box();
    place_cubes();
    make_groups();
    find_conflicts();
    find_stretches();
    find_front();
    return std::move(out_);
  }

 private:
  std::size_t size() const { return cubes_.size(); }

  /// The model's box along the axes ahead, left and up of a pose of the path; infinite and inverted
  /// where it is not known. The bodies of a vehicle stand at their own poses.
  Box model_box_at(std::uint32_t pose) const {
    if (options_.bodies.empty()) return model_box_;
    Box box = kNothing;
    for (const Body& body : options_.bodies) {
      const Pose* own = pose_at(body, pose);
      if (own == nullptr) continue;
      const Box around = box_of(body.model.vertices);
      for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3 there = transform(*own, around.corner(corner));
        box.extend(ahead_left_up(there, poses_[pose], options_.forward, options_.up));
      }
    }
    return box;
  }

  void find_model_box() {
    model_box_ = kNothing;
    if (!options_.bodies.empty()) {
      // Bodies that turn against each other change the box a little; some poses are enough.
      constexpr std::size_t kSome = 100;
      const std::size_t stride = std::max<std::size_t>(1, poses_.size() / kSome);
      for (std::size_t i = 0; i < poses_.size(); i += stride) {
        const Box box = model_box_at(static_cast<std::uint32_t>(i));
        model_box_.extend(box.lo);
        model_box_.extend(box.hi);
      }
      return;
    }
    if (result_.bodies().empty()) {
      model_box_ = turned(result_.model_box(), options_.forward, options_.up);
    }
  }

  /// Finds where each cube lies, seen from the pose of the path that first reaches it.
  void place_cubes() {
    middles_.reserve(size());
    seen_from_path_.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) {
      middles_.push_back(middle_of_cube(lattice_, header_.quantisation, cubes_.cube[i]));
      seen_from_path_.push_back(
          ahead_left_up(middles_[i], poses_[cubes_.first_pose[i]], options_.forward, options_.up));
    }
  }

  double half(int k) const {
    return 0.5 * static_cast<double>(lattice_.side[k]) * header_.quantisation.scale[k];
  }

  double end_of(std::uint32_t pose) const {
    return chainage_[std::min<std::size_t>(pose + std::size_t{1}, chainage_.size() - 1)];
  }

  /// Describes the groups one by one, from their cubes in the order of the file.
  void make_groups() {
    std::vector<std::uint32_t> order(size());
    std::iota(order.begin(), order.end(), 0U);
    const auto group_of = [&](std::uint32_t cube) { return cubes_.group[cube]; };
    std::ranges::stable_sort(order, {}, group_of);
    listed_at_.assign(order.empty() ? 1 : group_of(order.back()) + std::size_t{1}, kNotListed);
    for (auto first = order.begin(); first != order.end();) {
      const std::uint32_t id = group_of(*first);
      const auto end = std::ranges::upper_bound(first, order.end(), id, {}, group_of);
      const std::span<const std::uint32_t> cubes(first, end);
      first = end;
      if (cubes.size() < header_.seen_min) {
        ++out_.small_groups;
        out_.small_cubes += cubes.size();
        continue;
      }
      listed_at_[id] = static_cast<std::uint32_t>(out_.listed.size());
      out_.listed.push_back(group_of_cubes(id, cubes));
    }
  }

  UnseenGroup group_of_cubes(std::uint32_t id, std::span<const std::uint32_t> cubes) {
    UnseenGroup group{.id = id, .cubes = cubes.size(), .box = kNothing, .seen = kNothing};
    group.first_pose = std::numeric_limits<std::uint32_t>::max();
    const Vec3 half_cube{half(0), half(1), half(2)};
    for (const std::uint32_t i : cubes) {
      group.box.extend(middles_[i] - half_cube);
      group.box.extend(middles_[i] + half_cube);
      group.middle = group.middle + middles_[i];
      group.first_pose = std::min(group.first_pose, cubes_.first_pose[i]);
      group.last_pose = std::max(group.last_pose, cubes_.first_pose[i]);
      if (is_finite(seen_from_path_[i])) group.seen->extend(seen_from_path_[i]);
      out_.middles.push_back(middles_[i]);
    }
    const auto count = static_cast<double>(group.cubes);
    group.middle = {group.middle.x / count, group.middle.y / count, group.middle.z / count};
    finish(group);
    group.middle = nearest_middle(group.middle, cubes);
    group.side = side_at_first(group.first_pose, cubes);
    return group;
  }

  /// The middle of the cube that is nearest to a place, because the mean of a group along a bend
  /// can lie outside all of its cubes. Of equals the first.
  Vec3 nearest_middle(const Vec3& place, std::span<const std::uint32_t> cubes) const {
    const auto squared = [&](std::uint32_t i) {
      const Vec3 from = middles_[i] - place;
      return dot(from, from);
    };
    return middles_[*std::ranges::min_element(cubes, {}, squared)];
  }

  /// The side on which the cubes lie that are reached at the first pose of their group.
  Side side_at_first(std::uint32_t pose, std::span<const std::uint32_t> cubes) const {
    Box first = kNothing;
    for (const std::uint32_t i : cubes) {
      if (cubes_.first_pose[i] == pose && is_finite(seen_from_path_[i])) {
        first.extend(seen_from_path_[i]);
      }
    }
    const Box model = model_box_at(pose);
    if (!(model.lo.x <= model.hi.x) || !(first.lo.x <= first.hi.x)) return Side::kUnknown;
    // Both boxes are along ahead, left and up already.
    return side_of(first, model, Axis::kPlusX, Axis::kPlusZ);
  }

  UnseenGroup* listed_of(std::size_t i) {
    const std::uint32_t at = listed_at_[cubes_.group[i]];
    return at == kNotListed ? nullptr : &out_.listed[at];
  }

  void finish(UnseenGroup& group) const {
    const double from = chainage_[group.first_pose], to = end_of(group.last_pose);
    group.chainage_from = from + options_.chainage_start;
    group.chainage_to = to + options_.chainage_start;
    group.along_path = out_.path_length > 0 && to - from > 0.5 * out_.path_length;
    if (!(group.seen->lo.x <= group.seen->hi.x)) group.seen.reset();
    if (!group.along_path || !group.seen || !(model_box_.lo.z <= model_box_.hi.z)) return;
    constexpr double kMostOfWidth = 0.75;
    const double wide = group.seen->hi.y - group.seen->lo.y;
    group.is_ground = group.seen->lo.z < model_box_.lo.z + seen_.cube &&
                      wide > kMostOfWidth * (model_box_.hi.y - model_box_.lo.y);
    group.is_sky = group.seen->lo.z > 0.5 * (model_box_.lo.z + model_box_.hi.z);
  }

  /// Marks the listed groups of a cube and of the cubes that touch it.
  void mark_around(const std::array<std::int32_t, 3>& cube) {
    for (std::int32_t dx = -1; dx <= 1; ++dx) {
      for (std::int32_t dy = -1; dy <= 1; ++dy) {
        // The cubes of a column along z follow each other.
        const std::array<std::int32_t, 3> first{cube[0] + dx, cube[1] + dy, cube[2] - 1};
        const std::array<std::int32_t, 3> last{cube[0] + dx, cube[1] + dy, cube[2] + 1};
        auto at = std::ranges::lower_bound(cubes_.cube, first);
        for (; at != cubes_.cube.end() && *at <= last; ++at) {
          UnseenGroup* group = listed_of(static_cast<std::size_t>(at - cubes_.cube.begin()));
          if (group == nullptr || group->behind_conflict) continue;
          group->behind_conflict = true;
          ++out_.behind_conflicts;
        }
      }
    }
  }

  /// Finds the groups that hold or touch a cube with a colliding point.
  void find_conflicts() {
    if (out_.listed.empty()) return;
    RowStream<Collisions> stream(result_.reader());
    std::array<std::int32_t, 3> before{};
    bool any = false;
    for (Collisions rows; stream.read(rows);) {
      std::vector<QuantumPoint> quanta(rows.size());
      requantize(result_.reader(), rows, quanta);
      for (const auto& [q] : quanta) {
        const std::array<std::int32_t, 3> cube{lattice_.cube_of(0, q[0]), lattice_.cube_of(1, q[1]),
                                               lattice_.cube_of(2, q[2])};
        if (any && cube == before) continue;
        any = true;
        before = cube;
        mark_around(cube);
      }
    }
  }

  void find_stretches() {
    std::vector<std::uint32_t> reached;
    for (std::size_t i = 0; i < size(); ++i) {
      if (listed_of(i) != nullptr) reached.push_back(cubes_.first_pose[i]);
    }
    std::ranges::sort(reached);
    reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
    for (const std::uint32_t pose : reached) {
      const double from = chainage_[pose] + options_.chainage_start;
      const double to = end_of(pose) + options_.chainage_start;
      if (!out_.stretches.empty() && from - out_.stretches.back().second < seen_.cube) {
        out_.stretches.back().second = std::max(out_.stretches.back().second, to);
      } else {
        out_.stretches.emplace_back(from, to);
      }
    }
  }

  /// Finds what of the cells of the cross-section is swept, and what of that is unseen.
  void find_front() {
    constexpr std::int32_t kMostCells = 24;  // of a side, so that a number fits into each
    SweptCells swept;
    RowStream<SweptCells> stream(result_.reader());
    for (SweptCells rows; stream.read(rows);) append_rows(rows, swept);
    CrossSections sections(seen_.cube);
    for (std::size_t i = 0; i < size(); ++i) {
      sections.add(pulled_back(poses_[cubes_.first_pose[i]], middles_[i]));
    }
    const SweptCells unseen = sections.cells();
    std::array<std::int32_t, 2> least{kMost, kMost}, greatest{-kMost, -kMost};
    each_front_cell(swept, [&](std::int32_t left, std::int32_t up, std::uint64_t) {
      least = {std::min(least[0], left), std::min(least[1], up)};
      greatest = {std::max(greatest[0], left), std::max(greatest[1], up)};
    });
    if (greatest[0] < least[0]) return;
    UnseenFront& front = out_.front;
    const std::int32_t widest = std::max(greatest[0] - least[0], greatest[1] - least[1]) + 1;
    const std::int32_t side = (widest + kMostCells - 1) / kMostCells;
    const auto in_cells = [&](std::int32_t i) { return (i >= 0 ? i : i - side + 1) / side; };
    front.cell = seen_.cube * side;
    front.columns = static_cast<std::uint32_t>(in_cells(greatest[0]) - in_cells(least[0])) + 1;
    front.rows = static_cast<std::uint32_t>(in_cells(greatest[1]) - in_cells(least[1])) + 1;
    front.left = in_cells(least[0]) * front.cell;
    front.up = in_cells(least[1]) * front.cell;
    const auto lengths = [&](const SweptCells& cells) {
      std::vector<std::uint64_t> parts(std::size_t{front.columns} * front.rows);
      each_front_cell(cells, [&](std::int32_t left, std::int32_t up, std::uint64_t more) {
        const auto column = static_cast<std::size_t>(in_cells(left) - in_cells(least[0]));
        const auto row = static_cast<std::size_t>(in_cells(up) - in_cells(least[1]));
        parts[row * front.columns + column] += more;
      });
      const double volume = 8 * half(0) * half(1) * half(2) / double{CrossSections::kParts};
      std::vector<double> out;
      out.reserve(parts.size());
      for (const std::uint64_t part : parts) {
        out.push_back(static_cast<double>(part) * volume / (front.cell * front.cell));
      }
      return out;
    };
    front.swept = lengths(swept);
    front.unseen = lengths(unseen);
  }

  /// Calls visit(left, up, parts) for the cells that are seen along the model's forward axis.
  template <typename Visit>
  void each_front_cell(const SweptCells& cells, const Visit& visit) const {
    const int ahead = line_of(options_.forward), up = line_of(options_.up);
    const bool up_is_last = up == 2 || (up == 1 && ahead == 2);
    const bool turns_up = is_negative(options_.up);
    const bool turns_left = is_negative(axis_to_left({options_.forward, options_.up}));
    // Cell i reaches from i to i + 1, so that turned round it is cell -1 - i.
    const auto turned_round = [](bool turns, std::int32_t i) { return turns ? -1 - i : i; };
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto& [axis, a, b] = cells.cell[i];
      if (axis != ahead) continue;
      visit(turned_round(turns_left, up_is_last ? a : b),
            turned_round(turns_up, up_is_last ? b : a), cells.parts[i]);
    }
  }

  static constexpr std::uint32_t kNotListed = 0xFFFFFFFF;
  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

  const Result& result_;
  const ResultHeader& header_;
  const std::vector<Pose>& poses_;
  const ConflictOptions& options_;
  const SeenSummary seen_;
  const CubeLattice lattice_;
  const UnseenCubes cubes_;
  const std::vector<double> chainage_;
  /// Box of the model along ahead, left and up of the path's poses; inverted where it is not known.
  Box model_box_{};
  std::vector<Vec3> middles_, seen_from_path_;
  /// For each group, its place in the list, or kNotListed.
  std::vector<std::uint32_t> listed_at_;
  UnseenGroups out_;
};

}  // namespace

UnseenGroups find_unseen_groups(const Result& result, const std::vector<Pose>& poses,
                                const ConflictOptions& options) {
  const ResultReader& reader = result.reader();
  const auto& seen = reader.findings().seen;
  if (!reader.header().seen || !seen) return {};
  if (poses.empty() || hash_of_trajectory(poses) != reader.header().trajectory_hash) {
    if (poses.empty() && reader.header().poses == 0) return {};
    throw InputError(reader.name() + ": is the result of another trajectory",
                     Remedy::kSameTrajectory);
  }
  return GroupSearch(result, poses, options, *seen).run();
}

}  // namespace clearway
