// Conversions that are killed or stopped at any step, and go on.
#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <set>

#include "clearway/convert.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "io/result/journal.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/bytes/laz/laz_bytes.hpp"
#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

namespace fs = std::filesystem;

using FilesLeft = std::map<std::string, std::string>;

FilesLeft files_in(const fs::path& folder) {
  FilesLeft files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::string bytes = bytes_of(entry.path());
    if (!bytes.empty()) files[entry.path().filename().string()] = std::move(bytes);
  }
  return files;
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files_in(folder)) names.push_back(name);
  return names;
}

std::vector<Quantum> plane_cloud(std::size_t count, std::uint64_t seed) {
  std::vector<Quantum> points = cube_cloud(count, -300, 300, seed);
  for (Quantum& p : points) p[2] = 7;
  return points;
}

std::vector<Vec3> plane_positions(std::size_t count, std::uint64_t seed) {
  std::vector<Vec3> positions;
  for (const Quantum& q : plane_cloud(count, seed)) {
    positions.push_back({q[0] / 64.0, q[1] / 64.0, q[2] / 64.0});
  }
  return positions;
}

std::string text_scan(std::size_t count, std::uint64_t seed) {
  std::string text;
  for (const Quantum& q : plane_cloud(count, seed)) {
    text += std::to_string(q[0]) + ".5 " + std::to_string(q[1]) + ".25 1.125\n";
  }
  return text;
}

/// An E57 file of several scans, each with several packets.
std::string e57_scans(std::size_t count, std::uint64_t seed) {
  constexpr std::size_t kScan = 12000, kPacket = 2000 * sizeof(double);
  E57Bytes file;
  const std::vector<Vec3> positions = plane_positions(count, seed);
  for (std::size_t first = 0; first < count; first += kScan) {
    std::array<std::vector<double>, 3> xyz;
    for (std::size_t i = first; i < std::min(count, first + kScan); ++i) {
      for (int k = 0; k < 3; ++k) xyz[static_cast<std::size_t>(k)].push_back(positions[i][k]);
    }
    E57Bytes::Scan scan = e57_scan(xyz[0], xyz[1], xyz[2]);
    const std::size_t packets = divide_up(xyz[0].size() * sizeof(double), kPacket) - 1;
    scan.packets.assign(packets, {kPacket, kPacket, kPacket});
    file.scans.push_back(std::move(scan));
  }
  return file.build();
}

/// table: without one, the file is read from its first point on.
std::string laz_scan(std::size_t count, std::uint64_t seed, LazBytes::Table table) {
  LazBytes file;
  file.table = table;
  file.chunks = {9000};
  file.las.scale = {0.01, 0.01, 0.01};
  for (const Quantum& q : plane_cloud(count, seed)) file.points.push_back({.position = q});
  return file.build();
}

/// Calls a function after each advance, one at a time.
class EachAdvance final : public Progress {
 public:
  explicit EachAdvance(std::function<void()> advanced) : advanced_(std::move(advanced)) {}

  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {
    const std::lock_guard lock(mutex_);
    advanced_();
  }
  void end() override {}
  bool stop_requested() const override { return false; }

 private:
  std::function<void()> advanced_;
  std::mutex mutex_;
};

/// How far a conversion came whose report says what it went on from.
int phase_of(const ConversionReport& report) {
  constexpr std::array<std::string_view, 4> kPhases{
      "", "the inputs were inspected", "all points were counted", "all points were distributed"};
  const auto at = std::ranges::find(kPhases, report.resumed_from);
  REQUIRE(at != kPhases.end());
  return static_cast<int>(at - kPhases.begin());
}

/// Conversions to a folder for the store alone, and what the store is when nobody disturbs its
/// making.
class Resumed : public Conversion {
 public:
  Resumed() : Conversion(500) {
    fs::create_directory(out());
    options.output = out() / "a.h5";
    options.overwrite = false;
    options.threads = 1;
  }

  fs::path out() const { return folder / "out"; }
  void add_classed(const std::string& name, std::size_t points, unsigned most_class = 0) {
    write_classed(folder / name, plane_cloud(points, points), random_classes(points, most_class));
    options.inputs.push_back(folder / name);
  }
  ConversionOptions resuming() const {
    ConversionOptions changed = options;
    changed.resume = true;
    return changed;
  }

  const std::string& expected() {
    if (expected_.empty()) {
      expected_ = converted_bytes();
      REQUIRE(names_in(out()) == std::vector<std::string>{"a.h5"});
      clear();
    }
    return expected_;
  }

  void clear() const {
    for (const std::string& name : names_in(out())) fs::remove(out() / name);
  }
  void put(const FilesLeft& files) const {
    clear();
    for (const auto& [name, bytes] : files) put_bytes(out() / name, bytes);
  }

  /// Resumes, and checks that the store is as if nobody had disturbed anything.
  ConversionReport check_resumed() {
    const ConversionReport report = convert_quietly(resuming());
    check_finished();
    return report;
  }
  void check_finished() {
    check_same(bytes_of(options.output), expected());
    check_equal(names_in(out()), {"a.h5"});
  }

  /// The files that a process leaves that is killed after each record of its journal and, unless
  /// null, after each `step`-th advance of a stage.
  std::vector<FilesLeft> killed(int step = 0) {
    std::vector<FilesLeft> found;
    ConversionOptions watched = options;
    watched.journalled = [&] { found.push_back(files_in(out())); };
    int advances = 0;
    EachAdvance progress([&] {
      if (step > 0 && ++advances % step == 0) found.push_back(files_in(out()));
    });
    convert_scans(watched, progress);
    clear();
    return found;
  }

 private:
  std::string expected_;
};

struct ResumedRow {
  const char* name;
  std::function<void(Resumed&)> make;
};

const std::vector<ResumedRow> kResumedRows{
    {"two LAS files with classes",
     [](Resumed& scans) {
       scans.add_classed("a.las", 100000, 3);
       scans.add_classed("b.las", 70000, 9);
     }},
    {"PLY and text, whose scale is chosen, and many points at one place, of which the store warns",
     [](Resumed& scans) {
       std::vector<Vec3> positions = plane_positions(90000, 1);
       std::fill(positions.end() - 5000, positions.end(), positions.front());
       scans.add_ply("a.ply", plane_positions(50000, 2));
       scans.add_ply("b.ply", positions);
       scans.add("c.xyz", text_scan(36000, 3));
     }},
    {"E57 of several scans, and LAZ with a table of chunks and without one",
     [](Resumed& scans) {
       scans.add("a.e57", e57_scans(70000, 1));
       scans.add("b.laz", laz_scan(40000, 2, LazBytes::Table::kAtPoints));
       scans.add("c.laz", laz_scan(40000, 3, LazBytes::Table::kNone));
     }},
    {"cubes near a path, with origins", [](Resumed& scans) {
       scans.add_classed("a.las", 140000);
       scans.options.near = scans.folder.write(
           "path.txt", "1 0 0 99.9 0 1 0 -200 0 0 1 0\n1 0 0 100 0 1 0 -200 0 0 1 0\n");
       scans.options.within = 0.3;
       scans.options.origins =
           scans.folder.write("origins.csv", "first,x,y,z\n0,1,2,3\n70000,4,5,6\n");
       scans.options.regular_size = 0.2;
     }}};

}  // namespace

TEST_CASE("a conversion that is killed at any moment goes on after the phase that it finished") {
  for (const ResumedRow& row : kResumedRows) {
    const RowName name(row.name);
    Resumed scans;
    row.make(scans);
    scans.expected();
    const std::vector<FilesLeft> killed = scans.killed(20);
    CHECK(killed.size() > 10);
    int before = 0;
    std::set<int> phases;
    for (std::size_t i = 0; i < killed.size(); ++i) {
      CAPTURE(i);
      scans.put(killed[i]);
      const int phase = phase_of(scans.check_resumed());
      CHECK(phase >= before);
      phases.insert(before = phase);
    }
    CHECK(phases.contains(2));
    CHECK(before == 3);
    scans.clear();
    // The same where writing fails at a record, or somebody stops it, with other threads.
    for (int last = 0; last < 3; ++last) {
      CAPTURE(last);
      ConversionOptions options = scans.options;
      options.threads = 3;
      int left = last;
      options.journalled = [&left] {
        if (left-- == 0) throw ResourceError("the disk is full");
      };
      const bool failed = !conversion_refusal<ResourceError>(options).empty();
      CHECK((failed || last == 2));
      CHECK(fs::exists(options.output) != failed);
      if (failed) CHECK(phase_of(scans.check_resumed()) > last);
      scans.clear();
    }
    for (const char* stage : {"count", "distribute", "partition"}) {
      WatchedStage stopping(
          stage, [] {}, 2);
      CHECK_THROWS_AS(convert_scans(scans.resuming(), stopping), Interrupted);
    }
    CHECK(phase_of(scans.check_resumed()) == 3);
    scans.clear();
  }
}

TEST_CASE("points that their files do not hold any more are distributed again") {
  Resumed scans;
  scans.add_classed("a.las", 2300000);
  scans.expected();
  const FilesLeft left = scans.killed().back();
  const auto check = [&](int phase, const std::function<void(FilesLeft&)>& change) {
    FilesLeft changed = left;
    change(changed);
    scans.put(changed);
    CHECK(phase_of(scans.check_resumed()) == phase);
  };
  const std::string points = "a.h5.points-1";
  check(3, [](FilesLeft&) {});
  check(2, [&](FilesLeft& files) { files.erase(points); });
  check(2, [&](FilesLeft& files) { files[points].resize(files[points].size() - 5000); });
  check(2, [&](FilesLeft& files) {
    // As a file system may leave a file whose bytes were not on the disk when the system crashed.
    std::fill(files[points].begin() + 8192, files[points].begin() + 12288, '\0');
  });
  scans.clear();
  // While they wait, too.
  ConversionOptions options = scans.options;
  WatchedStage changing("partition", [&] {
    std::fstream file(scans.out() / points, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(1000003);
    file.put('!');
  });
  CHECK_THROWS_AS(convert_scans(options, changing), ResourceError);
  CHECK(phase_of(scans.check_resumed()) == 2);
}

TEST_CASE("a journal that is cut or damaged never leads to wrong bytes") {
  Resumed scans;
  scans.add_classed("a.las", 300, 2);
  scans.add("b.xyz", text_scan(20, 1));
  scans.expected();
  const FilesLeft last = scans.killed().back();
  const std::size_t journal_bytes = last.at("a.h5.journal").size();
  for (std::size_t bytes = 0; bytes < journal_bytes; bytes += bytes < 100 ? 3 : 599) {
    CAPTURE(bytes);
    FilesLeft cut = last;
    cut["a.h5.journal"].resize(bytes);
    scans.put(cut);
    scans.check_resumed();
  }
  int refused = 0;
  const auto check_damaged = [&](const FilesLeft& damaged) {
    scans.put(damaged);
    if (conversion_refusal(scans.resuming()).empty()) {
      check_same(bytes_of(scans.options.output), scans.expected());
    } else {
      ++refused;
      CHECK(!fs::exists(scans.options.output));
    }
  };
  const auto check_flipped = [&](const std::string& name, std::size_t at) {
    CAPTURE(name, at);
    FilesLeft damaged = last;
    damaged[name][at] = static_cast<char>(damaged[name][at] ^ 4);
    check_damaged(damaged);
  };
  for (std::size_t at = 0; at < journal_bytes; at += at < 100 ? 9 : 797) {
    check_flipped("a.h5.journal", at);
  }
  CHECK(refused < 5);  // only where it is no journal any more
  const char* points = "a.h5.points-1";
  for (std::size_t at = 8; at < last.at(points).size(); at += 2999) check_flipped(points, at);
  FilesLeft lost = last;
  lost.erase(points);
  check_damaged(lost);
  lost[points] = "";
  check_damaged(lost);
}

TEST_CASE("an unfinished conversion is refused by name where its inputs or options differ") {
  Resumed scans;
  scans.add_classed("a.las", 70000);
  scans.add_classed("b.las", 500);
  scans.expected();
  const std::vector<FilesLeft> killed = scans.killed();
  const FilesLeft left = killed.front();
  scans.put(left);
  const fs::path b = scans.folder / "b.las", c = scans.folder / "c.las";
  fs::copy_file(b, c);
  const auto check = [&](const std::string& words,
                         const std::function<void(ConversionOptions&)>& change) {
    ConversionOptions options = scans.resuming();
    change(options);
    check_says(conversion_refusal<UsageError>(options), words);
    CHECK(files_in(scans.out()) == left);  // nothing was lost
  };
  check("a.h5.journal: is the journal of an unfinished conversion; all points were counted",
        [](auto& options) { options.resume = false; });
  check("a.h5.journal: belongs to another conversion: its cell_points is 500, expected 501",
        [](auto& options) { options.cell_points = 501; });
  check("keep_withheld is no, expected yes", [](auto& options) { options.keep_withheld = true; });
  check("conversion: its input ... b.las is not given",
        [](auto& options) { options.inputs.pop_back(); });
  check("conversion: it has the same inputs in another order",
        [](auto& options) { std::swap(options.inputs[0], options.inputs[1]); });
  check("c.las is none of its inputs", [&](auto& options) { options.inputs.push_back(c); });
  check("its input ... b.las is not given; ... c.las is none of its inputs",
        [&](auto& options) { options.inputs[1] = c; });
  const auto as_before = [](ConversionOptions&) {};
  const std::string bytes = bytes_of(b);
  put_bytes(b, bytes + "more");
  check("b.las had " + std::to_string(bytes.size()) + " bytes when it began, and has " +
            std::to_string(bytes.size() + 4) + " now",
        as_before);
  put_bytes(b, bytes);
  fs::last_write_time(b, fs::last_write_time(b) - std::chrono::hours(24));
  check("b.las was last modified at ... UTC when it began, and at ... UTC now", as_before);

  scans.options.overwrite = true;
  scans.convert();
  scans.check_finished();
}

TEST_CASE("an unfinished conversion goes on with its inputs by other names of their folders") {
  Resumed scans;
  scans.add_classed("a.las", 70000);
  scans.add("b.xyz", "no point at all\n");
  scans.add("c.xyz", text_scan(3000, 2));
  scans.options.skip_unreadable = true;
  scans.expected();
  const std::vector<FilesLeft> killed = scans.killed();
  fs::create_directory_symlink(scans.folder / ".", scans.folder / "scans");
  const fs::path folder = scans.folder / "";
  const std::vector<fs::path> names{folder / ".", folder / "out" / "..", folder / "scans",
                                    fs::proximate(folder)};
  for (std::size_t i = 0; i < killed.size(); ++i) {
    CAPTURE(i);
    scans.put(killed[i]);
    for (fs::path& input : scans.options.inputs) input = names[i % names.size()] / input.filename();
    const ConversionReport report = convert_quietly(scans.resuming());
    CHECK(report.points == 73000);
    CHECK(phase_of(report) > 0);
  }
}

TEST_CASE("no other conversion takes the journal of one that runs") {
  Resumed scans;
  scans.add_classed("a.las", 140000);
  scans.expected();
  ConversionOptions running = scans.options;
  std::size_t records = 0;
  running.journalled = [&] {
    ++records;
    const FilesLeft before = files_in(scans.out());
    for (const bool overwrite : {true, false}) {
      ConversionOptions other = scans.options;
      other.overwrite = overwrite;
      other.resume = !overwrite;
      check_says(conversion_refusal<ResourceError>(other), "another process is writing it");
    }
    CHECK(files_in(scans.out()) == before);
  };
  convert_quietly(running);
  CHECK(records == 2);
  scans.check_finished();
}

TEST_CASE("files of a user beside the output stay, and so does what another conversion left") {
  Resumed scans;
  scans.add_classed("a.las", 70000);
  const std::string store = scans.expected();
  FilesLeft left = scans.killed().front();
  left["a.h5.points-1"] = "the notes of a user";
  scans.put(left);
  check_says(conversion_refusal<UsageError>(scans.resuming()),
             "a.h5.points-1: is where this output's temporary file has to be, and is another file");
  CHECK(files_in(scans.out()) == left);
  left["a.h5.points-1"] = "";  // a file that was only just made
  scans.put(left);
  scans.check_resumed();

  left["a.h5"] = store;
  scans.put(left);
  scans.options.cell_points = 600;
  check_says(conversion_refusal<UsageError>(scans.resuming()), "belongs to another conversion");
  left.erase("a.h5.points-1");  // has no bytes
  CHECK(files_in(scans.out()) == left);
}
