// A session against single searches: every answer has the bytes that search() writes.
#include "clearway/session.hpp"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "clearway/error.hpp"
#include "library/vehicle_scene.hpp"
#include "search/check_query.hpp"
#include "search/devices.hpp"
#include "search/search_engines.hpp"
#include "search/session_state.hpp"
#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kRoom{{100, -200, 0}, {104, -197, 1}};

/// A question, and how it is asked.
struct Asked {
  Query query;
  Engine engine = Engine::kSweep;
};

/// A scan with classes and origins, and models of all kinds.
struct SessionScene {
  SessionScene() {
    Random random(41);
    std::vector<Quantum> points;
    for (int i = 0; i < 3000; ++i) {
      points.push_back({static_cast<std::int32_t>(below(random, 4000)),
                        static_cast<std::int32_t>(below(random, 3000)),
                        static_cast<std::int32_t>(below(random, 1000))});
    }
    write_classed(folder / "scan.las", points, random_classes(points.size(), 4), 6, {100, -200, 0});
    std::ofstream(folder / "origins.csv") << "first,x,y,z\n0,101,-198.5,0.5\n1500,103,-198,0.8\n";
    ConvertOptions how;
    how.cell_points = 64;
    how.threads = 2;
    how.origins = folder / "origins.csv";
    convert({folder / "scan.las"}, store(), how);
    const Box part{{-0.3, -0.2, -0.1}, {0.3, 0.2, 0.1}};
    for (const std::size_t count : {1, 25, 400}) {
      models.emplace_back(random_points(random, part, count));
    }
    const Surface surface = random_surface(random, part, 30);
    Model& of_surface = models.emplace_back(surface.vertices);
    of_surface.triangles = surface.triangles;
    Bodies solids;
    solids.add(box_surface(part));
    solids.add(mapped(unit_sphere(1), [](const Vec3& v) { return plus({0.4, 0, 0.3}, 0.2, v); }));
    Model& of_solids = models.emplace_back(solids.surface.vertices);
    of_solids.triangles = solids.surface.triangles;
    of_solids.solid_of = solids.solid_of;
  }

  std::filesystem::path store() const { return folder / "store.h5"; }

  /// Poses on a path, most often a single one.
  std::vector<Pose> some_poses(Random& random) const {
    const std::size_t counts[] = {1, 1, 1, 2, 5, 40};
    const std::size_t count = counts[below(random, std::size(counts))];
    return smooth_path(random, kRoom, count);
  }

  void add_vehicle(Random& random, Query& query) const {
    const std::size_t bodies = 1 + below(random, 3);
    for (std::size_t i = 0; i < bodies; ++i) {
      Body body{.name = "body " + std::to_string(i),
                .model = models[below(random, models.size())],
                .poses = {},
                .path_pose = {}};
      const bool gaps = !query.between_poses && below(random, 2) == 0;
      for (std::uint32_t pose = 0; pose < query.poses.size(); ++pose) {
        if (gaps && pose % 4 == 1) continue;
        body.poses.push_back(query.poses[pose]);
        body.poses.back().translation[0] += 0.3 * static_cast<double>(i);
        body.path_pose.push_back(pose);
      }
      query.bodies.push_back(body);
    }
  }

  /// A random question that can be asked.
  Asked question(Random& random) const {
    for (;;) {
      Asked asked = any_question(random);
      try {
        const SearchOptions options{.engine = asked.engine};
        check_query(asked.query, options);
        check_bodies(asked.query, options);
        if (asked.query.model.is_surface()) check_surface(asked.query, options);
        return asked;
      } catch (const UsageError&) {  // what it asks for cannot be combined
      }
    }
  }

  Asked any_question(Random& random) const {
    Asked asked;
    Query& query = asked.query;
    const auto one_in = [&](std::uint64_t n) { return below(random, n) == 0; };
    query.poses = some_poses(random);
    query.radius = one_in(2) ? 0.05 : 0.13;
    query.first_pose = one_in(2);
    query.between_poses = one_in(4);
    if (one_in(3)) query.clearance = one_in(2) ? 0.04 : 0.3;
    if (one_in(3)) query.profile = one_in(2) ? 0.1 : 0.5;
    if (one_in(4)) query.ignore_classes = {static_cast<std::uint8_t>(below(random, 6))};
    if (one_in(6)) query.ignore_boxes = {{{100.5, -199, 0}, {102, -198, 0.6}}};
    if (one_in(8)) query.seen = true;
    if (one_in(6)) query.error_scan = 0.004;
    if (one_in(5)) {
      add_vehicle(random, query);
      return asked;
    }
    query.model = models[below(random, models.size())];
    const bool plain = !query.model.is_surface() && !query.between_poses && query.clearance == 0 &&
                       query.profile == 0 && !query.seen && !query.has_budget();
    if (plain && one_in(2)) asked.engine = one_in(2) ? Engine::kKdtree : Engine::kGrid;
    return asked;
  }

  ScratchFolder folder;
  std::vector<Model> models;
};

/// What search() writes for a question.
std::string bytes_by_run(const SessionScene& scene, const Asked& asked) {
  static std::atomic<int> number = 0;
  const auto output = scene.folder / ("run" + std::to_string(number++) + ".h5");
  SearchOptions options{.engine = asked.engine, .device = Device::kCpu, .threads = 2};
  search(Store(scene.store()), asked.query, output, options);
  std::string bytes = bytes_of(output);
  std::filesystem::remove(output);
  return bytes;
}

std::string bytes_of_answer(const SessionScene& scene, const SessionAnswer& answer) {
  static std::atomic<int> number = 0;
  const auto output = scene.folder / ("saved" + std::to_string(number++) + ".h5");
  answer.save(output);
  std::string bytes = bytes_of(output);
  std::filesystem::remove(output);
  return bytes;
}

/// Asks all questions with so many threads, each thread in another order. Returns the numbers of
/// those whose answers differ from the bytes that are expected.
std::vector<std::size_t> differing(const SessionScene& scene, const Session& session,
                                   const std::vector<Asked>& questions,
                                   const std::vector<std::string>& expected, int threads) {
  std::vector<std::atomic<bool>> differs(questions.size());
  const auto ask = [&](int thread) {
    for (std::size_t i = static_cast<std::size_t>(thread); i < questions.size();
         i += static_cast<std::size_t>(threads)) {
      const std::size_t at = (i * 7919) % questions.size();
      const SessionAnswer answer =
          session.search(questions[at].query, {.engine = questions[at].engine});
      if (bytes_of_answer(scene, answer) != expected[at]) differs[at] = true;
    }
  };
  std::vector<std::jthread> asking;
  for (int thread = 0; thread < threads; ++thread) asking.emplace_back(ask, thread);
  asking.clear();
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (differs[i]) out.push_back(i);
  }
  return out;
}

std::vector<Asked> random_questions(const SessionScene& scene, std::uint64_t seed,
                                    std::size_t count) {
  Random random(seed);
  std::vector<Asked> questions;
  for (std::size_t i = 0; i < count; ++i) questions.push_back(scene.question(random));
  return questions;
}

std::vector<std::string> answers_of_runs(const SessionScene& scene,
                                         const std::vector<Asked>& questions) {
  std::vector<std::string> expected;
  for (const Asked& asked : questions) expected.push_back(bytes_by_run(scene, asked));
  return expected;
}

}  // namespace

TEST_CASE("a session gives the bytes of single searches, whoever asks") {
  const SessionScene scene;
  const Session session(scene.store(), {.device = Device::kCpu, .threads = 2});
  for (const int threads : {1, 2, 8}) {
    CAPTURE(threads);
    const auto questions = random_questions(scene, static_cast<std::uint64_t>(threads), 337);
    const auto expected = answers_of_runs(scene, questions);
    CHECK(differing(scene, session, questions, expected, threads).empty());
  }
  CHECK(session.kept_bytes() > 0);
  session.forget_models();
  CHECK(session.kept_bytes() == 0);
}

TEST_CASE("a session with little memory gives the same bytes") {
  const SessionScene scene;
  const auto questions = random_questions(scene, 2, 101);
  const auto expected = answers_of_runs(scene, questions);
  const Session session(
      scene.store(),
      {.device = Device::kCpu, .threads = 1, .memory_bytes = std::uint64_t{40} << 20});
  for (const int threads : {1, 8}) {
    CHECK(differing(scene, session, questions, expected, threads).empty());
  }
}

namespace {

bool has_two_gpus() {
  try {
    return may_take_gpus({.device = Device::kCuda, .gpus = {0, 1}});
  } catch (const ResourceError&) {
    return false;
  }
}

}  // namespace

TEST_CASE("a session on a GPU gives the bytes of the CPU") {
  if (!may_take_gpus({})) {
    WARN("no GPU here, so nothing is asked of one");
    return;
  }
  const SessionScene scene;
  std::vector<Asked> questions = random_questions(scene, 3, 211);
  std::erase_if(questions, [](const Asked& asked) { return asked.engine == Engine::kKdtree; });
  const auto expected = answers_of_runs(scene, questions);
  // With 64 MiB questions wait for each other, and with 24 MiB nothing can stay on the GPU.
  for (const std::uint64_t mebibytes : {0, 64, 24}) {
    CAPTURE(mebibytes);
    const Session session(
        scene.store(),
        {.device = Device::kCuda, .threads = 2, .device_memory_bytes = mebibytes << 20});
    for (const int threads : {1, 4}) {
      CHECK(differing(scene, session, questions, expected, threads).empty());
    }
  }
  if (!has_two_gpus()) {
    WARN("no second GPU here, so nothing is asked of two");
    return;
  }
  const Session session(scene.store(), {.device = Device::kCuda, .gpus = {0, 1}, .threads = 2});
  CHECK(differing(scene, session, questions, expected, 4).empty());
}

TEST_CASE("an answer in memory has the columns and the verdict of the file") {
  const SessionScene scene;
  Query query{scene.models[1], smooth_path(*std::make_unique<Random>(5), kRoom, 20), {0.1}};
  query.first_pose = true;
  query.clearance = 0.3;
  query.profile = 0.5;
  const auto output = scene.folder / "out.h5";
  const Session session(scene.store());
  const SessionAnswer answer = session.search(query);
  const SearchReport report = search(Store(scene.store()), query, output);
  const Result result(output);
  const Collisions file = result.collisions();
  REQUIRE(file.size() > 0);
  CHECK(answer.collisions().source == file.source);
  CHECK(answer.collisions().first_pose == file.first_pose);
  CHECK(answer.collisions().last_pose == file.last_pose);
  CHECK(answer.clearances().distance == result.clearance().distance);
  CHECK(answer.profile().source == result.profile().source);
  CHECK(answer.profile().distance == result.profile().distance);
  CHECK(answer.verdict() == report.verdict());
  CHECK(answer.least_profile->source == report.least_profile->source);
  CHECK(answer.warnings.size() == report.warnings.size());
  answer.save(scene.folder / "saved.h5");
  CHECK(bytes_of(scene.folder / "saved.h5") == bytes_of(output));
  CHECK_THROWS_AS(answer.save(scene.folder / "saved.h5"), UsageError);
  answer.save(scene.folder / "saved.h5", true);
  CHECK_THROWS_AS(answer.save(scene.store(), true), UsageError);
}

TEST_CASE("a question that fails or is stopped leaves the session usable") {
  const SessionScene scene;
  const Session session(scene.store(), {.device = Device::kCpu, .threads = 2});
  Random random(6);
  Query query{scene.models[1], smooth_path(random, kRoom, 30), {0.1}};
  const std::string expected = bytes_by_run(scene, {query});
  Query wrong = query;
  wrong.radius = -1;
  CHECK_THROWS_AS(session.search(wrong), UsageError);
  wrong = query;
  wrong.ignore_classes = {7};
  CHECK_THROWS_AS(session.search(wrong, {.strict = true}), InputError);
  CHECK_THROWS_AS(Session(scene.store(), {.device = Device::kCpu, .gpus = {0}}), UsageError);
  const std::atomic<bool> stop = true;
  CHECK_THROWS_AS(session.search(query, {.stop = &stop}), Interrupted);
  CHECK(bytes_of_answer(scene, session.search(query)) == expected);
}

TEST_CASE("a session notices that its store was replaced, changed or shortened") {
  const SessionScene scene;
  Random random(7);
  const Query query{scene.models[1], smooth_path(random, kRoom, 3), {0.1}};
  const Session session(scene.store(), {.device = Device::kCpu, .threads = 1});
  session.search(query);
  const std::string whole = bytes_of(scene.store());
  SECTION("replaced") {
    put_bytes(scene.folder / "other.h5", whole);
    std::filesystem::rename(scene.folder / "other.h5", scene.store());
  }
  SECTION("shortened") { std::filesystem::resize_file(scene.store(), whole.size() / 2); }
  SECTION("removed") { std::filesystem::remove(scene.store()); }
  SECTION("written to") {
    std::filesystem::last_write_time(
        scene.store(), std::filesystem::last_write_time(scene.store()) + std::chrono::seconds(1));
  }
  CHECK_THROWS_WITH(session.search(query), Contains("was replaced or changed"));
}

TEST_CASE("a session may reach its store by a link, and notices where that leads elsewhere") {
  const SessionScene scene;
  Random random(10);
  const Query query{scene.models[1], smooth_path(random, kRoom, 3), {0.1}};
  const auto link = scene.folder / "link.h5", other = scene.folder / "other.h5";
  std::filesystem::create_symlink(scene.store(), link);
  const Session session(link, {.device = Device::kCpu, .threads = 1});
  CHECK(bytes_of_answer(scene, session.search(query)) == bytes_by_run(scene, {query}));
  put_bytes(other, bytes_of(scene.store()));
  std::filesystem::remove(link);
  std::filesystem::create_symlink(other, link);
  CHECK_THROWS_WITH(session.search(query), Contains("was replaced or changed"));
}

TEST_CASE("a store that shrinks while it is read ends the question, not the program") {
  const SessionScene scene;
  Random random(9);
  const Query query{scene.models[2], smooth_path(random, kRoom, 30), {.radius = 0.1, .profile = 1}};
  const std::string whole = bytes_of(scene.store());
  const auto other = scene.folder / "other.h5";
  put_bytes(other, whole);
  const Session intact(other, {.device = Device::kCpu, .threads = 1});
  const std::string expected = bytes_of_answer(scene, intact.search(query));
  for (const int askers : {1, 4}) {
    CAPTURE(askers);
    put_bytes(scene.store(), whole);
    const Session session(scene.store(), {.device = Device::kCpu, .threads = 2});
    if (askers == 4) session.search(query);  // so that no hash is looked at any more
    std::atomic<int> refused = 0, other_ends = 0;
    std::once_flag cut;
    const auto ask = [&] {
      // Notes are told once the store was looked at, and before its points are.
      const MessageCallback shorten = [&](const Message&) {
        std::call_once(cut, [&] { std::filesystem::resize_file(scene.store(), 4096); });
      };
      try {
        session.search(query, {.message = shorten});
        ++other_ends;
      } catch (const InputError& error) {
        const std::string text = error.what();
        const bool names = text.find(scene.store().string()) != std::string::npos;
        const bool why = text.find("shrank") != std::string::npos ||
                         text.find("was replaced or changed") != std::string::npos;
        ++(names && why ? refused : other_ends);
      }
    };
    {
      std::vector<std::jthread> threads;
      for (int i = 0; i < askers; ++i) threads.emplace_back(ask);
    }
    CHECK(refused == askers);
    CHECK(other_ends == 0);
    CHECK_THROWS_AS(session.search(query), InputError);
    CHECK(bytes_of_answer(scene, intact.search(query)) == expected);
  }
  put_bytes(scene.store(), whole);
  const Session again(scene.store(), {.device = Device::kCpu, .threads = 2});
  CHECK(bytes_of_answer(scene, again.search(query)) == expected);
}

TEST_CASE("too little memory is refused with the number that would do") {
  const SessionScene scene;
  Random random(8);
  const Query query{scene.models[1], smooth_path(random, kRoom, 3), {0.1}};
  const Session session(
      scene.store(),
      {.device = Device::kCpu, .threads = 1, .memory_bytes = std::uint64_t{1} << 20});
  CHECK_THROWS_WITH(session.search(query), Contains("of memory is too little"));
}

TEST_CASE(
    "a question that finds more than there is memory for ends, and leaves the session usable") {
  const SessionScene scene;
  const Query query(scene.models[2],
                    [] {
                      Random random(3);
                      return smooth_path(random, kRoom, 40);
                    }(),
                    {.radius = 0.3, .first_pose = true});
  const auto session_with = [&](std::uint64_t bytes) {
    return Session(scene.store(), {.device = Device::kCpu, .threads = 1, .memory_bytes = bytes});
  };
  const SessionAnswer answer = session_with(std::uint64_t{1} << 30).search(query);
  REQUIRE(answer.colliding_points > 100);
  const Session tight = session_with(answer.needed_host_bytes - 1);
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
  const Session enough = session_with(answer.needed_host_bytes);
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
    std::atomic<int> outcome = 0;  // 1: it has its memory, 2: it was stopped
    const auto wait = [&] {
      SharedMemory::Share second(memory);
      try {
        second.take(bytes, progress);
        outcome = 1;
      } catch (const Interrupted&) {
        outcome = 2;
      }
    };
    const std::jthread waiting(wait);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    memory.set_bytes(now);
    if (give_back) first.reset();
    for (int i = 0; i < 2000 && outcome == 0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    stop = outcome == 0;
    while (outcome == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    stop = false;
    return outcome == 1;
  };
  CHECK(ends(80, 200, false));
  memory.set_bytes(100);
  CHECK(ends(80, 50, true));
}

TEST_CASE("while a field is made, other questions get their models") {
  Random random(12);
  const Box part{{-1, -1, -1}, {1, 1, 1}};
  const Model large(random_points(random, part, 20'000));
  const Model small(random_points(random, part, 10));
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
  const SessionScene scene;
  const Store store(scene.store());
  const Query query{scene.models[1], {translation(kRoom.centre())}, {0.1}};
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
    CHECK_THAT(said[0], Contains("the CPU is taken: the GPU has no memory"));
  }
}
