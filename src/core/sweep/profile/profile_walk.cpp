#include "core/sweep/profile/profile_walk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <utility>

#include "core/sweep/field/field_lanes.hpp"
#include "core/util/lane_bits.hpp"
#include "core/util/macros.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kNever = kSweepNever;

/// Number of points of an open block from which on its sphere is looked at first (measured).
constexpr int kManyPoints = 8;

/// The points of a block that may be due up to so many poses later are looked up, too (measured).
constexpr std::uint32_t kPosesAhead = 3;

/// For how many entries of each block the lists have room. A pose begins with at most two of each
/// and adds at most two.
constexpr std::size_t kEntries = 4;

template <typename Item>
void push(std::vector<Item>& heap, const Item& item) {
  heap.push_back(item);
  std::push_heap(heap.begin(), heap.end(), std::greater<>());
}

template <typename Item>
Item pop(std::vector<Item>& heap) {
  std::pop_heap(heap.begin(), heap.end(), std::greater<>());
  const Item item = heap.back();
  heap.pop_back();
  return item;
}

/// Marks the keys that are not above a limit.
CLEARWAY_SIMD_CLONES
void mark_not_above(const double* keys, double limit, std::uint8_t* marks) {
  for (std::uint32_t i = 0; i < kBlockPoints; ++i) marks[i] = !(keys[i] > limit);
}

/// The keys that are not above a limit, as bits.
std::uint64_t not_above(const double* keys, double limit) {
  std::uint8_t marks[kBlockPoints];
  mark_not_above(keys, limit, marks);
  return packed_bits(marks);
}

double least_of(const double* keys) {
  double least[8];
  std::copy(keys, keys + 8, least);
  for (std::uint32_t i = 8; i < kBlockPoints; i += 8) {
    for (std::uint32_t k = 0; k < 8; ++k) least[k] = std::min(least[k], keys[i + k]);
  }
  return *std::ranges::min_element(least);
}

}  // namespace

/// The search of one page.
template <typename Element>
class ProfileWalkOf<Element>::OfPage {
 public:
  OfPage(ProfileWalkOf& memory, const PageRef& page, const ProfileBests& bests,
         std::vector<ProfileFact>& found)
      : m_(memory),
        sweep_(memory.filter_.ref()),
        travel_(memory.filter_.travel()),
        page_(page),
        bests_(bests),
        reaches_{sweep_.motion, bests, sweep_.rounding},
        ties_(memory.cloud_, found),
        warp_blocks_(sweep_, page, memory.cloud_.quantisation(), shared_, memory.statistics_),
        depths_(sweep_, page, memory.cloud_.quantisation(), bests_, warp_blocks_, ties_,
                memory.statistics_),
        lanes_(sweep_.field) {}

  /// Begins a part of a cell of the page. Returns whether the part has points.
  bool enter(std::uint32_t cell, std::uint32_t part) {
    cell_ = &page_.cell(cell);
    index_ = cell;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      chunks_[axis] = packed_chunk(page_, cell_->chunks[axis], m_.cloud_.cell_points());
    }
    const std::uint32_t first_block = part * Blocks::kPartBlocks;
    const auto blocks = static_cast<std::uint32_t>(divide_up(cell_->count, kBlockPoints));
    if (first_block >= blocks) return false;
    first_point_ = first_block * kBlockPoints;
    first_slot_ = cell * page_.shape.blocks_per_cell * kBlockPoints + first_point_;
    has_guess_ = was_found_ = false;
    last_pose_ = kNever;
    ties_.enter_cell(cell, *cell_);
    if constexpr (kIsSolid<Element>) {
      depths_.enter(cell, first_point_, first_slot_);
      warp_blocks_.enter(cell, part);
    }
    take_blocks(first_block, std::min(blocks - first_block, Blocks::kPartBlocks));
    return true;
  }

  /// Searches all poses of a motion node. The nodes of a part come in the order of their poses.
  void search(std::uint32_t top) {
    if constexpr (kIsSolid<Element>) {
      depths_.search(top);
      last_pose_ = kNever;
    }
    const MotionNode* nodes = sweep_.motion.nodes;
    end_pose_ = nodes[top].first + nodes[top].count;
    if (sweep_.has_floor()) find_farthest(nodes[top]);
    m_.visited_.clear();
    const std::uint32_t end = top + 2 * nodes[top].count - 1;
    for (std::uint32_t node = top; node < end;) {
      if (is_passed_over(node)) {
        node += 2 * nodes[node].count - 1;
        continue;
      }
      if (nodes[node].count == 1) {
        search_pose(nodes[node].mid);
      } else {
        m_.visited_.push_back(node);
      }
      ++node;
    }
    for (std::size_t i = m_.visited_.size(); i-- > 0;) reaches_.note_halves(m_.visited_[i]);
  }

 private:
  void take_blocks(std::uint32_t first, std::uint32_t count) {
    const Quantisation& quantisation = m_.cloud_.quantisation();
    const BlockBox* boxes = page_.blocks(index_) + first;
    m_.blocks_.resize(count);
    m_.queue_.clear();
    m_.sleepers_.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
      Block& block = m_.blocks_[i];
      const std::uint64_t searched = page_.searched(index_, first + i);
      block = {{}, 0, kInfinity, 0, 0, kNever, kNever, false};
      if (searched == 0) continue;
      const Box box = position_box(quantisation, decode_block_box(cell_->box, boxes[i]));
      block = {box.centre(), half_diagonal(box), -kInfinity, searched, 0, kNever, kNever, false};
      m_.queue_.push_back({block.key, i});
    }
  }

  /// Finds how far points of the cell are at most from the positions of a node's poses.
  void find_farthest(const MotionNode& node) {
    const Box box = position_box(m_.cloud_.quantisation(), cell_->box);
    double squared = 0;
    for (std::uint32_t pose = node.first; pose < end_pose_; ++pose) {
      const double* at = sweep_.motion.inverse_poses[pose].translation;
      squared = std::max(squared, greatest_squared_distance(box, {at[0], at[1], at[2]}));
    }
    farthest_ = std::sqrt(squared) * kRoundedUp;
  }

  /// Whether nothing of the part can matter to any pose of a motion node.
  bool is_passed_over(std::uint32_t index) const {
    const MotionNode& node = sweep_.motion.nodes[index];
    const std::uint32_t last = node.first + node.count - 1;
    if (!m_.sleepers_.empty() && m_.sleepers_.front().pose <= last) return false;
    return m_.queue_.empty() || m_.queue_.front().key > limit_of(reaches_.of_node(index), last);
  }

  double limit_of(double reach, std::uint32_t pose) const {
    return (reach + travel_.moved(pose)) * kRoundedUp;
  }

  /// The key for a distance that every pair of something and the model has at the pose under
  /// search.
  double key_of(double distance) const {
    const double proven = distance - sweep_.rounding;
    return ((proven > 0 ? proven : 0) + moved_) * kRoundedDown;
  }

  /// The root of a squared distance. One that is too great for a double proves only so much.
  static double root_of(double squared) { return std::min(std::sqrt(squared), 1e154); }

  /// A distance from the model at the pose under search, from a bound of the field.
  double distance_of(double squared_lower) const {
    return sweep_.motion.inverse_poses[pose_].least * root_of(squared_lower) * kRoundedDown;
  }

  void search_pose(std::uint32_t pose) {
    bound_ = load_shared(bests_.of_pose + pose);
    if (kIsSolid<Element> && bound_ < 0) {
      last_pose_ = kNever;
      return;
    }
    if (last_pose_ != kNever && last_pose_ + 1 == pose &&
        sweep_.motion.poses[pose] == sweep_.motion.poses[last_pose_]) {
      last_pose_ = pose;  // the pose repeats the last one, so what was found is the same
      if (was_found_ && found_ <= bound_) keep();
      return;
    }
    pose_ = last_pose_ = pose;
    moved_ = travel_.moved(pose);
    limit_ = limit_of(reaches_.of(bound_), pose);
    found_ = kInfinity;
    wake();
    if (has_guess_ && sweep_.counts(point_, pose)) lower_bound(squared_at(point_, element_));
    m_.settled_.clear();
    while (!m_.queue_.empty() && !(m_.queue_.front().key > limit_)) {
      const Queued next = pop(m_.queue_);
      if (m_.blocks_[next.block].key == next.key) look_at(next.block);
    }
    for (const std::uint32_t block : m_.settled_) push(m_.queue_, {m_.blocks_[block].key, block});
    was_found_ = found_ < kInfinity;
    if (was_found_) keep();
  }

  void keep() {
    lower_shared(bests_.of_pose + last_pose_, found_);
    ties_.keep(last_pose_, found_);
  }

  void lower_bound(double squared) {
    if (!(squared < bound_)) return;
    bound_ = squared;
    limit_ = limit_of(reaches_.of(bound_), pose_);
  }

  double squared_at(const Vec3& e, const Element& m) const {
    return squared_distance(e, transform(sweep_.motion.poses[pose_], m));
  }

  /// The limit of a pose soon after this one, if it has the same reach.
  double limit_of_next() const {
    const std::uint32_t next = std::min(pose_ + kPosesAhead, end_pose_ - 1);
    return (limit_ + (travel_.moved(next) - moved_)) * kRoundedUp;
  }

  /// Looks at a block whose time has come: at its sphere, unless it is open and only few of its
  /// points are concerned, and when it is the next one again at its points, with those whose time
  /// comes soon. So its points come due together, and the block is looked at less often.
  void look_at(std::uint32_t index) {
    Block& block = m_.blocks_[index];
    double* const keys = m_.keys_.data() + std::size_t{index} * kBlockPoints;
    std::uint64_t due = block.is_open ? not_above(keys, limit_) & block.awake : block.awake;
    if (block.looked_at != pose_ && (!block.is_open || std::popcount(due) >= kManyPoints)) {
      block.looked_at = pose_;
      block.key = std::max(block.key, key_of_sphere(block));
      if (block.key > limit_) {
        m_.settled_.push_back(index);
      } else if (!sends_to_sleep(index)) {
        push(m_.queue_, {block.key, index});
      }
      return;
    }
    if (block.is_open) {
      due = not_above(keys, limit_of_next()) & block.awake;
    } else {
      open(index, keys);
    }
    search_points(index, due);
    block.key = least_of(keys);
    m_.settled_.push_back(index);
  }

  /// Decodes the points of a block and gives them keys of their own.
  void open(std::uint32_t index, double* keys) {
    Block& block = m_.blocks_[index];
    block.is_open = true;
    const std::uint32_t first = first_point_ + index * kBlockPoints;
    const std::uint32_t count = std::min(kBlockPoints, cell_->count - first);
    for (std::size_t k = 0; k < 3; ++k) {
      chunks_[k].decode(first, std::span(m_.stored_[index].at[k], count));
    }
    for (std::uint32_t i = 0; i < kBlockPoints; ++i) {
      keys[i] = (block.awake >> i & 1) != 0 ? -kInfinity : kInfinity;
    }
  }

  Vec3 position_of(std::uint32_t block, std::uint32_t point) const {
    const StoredBlock& stored = m_.stored_[block];
    return position(m_.cloud_.quantisation(), stored.at[0][point], stored.at[1][point],
                    stored.at[2][point]);
  }

  double key_of_sphere(const Block& block) {
    ++statistics().node_tests;
    const Vec3 x = sweep_.motion.inverse_poses[pose_].apply(block.centre);
    return key_of(distance_of(sweep_.field.squared_lower(x)) - block.rho);
  }

  /// Searches points of a block: first against the elements that the field names as near, then, if
  /// still open, against the model's tree.
  void search_points(std::uint32_t index, std::uint64_t due) {
    double* const keys = m_.keys_.data() + std::size_t{index} * kBlockPoints;
    std::uint32_t open = 0, wakes = kNever;
    statistics().point_tests += static_cast<std::uint64_t>(std::popcount(due));
    lanes_.clear();
    for_each_bit(due, [&](std::uint32_t i) { lanes_.add(position_of(index, i)); });
    if (due != 0) lanes_.look_up(sweep_.motion.inverse_poses[pose_]);
    std::uint32_t next_lane = 0;
    for_each_bit(due, [&](std::uint32_t i) {
      const double proven = key_of(distance_of(lanes_.squared_lower(next_lane++)));
      keys[i] = std::max(keys[i], proven);
    });
    for_each_bit(due & not_above(keys, limit_), [&](std::uint32_t i) {
      if (keys[i] > limit_) return;
      Candidate& candidate = candidates_[open];
      candidate.e = position_of(index, i);
      if (!sweep_.counts(candidate.e, pose_)) {
        wakes = std::min(wakes, send_to_sleep(index, i, candidate.e));
        return;
      }
      candidate.point = i;
      candidate.least = kInfinity;
      const std::uint64_t before = due & ((std::uint64_t{1} << i) - 1);
      const std::uint32_t near = lanes_.near(static_cast<std::uint32_t>(std::popcount(before)));
      if (near != ModelFieldRef::kNone) {
        offer(candidate, sweep_.model.elements[near]);
        lower_bound(candidate.least);
      }
      ++open;
    });
    sleep_until(index, wakes);
    for (std::uint32_t k = 0; k < open; ++k) {
      Candidate& candidate = candidates_[k];
      double& key = keys[candidate.point];
      if (key > limit_) continue;
      ++statistics().exact_tests;
      search_point(candidate);
      // Every pair has a computed d2 of at least this.
      key = std::max(key, key_of(root_of(candidate.least) * kRoundedDown));
      take(index, candidate);
    }
  }

  struct Candidate {
    Vec3 e;
    double least;     ///< the least d2 of the elements offered
    Element element;  ///< an element that has it
    std::uint32_t point;
  };

  void offer(Candidate& candidate, const Element& m) const {
    const double squared = squared_at(candidate.e, m);
    if (!(squared < candidate.least)) return;
    candidate.least = squared;
    candidate.element = m;
  }

  /// Offers a point all model elements that may have a d2 of at most its least.
  void search_point(Candidate& candidate) const {
    const InversePose& back = sweep_.motion.inverse_poses[pose_];
    const Vec3 x = back.apply(candidate.e);
    double ball = squared_ball(back, candidate.least);
    const auto visit = [&](const Element& m) {
      offer(candidate, m);
      ball = squared_ball(back, candidate.least);
      return false;
    };
    if constexpr (kIsTriangle<Element>) {
      sweep_.model.any(
          [&](const Box& box) {
            return least_squared_distance(box, x) > ball ? ModelStep::kSkip : ModelStep::kEnter;
          },
          [&](const Element& m) { return !(squared_distance(x, m) > ball) && visit(m); });
    } else {
      sweep_.wide.any_nearest_first(
          Box{x, x}, [&] { return ball; },
          [&](const PointPacket& packet, double(&out)[PointPacket::kMost]) {
            for (std::uint32_t i = 0; i < PointPacket::kMost; ++i) {
              out[i] = squared_distance(x, packet.point(i));
            }
          },
          [&](const PointPacket& packet, std::uint32_t i) { return visit(packet.point(i)); });
    }
  }

  double squared_ball(const InversePose& back, double least) const {
    const double ball = reaches_.of(least) / back.least * kRoundedUp;
    return ball * ball * kRoundedUp;
  }

  void take(std::uint32_t index, const Candidate& candidate) {
    if (!(candidate.least <= bound_ && candidate.least < bests_.limit)) return;
    lower_bound(candidate.least);
    if (candidate.least < found_) {
      found_ = candidate.least;
      ties_.restart();
    }
    ties_.add(first_slot_ + index * kBlockPoints + candidate.point, 1);
    point_ = candidate.e;
    element_ = candidate.element;
    has_guess_ = true;
  }

  /// The first pose after this one at which what is at most `half` from e along each axis may
  /// count, or the end of the node's poses.
  std::uint32_t wakes_at(const Vec3& e, double half) const {
    const InversePose& back = sweep_.motion.inverse_poses[pose_];
    double height = 0, spread = 2 * sweep_.floor_rounding;
    for (int k = 0; k < 3; ++k) {
      height += back.inverse[6 + k] * (e[k] - back.translation[k]);
      spread += std::fabs(back.inverse[6 + k]) * half;
    }
    const double gap = sweep_.floor - height - spread * kRoundedUp;
    return gap > 0 ? travel_.sleep(pose_, end_pose_, farthest_, gap) : pose_ + 1;
  }

  /// Lets a block sleep if it lies below the floor.
  bool sends_to_sleep(std::uint32_t index) {
    Block& block = m_.blocks_[index];
    const Vec3 half{block.rho, block.rho, block.rho};
    if (sweep_.floor_side({pose_}, block.centre, half) != FloorSide::kBelow) return false;
    block.key = kInfinity;
    sleep_until(index, wakes_at(block.centre, block.rho));
    return true;
  }

  /// Lets a point of an open block sleep, which does not count at this pose. Returns until when;
  /// kNever: it stays awake.
  std::uint32_t send_to_sleep(std::uint32_t index, std::uint32_t point, const Vec3& e) {
    const std::uint32_t pose = wakes_at(e, 0);
    if (pose <= pose_ + 1) return kNever;
    const std::size_t slot = std::size_t{index} * kBlockPoints + point;
    m_.keys_[slot] = kInfinity;
    m_.wakes_[slot] = pose;
    Block& block = m_.blocks_[index];
    block.awake &= ~(std::uint64_t{1} << point);
    block.asleep |= std::uint64_t{1} << point;
    return pose;
  }

  /// Puts a block on the list of sleepers, unless it is there for an earlier pose.
  void sleep_until(std::uint32_t index, std::uint32_t pose) {
    Block& block = m_.blocks_[index];
    if (pose >= block.wakes) return;
    block.wakes = pose;
    push(m_.sleepers_, {pose, index});
  }

  /// Wakes all blocks and points whose time to sleep is over.
  void wake() {
    while (!m_.sleepers_.empty() && m_.sleepers_.front().pose <= pose_) {
      const Sleeper sleeper = pop(m_.sleepers_);
      Block& block = m_.blocks_[sleeper.block];
      if (block.wakes != sleeper.pose) continue;  // has been woken before
      block.wakes = kNever;
      block.key = -kInfinity;
      push(m_.queue_, {block.key, sleeper.block});
      std::uint32_t wakes = kNever;
      for_each_bit(block.asleep, [&](std::uint32_t point) {
        const std::size_t slot = std::size_t{sleeper.block} * kBlockPoints + point;
        if (m_.wakes_[slot] > pose_) {
          wakes = std::min(wakes, m_.wakes_[slot]);
          return;
        }
        m_.keys_[slot] = -kInfinity;
        block.awake |= std::uint64_t{1} << point;
        block.asleep &= ~(std::uint64_t{1} << point);
      });
      sleep_until(sleeper.block, wakes);
    }
    drop_outdated();
  }

  /// Drops entries that others have taken the place of, where they are many. To be called where no
  /// block is off the queue but those that sleep.
  void drop_outdated() {
    const std::size_t most = kEntries / 2 * m_.blocks_.size();
    if (m_.queue_.size() > most) {
      m_.queue_.clear();
      for (std::uint32_t i = 0; i < m_.blocks_.size(); ++i) {
        const Block& block = m_.blocks_[i];
        if ((block.awake | block.asleep) != 0) m_.queue_.push_back({block.key, i});
      }
      std::make_heap(m_.queue_.begin(), m_.queue_.end(), std::greater<>());
    }
    if (m_.sleepers_.size() > most) {
      m_.sleepers_.clear();
      for (std::uint32_t i = 0; i < m_.blocks_.size(); ++i) {
        if (m_.blocks_[i].wakes != kNever) m_.sleepers_.push_back({m_.blocks_[i].wakes, i});
      }
      std::make_heap(m_.sleepers_.begin(), m_.sleepers_.end(), std::greater<>());
    }
  }

  SweepStatistics& statistics() { return m_.statistics_[0]; }

  ProfileWalkOf& m_;
  const SweepRefOf<Element>& sweep_;
  const ProfileTravel& travel_;
  const PageRef& page_;
  const ProfileBests& bests_;
  ProfileReaches reaches_;
  SmallestSource ties_;
  typename Blocks::Shared shared_;
  Blocks warp_blocks_;
  Depths depths_;

  FieldLanes lanes_;
  const PageCell* cell_ = nullptr;
  std::array<PackedChunk<std::int32_t>, 3> chunks_;  ///< the coordinates of the cell
  std::uint32_t index_ = 0;                          ///< index of the cell in the page
  std::uint32_t first_point_ = 0;                    ///< first point of the part, in its cell
  std::uint32_t first_slot_ = 0;                     ///< slot of the first point, in the page
  std::uint32_t end_pose_ = 0;  ///< end of the poses of the motion node under search
  double farthest_ = 0;         ///< how far any point is from the positions of its poses

  std::uint32_t pose_ = 0;            ///< the pose under search
  double moved_ = 0;                  ///< the way moved up to it
  double bound_ = 0;                  ///< values of d2 above it do not matter at this pose
  double limit_ = 0;                  ///< keys above it do not matter at this pose
  double found_ = kInfinity;          ///< the least d2 found at the last pose
  std::uint32_t last_pose_ = kNever;  ///< the last pose, if what it found is still known
  bool was_found_ = false;
  bool has_guess_ = false;
  Vec3 point_{};       ///< the last point found
  Element element_{};  ///< the model's element nearest to it
  Candidate candidates_[kBlockPoints];
};

template <typename Element>
ProfileWalkOf<Element>::ProfileWalkOf(const PackedCloud& cloud,
                                      const SweepFilterOf<Element>& filter)
    : cloud_(cloud), filter_(filter) {
  const std::size_t blocks = std::min<std::size_t>(cloud.blocks_per_cell(), Blocks::kPartBlocks);
  blocks_.reserve(blocks);
  queue_.reserve(kEntries * blocks);
  settled_.reserve(blocks);
  keys_.resize(blocks * kBlockPoints);
  stored_.resize(blocks);
  if (!filter.ref().has_floor()) return;
  sleepers_.reserve(kEntries * blocks);
  wakes_.resize(blocks * kBlockPoints);
}

template <typename Element>
void ProfileWalkOf<Element>::search(const PageRef& page, const ProfileBests& bests,
                                    std::vector<ProfileFact>& found) {
  using Descent = ProfileSearch<HostWarp, SmallestSource, Element>;
  OfPage walk(*this, page, bests, found);
  typename Descent::Shared shared;
  Descent descent(filter_.ref(), page, cloud_.quantisation(), bests, SmallestSource(cloud_, found),
                  shared, statistics_);
  const std::uint32_t parts = Descent::parts_of_cell(page.shape.blocks_per_cell);
  for (std::uint32_t i = 0; i < page.shape.cells; ++i) {
    const PageCell& cell = page.cell(i);
    for (std::uint32_t part = 0; part < parts && walk.enter(i, part); ++part) {
      bool entered = false;
      for (std::uint32_t node = 0; node < cell.node_count; ++node) {
        const std::uint32_t top = page.nodes(cell)[node];
        if (!is_far_apart(cell, top)) {
          walk.search(top);
          continue;
        }
        entered = entered || descent.enter(i, part);
        if (entered) descent.search(top);
      }
    }
    if (page.shape.cells > 1) keep_least_facts(cloud_, page, true, found);
  }
}

/// Whether the model moves so far from pose to pose of a node that bounds do not last: all blocks
/// of a cell would be looked at again at each pose. Then the motion tree is descended as on a GPU.
template <typename Element>
bool ProfileWalkOf<Element>::is_far_apart(const PageCell& cell, std::uint32_t top) const {
  const MotionNode& node = filter_.ref().motion.nodes[top];
  const ProfileTravel& travel = filter_.travel();
  // With the step to its first pose, since a node may have one pose alone.
  const std::uint32_t before = node.first - (node.first > 0 ? 1 : 0);
  const double way = travel.moved(node.first + node.count - 1) - travel.moved(before);
  const double size = half_diagonal(position_box(cloud_.quantisation(), cell.box));
  return !(kFarSteps * way < size * node.count);
}

template <typename Element>
SweepStatistics ProfileWalkOf<Element>::take_statistics() {
  SweepStatistics sum;
  for (SweepStatistics& of_lane : statistics_.values) sum.add(std::exchange(of_lane, {}));
  return sum;
}

template <typename Element>
std::uint64_t ProfileWalkOf<Element>::most_bytes(const PackedCloud& cloud, const Query& query,
                                                 std::uint64_t most_poses) {
  if (!(query.profile > 0)) return 0;
  const std::uint64_t blocks =
      std::min<std::uint64_t>(cloud.blocks_per_cell(), Blocks::kPartBlocks);
  return sizeof(ProfileWalkOf) +
         blocks * (sizeof(Block) + sizeof(StoredBlock) +
                   kBlockPoints * (sizeof(double) + sizeof(std::uint32_t)) +
                   kEntries * (sizeof(Queued) + sizeof(Sleeper)) + 2 * sizeof(std::uint32_t)) +
         2 * most_poses * sizeof(std::uint32_t);  // the list may have grown to twice its size
}

template class ProfileWalkOf<Vec3>;
template class ProfileWalkOf<Triangle>;
template class ProfileWalkOf<SolidTriangle>;

}  // namespace clearway
