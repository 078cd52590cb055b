// Whether every engine on every device gives the bytes that the sweep gives on the CPU, and keeps
// to the memory of the device.
#include "bench/experiments/bench.hpp"
#include "bench/measure/scoring.hpp"
#include "cli/support/console.hpp"

namespace clearway::bench {
namespace {

struct Mode {
  const char* name;
  std::vector<std::string> options;
  bool plain = false;    ///< whether the engines kdtree and grid have the mode too
  bool origins = false;  ///< whether the store has to know its scanner's places
};

const std::vector<Mode>& modes() {
  static const std::vector<Mode> kModes{
      {"set", {}, true},
      {"first pose", {"--first-pose"}},
      {"between poses", {"--between-poses"}},
      {"between poses, first pose", {"--between-poses", "--first-pose"}},
      {"clearance", {"--clearance", "0.3"}},
      {"clearance below the radius, first pose", {"--clearance", "0.05", "--first-pose"}},
      {"clearance, first pose", {"--clearance", "0.3", "--first-pose"}},
      {"profile", {"--profile", "0.3"}},
      {"seen space", {"--seen"}, false, true},
      {"seen space, small cubes", {"--seen", "--seen-cube", "0.1"}, false, true},
      {"between poses, seen space", {"--between-poses", "--seen"}, false, true}};
  return kModes;
}

struct DeviceMemory {
  const char* text;
  std::uint64_t bytes;
};
constexpr DeviceMemory kDeviceMemory[] = {{"256M", std::uint64_t{256} << 20},
                                          {"2G", std::uint64_t{2} << 30}};

class Equality {
 public:
  explicit Equality(Bench& bench) : bench_(bench) {}

  void scene(const std::string& name) {
    const std::string size = bench_.options().size == "small" ? "equality" : bench_.options().size;
    SceneFiles files = bench_.scene(name, size);
    const std::string origins = (files.environment.parent_path() / "origins.csv").string();
    for (const char* cells : {"65536", "1000"}) {
      files.store = bench_.store(name + "-" + size + "-cells-" + cells, files.environment,
                                 {"--cell-points", cells, "--origins", origins});
      query(name + ", cells of " + cells, files, true);
    }
  }

  /// origins: whether the store knows its scanner's places.
  void query(const std::string& name, const SceneFiles& files, bool origins) {
    for (const Mode& mode : modes()) {
      if (mode.origins && !origins) continue;
      const std::string key = name + "/" + mode.name + "/";
      bool answered = false;  // the reference is made where a case needs it
      const auto judge = [&](const std::filesystem::path& result) -> Json {
        const auto reference = bench_.work() / "reference.h5";
        const EngineChoice sweep = bench_.engine("sweep cpu").with(mode.options);
        if (!answered) bench_.run(files, reference, sweep.options);
        answered = true;
        return {{"equal", same_bytes(result, reference)}};
      };
      for (const char* engine : {"kdtree cpu", "grid cpu"}) {
        const bool takes_too_long = engine == std::string("grid cpu") && bench_.full();
        if (!mode.plain || takes_too_long) continue;
        compare(key + engine, files, bench_.engine(engine).with(mode.options), judge);
      }
      for (const char* engine : {"sweep cuda", "grid cuda"}) {
        if (!bench_.cuda() || (std::string(engine) == "grid cuda" && !mode.plain)) continue;
        for (const auto& [memory, bytes] : kDeviceMemory) {
          const auto on_device = bench_.engine(engine).with({"--device-memory", memory});
          const Json done =
              compare(key + engine + "/" + memory, files, on_device.with(mode.options), judge);
          over_ += done["runs"][0]["peak_device_bytes"] > bytes;
        }
      }
    }
  }

  /// Throws ResultsDiffer where a result differs or a run took too much of the device's memory.
  void finish() const {
    bench_.conclude({{"runs", runs_}, {"differing", differing_}, {"over_device_memory", over_}});
    const std::string found = std::to_string(runs_) + " runs: " + std::to_string(differing_) +
                              " differ from the sweep's on the CPU, " + std::to_string(over_) +
                              " took more than --device-memory";
    tool::print(found + "\n");
    if (differing_ + over_ > 0)
      throw ResultsDiffer(bench_.options().output.string() + ": " + found);
  }

 private:
  Json compare(const std::string& key, const SceneFiles& files, const EngineChoice& engine,
               const Bench::Judge& judge) {
    Json done = bench_.measure(key, {{"engine", engine.name}}, files, engine.options, judge, 1);
    if (done.contains("failed")) throw ResourceError(key + ": " + reason_of(done["failed"]));
    ++runs_;
    differing_ += !done["findings"]["equal"].get<bool>();
    return done;
  }

  Bench& bench_;
  int runs_ = 0, differing_ = 0, over_ = 0;
};

}  // namespace

void bench_equality(Bench& bench) {
  Equality equality(bench);
  for (const std::string& scene : bench.options().scenes) equality.scene(scene);
  if (!bench.options().also.store.empty()) equality.query("given", bench.options().also, false);
  equality.finish();
}

}  // namespace clearway::bench
