#include <barrier>
#include <thread>

#include "core/query/search_result.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("marks are kept one by one and by word") {
  HitSet hits(200, false);
  check_equal(hits.count(), 0);
  hits.mark(0);
  hits.mark(63);
  hits.mark(64);
  hits.mark(199);
  hits.mark(199);
  check_equal(hits.count(), 4);
  CHECK(hits.contains(63));
  CHECK_FALSE(hits.contains(62));
  CHECK(hits.word(0) == (1ull | 1ull << 63));
  hits.mark_word(2, 0b1010);
  CHECK(hits.contains(129));
  CHECK(hits.contains(131));
  CHECK_FALSE(hits.contains(130));
  check_equal(hits.count(), 6);
  CHECK_FALSE(hits.has_first_pose());
}

TEST_CASE("an empty set") {
  const HitSet hits(0, true);
  check_equal(hits.count(), 0);
}

TEST_CASE("a first pose only falls") {
  HitSet hits(65, true);
  CHECK(hits.first_pose(64) == HitSet::kNever);
  hits.mark(64, 7);
  hits.mark(64, 9);
  check_equal(hits.first_pose(64), 7);
  hits.mark(64, 2);
  check_equal(hits.first_pose(64), 2);
  CHECK(hits.contains(64));
  check_equal(hits.count(), 1);
}

TEST_CASE("a set costs a bit a slot, first poses four bytes more") {
  check_equal(HitSet(6400, false).allocated_bytes(), 800);
  CHECK(HitSet(6400, true).allocated_bytes() == 800 + 4 * 6400);
}

TEST_CASE("the least first pose of many threads wins") {
  constexpr std::uint64_t kSlots = 1 << 14;
  constexpr std::uint64_t kThreads = 4;
  constexpr int kRounds = 50;
  std::vector<HitSet> rounds;
  while (rounds.size() < kRounds) rounds.emplace_back(kSlots, true);
  std::barrier start(kThreads);
  const auto mark_all = [&](std::uint64_t thread) {
    for (HitSet& hits : rounds) {
      start.arrive_and_wait();
      for (std::uint64_t slot = 0; slot < kSlots; ++slot) {
        hits.mark(slot, static_cast<std::uint32_t>((thread + slot) % kThreads));
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < kThreads; ++t) threads.emplace_back(mark_all, t);
  for (std::thread& thread : threads) thread.join();
  std::uint64_t wrong = 0;
  for (const HitSet& hits : rounds) {
    wrong += kSlots - hits.count();
    for (std::uint64_t slot = 0; slot < kSlots; ++slot) wrong += hits.first_pose(slot) != 0;
  }
  check_equal(wrong, 0);
}

TEST_CASE("marks of many threads in the same words are all there") {
  constexpr std::uint64_t kSlots = 1 << 21;
  constexpr std::uint64_t kThreads = 4;
  constexpr int kRounds = 20;
  std::vector<HitSet> rounds;
  while (rounds.size() < kRounds) rounds.emplace_back(kSlots, false);
  std::barrier start(kThreads);
  const auto mark_own = [&](std::uint64_t thread) {
    for (HitSet& hits : rounds) {
      start.arrive_and_wait();
      for (std::uint64_t slot = thread; slot < kSlots; slot += kThreads) hits.mark(slot);
    }
  };
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < kThreads; ++t) threads.emplace_back(mark_own, t);
  for (std::thread& thread : threads) thread.join();
  for (const HitSet& hits : rounds) CHECK(hits.count() == kSlots);
}
