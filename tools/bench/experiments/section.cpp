// The time of a section: by the length of its bins, its cells and its load, by threads and device;
// and what the same knowledge costs by every pair of a point and a pose, or by a run for each
// width.
#include <tbb/info.h>

#include <fstream>

#include "bench/experiments/bench.hpp"
#include "clearway/trajectory.hpp"
#include "core/section/section_ref.hpp"
#include "core/util/stopwatch.hpp"
#include "io/store/store_reader.hpp"

namespace clearway::bench {
namespace {

constexpr double kRear = -2.25, kFront = 2.25;  ///< of the load where its length is not varied
constexpr int kWidths = 200, kWidthsMeasured = 10;
constexpr std::size_t kPosesOfBruteForce = 50;

std::string range_text(double rear, double front) {
  return "--x-range=" + std::to_string(rear) + "," + std::to_string(front);
}

/// Blocks cells by every pair of a point and a pose, but for cells and blocks of points out of
/// reach, at some of the poses, and says how long all of them would take.
Json by_brute_force(const SceneFiles& files) {
  const StoreReader store(files.store);
  const std::vector<Pose> poses = read_trajectory(files.trajectory, {});
  const SectionParameters asked{
      .rear = kRear, .front = kFront, .window = SectionWindow{-4, 4, 0, 6}, .cell = 0.02, .bin = 5};
  const SectionLattice lattice = section_lattice(asked, 0);
  const double slack = section_rounding(largest_coordinate(store), poses, asked, lattice);
  SectionMaps maps(lattice, 1);
  const std::size_t every = std::max<std::size_t>(poses.size() / kPosesOfBruteForce, 1);
  std::uint64_t pairs = 0, searched = 0;
  double seconds = 0;
  std::vector<std::int32_t> q[3];
  for (auto& of_axis : q) of_axis.resize(store.cell_points());
  for (std::uint32_t i = 0; i < poses.size(); i += static_cast<std::uint32_t>(every), ++searched) {
    const std::vector<SectionBin> bins{{0, 0, 1}};
    const std::span<const Pose> one(&poses[i], 1);
    const std::span<const std::uint32_t> number(&i, 1);
    const SectionPoses pose(one, number, bins);
    SectionRef section = section_ref(pose, lattice, slack, maps);
    SectionPoseNode node = section.nodes[0];
    node.bin = SectionPoseNode::kManyBins;  // only the places decide
    const Stopwatch clock;
    for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
      const Cell& of = store.cells()[cell];
      if (!section.may_block(node, position_box(store.quantisation(), of.box))) continue;
      const auto coordinates = store.coordinates(cell);
      for (std::size_t k = 0; k < 3; ++k) coordinates[k].decode(0, std::span(q[k]).first(of.count));
      const auto blocks = store.blocks().subspan(std::size_t{cell} * store.blocks_per_cell());
      for (std::uint32_t block = 0; block * kBlockPoints < of.count; ++block) {
        const QuantumBox box = decode_block_box(of.box, blocks[block]);
        if (!section.may_block(node, position_box(store.quantisation(), box))) continue;
        const std::uint32_t end = std::min((block + 1) * kBlockPoints, of.count);
        for (std::uint32_t p = block * kBlockPoints; p < end; ++p, ++pairs) {
          section.block(section.nodes[0],
                        position(store.quantisation(), q[0][p], q[1][p], q[2][p]));
        }
      }
    }
    seconds += clock.seconds();
  }
  const double share = static_cast<double>(poses.size()) / static_cast<double>(searched);
  return {{"poses_searched", searched},
          {"pairs", static_cast<double>(pairs) * share},
          {"seconds", seconds * share}};
}

/// A closed box of the width, as high as a load.
void write_load(double width, const std::filesystem::path& path) {
  std::ofstream off(path);
  off << "OFF\n8 6 0\n";
  for (const double z : {0.5, 3.0}) {
    for (const int corner : {0, 1, 2, 3}) {
      off << (corner == 1 || corner == 2 ? kFront : kRear) << ' '
          << (corner < 2 ? -width / 2 : width / 2) << ' ' << z << '\n';
    }
  }
  off << "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
}

class Sections {
 public:
  Sections(Bench& bench, std::string scene)
      : bench_(bench), name_(std::move(scene)), files_(bench.scene(name_)) {}

  void by_method() {
    bench_.keep(name_ + "/method/brute force", parameters("method", "brute force"),
                [&] { return by_brute_force(files_); });
    measure("method", "section, 1 thread", {"--threads", "1", "--device", "cpu"});
    measure("method", "section, all threads", {"--device", "cpu"});
    if (bench_.cuda()) measure("method", "section, GPU", {"--device", "cuda"});
  }

  /// Some of the widths that a user would have to try.
  void by_widths() {
    SceneFiles files = files_;
    files.model = bench_.work() / "load.off";
    for (int i = 0; i < kWidthsMeasured; ++i) {
      const double width = 1 + 0.3 * i;
      write_load(width, files.model);
      bench_.measure(name_ + "/width/" + std::to_string(width),
                     {{"scene", name_}, {"vary", "width"}, {"value", width}, {"widths", kWidths}},
                     files, {"--model-as", "solid", "--radius", "0.001", "--device", "cpu"}, {}, 1);
    }
  }

  void by_parameters() {
    for (const char* bin : {"80", "20", "5", "1.25"})
      measure("bin", std::stod(bin), {"--bin", bin});
    for (const char* cell : {"0.08", "0.04", "0.02", "0.01"}) {
      measure("cell", std::stod(cell), {"--cell", cell});
    }
    for (const double length : {1.0, 4.5, 12.0, 25.0}) {
      find("length", length, {range_text(-length / 2, length / 2)});
    }
    const int cores = tbb::info::default_concurrency();
    for (int threads = 1; threads <= cores; threads *= 2) {
      measure("threads", threads, {"--threads", std::to_string(threads)});
    }
  }

 private:
  Json parameters(const std::string& vary, const Json& value) const {
    return {{"scene", name_}, {"vary", vary}, {"value", value}};
  }

  /// A section of the usual load. Those that vary a parameter are on the CPU.
  void measure(const std::string& vary, const Json& value, std::vector<std::string> options) {
    options.push_back(range_text(kRear, kFront));
    find(vary, value, std::move(options));
  }

  void find(const std::string& vary, const Json& value, std::vector<std::string> options) {
    if (vary != "method") options.insert(options.end(), {"--device", "cpu"});
    bench_.measure_section(name_ + "/" + vary + "/" + value.dump(), parameters(vary, value), files_,
                           options);
  }

  Bench& bench_;
  std::string name_;
  SceneFiles files_;
};

}  // namespace

void bench_section(Bench& bench) {
  for (const std::string& scene : bench.options().scenes) {
    Sections sections(bench, scene);
    sections.by_method();
    sections.by_widths();
    sections.by_parameters();
  }
}

}  // namespace clearway::bench
