// Whether `--engine auto` takes the faster engine.
#include <algorithm>
#include <cstdio>

#include "bench/experiments/bench.hpp"
#include "bench/measure/scoring.hpp"
#include "clearway/error.hpp"
#include "cli/support/console.hpp"

namespace clearway::bench {
namespace {

/// The least value among the runs of a case, because other load on the machine only adds to it.
double least(const Json& of_case, const char* name) {
  double least = of_case["runs"][0][name];
  for (const Json& run : of_case["runs"]) least = std::min(least, run[name].get<double>());
  return least;
}

class Choice {
 public:
  explicit Choice(Bench& bench) : bench_(bench) {}

  void scene(const std::string& name) {
    const SceneFiles files = bench_.scene(name);
    const scene::Sizes size = scene_size(name, bench_.options().size);
    for (const std::uint64_t poses : {10, 100, 1'000}) {
      if (poses >= size.poses) continue;
      const SceneFiles fewer = bench_.resized(name, files, size.model_points, poses);
      for (const char* radius : {"0.02", "0.1", "0.3", "1"}) {
        ask(name + ", " + std::to_string(poses) + " poses", fewer, radius);
      }
    }
    for (const char* radius : {"0.02", "0.1", "0.3", "1"}) ask(name + ", all poses", files, radius);
  }

  void query(const SceneFiles& files) {
    for (const char* radius : {"0.02", "0.05", "0.1", "0.3", "0.5", "1"}) {
      ask("given", files, radius);
    }
  }

  void finish() const {
    bench_.conclude({{"questions", questions_},
                     {"worst_ratio", worst_},
                     {"worst_question", worst_question_},
                     {"worst_cpu_ratio", worst_cpu_},
                     {"kdtree_chosen", kdtree_chosen_}});
    char text[160];
    std::snprintf(text, sizeof text,
                  "%d questions: the choice took at most %.2f times the faster engine, by CPU "
                  "seconds %.2f times\n",
                  questions_, worst_, worst_cpu_);
    tool::print(text);
    wrong_.refuse();
  }

 private:
  void ask(const std::string& name, const SceneFiles& files, const char* radius) {
    const std::string question = name + ", radius " + radius;
    const std::vector<std::string> options{"--radius", radius, "--device", "cpu"};
    const auto run = [&](const char* engine, const Bench::Judge& judge, std::optional<int> runs) {
      std::vector<std::string> all{"--engine", engine};
      all.insert(all.end(), options.begin(), options.end());
      return bench_.measure(question + "/" + engine, {{"question", question}, {"engine", engine}},
                            files, all, judge, runs);
    };
    const auto reference = bench_.work() / "reference.h5";
    const Json sweep = run("sweep", {}, {});
    const Json kdtree = run("kdtree", {}, {});
    const Json chosen = run(
        "auto",
        [&](const std::filesystem::path& result) -> Json {
          bench_.run(files, reference,
                     bench_.engine("sweep cpu").with({"--radius", radius}).options);
          return {{"equal", same_bytes(result, reference)}};
        },
        1);
    wrong_.look_at(chosen);
    if (!sweep.contains("failed") && !kdtree.contains("failed"))
      judge(question, sweep, kdtree, chosen);
  }

  void judge(const std::string& question, const Json& sweep, const Json& kdtree,
             const Json& chosen) {
    const Json& report = chosen["runs"][0];
    const bool took_kdtree = report["engine"] == "kdtree";
    const auto ratio = [&](const char* name) {
      const double a = least(sweep, name), b = least(kdtree, name);
      return (took_kdtree ? b : a) / std::min(a, b);
    };
    const double wall = ratio("wall_seconds"), cpu = ratio("cpu_seconds");
    bench_.keep(question, {{"question", question}}, [&]() -> Json {
      return {{"sweep_seconds", least(sweep, "wall_seconds")},
              {"kdtree_seconds", least(kdtree, "wall_seconds")},
              {"sweep_cpu_seconds", least(sweep, "cpu_seconds")},
              {"kdtree_cpu_seconds", least(kdtree, "cpu_seconds")},
              {"choice", report["engine"]},
              {"ratio", wall},
              {"cpu_ratio", cpu}};
    });
    ++questions_;
    kdtree_chosen_ += took_kdtree;
    worst_cpu_ = std::max(worst_cpu_, cpu);
    if (wall <= worst_) return;
    worst_ = wall;
    worst_question_ = question;
  }

  Bench& bench_;
  WrongCases wrong_;
  int questions_ = 0, kdtree_chosen_ = 0;
  double worst_ = 0, worst_cpu_ = 0;
  std::string worst_question_;
};

}  // namespace

void bench_choice(Bench& bench) {
  Choice choice(bench);
  for (const std::string& scene : bench.options().scenes) choice.scene(scene);
  if (!bench.options().also.store.empty()) choice.query(bench.options().also);
  choice.finish();
}

}  // namespace clearway::bench
