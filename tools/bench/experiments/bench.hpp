#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/measure/failure.hpp"
#include "bench/measure/record.hpp"
#include "bench/measure/work_folder.hpp"
#include "clearway/vec3.hpp"
#include "scene/scene.hpp"

namespace clearway::bench {

/// The files of a query: a store, a model and a trajectory.
struct SceneFiles {
  std::filesystem::path environment;  ///< the LAS file of the store's points
  std::filesystem::path store, model, trajectory;
};

struct BenchOptions {
  std::filesystem::path program;  ///< the measured program; empty: clearway beside this one
  std::filesystem::path output, work;
  std::string size = "small";   ///< "smoke", "small" or "full"
  std::string device = "auto";  ///< "auto", "cpu" or "cuda"
  int repetitions = 3;
  std::vector<std::string> scenes{"mine", "hall", "plant", "tunnel"};
  std::string memory = "4G", device_memory = "2G";
  std::string gpus;   ///< --gpus of every run on a GPU, such as "0,1"; empty: the first with room
  bool cold = false;  ///< whether every run reads its store from the disk
  SceneFiles also;    ///< the user's own query, for equality; may be empty
  double limit_seconds = 60;  ///< limit of one run; a longer run is stopped and has failed
  bool resume = false, force = false;
};

/// The sizes of a scene. size: a size of the options; "tenth", a tenth of the paper's points; or
/// "hard" or "equality", the small sizes of those experiments.
scene::Sizes scene_size(const std::string& name, const std::string& size);

/// An engine on a device, with options of `clearway run` or, where one of these sets the engine as
/// no run does, of `clearway-bench search`.
struct EngineChoice {
  std::string name;  ///< the name in charts: "sweep cuda"
  std::vector<std::string> options;
  bool exact = true;

  /// This engine with more options.
  EngineChoice with(const std::vector<std::string>& more) const;
};

/// Runs `clearway` again and again, and records what it reports. It holds the work folder as long
/// as it lives.
class Bench {
 public:
  /// Throws as WorkFolder and Record do, and ResourceError where a GPU is asked for and there is
  /// none. Logs the warnings that they give about the program.
  Bench(const std::string& experiment, const BenchOptions& options);

  const BenchOptions& options() const { return options_; }
  const Program& program() const { return program_; }
  bool full() const { return options_.size == "full"; }
  bool cuda() const { return cuda_; }
  const std::filesystem::path& work() const { return work_.path(); }

  /// A scene at the size of the options or another one; made on the first call and kept in the work
  /// folder.
  SceneFiles scene(const std::string& name);
  SceneFiles scene(const std::string& name, const std::string& size);
  /// A scene of the options' size with another number of points, whose store knows where its
  /// scanner stood.
  SceneFiles scanned(const std::string& name, std::uint64_t points);
  /// The scene's environment with a model and a trajectory of other sizes.
  SceneFiles resized(const std::string& name, SceneFiles files, std::uint64_t model_points,
                     std::uint64_t poses);
  /// A store of an environment, made on the first call. `name` is the name of its file.
  std::filesystem::path store(const std::string& name, const std::filesystem::path& environment,
                              const std::vector<std::string>& options = {});

  /// Runs `clearway` into a file that is replaced, and records no case.
  void run(const SceneFiles& files, const std::filesystem::path& result,
           const std::vector<std::string>& run_options) const;

  /// A result, made on the first call and kept; records no case.
  std::filesystem::path answer(const std::string& name, const SceneFiles& files,
                               const std::vector<std::string>& run_options);

  /// The exact result of these files, with exact distances of all points nearer than 0.3 m.
  std::filesystem::path truth(const std::string& name, const SceneFiles& files);

  /// A scene moved by whole metres: its environment and its poses.
  SceneFiles shifted(const std::string& name, const SceneFiles& files, const Vec3& shift);

  /// Converts into a store that replaces one of that name. Returns wall clock, peak memory and
  /// size, or that the conversion failed for want of time or memory; throws where it failed
  /// otherwise. `key` names the case in messages.
  Json convert(const std::string& key, const std::filesystem::path& environment,
               const std::filesystem::path& store, const std::vector<std::string>& convert_options);

  /// The exact engines of this machine: those on the GPU where there is one, and the CPU's.
  std::vector<EngineChoice> exact_engines() const;
  EngineChoice engine(const std::string& name) const;
  /// The engine "sweep", "grid" or "grid float", on the GPU where there is one, otherwise on the
  /// CPU.
  EngineChoice engine_here(const std::string& name) const;

  /// Judges a result; what it returns is added to the case as "findings".
  using Judge = std::function<Json(const std::filesystem::path& result)>;

  /// The recorded case with that key; nullptr where it has yet to be measured.
  const Json* find(const std::string& key) const { return record_.find(key); }

  /// Measures a case, unless the file has it already: a search of these files, `repetitions` times
  /// (as in the options where it is not given), but not again after some seconds. Every report,
  /// with wall clock and peak memory, goes to "runs". A run that exceeds the limit or ends with
  /// `expected` goes to "failed" instead, with a warning; one that fails otherwise throws
  /// ResourceError.
  Json measure(const std::string& key, Json parameters, const SceneFiles& files,
               const std::vector<std::string>& run_options, const Judge& judge = {},
               std::optional<int> repetitions = {}, Refusal expected = Refusal::kNone);

  /// Measures a case as measure() does, with `clearway section find` in the place of a run.
  Json measure_section(const std::string& key, Json parameters, const SceneFiles& files,
                       const std::vector<std::string>& find_options);

  /// Records a case whose findings come from elsewhere, unless the file has it already.
  Json keep(const std::string& key, Json parameters, const std::function<Json()>& findings);

  /// Replaces the case "all", which holds what is found of all cases together.
  void conclude(Json findings);

 private:
  /// The files of a scene but for its store, made on the first call. label: name of their folder.
  SceneFiles made(const std::string& name, const std::string& label, const scene::Sizes& size);
  void make_scene(const std::filesystem::path& folder, const std::string& name,
                  const scene::Sizes& size) const;

  /// A program with its arguments.
  struct Command {
    const Program& program;
    std::vector<std::string> arguments;
  };
  Command command(const SceneFiles& files, const std::filesystem::path& result,
                  const std::vector<std::string>& run_options) const;

  Json measure_program(const std::string& key, Json parameters, const SceneFiles& files,
                       const Command& command, const std::filesystem::path& result,
                       const Judge& judge, std::optional<int> repetitions, Refusal expected);

  /// What is recorded of a failed run that is a finding; throws ResourceError where it is none.
  Json finding(const std::string& key, const ProgramRun& failed, Refusal expected) const;

  BenchOptions options_;
  Program program_;
  Program own_;       ///< this program
  Json description_;  ///< the description of the measured program
  WorkFolder work_;
  bool cuda_;
  Record record_;
};

/// The radius of all experiments that do not vary it, metres; it is the paper's.
inline constexpr const char* kRadius = "0.1";

// Each function runs one experiment (docs/design/evaluation.md).
void bench_table(Bench& bench);
void bench_threads(Bench& bench);
void bench_grid(Bench& bench);
void bench_points(Bench& bench);
void bench_accuracy(Bench& bench);
void bench_stability(Bench& bench);
void bench_scaling(Bench& bench);
void bench_share(Bench& bench);
void bench_hard(Bench& bench);
void bench_equality(Bench& bench);
void bench_shards(Bench& bench);
void bench_surfaces(Bench& bench);
void bench_seen(Bench& bench);
void bench_section(Bench& bench);

}  // namespace clearway::bench
