// What it costs to know more than the set: time by question, and time of seen space by the number
// of beams, the side of its cubes, the swept part of the path, and threads.
#include <tbb/info.h>

#include "bench/experiments/bench.hpp"
#include "bench/variants/variants.hpp"

namespace clearway::bench {
namespace {

/// What a user may ask about one query.
struct Question {
  const char* name;
  std::vector<std::string> options;
};

/// All questions; the errors are those of a usual scan and vehicle.
std::vector<Question> questions() {
  const std::vector<std::string> budget{"--error-scan", "0.005",        "--error-registration",
                                        "0.01",         "--error-pose", "0.02"};
  std::vector<std::string> both = budget;
  both.emplace_back("--seen");
  return {{"set", {}},
          {"first poses", {"--first-pose"}},
          {"least distances", {"--clearance", "0.3"}},
          {"profile", {"--profile", "1"}},
          {"error budget", budget},
          {"seen, 0.2 m", {"--seen"}},
          {"seen, 0.1 m", {"--seen", "--seen-cube", "0.1"}},
          {"seen, 0.2 m, and budget", both}};
}

/// A scene's points, or its path, are divided by each of these.
constexpr std::uint64_t kPartsOfScene[] = {64, 16, 4, 1};

class Seen {
 public:
  Seen(Bench& bench, std::string scene)
      : bench_(bench),
        name_(std::move(scene)),
        points_(scene_size(name_, bench.options().size).points),
        files_(bench.scanned(name_, points_)),
        sweep_(bench.engine_here("sweep")) {}

  void by_question() {
    for (const Question& question : questions()) {
      measure("question", question.name, files_, question.options);
    }
  }

  void by_beams() {
    for (const std::uint64_t part : kPartsOfScene) {
      const std::uint64_t points = points_ / part;
      measure("beams", points, bench_.scanned(name_, points), {"--seen"});
    }
  }

  void by_cube() {
    std::vector<const char*> sides{"0.8", "0.4", "0.2", "0.1"};
    if (bench_.full()) sides.push_back("0.05");  // minutes on two cores
    for (const char* side : sides) measure("cube", side, files_, {"--seen", "--seen-cube", side});
  }

  void by_path() {
    for (const std::uint64_t part : kPartsOfScene) {
      SceneFiles files = files_;
      files.trajectory = bench_.work() / "first-poses.txt";
      write_first_poses(files_.trajectory, files.trajectory, part);
      measure("path", 1.0 / static_cast<double>(part), files, {"--seen"});
    }
  }

  void by_threads() {
    const int cores = tbb::info::default_concurrency();
    for (int threads = 1; threads <= cores; threads *= 2) {
      measure("threads", threads, files_, {"--seen", "--threads", std::to_string(threads)});
    }
  }

 private:
  void measure(const std::string& vary, const Json& value, const SceneFiles& files,
               const std::vector<std::string>& more) {
    bench_.measure(name_ + "/" + vary + "/" + value.dump(),
                   {{"scene", name_}, {"engine", sweep_.name}, {"vary", vary}, {"value", value}},
                   files, sweep_.with(more).options, {}, {}, Refusal::kMemory);
  }

  Bench& bench_;
  std::string name_;
  std::uint64_t points_;
  SceneFiles files_;
  EngineChoice sweep_;
};

}  // namespace

void bench_seen(Bench& bench) {
  for (const std::string& scene : bench.options().scenes) {
    Seen seen(bench, scene);
    seen.by_question();
    seen.by_beams();
    seen.by_cube();
    seen.by_path();
    seen.by_threads();
  }
}

}  // namespace clearway::bench
