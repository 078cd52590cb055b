#include "scene/write.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

#include "core/util/format.hpp"
#include "io/scans/las/las_writer.hpp"
#include "io/scans/ply/ply_writer.hpp"

namespace clearway::scene {
namespace {

constexpr std::uint64_t kBatchPoints = 1 << 15;

/// Scans batches of consecutive sweeps in parallel and writes them in order. Points lie in a ring
/// with a place for each batch in flight, because what oneTBB holds between two stages is lost when
/// a stage throws.
void scan_in_order(const Scanner& scanner, int threads, LasWriter& writer, Progress& progress) {
  const std::uint64_t sweeps = scanner.plan().sweeps();
  const std::uint64_t batch =
      std::max<std::uint64_t>(1, kBatchPoints / scanner.plan().rays_a_sweep);
  std::vector<Scanner::Points> ring(static_cast<std::size_t>(4 * threads));
  std::uint64_t next = 0;
  const auto number = [&](tbb::flow_control& flow) {
    throw_if_stopped(progress);
    if (next * batch >= sweeps) flow.stop();
    return next++;
  };
  const auto scan = [&](std::uint64_t index) {
    Scanner::Points& points = ring[index % ring.size()];
    points.clear();
    points.reserve((batch + 1) * scanner.plan().rays_a_sweep);
    const std::uint64_t end = std::min((index + 1) * batch, sweeps);
    for (std::uint64_t i = index * batch; i < end; ++i) scanner.scan(i, points);
    return index;
  };
  const auto write = [&](std::uint64_t index) {
    const Scanner::Points& points = ring[index % ring.size()];
    writer.write(points);
    progress.advance(points.size());
  };
  tbb::parallel_pipeline(
      ring.size(),
      tbb::make_filter<void, std::uint64_t>(tbb::filter_mode::serial_in_order, number) &
          tbb::make_filter<std::uint64_t, std::uint64_t>(tbb::filter_mode::parallel, scan) &
          tbb::make_filter<std::uint64_t, void>(tbb::filter_mode::serial_in_order, write));
}

}  // namespace

void write_environment(const Scene& scene, std::uint64_t seed, const File& file, int threads,
                       Progress& progress) {
  const Scanner scanner(scene.path, scene.world, scene.plan, seed);
  const std::uint64_t points = scene.sizes.points;
  LasWriter writer(file, LasFormat::of_points(Scanner::kQuantisation, points),
                   LasTotals{points, scanner.bounds(), {points}});
  progress.begin("scan", scene.sizes.points, "points");
  const int count = threads > 0 ? threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(count));
  tbb::task_arena arena(count);
  arena.execute([&] { scan_in_order(scanner, count, writer, progress); });
  writer.finish();
  progress.end();
}

void write_origins(const Scene& scene, const File& file) {
  ByteWriter out(file);
  const auto put = [&](const std::string& text) { out.put_text(text, text.size()); };
  put("first,x,y,z\n");
  std::optional<Vec3> before;
  for (std::uint64_t sweep = 0; sweep < scene.plan.sweeps(); ++sweep) {
    const Vec3 at = scene.path.to_world(scene.plan.sweep_of(sweep).scanner);
    if (before && at.x == before->x && at.y == before->y && at.z == before->z) continue;
    before = at;
    put(std::to_string(sweep * scene.plan.rays_a_sweep) + "," + format_number(at.x) + "," +
        format_number(at.y) + "," + format_number(at.z) + "\n");
  }
  out.flush();
}

void write_model(const Scene& scene, const File& file) {
  PlyWriter writer(file, {.points = scene.model.size(),
                          .coordinates = PlyCoordinates::kFloat32,
                          .comments = {"Clearway scene " + std::string(name_of(scene.kind))}});
  writer.write(scene.model);
  writer.finish();
}

void write_trajectory(const Scene& scene, const File& file) {
  ByteWriter out(file);
  const auto put = [&](double value, char end) {
    char text[32];
    const auto written =
        std::to_chars(text, text + sizeof text, value, std::chars_format::general, 9);
    *written.ptr = end;
    out.put_text({text, written.ptr + 1}, static_cast<std::size_t>(written.ptr + 1 - text));
  };
  for (std::uint64_t i = 0; i < scene.sizes.poses; ++i) {
    const Pose pose = scene.pose(i);
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k) put(pose.rotation[3 * row + k], ' ');
      put(pose.translation[row], row < 2 ? ' ' : '\n');
    }
  }
  out.flush();
}

}  // namespace clearway::scene
