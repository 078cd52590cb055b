// Sections through the library: the file, memory, refusals, and the guarantee against solids.
#include <algorithm>
#include <fstream>

#include "core/section/section_tables.hpp"
#include "core/trajectory/chainage.hpp"
#include "library/section_guarantee.hpp"
#include "support/change_header.hpp"
#include "support/compare.hpp"
#include "support/section_scene.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a section keeps what solids are promised") {
  Verdicts verdicts;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Tube tube(seed);
    tube.find();
    const Section section = tube.section();
    Random random(100 + seed);
    for (int i = 0; i < 40; ++i) {
      tube.guarantee(section, tube.path)
          .check(random_outline(random, 2, 0.3, uniform(random, 0.5, 2.3)),
                 uniform(random, 0.01, 0.3), verdicts);
    }
  }
  CHECK(verdicts.passes > 20);
  CHECK(verdicts.stopped > 20);
}

TEST_CASE("between poses a pass is one on the ways, too") {
  Tube tube(4);
  tube.asked.between_poses = true;
  const SectionReport report = tube.find();
  REQUIRE(report.motion);
  CHECK((*report.motion)[0] == Approx(0.4).margin(0.05));
  const Section section = tube.section();
  std::vector<Pose> between;  // poses between the poses, on which the load moves as it turns
  for (std::size_t k = 1; k < tube.path.size(); ++k) {
    for (int n = 0; n < 4; ++n) {
      const double t = 0.25 * n, angle = 0.01 * (static_cast<double>(k) - 1 + t);
      const Pose &a = tube.path[k - 1], &b = tube.path[k];
      between.push_back(rotation({0, 0, 1}, angle, (1 - t) * a.position() + t * b.position()));
    }
  }
  Random random(5);
  int passes = 0;
  for (int i = 0; i < 60; ++i) {
    const auto outline = random_outline(random, 2, 0.2, uniform(random, 0.4, 1.6));
    const double margin = uniform(random, 0.01, 0.2);
    if (section.check(outline, margin).verdict != SectionVerdict::kPasses) continue;
    ++passes;
    CHECK_FALSE(tube.guarantee(section, between).first_collision(outline, margin));
  }
  CHECK(passes > 5);
}

namespace {

/// A road with posts beside a path whose steps are longer than a bin, and a table of outlines.
struct LongSteps {
  static constexpr double kRear = -1.5, kFront = 2, kBin = 3;

  explicit LongSteps(Random& random) {
    Vec3 at{0, 0, 0};
    double angle = uniform(random, -3, 3), ahead = 1;
    const std::size_t count = 2 + below(random, 7);
    for (std::size_t i = 0; i < count; ++i) {
      path.push_back(rotation({0, 0, 1}, angle, at));
      angles.push_back(angle);
      if (below(random, 6) == 0) ahead = -ahead;  // it turns back on its own way
      const double step = below(random, 3) == 0 ? uniform(random, 0.1, 2) : uniform(random, 4, 14);
      at = at + ahead * step * Vec3{std::cos(angle), std::sin(angle), 0};
      angle += uniform(random, -0.05, 0.05);
    }
    chainage = chainage_of(path);
    for (std::uint64_t i = 1 + below(random, 4); i > 0; --i) {
      const Pose place = at_chainage(uniform(random, 0, length()));
      posts.push_back(place.rotated({uniform(random, -1, 1), uniform(random, -1.5, 1.5), 1}) +
                      place.position());
    }
    posts.push_back(path.front().rotated({0, 3.5, 0.2}) + path.front().position());
    double from = 0;
    while (from < length()) {
      const double to = from + uniform(random, 0.5, 12);
      const double half = below(random, 2) == 0 ? 1 : 0.3;
      table.rows.push_back({.line = table.rows.size() + 2,
                            .from = from,
                            .to = to,
                            .file = "load.csv",
                            .outline = {{-half, 0.5}, {half, 0.5}, {half, 2}, {-half, 2}},
                            .margin = 0});
      from = to;
    }
  }

  double length() const { return chainage.back(); }

  Pose at_chainage(double s) const {
    std::size_t i = 0;
    while (i + 2 < path.size() && chainage[i + 1] < s) ++i;
    const double t = (s - chainage[i]) / (chainage[i + 1] - chainage[i]);
    return rotation({0, 0, 1}, (1 - t) * angles[i] + t * angles[i + 1],
                    (1 - t) * path[i].position() + t * path[i + 1].position());
  }

  /// Whether a post is in the load of a row at a place, made longer and wider, and above a height.
  bool holds_post(const OutlineRow& row, const Pose& place, double along, double across,
                  double low) const {
    return std::ranges::any_of(posts, [&](const Vec3& post) {
      const auto [x, y, z] = place_of(place, post);
      return x > kRear - along && x < kFront + along && std::abs(y) < row.outline[2].y + across &&
             z > low;
    });
  }

  /// Whether a post is surely in the load of a row at a place of the row, in steps of 2 cm.
  bool is_hit(const OutlineRow& row) const {
    for (double s = row.from; s < std::min(row.to, length()); s += 0.02) {
      if (holds_post(row, at_chainage(s), 0, -0.03, 0.5)) return true;
    }
    return false;
  }

  /// Whether a post comes near the load at a pose that stands for a part of a bin of the row.
  bool may_be_hit(const OutlineRow& row, const SectionData& section) const {
    const double from = std::floor(row.from / kBin) * kBin;
    const double to = (std::floor(std::nextafter(row.to, 0) / kBin) + 1) * kBin;
    const double along = (*section.motion)[0] / 2 + 1e-6;
    const double across = (*section.motion)[1] / 2 + 2 * section.parameters.cell;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const double before = i == 0 ? 0 : (chainage[i - 1] + chainage[i]) / 2;
      const double after = i + 1 == path.size() ? length() : (chainage[i] + chainage[i + 1]) / 2;
      const bool is_last = row.to >= length();
      if (after < from || (before >= to && !is_last)) continue;
      if (holds_post(row, path[i], along, across, -1)) return true;
    }
    return false;
  }

  std::vector<Pose> path;
  std::vector<double> angles, chainage;
  std::vector<Vec3> posts;
  OutlineTable table{.path = "table.csv"};
};

}  // namespace

TEST_CASE("between poses a table is judged on the whole way, however long its steps are") {
  const ScratchFolder folder;
  Random random(77);
  int hit = 0, passed = 0, without_pose = 0;
  for (int i = 0; i < 60; ++i) {
    CAPTURE(i);
    const LongSteps road(random);
    write_ply(folder / "posts.ply", road.posts);
    convert({folder / "posts.ply"}, folder / "posts.h5", {.threads = 1, .overwrite = true});
    find_section(Store(folder / "posts.h5"), road.path,
                 {.rear = LongSteps::kRear,
                  .front = LongSteps::kFront,
                  .window = SectionWindow{-4, 4, 0, 3},
                  .cell = 0.05,
                  .bin = LongSteps::kBin,
                  .between_poses = true},
                 folder / "section.h5", {.threads = 1, .overwrite = true});
    const Section section(folder / "section.h5");
    check_equal(section.data().bins.size(),
                static_cast<std::size_t>(std::floor(road.length() / LongSteps::kBin)) + 1);
    const OutlineTableCheck check = section.check(road.table);
    bool any = false;
    for (std::size_t r = 0; r < road.table.rows.size(); ++r) {
      CAPTURE(r);
      const OutlineRow& row = road.table.rows[r];
      const SectionCheck& judged = check.rows[r].check;
      REQUIRE(check.rows[r].bins);
      without_pose += std::ranges::none_of(road.chainage,
                                           [&](double s) { return row.from <= s && s < row.to; });
      if (road.is_hit(row)) {
        CHECK(judged.verdict == SectionVerdict::kStopped);
        any = true;
        ++hit;
      } else if (!road.may_be_hit(row, section.data())) {
        CHECK(judged.stops.empty());
        ++passed;
      }
    }
    if (any) CHECK(check.verdict == SectionVerdict::kStopped);
    // A stretch is no wider than the posts leave room for on the way.
    for (const SectionStretch& stretch : section_stations(section, {.band = 1, .base = 0.5})) {
      const double from = stretch.bin * LongSteps::kBin;
      const OutlineRow wide{.from = from,
                            .to = std::min(from + LongSteps::kBin, road.length()),
                            .outline = {{}, {}, {1, 2}}};
      const auto width = symmetric_width(section.data(), stretch.bands[0]);
      if (road.is_hit(wide)) CHECK((width && *width < 2));
    }
  }
  CHECK(hit > 30);
  CHECK(passed > 30);
  CHECK(without_pose > 30);
}

TEST_CASE("one more point stops the load at the pose that the search finds first") {
  Tube tube(6);
  tube.asked.margin = 0.1;
  tube.find();
  const std::vector<OutlinePoint> outline{{-0.4, 1.6}, {0.4, 1.6}, {0.4, 2.4}, {-0.4, 2.4}};
  REQUIRE(tube.section().check(outline, 0.05).verdict == SectionVerdict::kPasses);
  const Pose& at = tube.path[20];
  write_ply(tube.folder / "one.ply", std::vector<Vec3>{at.rotated({0.2, 0.2, 2}) + at.position()});
  convert({tube.folder / "tube.ply", tube.folder / "one.ply"}, tube.folder / "tube.h5",
          {.cell_points = 512, .threads = 2, .overwrite = true});
  tube.find();
  const Section section = tube.section();
  const SectionCheck check = section.check(outline, 0.05);
  REQUIRE(check.verdict == SectionVerdict::kStopped);
  // The cell is well inside of the outline, so that margins change nothing across; along x the
  // section counts what is within its margin.
  const double reach = section.data().parameters.margin;
  CHECK(check.stop->first_pose ==
        tube.guarantee(section, tube.path).first_collision(outline, reach));
}

TEST_CASE("a section's bytes depend on neither threads nor memory nor device") {
  const Tube tube(7);
  const SectionReport on_cpu = tube.find({.device = Device::kCpu, .threads = 1, .overwrite = true});
  CHECK(on_cpu.device == Device::kCpu);
  CHECK(on_cpu.device_name == "the CPU");
  CHECK(on_cpu.peak_device_bytes == 0);
  CHECK(!on_cpu.estimate);
  const std::string bytes = tube.bytes();
  for (const int threads : {2, 3, 7}) {
    // Few points do not pay for the start of a GPU.
    const SectionReport report =
        tube.find({.threads = threads, .memory_bytes = 64 << 20, .overwrite = true});
    CHECK(report.device == Device::kCpu);
    check_same(tube.bytes(), bytes);
  }
  // A machine without a GPU refuses one, so that nobody takes the CPU's time for that of a GPU.
  SectionOptions on_gpu{.device = Device::kCuda, .threads = 2, .overwrite = true};
  try {
    const SectionReport report = tube.find(on_gpu);
    CHECK(report.device == Device::kCuda);
    CHECK(report.peak_device_bytes > 0);
    check_same(tube.bytes(), bytes);
    on_gpu.device_memory_bytes = 100000;
    check_refused([&] { tube.find(on_gpu); }, "device memory is too little");
  } catch (const ResourceError& error) {
    check_says(error.what(), "device cuda");
  }
  CHECK_THROWS_WITH(tube.find({.gpus = {1023}, .overwrite = true}),
                    Contains("GPU 1023") || Contains("device cuda"));
}

TEST_CASE("too little memory is refused with a bin that fits") {
  Tube tube(8);
  tube.asked.bin = 0.5;
  const SectionOptions little{.threads = 1, .memory_bytes = 900'000, .overwrite = true};
  std::string message;
  try {
    tube.find(little);
  } catch (const ResourceError& error) {
    message = error.what();
    CHECK(error.remedy() == Remedy::kMoreMemory);
    SectionOptions enough = little;
    enough.memory_bytes = static_cast<std::uint64_t>(error.amount());
    CHECK_NOTHROW(tube.find(enough));
  }
  const std::size_t last = message.rfind("bins of ");
  REQUIRE(last != std::string::npos);
  tube.asked.bin = std::stod(message.substr(last + 8));
  CHECK_NOTHROW(tube.find(little));
  tube.asked.cell = 0.001;
  check_refused([&] { tube.find(little); }, "larger cells or a smaller window take less");
}

TEST_CASE("a damaged section is refused wherever it is damaged") {
  const Tube tube(9, 10);
  tube.find();
  const std::string bytes = tube.bytes();
  const SectionCells cells = tube.section().cells();
  int refused = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 400) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x55);
    put_bytes(tube.folder / "section.h5", changed);
    try {
      const Section read = tube.section();
      CHECK((read.cells() == cells));  // a byte that is not used
    } catch (const Error& error) {
      ++refused;
      check_says(error.what(), "section.h5");
    }
  }
  CHECK(refused > 100);
  put_bytes(tube.folder / "section.h5", bytes.substr(0, bytes.size() / 2));
  CHECK_THROWS_AS(tube.section(), InputError);
  check_refused([&] { Section(tube.folder / "tube.h5"); }, "is not a section");
}

TEST_CASE("a section that contradicts itself is refused, though its hashes are right") {
  const Tube tube(9, 10);
  tube.find();
  const std::string bytes = tube.bytes();
  const auto path = tube.folder / "section.h5";
  const auto check = [&](const std::string& words, const auto& change) {
    INFO(words);
    put_bytes(path, bytes);
    change();
    check_refused<InputError>([&] { tube.section(); }, words);
  };
  const auto fact = [&](const char* name, const Json& value) {
    return [=] { change_header(path, [&](Json& header) { header[name] = value; }); };
  };
  const auto column = [&]<typename Value>(const char* name, std::size_t at, Value value) {
    return [=] {
      std::vector<Value> values = values_of_column<Value>(path, name);
      values.at(at) = value;
      change_column(path, name, values);
    };
  };
  check("'window': expected an object", fact("window", nullptr));
  check("'cell': expected a number", fact("cell", nullptr));
  check("cell", fact("cell", -1));
  check("the rounding is no number above 0", fact("rounding", 0));
  check("the chainage is not that of the poses", fact("poses", 1));
  check("the bins are not ascending", fact("load_poses", 0));
  check("is not what was asked", fact("motion", {1, 2}));
  check("is not what was asked", fact("ignore_classes", {2}));
  check("/bins/unknown is missing", fact("seen", true));
  check("the chainage is not that", column("path/chainage", 0, 1e9));
  check("the bins are not ascending", column("bins/number", 0, std::uint32_t{1000}));
  check("other cells than those in the file", column("bins/cells", 0, ~std::uint64_t{0}));
  check("outside the window", column("section/j", 0, std::int32_t{1 << 30}));
  check("a pose that is not there", column("section/first_pose", 0, ~std::uint32_t{0}));
  const auto j = values_of_column<std::int32_t>(path, "section/j");
  const auto k = values_of_column<std::int32_t>(path, "section/k");
  check("not ascending", [&] {
    change_column(path, "section/j", std::vector(j.size(), j[0]));
    change_column(path, "section/k", std::vector(k.size(), k[0]));
  });
  check("different lengths", [&] { change_column(path, "section/k", std::vector(1, k[0])); });
}

TEST_CASE("pivots give the load chords of the path, and poses stay those of the path") {
  Tube tube(10);
  tube.asked.pivots = BodyPivots{1.2, -0.8};
  tube.find();
  const SectionData data = tube.section().data();
  CHECK(data.poses == 40);
  CHECK(data.load_poses < 40);
  REQUIRE(data.parameters.pivots);
  const Body body = follow({"load", {}, {}, {}}, tube.path, *tube.asked.pivots);
  CHECK(data.load_poses == body.poses.size());
  for (const std::uint32_t pose : data.bin_cells.first_pose) {
    CHECK(std::binary_search(body.path_pose.begin(), body.path_pose.end(), pose));
  }
}

TEST_CASE("questions without a section are refused, and doubtful ones are never a pass") {
  Tube tube(11);
  const std::vector<Pose> path = tube.path;
  tube.path[3].rotation[0] *= 1.01;
  check_refused([&] { tube.find(); }, "pose 3 stretches lengths");
  tube.path = path;
  tube.path[5] = {{0, 0, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0}};
  CHECK_THROWS_AS(tube.find(), UsageError);

  const std::vector<OutlinePoint> outline{{-0.5, 1.5}, {0.5, 1.5}, {0.5, 2.5}, {-0.5, 2.5}};
  const auto codes_in_doubt = [&] {
    const std::string codes = codes_of(tube.find().warnings);
    CHECK(tube.section().check(outline, 0).verdict == SectionVerdict::kUnknown);
    return codes;
  };
  tube.path.clear();
  check_says(codes_in_doubt(), "no-poses");
  tube.path = path;
  for (Pose& pose : tube.path) pose.translation[0] += 5000;
  check_says(codes_in_doubt(), "out-of-reach");
  check_refused([&] { tube.find({.threads = 1, .overwrite = true, .strict = true}); }, "strict");
  tube.path = path;
  tube.asked.ignore_boxes = {{{-1e4, -1e4, -1e4}, {1e4, 1e4, 1e4}}};
  codes_in_doubt();
  check_refused([&] { tube.find({.threads = 1}); }, "section.h5");  // it exists
}

TEST_CASE("tables of a section are written as text") {
  const Tube tube(12);
  tube.find();
  const Section section = tube.section();
  const auto check_table = [&](SectionTable table, std::size_t rows, const std::string& header) {
    export_section(section, table, tube.folder / "t.csv", {.band = 0.5, .base = 0}, true);
    std::ifstream file(tube.folder / "t.csv");
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) {
      if (!line.starts_with("#")) lines.push_back(line);
    }
    CHECK(lines.size() == 1 + rows);
    CHECK(lines[0].starts_with(header));
    for (const std::string& line : lines) {
      CHECK(std::ranges::count(line, ',') == std::ranges::count(lines[0], ','));
    }
  };
  check_table(SectionTable::kCells, section.cells().size(), "j,k,first_pose");
  check_table(SectionTable::kBinCells, section.data().bin_cells.size(), "");
  check_table(SectionTable::kBands, 9,
              "z_from,z_to,left,left_pose,left_station,right,right_pose,right_station,"
              "symmetric_width");
  check_table(SectionTable::kBoxes, 9, "top,left,right,symmetric_width");
  check_table(SectionTable::kStations, 9 * section.data().bins.size(), "");
  export_section_outline(section, tube.folder / "o.dxf", {.band = 0.25, .base = 1.75});
  CHECK(std::filesystem::file_size(tube.folder / "o.dxf") > 200);
}
