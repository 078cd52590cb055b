#include "support/engines.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <utility>

#include "core/answer.hpp"
#include "core/tolerance.hpp"
#include "cpu/brute_force.hpp"
#include "cpu/kdtree_engine.hpp"
#include "cpu/sweep_engine.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "support/grid_runs.hpp"
#include "support/host_sweep.hpp"

namespace clearway {
namespace {

Answer kdtree(const PackedCloud& cloud, const Question& question, int threads) {
  NoProgress progress;
  return {run_kdtree(cloud, question, {threads}, progress), ClearanceSet()};
}

Answer sweep(const PackedCloud& cloud, const Question& question, int threads) {
  return run_sweep(cloud, question, threads,
                   [](const SweepFilter& filter, const PackedCloud& of, const SlotLayout& layout) {
                     return std::make_unique<SweepEngine>(of, filter, layout);
                   });
}

/// The bodies of the CUDA engine as loops, with lists of open work from ample to none.
Answer sweep_as_on_cuda(const PackedCloud& cloud, const Question& question, int threads) {
  return run_sweep(cloud, question, threads,
                   [](const SweepFilter& filter, const PackedCloud& of, const SlotLayout& layout) {
                     const std::uint32_t entries = layout.slots % 3 == 0   ? 0
                                                   : layout.slots % 3 == 1 ? 50
                                                                           : 100'000;
                     return std::make_unique<HostSweep>(of, filter.ref(), layout, entries);
                   });
}

Answer grid(const PackedCloud& cloud, const Question& question, int) {
  return {run_grid(cloud, question, {}), ClearanceSet()};
}

std::vector<Engine> under_test{{"kdtree", kdtree, true, false, false},
                               {"sweep", sweep, true, true, true},
                               {"sweep as on CUDA", sweep_as_on_cuda, true, true, true},
                               {"grid", grid, false, false, false}};

constexpr int kThreads = 3;

/// First poses by brute force, at poses and between them.
struct Expected {
  Expected(const std::vector<Vec3>& positions, Question question) {
    question.between_poses = false;
    at_poses = brute_force_first_poses(positions, question);
    question.between_poses = true;
    between_poses = brute_force_first_poses(positions, question);
  }

  std::vector<std::uint32_t> at_poses, between_poses;
};

std::uint64_t check_answers(const MemoryCloud& cloud, const std::vector<std::uint32_t>& expected,
                            Question question) {
  std::uint64_t colliding = 0;
  for (const std::uint32_t pose : expected) colliding += pose != HitSet::kNever;
  for (const Engine& engine : engines()) {
    if (question.between_poses && !engine.between_poses) continue;
    for (const bool first_pose : {false, true}) {
      question.first_pose = first_pose;
      const HitSet hits = engine.run(cloud, question, kThreads).hits;
      CAPTURE(engine.name, first_pose, question.between_poses, cloud.cell_points(),
              cloud.cells().size());
      std::uint64_t wrong = 0;
      for (std::uint64_t slot = 0; slot < cloud.slot_count(); ++slot) {
        if (!cloud.is_used(slot)) {
          wrong += hits.contains(slot);
          continue;
        }
        const std::uint32_t pose = expected[cloud.source(slot)];
        wrong += hits.contains(slot) != (pose != HitSet::kNever);
        if (first_pose) wrong += hits.first_pose(slot) != pose;
      }
      CHECK(wrong == 0);
      CHECK(hits.count() == colliding);
    }
  }
  return colliding;
}

using Oracle = std::vector<Clearance>;

/// Every clearance and every hit, a set or with first poses.
std::uint64_t check_clearances(const Engine& engine, const MemoryCloud& cloud, const Oracle& least,
                               const std::vector<std::uint32_t>& first_poses,
                               const Question& question) {
  const double limit = question.clearance * question.clearance;
  const Answer answer = engine.run(cloud, question, kThreads);
  CAPTURE(engine.name, question.clearance, question.radius, question.first_pose,
          cloud.cell_points());
  std::uint64_t wrong = 0, wrong_hits = 0, found = 0;
  for (std::uint64_t slot = 0; slot < cloud.slot_count(); ++slot) {
    Clearance expected;
    std::uint32_t pose = HitSet::kNever;
    if (cloud.is_used(slot)) {
      const Clearance& oracle = least[cloud.source(slot)];
      if (oracle.squared < limit) expected = oracle;
      pose = first_poses[cloud.source(slot)];
    }
    found += expected.found();
    wrong += answer.clearances.at(slot) != expected;
    wrong_hits += answer.hits.contains(slot) != (pose != HitSet::kNever);
    if (question.first_pose) wrong_hits += answer.hits.first_pose(slot) != pose;
  }
  CHECK(wrong == 0);
  CHECK(wrong_hits == 0);
  CHECK(answer.clearances.count() == found);
  return found;
}

std::uint64_t check_clearances(const MemoryCloud& cloud, const Oracle& least,
                               const std::vector<std::uint32_t>& first_poses,
                               const Question& question) {
  std::uint64_t found = 0;
  for (const Engine& engine : engines()) {
    if (engine.clearances) found = check_clearances(engine, cloud, least, first_poses, question);
  }
  return found;
}

Question with_clearance(Question question, double clearance, bool first_pose) {
  question.clearance = clearance;
  question.first_pose = first_pose;
  return question;
}

/// By index in the points given.
std::vector<bool> by_source(const MemoryCloud& cloud, const HitSet& hits) {
  std::vector<bool> out(cloud.point_count());
  for (std::uint64_t slot = 0; slot < cloud.slot_count(); ++slot) {
    if (cloud.is_used(slot)) out[cloud.source(slot)] = hits.contains(slot);
  }
  return out;
}

/// |d - radius| of the wrong answers at the most, 0 without any; in more digits than the engines'.
double farthest_difference(const std::vector<bool>& answer, const std::vector<bool>& expected,
                           const Oracle& least, double radius) {
  long double farthest = 0;
  for (std::size_t i = 0; i < answer.size(); ++i) {
    if (answer[i] == expected[i]) continue;
    const long double d = std::sqrt(static_cast<long double>(least[i].squared));
    farthest = std::max(farthest, std::abs(d - radius));
  }
  const auto rounded = static_cast<double>(farthest);
  return rounded < farthest ? std::nextafter(rounded, HUGE_VAL) : rounded;
}

std::uint64_t check_packed(const MemoryCloud& cloud, const Expected& expected, Question question) {
  question.between_poses = true;
  const std::uint64_t swept = check_answers(cloud, expected.between_poses, question);
  question.between_poses = false;
  const std::uint64_t colliding = check_answers(cloud, expected.at_poses, question);
  CHECK(swept >= colliding);
  return colliding;
}

}  // namespace

std::span<const Engine> engines() { return under_test; }

Answer run_sweep(const PackedCloud& cloud, const Question& asked, int threads,
                 const MakeSweep& make) {
  NoProgress progress;
  std::optional<ThinnedQuestion> thinned;
  if (asked.tolerance > 0) thinned.emplace(asked);
  const Question& question = thinned ? thinned->question() : asked;
  if (question.model.empty()) {
    return {HitSet(cloud.slot_count(), question.first_pose), ClearanceSet(cloud.slot_count())};
  }
  const ModelTree model(question.model);
  const ModelField field(model, search_radius(question), {.reach = question.clearance}, threads);
  const MotionTree motion(question.poses, model.box(), question.between_poses);
  const SweepFilter filter(question, motion, model, field, cloud);
  const std::vector<PlannedCell> cells = plan(cloud, filter);
  const SlotLayout layout{.slots = 1 + static_cast<std::uint32_t>(cells.size() % 5),
                          .page_bytes = 2 * smallest_page_bytes(cloud, cells),
                          .cells = 1 + static_cast<std::uint32_t>(cells.size() % 3)};
  const std::unique_ptr<PageEngine> engine = make(filter, cloud, layout);
  PageEngine* const engines[] = {engine.get()};
  StageTimes times;
  return run_pages(cloud, cells, paginate(cloud, cells, layout.page_bytes, layout.cells), engines,
                   question, threads, progress, times);
}

void test_only(std::vector<Engine> engines) { under_test = std::move(engines); }

std::vector<std::uint32_t> check_between_poses(std::span<const Quantum> points,
                                               const Quantisation& quantisation,
                                               Question question) {
  question.between_poses = true;
  const auto expected = brute_force_first_poses(positions_of(points, quantisation), question);
  check_answers(MemoryCloud(points, quantisation, {128, 0}), expected, question);
  return expected;
}

std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Question& question, const MemoryCloudOptions& packing) {
  const auto environment = positions_of(points, quantisation);
  const Expected expected(environment, question);
  const MemoryCloud cloud(points, quantisation, packing);
  check_clearances(cloud, brute_force_clearances(environment, question), expected.at_poses,
                   with_clearance(question, 2.5 * question.radius, points.size() % 2 == 0));
  return check_packed(cloud, expected, question);
}

std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Question& question) {
  const auto environment = positions_of(points, quantisation);
  const Expected expected(environment, question);
  const Oracle least = brute_force_clearances(environment, question);
  std::uint64_t colliding = 0;
  double of_radius = 0.4;
  bool first_pose = false;
  for (const MemoryCloudOptions& packing :
       {MemoryCloudOptions{64, 0}, MemoryCloudOptions{1000, 0}, MemoryCloudOptions{65536, 0},
        MemoryCloudOptions{128, 500}}) {
    const MemoryCloud cloud(points, quantisation, packing);
    colliding = check_packed(cloud, expected, question);
    check_clearances(cloud, least, expected.at_poses,
                     with_clearance(question, of_radius * question.radius, first_pose));
    first_pose = !first_pose;
    of_radius *= 2.5;
  }
  return colliding;
}

ToleratedAnswers check_tolerance(std::span<const Quantum> points, const Quantisation& quantisation,
                                 const Question& question) {
  const Oracle least = brute_force_clearances(positions_of(points, quantisation), question);
  ToleratedAnswers out;
  std::vector<bool> expected;
  for (const Clearance& c : least) {
    expected.push_back(c.squared < question.radius * question.radius);
    out.colliding += expected.back();
  }
  for (const Engine& engine : engines()) {
    if (!engine.tolerance) continue;
    std::vector<bool> first;
    int threads = 1;
    for (const MemoryCloudOptions& packing :
         {MemoryCloudOptions{64, 0}, MemoryCloudOptions{1000, 0}, MemoryCloudOptions{128, 300}}) {
      const MemoryCloud cloud(points, quantisation, packing);
      const std::vector<bool> answer =
          by_source(cloud, engine.run(cloud, question, threads++).hits);
      const double farthest = farthest_difference(answer, expected, least, question.radius);
      CAPTURE(engine.name, packing.cell_points, question.radius, question.tolerance);
      CHECK(farthest <= question.tolerance);
      if (first.empty()) first = answer;
      CHECK((answer == first));
    }
    for (std::size_t i = 0; i < first.size(); ++i) out.differing += first[i] != expected[i];
  }
  return out;
}

std::uint64_t check_clearances(std::span<const Quantum> points, const Quantisation& quantisation,
                               const Question& question) {
  const auto environment = positions_of(points, quantisation);
  return check_clearances(MemoryCloud(points, quantisation, {256, 0}),
                          brute_force_clearances(environment, question),
                          brute_force_first_poses(environment, question), question);
}

}  // namespace clearway
