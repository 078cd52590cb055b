#include "search/kinds/visit_kind.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/search_result.hpp"
#include "core/sweep/profile/host_profile.hpp"
#include "search/body_queries.hpp"
#include "search/memory_budget.hpp"

namespace clearway {
namespace {

using Of = VisitQuestion::Of;

/// An engine that searches the model of a body for a question, at the poses of that body.
struct EngineOfLane {
  std::unique_ptr<PageEngine> engine;
  std::size_t question;
  std::uint32_t body;
  /// For each pose of the body, the index of the pose of the path that it belongs to; none without
  /// bodies.
  std::span<const std::uint32_t> path_pose;
  /// The number of the lane's first motion node in a page, where nodes are numbered over all lanes.
  std::uint32_t first_node;
};

/// The layout of the answers' slots, which have no page: pages are in the slots of the engines.
SlotLayout without_pages(SlotLayout layout) {
  layout.page_bytes = 0;
  return layout;
}

void extend(Interval& whole, const Interval& part) {
  whole = {std::min(whole.begin, part.begin), std::max(whole.end, part.end)};
}

/// The answer of a question with bodies: for each point the smallest of the BodyNumbers is kept.
class AnswerOfBodies {
 public:
  AnswerOfBodies(const PackedCloud& cloud, const Query& query, const SlotLayout& layout)
      : numbers_(query), answers_(cloud, query, without_pages(layout)), facts_(layout.slots) {}

  /// Joins what the lanes of the bodies have found in a slot's page of so many cells. A lane that
  /// was not searched has found nothing.
  PageResult join(std::uint32_t slot, std::uint32_t cells, std::span<const EngineOfLane> lanes,
                  std::span<const PageResult> found) {
    std::ranges::fill(answers_.hits(slot), 0);
    std::ranges::fill(answers_.first_poses(slot), kNoPose);
    std::ranges::fill(answers_.clearances(slot), Clearance{});
    make_room(slot, found);
    for (std::size_t body = 0; body < lanes.size(); ++body) add(slot, lanes[body], found[body]);
    PageResult result = answers_.result(slot, cells);
    result.profile = facts_[slot];
    return result;
  }

  /// Bytes of memory for the answers of all slots. most_poses: the most poses of the motion nodes
  /// of any cell, for all bodies together.
  static std::uint64_t bytes(const PackedCloud& cloud, const Query& query, const SlotLayout& layout,
                             std::uint64_t most_poses) {
    const std::uint64_t answers =
        layout.slots * PagePool::slot_bytes(cloud, query, without_pages(layout));
    if (!(query.profile > 0)) return answers;
    // Models of points and of triangles have the same bound.
    const std::uint64_t of_body =
        HostProfileOf<Vec3>::most_facts(cloud, query.poses.size(), layout.cells, most_poses);
    return answers + layout.slots * query.bodies.size() * of_body * sizeof(ProfileFact);
  }

 private:
  /// Empties the slot's profile facts and reserves memory for those of all bodies, and no more.
  void make_room(std::uint32_t slot, std::span<const PageResult> found) {
    std::size_t facts = 0;
    for (const PageResult& of_body : found) facts += of_body.profile.size();
    if (facts_[slot].capacity() < facts) facts_[slot] = {};
    facts_[slot].clear();
    facts_[slot].reserve(facts);
  }

  void add(std::uint32_t slot, const EngineOfLane& lane, const PageResult& found) {
    const auto number_of = [&](std::uint32_t pose) {
      return numbers_.number(lane.path_pose[pose], lane.body);
    };
    const auto hits = answers_.hits(slot);
    for (std::size_t i = 0; i < found.hits.size(); ++i) hits[i] |= found.hits[i];
    const auto first_poses = answers_.first_poses(slot);
    for (std::size_t i = 0; i < found.first_poses.size(); ++i) {
      const std::uint32_t pose = found.first_poses[i];
      if (pose != kNoPose) first_poses[i] = std::min(first_poses[i], number_of(pose));
    }
    const auto clearances = answers_.clearances(slot);
    for (std::size_t i = 0; i < found.clearances.size(); ++i) {
      Clearance other = found.clearances[i];
      if (!other.found()) continue;
      other.pose = number_of(other.pose);
      Clearance& least = clearances[i];
      const bool nearer = other.squared < least.squared;
      if (nearer || (other.squared == least.squared && other.pose < least.pose)) least = other;
    }
    for (ProfileFact fact : found.profile) {
      fact.pose = lane.path_pose[fact.pose];
      facts_[slot].push_back(fact);
    }
  }

  const BodyNumbers numbers_;
  PagePool answers_;
  /// For each slot, the profile facts of its page.
  std::vector<std::vector<ProfileFact>> facts_;
};

/// The engines of all lanes as one engine, on any device. Every page is searched by each of them,
/// and by those that ask about colliding points once these are known.
class VisitEngine final : public PageEngine {
 public:
  /// lanes: those of each question together. layout: that of the first engine. What is referred to
  /// outlives this engine.
  VisitEngine(const PackedCloud& cloud, std::span<const VisitQuestion> questions,
              std::vector<EngineOfLane> lanes, const SlotLayout& layout);

  std::uint32_t slots() const override { return static_cast<std::uint32_t>(shapes_.size()); }
  bool pages_alike() const override { return first().pages_alike(); }
  std::span<std::byte> page(std::uint32_t slot) override { return first().page(slot); }
  std::optional<CellPayload> kept(std::uint32_t slot, std::uint32_t cell) override;
  void start(std::uint32_t slot, const PageShape& shape) override;
  void wait(std::uint32_t slot) override;
  PageResult finish(std::uint32_t slot) override;
  void release(std::uint32_t slot) override {
    for (const EngineOfLane& lane : lanes_) lane.engine->release(slot);
  }

  PageEngine& engine(std::size_t lane) const { return *lanes_[lane].engine; }

 private:
  struct Question {
    bool depends = false;  ///< whether it is asked only of what the first question has found
    bool inverts = false;  ///< whether it is asked of the points that the masks leave out
    std::size_t first_lane = 0, lanes = 0;
    std::optional<AnswerOfBodies> bodies = {};  ///< only where there are bodies
  };

  PageEngine& first() const { return *lanes_.front().engine; }
  std::span<std::uint64_t> masks(std::uint32_t slot, const EngineOfLane& lane) const;
  void keep_nodes(std::uint32_t slot, std::size_t lane) const;
  void invert_masks(std::uint32_t slot, const EngineOfLane& lane) const;
  void start_lanes(std::uint32_t slot, bool dependent) const;
  void search_hits(std::uint32_t slot, std::span<PageResult> found);
  PageResult answer(std::uint32_t slot, std::size_t question, std::span<const PageResult> found);
  template <typename Call>
  void for_lanes(bool dependent, Call call) const;

  const std::vector<EngineOfLane> lanes_;
  std::vector<Question> questions_;
  std::vector<PageShape> shapes_;                 ///< of each slot's page
  std::vector<std::vector<PageResult>> results_;  ///< of each slot, for each question
  std::vector<std::uint64_t> no_hits_;            ///< of a page that is not searched
};

VisitEngine::VisitEngine(const PackedCloud& cloud, std::span<const VisitQuestion> questions,
                         std::vector<EngineOfLane> lanes, const SlotLayout& layout)
    : lanes_(std::move(lanes)),
      questions_(questions.size()),
      shapes_(layout.slots),
      results_(layout.slots, std::vector<PageResult>(questions.size())),
      no_hits_(std::size_t{layout.cells} * cloud.blocks_per_cell()) {
  for (std::size_t i = 0; i < questions.size(); ++i) {
    questions_[i].depends = i > 0 && questions[i].of == Of::kHits;
    questions_[i].inverts = i > 0 && questions[i].of == Of::kIgnored;
    if (i > 0) questions_[i].first_lane = questions_[i - 1].first_lane + questions_[i - 1].lanes;
    questions_[i].lanes = std::max<std::size_t>(questions[i].query.bodies.size(), 1);
    if (!questions[i].query.bodies.empty()) {
      questions_[i].bodies.emplace(cloud, questions[i].query, layout);
    }
  }
}

/// Makes the call for every lane of the questions that depend on hits, or of the others. The first
/// failure is thrown after the last call.
template <typename Call>
void VisitEngine::for_lanes(bool dependent, Call call) const {
  std::exception_ptr failure;
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    if (questions_[lanes_[lane].question].depends != dependent) continue;
    try {
      call(lane);
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

/// Where the first engine finds a cell that all engines find, each of which then holds it.
std::optional<CellPayload> VisitEngine::kept(std::uint32_t slot, std::uint32_t cell) {
  std::optional<CellPayload> place = first().kept(slot, cell);
  for (std::size_t lane = 1; lane < lanes_.size() && place; ++lane) {
    if (!lanes_[lane].engine->kept(slot, cell)) place.reset();
  }
  return place;
}

/// The caller has filled the first engine's page. The others get copies of it without the
/// coordinates, which they find where the first one has them, so that a GPU gets them once.
void VisitEngine::start(std::uint32_t slot, const PageShape& shape) {
  shapes_[slot] = shape;
  const std::span<const std::byte> filled = first().page(slot).first(shape.payload_at());
  for (std::size_t lane = lanes_.size(); lane-- > 0;) {
    if (lane > 0) std::ranges::copy(filled, lanes_[lane].engine->page(slot).begin());
    keep_nodes(slot, lane);
    if (questions_[lanes_[lane].question].inverts) invert_masks(slot, lanes_[lane]);
  }
  start_lanes(slot, false);
}

std::span<std::uint64_t> VisitEngine::masks(std::uint32_t slot, const EngineOfLane& lane) const {
  const PageShape& shape = shapes_[slot];
  return {reinterpret_cast<std::uint64_t*>(lane.engine->page(slot).data() + shape.masks_at()),
          std::size_t{shape.cells} * shape.blocks_per_cell};
}

/// Reduces the nodes of every cell of a lane's page to its own, renumbered from 0. A cell's nodes
/// come lane after lane, numbered over all lanes.
void VisitEngine::keep_nodes(std::uint32_t slot, std::size_t lane) const {
  const std::span<std::byte> page = lanes_[lane].engine->page(slot);
  const PageShape& shape = shapes_[slot];
  const std::uint32_t begin = lanes_[lane].first_node;
  const std::uint32_t end = lane + 1 < lanes_.size() ? lanes_[lane + 1].first_node
                                                     : std::numeric_limits<std::uint32_t>::max();
  const std::span nodes(reinterpret_cast<std::uint32_t*>(page.data() + shape.nodes_at()),
                        shape.nodes);
  for (PageCell& cell : std::span(reinterpret_cast<PageCell*>(page.data()), shape.cells)) {
    const auto of_cell = nodes.subspan(cell.first_node, cell.node_count);
    const auto before = [](std::uint32_t bound) {
      return [bound](std::uint32_t node) { return node < bound; };
    };
    const auto first = std::ranges::partition_point(of_cell, before(begin));
    const auto last = std::partition_point(first, of_cell.end(), before(end));
    for (auto node = first; node != last; ++node) *node -= begin;
    cell.first_node += static_cast<std::uint32_t>(first - of_cell.begin());
    cell.node_count = static_cast<std::uint32_t>(last - first);
  }
}

void VisitEngine::invert_masks(std::uint32_t slot, const EngineOfLane& lane) const {
  PageRef all{lane.engine->page(slot).data(), shapes_[slot]};
  all.shape.masked = false;
  const std::span<std::uint64_t> words = masks(slot, lane);
  for (std::uint32_t i = 0; i < words.size(); ++i) {
    words[i] ^= all.searched(i / all.shape.blocks_per_cell, i % all.shape.blocks_per_cell);
  }
}

/// Starts the lanes that depend on hits, or the others, of which the first brings the coordinates.
void VisitEngine::start_lanes(std::uint32_t slot, bool dependent) const {
  const PageShape without_payloads = shapes_[slot].without_payloads();
  std::vector<std::size_t> started;
  try {
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
      if (questions_[lanes_[lane].question].depends != dependent) continue;
      if (lane == 0) {
        first().start(slot, shapes_[slot]);
      } else {
        lanes_[lane].engine->start_beside(first(), slot, without_payloads);
      }
      started.push_back(lane);
    }
  } catch (...) {
    for (const std::size_t lane : started) {
      try {
        lanes_[lane].engine->finish(slot);
      } catch (...) {  // only the first failure is thrown
      }
    }
    throw;
  }
}

void VisitEngine::wait(std::uint32_t slot) {
  for_lanes(false, [&](std::size_t lane) { lanes_[lane].engine->wait(slot); });
}

PageResult VisitEngine::finish(std::uint32_t slot) {
  std::vector<PageResult> found(lanes_.size());
  for_lanes(false, [&](std::size_t lane) { found[lane] = lanes_[lane].engine->finish(slot); });
  std::vector<PageResult>& results = results_[slot];
  results[0] = answer(slot, 0, found);
  search_hits(slot, found);
  for (std::size_t i = 1; i < results.size(); ++i) results[i] = answer(slot, i, found);
  PageResult whole = results[0];
  whole.further = std::span(results).subspan(1);
  whole.upload = found.front().upload;
  whole.compute = found.front().compute;
  for (const PageResult& of_lane : found) {
    if (of_lane.hits.empty()) continue;  // not searched
    extend(whole.upload, of_lane.upload);
    extend(whole.compute, of_lane.compute);
  }
  return whole;
}

/// Asks the questions that depend on hits of the points that collide, if there are any.
void VisitEngine::search_hits(std::uint32_t slot, std::span<PageResult> found) {
  const std::span<const std::uint64_t> hits = results_[slot].front().hits;
  if (std::ranges::all_of(hits, [](std::uint64_t word) { return word == 0; })) return;
  for_lanes(true,
            [&](std::size_t lane) { std::ranges::copy(hits, masks(slot, lanes_[lane]).begin()); });
  start_lanes(slot, true);
  for_lanes(true, [&](std::size_t lane) { found[lane] = lanes_[lane].engine->finish(slot); });
}

/// found: what each lane has found.
PageResult VisitEngine::answer(std::uint32_t slot, std::size_t index,
                               std::span<const PageResult> found) {
  Question& question = questions_[index];
  const std::uint32_t cells = shapes_[slot].cells;
  const auto own = found.subspan(question.first_lane, question.lanes);
  if (question.bodies) {
    const auto lanes = std::span(lanes_).subspan(question.first_lane, question.lanes);
    return question.bodies->join(slot, cells, lanes, own);
  }
  if (!own.front().hits.empty()) return own.front();
  return {.hits = std::span(no_hits_).first(std::size_t{cells} * shapes_[slot].blocks_per_cell),
          .first_poses = {},
          .clearances = {}};
}

/// The fewest slots of a GPU for several engines. Each slot of a GPU holds the page once for each
/// of them, and takes that much longer to make. A page is also searched that much longer, so fewer
/// pages are in flight.
constexpr std::uint32_t kFewestSlotsOfGpu = 8;

}  // namespace

VisitKind::VisitKind(const PackedCloud& cloud, std::vector<VisitQuestion> questions,
                     const MakeKind& make)
    : PageEngineKind({}), cloud_(cloud), questions_(std::move(questions)) {
  for (std::size_t i = 0; i < questions_.size(); ++i) {
    const Query& query = questions_[i].query;
    const auto add = [&](std::size_t body, const Query& one) {
      lanes_.push_back(std::make_unique<Lane>(i, body, one, make(one)));
    };
    const std::vector<Query>& bodies = bodies_.emplace_back(body_queries(query));
    for (std::size_t body = 0; body < bodies.size(); ++body) add(body, bodies[body]);
    if (bodies.empty()) add(0, query);
  }
  needs_ = needs_of_lanes();
}

PageEngineNeeds VisitKind::needs_of_lanes() const {
  PageEngineNeeds needs = lanes_.front()->kind->needs();
  needs.masked = std::ranges::any_of(lanes_, [&](const auto& lane) { return depends(*lane); });
  needs.may_be_divided = questions_.size() > 1;
  if (!needs.on_gpu) return needs;
  const auto fewer = static_cast<std::uint32_t>(needs.most_slots / lanes_.size());
  needs.most_slots = std::min(needs.most_slots, std::max(fewer, kFewestSlotsOfGpu));
  return needs;
}

/// Index sizes for all lanes together.
std::vector<PageEngineKind::IndexSize> VisitKind::index_sizes() const {
  std::vector<IndexSize> sizes = lanes_.front()->kind->index_sizes();
  for (IndexSize& size : sizes) {
    size.bytes *= lanes_.size();
    size.while_built *= lanes_.size();
  }
  return sizes;
}

const PoseReach& VisitKind::build_index(const QueryTrees& trees, std::uint64_t most_bytes) {
  std::uint32_t nodes = 0;
  for (const auto& lane : lanes_) {
    if (lane != lanes_.front() && !lane->trees) {
      lane->trees = std::make_unique<QueryTrees>(trees_of(lane->query, lane->body));
    }
    const QueryTrees& its = lane->trees ? *lane->trees : trees;
    lane->reach = &lane->kind->build_index(its, most_bytes / lanes_.size());
    lane->first_node = nodes;
    nodes += static_cast<std::uint32_t>(its.motion.nodes().size());
  }
  return *lanes_.front()->reach;
}

/// Plans the cells that any lane reaches, ordered by the first pose of the path at which a body
/// reaches them. Each cell has the motion nodes of one lane after the other. What depends on hits
/// needs no cells of its own.
std::vector<PlannedCell> VisitKind::plan_cells(const PackedCloud& cloud, const PoseReach&) const {
  struct Reached {
    PlannedCell cell;
    std::uint32_t first_pose = ~std::uint32_t{0};
  };
  std::vector<Reached> reached(cloud.cells().size());
  for (const auto& lane : lanes_) {
    const VisitQuestion& question = questions_[lane->question];
    const IgnoredPoints ignored(cloud, question.query,
                                question.of == Of::kIgnored ? IgnoredPoints::Search::kIgnored
                                                            : IgnoredPoints::Search::kOthers);
    for (const PlannedCell& planned : plan(cloud, *lane->reach)) {
      Reached& of = reached[planned.cell];
      if (ignored.skips(planned.cell) || (depends(*lane) && of.cell.nodes.empty())) continue;
      of.cell.cell = planned.cell;
      if (!depends(*lane)) {
        std::uint32_t pose = lane->reach->motion().nodes()[planned.nodes.front()].first;
        const auto& bodies = question.query.bodies;
        if (!bodies.empty()) pose = bodies[lane->body].path_pose[pose];
        of.first_pose = std::min(of.first_pose, pose);
      }
      of.cell.nodes.reserve(of.cell.nodes.size() + planned.nodes.size());
      for (const std::uint32_t node : planned.nodes) {
        of.cell.nodes.push_back(lane->first_node + node);
      }
    }
  }
  std::erase_if(reached, [](const Reached& of) { return of.cell.nodes.empty(); });
  std::ranges::stable_sort(reached, {}, &Reached::first_pose);
  std::vector<PlannedCell> cells;
  cells.reserve(reached.size());
  for (Reached& of : reached) cells.push_back(std::move(of.cell));
  return cells;
}

const VisitKind::Lane& VisitKind::lane_of(std::uint32_t node) const {
  const auto starts = [](const std::unique_ptr<Lane>& lane) { return lane->first_node; };
  return **std::prev(std::ranges::upper_bound(lanes_, node, {}, starts));
}

std::uint64_t VisitKind::most_poses(const MotionTree&, std::span<const PlannedCell> cells) const {
  std::uint64_t most = 0;
  for (const PlannedCell& cell : cells) {
    std::uint64_t poses = 0;
    for (const std::uint32_t node : cell.nodes) {
      const Lane& lane = lane_of(node);
      poses += lane.reach->motion().nodes()[node - lane.first_node].count;
    }
    most = std::max(most, poses);
  }
  return most;
}

void VisitKind::resolve_devices() {
  for (const auto& lane : lanes_) lane->kind->resolve_devices();
  needs_ = needs_of_lanes();
}

/// The layout of a lane's engine: the first one alone has coordinates.
SlotLayout VisitKind::layout_of(const Lane& lane, SlotLayout layout) const {
  if (&lane != lanes_.front().get() && layout.header_bytes > 0) {
    layout.page_bytes = layout.header_bytes;
  }
  return layout;
}

/// With the inputs of the further questions, which are there as long as the index is.
std::uint64_t VisitKind::index_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& lane : lanes_) {
    bytes += lane->kind->index_bytes() + (lane->trees ? lane->trees->allocated_bytes() : 0);
  }
  for (const VisitQuestion& question : std::span(questions_).subspan(1)) {
    bytes += input_bytes(cloud_, question.query) - cloud_.allocated_bytes();
  }
  return bytes;
}

std::uint64_t VisitKind::host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const {
  std::uint64_t bytes = 0;
  for (const VisitQuestion& question : questions_) {
    if (question.query.bodies.empty()) continue;
    bytes += needs_.devices * AnswerOfBodies::bytes(cloud_, question.query, layout, most_poses);
  }
  for (const auto& lane : lanes_) {
    bytes += lane->kind->host_bytes(layout_of(*lane, layout), most_poses);
  }
  return bytes;
}

std::uint64_t VisitKind::device_bytes(const SlotLayout& layout) const {
  std::uint64_t bytes = 0;
  for (const auto& lane : lanes_) bytes += lane->kind->device_bytes(layout_of(*lane, layout));
  return bytes;
}

void VisitKind::log_index(const MessageLog& log) const {
  for (const auto& lane : lanes_) {
    if (lane->question == 0) lane->kind->log_index(log);
  }
}

PageEngines VisitKind::make(const SlotLayout& layout) {
  std::vector<std::vector<EngineOfLane>> of_device(needs_.devices);
  for (const auto& lane : lanes_) {
    PageEngines engines = lane->kind->make(layout_of(*lane, layout));
    const auto& bodies = questions_[lane->question].query.bodies;
    const auto path_pose =
        bodies.empty() ? std::span<const std::uint32_t>() : std::span(bodies[lane->body].path_pose);
    for (std::size_t device = 0; device < engines.size(); ++device) {
      of_device[device].push_back({std::move(engines[device]), lane->question,
                                   static_cast<std::uint32_t>(lane->body), path_pose,
                                   lane->first_node});
    }
  }
  PageEngines engines;
  for (auto& lanes : of_device) {
    engines.push_back(std::make_unique<VisitEngine>(cloud_, questions_, std::move(lanes), layout));
  }
  return engines;
}

void VisitKind::report_search(EngineList engines, SearchReport& report,
                              const MessageLog& log) const {
  const MessageCallback silent;
  std::vector<Message> none;
  const MessageLog nothing(silent, none);
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    std::vector<const PageEngine*> of_lane;
    for (const PageEngine* engine : engines) {
      of_lane.push_back(&dynamic_cast<const VisitEngine&>(*engine).engine(i));
    }
    SearchReport taken;
    lanes_[i]->kind->report_search(of_lane, taken, lanes_[i]->question == 0 ? log : nothing);
    report.peak_device_bytes += taken.peak_device_bytes;
    report.pinned_bytes += taken.pinned_bytes;
  }
}

std::unique_ptr<PageEngineKind> visit_kind(const PackedCloud& cloud,
                                           std::vector<VisitQuestion> questions,
                                           const MakeKind& make) {
  if (questions.size() == 1 && questions.front().query.bodies.empty()) {
    return make(questions.front().query);
  }
  return std::make_unique<VisitKind>(cloud, std::move(questions), make);
}

}  // namespace clearway
