// Sessions: many askers at once, stores that change under them, and memory.
#include "clearway/session.hpp"

#include <atomic>
#include <future>
#include <thread>

#include "clearway/error.hpp"
#include "search/devices.hpp"
#include "search/search_engines.hpp"
#include "search/session_state.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/questions.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::string bytes_of_answer(const AskedScan& scan, const SessionAnswer& answer) {
  static std::atomic<int> number = 0;
  const auto output = scan.folder / ("saved" + std::to_string(number++) + ".h5");
  answer.save(output);
  std::string bytes = bytes_of(output);
  std::filesystem::remove(output);
  return bytes;
}

/// A scan, questions about it, and the bytes that single searches answer them with.
struct Asked {
  explicit Asked(std::uint64_t seed, std::size_t count, bool with_kdtree = true) : scan(41) {
    Random random(seed);
    while (questions.size() < count) {
      const Question asked = scan.question(random);
      if (asked.engine == Engine::kKdtree && !with_kdtree) continue;
      questions.push_back(asked);
      expected.push_back(
          searched(scan, asked.query, "run.h5", {.engine = asked.engine, .threads = 2}));
    }
  }

  /// Asks all questions with so many threads, each thread in another order. Checks that all answers
  /// are as expected.
  void ask(const Session& session, int threads) const {
    CAPTURE(threads);
    std::vector<std::string> found(questions.size());
    {
      std::vector<std::jthread> askers;
      for (int thread = 0; thread < threads; ++thread) {
        askers.emplace_back([&, thread] {
          for (auto i = static_cast<std::size_t>(thread); i < questions.size();
               i += static_cast<std::size_t>(threads)) {
            const std::size_t at = (i * 7919) % questions.size();
            const SessionAnswer answer =
                session.search(questions[at].query, {.engine = questions[at].engine});
            found[at] = bytes_of_answer(scan, answer);
          }
        });
      }
    }
    CHECK((found == expected));
  }

  AskedScan scan;
  std::vector<Question> questions;
  std::vector<std::string> expected;
};

/// A question about points, surely with an answer.
Query points_query(const AskedScan& scan, std::size_t model = 1, std::size_t poses = 30) {
  Random random(6);
  return {scan.models[model], AskedScan::path(random, poses), {.radius = 0.1}};
}

Session session_of(const std::filesystem::path& store,
                   std::uint64_t memory_bytes = std::uint64_t{1} << 30) {
  return Session(store, {.device = Device::kCpu, .threads = 1, .memory_bytes = memory_bytes});
}

}  // namespace

TEST_CASE("a session gives the bytes of single searches, whoever asks and in little memory") {
  const Asked asked(1, 211);
  const Session session(asked.scan.store, {.device = Device::kCpu, .threads = 2});
  asked.ask(session, 2);
  asked.ask(session, 8);
  CHECK(session.kept_bytes() > 0);
  session.forget_models();
  CHECK(session.kept_bytes() == 0);
  // Each question needs more than half of this, so that they wait for each other.
  asked.ask(session_of(asked.scan.store, std::uint64_t{56} << 20), 8);
}

TEST_CASE("a session on a GPU gives the bytes of the CPU") {
  if (!may_take_gpus({})) {
    WARN("no GPU here, so nothing is asked of one");
    return;
  }
  const Asked asked(3, 61, false);
  // With 64 MiB questions wait for each other, and with 24 MiB nothing can stay on the GPU.
  for (const std::uint64_t mebibytes : {0, 64, 24}) {
    CAPTURE(mebibytes);
    const Session session(
        asked.scan.store,
        {.device = Device::kCuda, .threads = 2, .device_memory_bytes = mebibytes << 20});
    for (const int threads : {1, 4}) asked.ask(session, threads);
  }
  try {
    const Session session(asked.scan.store,
                          {.device = Device::kCuda, .gpus = {0, 1}, .threads = 2});
    asked.ask(session, 4);
  } catch (const ResourceError&) {
    WARN("no second GPU here, so nothing is asked of two");
  }
}

TEST_CASE("a question that fails or is stopped leaves the session usable") {
  const AskedScan scan(41);
  const Session session = session_of(scan.store);
  const Query query = points_query(scan);
  const std::string expected = searched(scan, query, "run.h5");
  Query wrong = query;
  wrong.radius = -1;
  CHECK_THROWS_AS(session.search(wrong), UsageError);
  wrong = query;
  wrong.ignore_classes = {7};
  CHECK_THROWS_AS(session.search(wrong, {.strict = true}), InputError);
  CHECK_THROWS_AS(Session(scan.store, {.device = Device::kCpu, .gpus = {0}}), UsageError);
  const std::atomic<bool> stop = true;
  CHECK_THROWS_AS(session.search(query, {.stop = &stop}), Interrupted);
  const SessionAnswer answer = session.search(query);
  const auto saved = scan.folder / "saved.h5";
  answer.save(saved);
  CHECK_THROWS_AS(answer.save(saved), UsageError);
  answer.save(saved, true);
  CHECK(bytes_of(saved) == expected);
  CHECK_THROWS_AS(answer.save(scan.store, true), UsageError);
}

TEST_CASE("a session notices that its store was replaced, changed or shortened") {
  const AskedScan scan(41);
  const Query query = points_query(scan, 1, 3);
  const auto other = scan.folder / "other.h5", link = scan.folder / "link.h5";
  std::filesystem::create_symlink(scan.store, link);
  const Session session = session_of(link);
  CHECK(bytes_of_answer(scan, session.search(query)) == searched(scan, query, "run.h5"));
  const std::string whole = bytes_of(scan.store);
  put_bytes(other, whole);
  SECTION("replaced") { std::filesystem::rename(other, scan.store); }
  SECTION("shortened") { std::filesystem::resize_file(scan.store, whole.size() / 2); }
  SECTION("removed") { std::filesystem::remove(scan.store); }
  SECTION("written to") {
    std::filesystem::last_write_time(
        scan.store, std::filesystem::last_write_time(scan.store) + std::chrono::seconds(1));
  }
  SECTION("reached by a link that leads elsewhere now") {
    std::filesystem::remove(link);
    std::filesystem::create_symlink(other, link);
  }
  check_refused([&] { session.search(query); }, "was replaced or changed");
}

TEST_CASE("a store that shrinks while it is read ends the question, not the program") {
  const AskedScan scan(41);
  Query query = points_query(scan, 2);
  query.profile = 1;
  const std::string whole = bytes_of(scan.store);
  const auto other = scan.folder / "other.h5";
  put_bytes(other, whole);
  const Session intact = session_of(other);
  const std::string expected = bytes_of_answer(scan, intact.search(query));
  for (const int askers : {1, 4}) {
    CAPTURE(askers);
    put_bytes(scan.store, whole);
    const Session session(scan.store, {.device = Device::kCpu, .threads = 2});
    if (askers == 4) session.search(query);  // so that no hash is looked at any more
    std::once_flag cut;
    const auto is_refused = [&] {
      // Notes are told once the store was looked at, and before its points are.
      const MessageCallback shorten = [&](const Message&) {
        std::call_once(cut, [&] { std::filesystem::resize_file(scan.store, 4096); });
      };
      try {
        session.search(query, {.message = shorten});
        return false;
      } catch (const InputError& error) {
        const std::string text = error.what();
        return text.find(scan.store.string()) != std::string::npos &&
               (text.find("shrank") != std::string::npos ||
                text.find("was replaced or changed") != std::string::npos);
      }
    };
    std::vector<std::future<bool>> refused;
    for (int i = 0; i < askers; ++i) {
      refused.push_back(std::async(std::launch::async, is_refused));
    }
    for (auto& one : refused) CHECK(one.get());
    CHECK_THROWS_AS(session.search(query), InputError);
    CHECK(bytes_of_answer(scan, intact.search(query)) == expected);
  }
  put_bytes(scan.store, whole);
  CHECK(bytes_of_answer(scan, session_of(scan.store).search(query)) == expected);
}

TEST_CASE("a question with too little memory for it, or for what it finds, names what would do") {
  const AskedScan scan(41);
  Query query = points_query(scan, 2);
  query.radius = 0.3;
  query.first_pose = true;
  check_refused([&] { session_of(scan.store, 1 << 20).search(query); }, "of memory is too little");
  // In so little memory that first and last poses are asked one after the other, as below
  const SessionAnswer answer = session_of(scan.store, std::uint64_t{32} << 20).search(query);
  REQUIRE(answer.colliding_points > 100);
  const Session tight = session_of(scan.store, answer.needed_host_bytes - 1);
  for (int again = 0; again < 2; ++again) {
    try {
      tight.search(query);
      FAIL("there is no memory for rows");
    } catch (const ResourceError& error) {
      CHECK(error.remedy() == Remedy::kMoreMemory);
      CHECK(error.amount() == static_cast<double>(answer.needed_host_bytes));
      check_says(error.what(), "too little for what this question finds");
    }
  }
  const Session enough = session_of(scan.store, answer.needed_host_bytes);
  CHECK(enough.search(query).colliding_points == answer.colliding_points);
}

TEST_CASE("a question that waits for memory goes on when there is less or more of it") {
  SharedMemory memory(100);
  std::atomic<bool> stop = false;
  const ProgressCallback silent;
  const CallbackProgress progress(silent, &stop);
  const auto ends = [&](std::uint64_t bytes, std::uint64_t now, bool give_back) {
    auto first = std::make_unique<SharedMemory::Share>(memory);
    first->take(60, progress);
    std::future<void> second =
        std::async(std::launch::async, [&] { SharedMemory::Share(memory).take(bytes, progress); });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    memory.set_bytes(now);
    if (give_back) first.reset();
    const bool is_ready = second.wait_for(std::chrono::seconds(20)) == std::future_status::ready;
    stop = !is_ready;
    if (is_ready) second.get();
    return is_ready;
  };
  CHECK(ends(80, 200, false));
  memory.set_bytes(100);
  CHECK(ends(80, 50, true));
}

TEST_CASE("while a field is made, other questions get their models") {
  Random random(12);
  const Box part{{-1, -1, -1}, {1, 1, 1}};
  const Model large(random_points(random, part, 20'000)), small(random_points(random, part, 10));
  KeptModels models(KeptModels::Kept::kForSession, std::uint64_t{1} << 30);
  const auto index = models.index_of(large, std::nullopt, 1);
  models.index_of(small, std::nullopt, 1);
  std::atomic<int> state = 0;  // 1: the field is being made, 2: it is there
  std::uint64_t meanwhile = 0;
  {
    const std::jthread making([&] {
      state = 1;
      index->field<Vec3>(0.05, {.voxel = 0.01, .reach = 0.5}, 1);
      state = 2;
    });
    while (state == 0) std::this_thread::yield();
    for (; state == 1; ++meanwhile) models.index_of(small, std::nullopt, 1);
  }
  CHECK(meanwhile > 2);
}

TEST_CASE("where a GPU fails that nobody asked for, the CPU goes on and is named") {
  const AskedScan scan(41);
  const Store store(scan.store);
  const Query query = points_query(scan, 1, 1);
  for (const Device asked : {Device::kAuto, Device::kCuda}) {
    SearchOptions options{.device = asked, .threads = 1};
    SessionState session(store, options, KeptModels::Kept::kOneField);
    const std::vector<std::uint64_t> hashes;
    SearchReport report;
    report.device = Device::kCuda;
    report.device_name = "a GPU";
    std::vector<std::string> said;
    const MessageCallback message = [&](const Message& m) { said.push_back(m.text); };
    const MessageLog log(message, report.warnings);
    SearchEngines engines(session, query, hashes, options, report, log);
    int asked_of_gpu = 0;
    const auto work = [&](Device device) {
      if (device != Device::kCuda) return true;
      ++asked_of_gpu;
      throw ResourceError("the GPU has no memory", Remedy::kMoreDeviceMemory);
    };
    if (asked == Device::kCuda) {
      CHECK_THROWS_AS(engines.on(report.device, work), ResourceError);
      CHECK(report.device_name == "a GPU");
      continue;
    }
    for (int pass = 0; pass < 2; ++pass) CHECK(engines.on(report.device, work));
    CHECK(asked_of_gpu == 1);
    CHECK(report.device == Device::kCpu);
    CHECK(report.device_name == "the CPU");
    REQUIRE(said.size() == 1);
    check_says(said[0], "the CPU is taken: the GPU has no memory");
  }
}
