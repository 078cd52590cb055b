// A fault in a kernel while questions are asked. The process cannot use the GPU afterwards, so this
// is a program with one test.
#include "fault.hpp"

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "catch_session.hpp"
#include "clearway/clearway.hpp"
#include "gpu/devices.hpp"
#include "library/api_scene.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Asks until the question fails, at most 50 times. Returns what would help.
Remedy remedy_of_failure(const Session& session, const Query& query,
                         const QuestionOptions& options = {}) {
  try {
    for (int i = 0; i < 50; ++i) session.search(query, options);
  } catch (const ResourceError& error) {
    const bool is_named =
        std::string(error.what()).find("can use the GPU no more") != std::string::npos;
    return is_named ? error.remedy() : Remedy::kNone;
  }
  return Remedy::kNone;
}

}  // namespace

TEST_CASE("a fault in a kernel ends questions on that GPU with an error, and nothing else") {
  const ApiScene scene;
  const auto store = scene.folder / "wall.h5";
  Query query = scene.query;
  query.clearance = 0.3;
  query.poses.clear();
  for (int i = 0; i < 5000; ++i) {
    query.poses.push_back(translation({0.004 * i, 0.04, 0.2}));
  }
  const SessionAnswer expected = Session(store, {.device = Device::kCpu}).search(query);
  REQUIRE(expected.collisions().size() > 0);
  const auto is_as_expected = [&](const SessionAnswer& answer) {
    return answer.collisions().source == expected.collisions().source &&
           answer.clearances().distance == expected.clearances().distance;
  };

  const Session asked_for(store, {.device = Device::kCuda, .threads = 2});
  const Session automatic(store, {.threads = 1});
  CHECK(is_as_expected(asked_for.search(query)));
  const SessionAnswer before = automatic.search(query);
  CHECK(before.device == Device::kCuda);  // so that it has a GPU to lose
  CHECK(is_as_expected(before));

  std::atomic<bool> faulty = false;
  const QuestionOptions with_fault{.progress = [&](const ProgressUpdate&) {
    if (!faulty.exchange(true)) fault_on_device();
  }};
  std::atomic<int> failed = 0;
  {
    std::vector<std::jthread> asking;
    for (int i = 0; i < 4; ++i) {
      asking.emplace_back([&] {
        failed += remedy_of_failure(asked_for, query, with_fault) == Remedy::kNewProcess;
      });
    }
  }
  CHECK(failed == 4);
  CHECK(faulty);
  CHECK(remedy_of_failure(asked_for, query) == Remedy::kNewProcess);
  for (int again = 0; again < 2; ++again) {
    const SessionAnswer after = automatic.search(query);
    CHECK(after.device == Device::kCpu);
    CHECK(is_as_expected(after));
  }
  CHECK(is_as_expected(Session(store).search(query)));
  CHECK(is_as_expected(Session(store, {.device = Device::kCpu}).search(query)));
  const Session next(store, {.device = Device::kCuda});
  CHECK(remedy_of_failure(next, query) == Remedy::kNewProcess);
}

int main(int count, char** arguments) {
  return run_catch(count, arguments,
                   [] { return cuda_device_count() == 0 ? "no CUDA device here" : nullptr; });
}
