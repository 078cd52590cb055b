#include "tools/cli/support/asked.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "io/paths/trajectory_file.hpp"
#include "io/scans/point_reader.hpp"
#include "support/catch.hpp"
#include "support/store_fixture.hpp"

namespace clearway::test {

Scene::Scene(const std::string& kind, const std::string& sizes) {
  const Outcome made =
      run_program(folder, "scene " + kind + " " + sizes + " -o " + quoted(folder / ""));
  const Outcome converted =
      run_program(folder, "convert " + quoted(folder / "environment.las") + " -o " + store());
  if (made.exit_code != 0 || converted.exit_code != 0) throw std::runtime_error("no scene");
  model = read_model_points(folder / "model.ply");
  poses = read_trajectory(folder / "trajectory.txt");
}

const Scene& Scene::hall() {
  static const Scene scene("hall", "--points 100000 --model-points 20000 --poses 2000");
  return scene;
}

namespace {

/// Writes a store in `to` of those points of a scan for which `change` gives a place, at that
/// place.
std::string store_of(const std::filesystem::path& scan, const ScratchFolder& to,
                     const std::function<std::optional<Vec3>(const Vec3&)>& change) {
  const auto reader = open_point_file(scan);
  const Quantisation quantisation = *reader->info().quantisation;
  std::vector<Quantum> kept;
  for (PointBatch batch; reader->read(batch);) {
    for (const Quantum& q : batch.quanta) {
      const auto place = change(position(quantisation, q[0], q[1], q[2]));
      if (!place) continue;
      Quantum changed{};
      for (int k = 0; k < 3; ++k) {
        changed[k] = static_cast<std::int32_t>(
            std::lround(((*place)[k] - quantisation.offset[k]) / quantisation.scale[k]));
      }
      kept.push_back(changed);
    }
  }
  write_las(to / "changed.las", kept, quantisation);
  const std::string store = quoted(to / "changed.h5");
  REQUIRE(
      run_program(to, "convert " + quoted(to / "changed.las") + " --force -o " + store).exit_code ==
      0);
  return store;
}

}  // namespace

std::string Scene::changed_store(const ScratchFolder& to,
                                 const std::function<bool(const Vec3&)>& keep) const {
  return store_of(folder / "environment.las", to,
                  [&](const Vec3& p) { return keep(p) ? std::optional(p) : std::nullopt; });
}

std::string Scene::moved_store(const ScratchFolder& to,
                               const std::function<Vec3(const Vec3&)>& move) const {
  return store_of(folder / "environment.las", to, [&](const Vec3& p) { return move(p); });
}

void Asked::move_model(const std::function<Vec3(const Vec3&)>& change) {
  for (Vec3& p : model) p = change(p);
}

void Asked::move_path(const std::function<Vec3(const Vec3&)>& change) {
  for (Pose& pose : poses) {
    const Vec3 p = change({pose.translation[0], pose.translation[1], pose.translation[2]});
    for (int k = 0; k < 3; ++k) pose.translation[k] = p[k];
  }
}

void Asked::turn(const std::function<void(double*)>& change) {
  for (Pose& pose : poses) change(pose.rotation);
}

Outcome Asked::ask(const std::string& environment) const {
  const ScratchFolder folder;
  write_ply(folder / "model.ply", model);
  NoProgress progress;
  write_trajectory(poses, File::create(folder / "path.txt"), progress);
  const Outcome outcome = run_program(
      folder, "run --strict --env " + environment + " --model " + quoted(folder / "model.ply") +
                  " --trajectory " + quoted(folder / "path.txt") + " --radius " + radius + " -o " +
                  quoted(folder / "out.h5") + " " + options);
  CHECK(std::filesystem::exists(folder / "out.h5") == (outcome.exit_code == 0));
  return outcome;
}

std::string codes_of(const Outcome& outcome) {
  if (outcome.exit_code == 0) return "";
  REQUIRE(outcome.exit_code == 3);
  const std::size_t from = outcome.err.find("warning", outcome.err.find("strict: "));
  const std::size_t open = outcome.err.find('(', from);
  return outcome.err.substr(open + 1, outcome.err.find(')', open) - open - 1);
}

}  // namespace clearway::test
