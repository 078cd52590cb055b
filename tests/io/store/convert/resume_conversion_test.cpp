// Conversions that are killed or stopped at any step, and go on.
#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <map>

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

/// Resumed, a folder for the store alone, and what the store is when nobody disturbs its making.
class Resumed {
 public:
  Resumed() { fs::create_directory(out()); }

  fs::path out() const { return folder_ / "out"; }
  fs::path path(const std::string& name) const { return folder_ / name; }

  void add_las(const std::string& name, std::size_t points, unsigned most_class = 0) {
    const std::vector<Quantum> cloud = plane_cloud(points, inputs_.size() + 1);
    write_classed(path(name), cloud, random_classes(points, most_class));
    inputs_.push_back(path(name));
  }
  /// at_one_place: how many of the points, the last ones, are at the same place.
  void add_ply(const std::string& name, std::size_t points, std::size_t at_one_place = 0) {
    std::vector<Vec3> positions;
    for (const Quantum& q : plane_cloud(points, inputs_.size() + 1)) {
      positions.push_back({q[0] / 64.0, q[1] / 64.0, q[2] / 64.0});
    }
    for (std::size_t i = 0; i < at_one_place; ++i) positions[points - 1 - i] = positions.front();
    write_ply(path(name), positions);
    inputs_.push_back(path(name));
  }
  void add_text(const std::string& name, std::size_t points) {
    std::string text;
    for (const Quantum& q : plane_cloud(points, inputs_.size() + 1)) {
      text += std::to_string(q[0]) + ".5 " + std::to_string(q[1]) + ".25 1.125\n";
    }
    folder_.write(name, text);
    inputs_.push_back(path(name));
  }

  /// Several scans, one after another.
  void add_e57(const std::string& name, std::size_t points) {
    constexpr std::size_t kScan = 12000, kPacket = 2000 * sizeof(double);
    E57Bytes file;
    const std::vector<Quantum> cloud = plane_cloud(points, inputs_.size() + 1);
    for (std::size_t first = 0; first < points; first += kScan) {
      std::array<std::vector<double>, 3> xyz;
      for (std::size_t i = first; i < std::min(points, first + kScan); ++i) {
        for (std::size_t k = 0; k < 3; ++k) xyz[k].push_back(cloud[i][k] / 64.0);
      }
      E57Bytes::Scan scan = e57_scan(xyz[0], xyz[1], xyz[2]);
      const std::size_t packets = divide_up(xyz[0].size() * sizeof(double), kPacket) - 1;
      scan.packets.assign(packets, {kPacket, kPacket, kPacket});
      file.scans.push_back(std::move(scan));
    }
    put_bytes(path(name), file.build());
    inputs_.push_back(path(name));
  }
  /// table: without one, the file is read from its first point on.
  void add_laz(const std::string& name, std::size_t points, LazBytes::Table table) {
    LazBytes file;
    file.table = table;
    file.chunks = {9000};
    file.las.scale = {0.01, 0.01, 0.01};
    for (const Quantum& q : plane_cloud(points, inputs_.size() + 1)) {
      file.points.push_back({.position = q});
    }
    put_bytes(path(name), file.build());
    inputs_.push_back(path(name));
  }

  ConversionOptions options() const {
    ConversionOptions options = conversion_of(inputs_, out() / "a.h5", 500);
    options.overwrite = false;
    options.threads = 1;
    options.counted_interval_seconds = 0;
    change(options);
    return options;
  }
  std::function<void(ConversionOptions&)> change = [](ConversionOptions&) {};

  const std::string& expected() {
    if (expected_.empty()) {
      convert_quietly(options());
      expected_ = bytes_of(out() / "a.h5");
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
    ConversionOptions resuming = options();
    resuming.resume = true;
    const ConversionReport report = convert_quietly(resuming);
    check_same(bytes_of(out() / "a.h5"), expected());
    CHECK(names_in(out()) == std::vector<std::string>{"a.h5"});
    return report;
  }

  /// The files that a process leaves that is killed after each `step`-th record of its journal.
  std::vector<FilesLeft> killed_at_records(std::size_t step, std::size_t first = 0) {
    std::vector<FilesLeft> found;
    std::size_t record = 0;
    ConversionOptions watched = options();
    watched.journalled = [&] {
      if (record >= first && (record - first) % step == 0) found.push_back(files_in(out()));
      ++record;
    };
    convert_quietly(watched);
    clear();
    return found;
  }

 private:
  ScratchFolder folder_;
  std::vector<fs::path> inputs_;
  std::string expected_;
};

/// Throws where asked to stop after a number of advances of a stage.
class StopsIn final : public Progress {
 public:
  StopsIn(std::string stage, int advances) : stage_(std::move(stage)), left_(advances) {}
  void begin(std::string_view stage, std::uint64_t, std::string_view) override {
    in_stage_ = stage == stage_;
  }
  void advance(std::uint64_t) override {
    if (in_stage_) --left_;
  }
  void end() override { in_stage_ = false; }
  bool stop_requested() const override { return left_ <= 0; }

 private:
  std::string stage_;
  bool in_stage_ = false;
  int left_;
};

struct ResumedRow {
  const char* name;
  std::function<void(Resumed&)> make;
  std::size_t step = 3;  ///< the process is killed at each step-th record
};

const std::vector<ResumedRow>& rows() {
  static const std::vector<ResumedRow> all{
      {"two LAS files with classes",
       [](Resumed& scans) {
         scans.add_las("a.las", 100000, 3);
         scans.add_las("b.las", 70000, 9);
       },
       1},
      {"PLY and text, whose scale is chosen",
       [](Resumed& scans) {
         scans.add_ply("a.ply", 90000);
         scans.add_text("b.xyz", 66000);
       }},
      {"many points at one place of the second file, of which the store warns",
       [](Resumed& scans) {
         scans.add_ply("a.ply", 70000);
         scans.add_ply("b.ply", 70000, 5000);
       }},
      {"E57 of several scans, and LAZ with a table of chunks and without one",
       [](Resumed& scans) {
         scans.add_e57("a.e57", 70000);
         scans.add_laz("b.laz", 40000, LazBytes::Table::kAtPoints);
         scans.add_laz("c.laz", 40000, LazBytes::Table::kNone);
       }},
      {"cubes near a path, with origins",
       [](Resumed& scans) {
         scans.add_las("a.las", 140000);
         put_bytes(scans.path("path.txt"),
                   "1 0 0 99.9 0 1 0 -200 0 0 1 0\n1 0 0 100 0 1 0 -200 0 0 1 0\n");
         put_bytes(scans.path("origins.csv"), "first,x,y,z\n0,1,2,3\n70000,4,5,6\n");
         const Resumed* of = &scans;
         scans.change = [of](ConversionOptions& options) {
           options.near = of->path("path.txt");
           options.within = 0.3;
           options.origins = of->path("origins.csv");
           options.regular_size = 0.2;
         };
       }},
  };
  return all;
}

}  // namespace

TEST_CASE("a conversion that is killed at any record of its journal goes on to the same bytes") {
  for (const ResumedRow& row : rows()) {
    const RowName name(row.name);
    Resumed scans;
    row.make(scans);
    scans.expected();
    const std::vector<FilesLeft> killed = scans.killed_at_records(row.step);
    CHECK(killed.size() > 12 / row.step);
    std::uint64_t taken_over = 0;
    for (std::size_t i = 0; i < killed.size(); ++i) {
      CAPTURE(i);
      scans.put(killed[i]);
      const ConversionReport report = scans.check_resumed();
      CHECK(report.resumed_points >= taken_over);
      CHECK(report.recounted_batches + report.repeated_batches <= 1);
      CHECK(report.repeated_buckets <= 1);
      taken_over = report.resumed_points;
    }
    CHECK(taken_over > 100000);
  }
}

TEST_CASE("a conversion whose writing fails at any record goes on, with other threads and memory") {
  for (const ResumedRow& row : rows()) {
    const RowName name(row.name);
    Resumed scans;
    row.make(scans);
    scans.expected();
    int failed = 0;
    for (int last = 0; last >= 0; last += 4) {
      CAPTURE(last);
      ConversionOptions options = scans.options();
      options.threads = 3;
      std::atomic<int> left = last;
      options.journalled = [&left] {
        if (left-- == 0) throw ResourceError("the disk is full");
      };
      try {
        convert_quietly(options);
        last = -100;
      } catch (const ResourceError&) {
        ++failed;
        CHECK(!fs::exists(scans.out() / "a.h5"));
        const ConversionReport report = scans.check_resumed();
        CHECK(report.repeated_batches <= 3);
      }
      scans.clear();
    }
    CHECK(failed > 4);
  }
}

TEST_CASE("buckets that were written are copied, also by a resumption that is stopped itself") {
  Resumed scans;
  scans.add_las("a.las", 2300000);
  scans.expected();
  ConversionOptions options = scans.options();
  options.counted_interval_seconds = 1e9;
  std::vector<FilesLeft> killed;
  options.journalled = [&] {
    const bool is_writing = fs::file_size(scans.out() / "a.h5.partial") > 100000;
    if (is_writing) killed.push_back(files_in(scans.out()));
  };
  convert_quietly(options);
  scans.clear();
  std::uint64_t copied = 0;
  for (const FilesLeft& files : killed) {
    scans.put(files);
    for (const int advances : {1, 700}) {
      ConversionOptions resuming = scans.options();
      resuming.resume = true;
      StopsIn progress("partition", advances);
      CHECK_THROWS_AS(convert_scans(resuming, progress), Interrupted);
      CHECK(names_in(scans.out()).size() >= 2);
    }
    const ConversionReport report = scans.check_resumed();
    CHECK(report.resumed_points == 2300000);
    CHECK(report.repeated_buckets <= 2);
    copied = std::max(copied, report.resumed_cells);
    scans.clear();
  }
  CHECK(killed.size() >= 3);
  CHECK(copied > 2000);
  // Once all buckets are written their points are removed, before the store is complete.
  FilesLeft without_points = killed.back();
  CHECK(std::erase_if(without_points, [](const auto& file) {
          return file.first.find(".points") != std::string::npos;
        }) > 0);
  scans.put(without_points);
  CHECK(scans.check_resumed().resumed_cells == copied);
}

TEST_CASE("a journal that is cut or damaged never leads to wrong bytes") {
  Resumed scans;
  scans.add_las("a.las", 300, 2);
  scans.add_text("b.xyz", 20);
  scans.expected();
  const std::vector<FilesLeft> killed = scans.killed_at_records(1);
  const FilesLeft& last = killed.back();
  const std::string journal = last.at("a.h5.journal");
  for (std::size_t bytes = 0; bytes < journal.size(); bytes += bytes < 100 ? 3 : 599) {
    CAPTURE(bytes);
    FilesLeft cut = last;
    cut["a.h5.journal"].resize(bytes);
    scans.put(cut);
    scans.check_resumed();
  }
  int refused = 0;
  const auto check_damaged = [&](const FilesLeft& damaged) {
    scans.put(damaged);
    ConversionOptions resuming = scans.options();
    resuming.resume = true;
    try {
      convert_quietly(resuming);
      check_same(bytes_of(scans.out() / "a.h5"), scans.expected());
    } catch (const Error&) {
      ++refused;
      CHECK(!fs::exists(scans.out() / "a.h5"));
    }
  };
  for (std::size_t at = 0; at < journal.size(); at += at < 100 ? 9 : 797) {
    CAPTURE(at);
    FilesLeft damaged = last;
    damaged["a.h5.journal"][at] = static_cast<char>(damaged["a.h5.journal"][at] ^ 4);
    check_damaged(damaged);
  }
  CHECK(refused < 5);  // only where it is no journal any more
  for (const char* name : {"a.h5.points-1", "a.h5.partial"}) {
    CAPTURE(name);
    for (std::size_t at = 8; at < last.at(name).size(); at += 2999) {
      CAPTURE(at);
      FilesLeft damaged = last;
      damaged[name][at] = static_cast<char>(damaged[name][at] ^ 4);
      check_damaged(damaged);
    }
    FilesLeft lost = last;
    lost.erase(name);
    check_damaged(lost);
    lost[name] = "";
    check_damaged(lost);
  }
}

TEST_CASE("an unfinished conversion is refused by name where its inputs or options differ") {
  Resumed scans;
  scans.add_las("a.las", 70000);
  scans.add_las("b.las", 500);
  scans.expected();
  const std::vector<FilesLeft> killed = scans.killed_at_records(1);
  FilesLeft before = killed[killed.size() / 2];
  const auto refusal = [&](const std::function<void(ConversionOptions&)>& change) {
    scans.put(before);
    ConversionOptions options = scans.options();
    options.resume = true;
    change(options);
    const std::string said = conversion_refusal<UsageError>(options);
    CHECK(files_in(scans.out()) == before);  // nothing was lost
    return said;
  };
  const auto says = [&](const char* words, const std::function<void(ConversionOptions&)>& change) {
    check_says(refusal(change), words);
  };
  const FilesLeft left = before;
  for (const auto& [name, bytes] : left) {
    if (!name.starts_with("a.h5.points-")) continue;
    before[name] = "the notes of a user";
    says("a.h5.points-1: is where this output's temporary file has to be, and is another file",
         [](ConversionOptions&) {});
    before[name] = "";  // a file that was only just made
    scans.put(before);
    scans.check_resumed();
  }
  before = left;
  says("a.h5.journal: is the journal of an unfinished conversion; all points were counted",
       [](ConversionOptions& options) { options.resume = false; });
  says("a.h5.journal: belongs to another conversion: its cell_points is 500, expected 501",
       [](ConversionOptions& options) { options.cell_points = 501; });
  says("keep_withheld is no, expected yes",
       [](ConversionOptions& options) { options.keep_withheld = true; });
  says("conversion: its input ... b.las is not given",
       [](ConversionOptions& options) { options.inputs.pop_back(); });
  says("conversion: it has the same inputs in another order",
       [](ConversionOptions& options) { std::swap(options.inputs[0], options.inputs[1]); });
  const fs::path third = scans.path("c.las");
  fs::copy_file(scans.path("b.las"), third);
  says("c.las is none of its inputs",
       [&](ConversionOptions& options) { options.inputs.push_back(third); });
  says("its input ... b.las is not given; ... c.las is none of its inputs",
       [&](ConversionOptions& options) { options.inputs[1] = third; });
  const fs::path changed = scans.path("b.las");
  const std::string bytes = bytes_of(changed);
  put_bytes(changed, bytes + "more");
  says(("b.las had " + std::to_string(bytes.size()) + " bytes when it began, and has " +
        std::to_string(bytes.size() + 4) + " now")
           .c_str(),
       [](ConversionOptions&) {});
  put_bytes(changed, bytes);
  fs::last_write_time(changed, fs::last_write_time(changed) - std::chrono::hours(24));
  says("b.las was last modified at ... UTC when it began, and at ... UTC now",
       [](ConversionOptions&) {});

  scans.put(before);
  ConversionOptions afresh = scans.options();
  afresh.overwrite = true;
  convert_quietly(afresh);
  check_same(bytes_of(scans.out() / "a.h5"), scans.expected());
  CHECK(names_in(scans.out()) == std::vector<std::string>{"a.h5"});
}

TEST_CASE("an unfinished conversion goes on with its inputs by other names of their folders") {
  Resumed scans;
  scans.add_las("a.las", 70000);
  scans.add_text("b.xyz", 3000);
  put_bytes(scans.path("c.xyz"), "no point at all\n");
  scans.change = [&](ConversionOptions& options) {
    options.inputs.insert(options.inputs.begin() + 1, scans.path("c.xyz"));
    options.skip_unreadable = true;
  };
  scans.expected();
  const std::vector<FilesLeft> killed = scans.killed_at_records(1);
  fs::create_directory_symlink(scans.path("."), scans.path("scans"));
  const auto usual = scans.change;
  const fs::path folder = scans.path("");
  const std::vector<fs::path> names{folder / ".", folder / "out" / "..", folder / "scans",
                                    fs::proximate(folder)};
  for (std::size_t i = 0; i < killed.size(); ++i) {
    CAPTURE(i);
    scans.put(killed[i]);
    scans.change = [&](ConversionOptions& options) {
      usual(options);
      for (fs::path& input : options.inputs) input = names[i % names.size()] / input.filename();
    };
    ConversionOptions resuming = scans.options();
    resuming.resume = true;
    const ConversionReport report = convert_quietly(resuming);
    CHECK(report.points == 73000);
    if (i + 1 == killed.size()) CHECK(report.resumed_points > 0);
  }
}

TEST_CASE("no other conversion takes the journal of one that runs") {
  Resumed scans;
  scans.add_las("a.las", 140000);
  scans.expected();
  ConversionOptions running = scans.options();
  std::size_t records = 0;
  running.journalled = [&] {
    if (++records % 4 != 0) return;
    const FilesLeft before = files_in(scans.out());
    for (const bool overwrite : {true, false}) {
      ConversionOptions other = scans.options();
      other.overwrite = overwrite;
      other.resume = !overwrite;
      check_says(conversion_refusal<ResourceError>(other), "another process is writing it");
    }
    CHECK(files_in(scans.out()) == before);
  };
  convert_quietly(running);
  CHECK(records > 8);
  check_same(bytes_of(scans.out() / "a.h5"), scans.expected());
  CHECK(names_in(scans.out()) == std::vector<std::string>{"a.h5"});
}

TEST_CASE("files of a user beside the output stay, and so does what another conversion left") {
  Resumed scans;
  scans.add_las("a.las", 70000);
  const std::string store = scans.expected();
  scans.put({{"a.h5.written", "the notes of a user"}});
  check_says(conversion_refusal<UsageError>(scans.options()), "a.h5.written: is where");
  CHECK(names_in(scans.out()) == std::vector<std::string>{"a.h5.written"});

  scans.clear();
  FilesLeft other = scans.killed_at_records(20, 6).front();
  other["a.h5"] = store;
  scans.put(other);
  ConversionOptions resuming = scans.options();
  resuming.resume = true;
  const auto cells = scans.change;
  scans.change = [](ConversionOptions& options) { options.cell_points = 600; };
  ConversionOptions others = scans.options();
  others.resume = true;
  check_says(conversion_refusal<UsageError>(others), "belongs to another conversion");
  scans.change = cells;
  CHECK(files_in(scans.out()) == other);
}
