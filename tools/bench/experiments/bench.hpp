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

/// A query to be asked: a store, a model and a trajectory.
struct SceneFiles {
  std::filesystem::path environment;  ///< LAS
  std::filesystem::path store, model, trajectory;
};

struct BenchOptions {
  std::filesystem::path program;  ///< that is measured; empty: clearway beside this one
  std::filesystem::path output, work;
  std::string size = "small";   ///< "smoke", "small" or "full"
  std::string device = "auto";  ///< "auto", "cpu" or "cuda"
  int repetitions = 3;
  std::vector<std::string> scenes{"mine", "hall", "plant", "tunnel"};
  std::string memory = "4G", device_memory = "2G";
  std::string gpus;           ///< of every run on a GPU: "0,1"; empty: the first with room
  bool cold = false;          ///< every run reads its store from the disk
  SceneFiles also;            ///< a query of the user's, for equality and choice; may be empty
  double limit_seconds = 60;  ///< of one run; one that takes longer is stopped, and has failed
  bool resume = false, force = false;
};

/// size: that of the options; "tenth" of the points of the paper's; "hard" or "equality", the small
/// sizes of those experiments.
scene::Sizes scene_size(const std::string& name, const std::string& size);

/// An engine on a device, with options of `clearway run`.
struct EngineChoice {
  std::string name;  ///< of the choice, for charts: "sweep cuda"
  std::vector<std::string> options;
  bool exact = true;

  /// The same engine with more options.
  EngineChoice with(const std::vector<std::string>& more) const;
};

/// Runs `clearway` again and again, and keeps what it reports. The work folder is its own as long
/// as it lives.
class Bench {
 public:
  /// Throws as WorkFolder and Record do, and ResourceError for a GPU that is not there. Warns of
  /// what they say of the program.
  Bench(const std::string& experiment, const BenchOptions& options);

  const BenchOptions& options() const { return options_; }
  const Program& program() const { return program_; }
  bool full() const { return options_.size == "full"; }
  bool cuda() const { return cuda_; }
  const std::filesystem::path& work() const { return work_.path(); }

  /// Made on the first call, kept in the work folder, at the size of the options or another one.
  SceneFiles scene(const std::string& name);
  SceneFiles scene(const std::string& name, const std::string& size);
  /// The scene's environment with a model and a trajectory of other sizes.
  SceneFiles resized(const std::string& name, SceneFiles files, std::uint64_t model_points,
                     std::uint64_t poses);
  /// A store of an environment, made on the first call; `name` is that of its file.
  std::filesystem::path store(const std::string& name, const std::filesystem::path& environment,
                              const std::vector<std::string>& options = {});

  /// Runs `clearway` into a file that is replaced; no case.
  void run(const SceneFiles& files, const std::filesystem::path& result,
           const std::vector<std::string>& run_options) const;

  /// A result, made on the first call and kept; no case.
  std::filesystem::path answer(const std::string& name, const SceneFiles& files,
                               const std::vector<std::string>& run_options);

  /// The exact set of these files with exact distances of all points nearer than 0.3 m.
  std::filesystem::path truth(const std::string& name, const SceneFiles& files);

  /// The scene moved by whole metres: environment and poses.
  SceneFiles shifted(const std::string& name, const SceneFiles& files, const Vec3& shift);

  /// `convert` into a store that replaces one of that name; its wall clock, peak memory and size,
  /// or that it failed for want of time or memory. Throws where it failed otherwise. `key` is that
  /// of the case, for messages.
  Json convert(const std::string& key, const std::filesystem::path& environment,
               const std::filesystem::path& store, const std::vector<std::string>& convert_options);

  /// The engines of this machine: those on the GPU where there is one, and the CPU's.
  std::vector<EngineChoice> exact_engines() const;
  EngineChoice engine(const std::string& name) const;
  /// "sweep", "grid" or "grid float" on the GPU where there is one, else on the CPU.
  EngineChoice engine_here(const std::string& name) const;

  /// What is said of a result, added to the case as "findings".
  using Judge = std::function<Json(const std::filesystem::path& result)>;

  /// The case of that key, where it need not be measured.
  const Json* find(const std::string& key) const { return record_.find(key); }

  /// `run` on these files, `repetitions` times (those of the options where it is not given), unless
  /// the file has the case already; not again after half a minute. Every report, with wall clock
  /// and peak memory, goes to "runs". A run that exceeds the limit or ends with `expected` goes to
  /// "failed" instead, with a warning; one that fails otherwise throws ResourceError.
  Json measure(const std::string& key, Json parameters, const SceneFiles& files,
               const std::vector<std::string>& run_options, const Judge& judge = {},
               std::optional<int> repetitions = {}, Refusal expected = Refusal::kNone);

  /// Any other case.
  Json keep(const std::string& key, Json parameters, const std::function<Json()>& findings);

  /// The case "all", made anew: what is found of all cases together.
  void conclude(Json findings);

 private:
  void make_scene(const std::filesystem::path& folder, const std::string& name,
                  const scene::Sizes& size) const;

  std::vector<std::string> command(const SceneFiles& files, const std::filesystem::path& result,
                                   const std::vector<std::string>& run_options) const;

  /// The failure, where it is a finding; throws ResourceError where it is not.
  Json finding(const std::string& key, const ProgramRun& failed, Refusal expected) const;

  BenchOptions options_;
  Program program_;
  Json description_;  ///< of the program
  WorkFolder work_;
  bool cuda_;
  Record record_;
};

/// The radius of all experiments that do not vary it, metres (the paper's).
inline constexpr const char* kRadius = "0.1";

// One an experiment (docs/design/evaluation.md).
void bench_table(Bench& bench);
void bench_threads(Bench& bench);
void bench_grid(Bench& bench);
void bench_datasets(Bench& bench);
void bench_points(Bench& bench);
void bench_accuracy(Bench& bench);
void bench_stability(Bench& bench);
void bench_scaling(Bench& bench);
void bench_hard(Bench& bench);
void bench_equality(Bench& bench);
void bench_choice(Bench& bench);
void bench_shards(Bench& bench);
void bench_surfaces(Bench& bench);

}  // namespace clearway::bench
