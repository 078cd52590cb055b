// Disks that are really full or read-only: exit code 4, the file named, nothing that looks
// finished, and finished work is used once there is room.
#include "io/result/journal.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/hall.hpp"
#include "tools/cli/support/small_disk.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Names = std::vector<std::string>;
namespace fs = std::filesystem;

constexpr std::uint64_t kPage = 4096;
constexpr std::uint64_t kRoom = 64 << 20;

/// Whether disks can be made here; prints where not.
bool disks_can_be_made() {
  if (may_mount()) return true;
  WARN("not tested: this user may not mount file systems here");
  return false;
}

const Hall& hall_of_small_cells() {
  const Hall& hall = Hall::get();
  const ScratchFolder log;
  if (!fs::exists(hall.path("small_cells.h5")) &&
      run_program(log, "convert " + hall / "environment.las" + " --cell-points 256 -o " +
                           hall / "small_cells.h5")
              .exit_code != 0) {
    throw std::runtime_error("no store");
  }
  return hall;
}

struct Place : Workplace {
  /// The command line of a run in the hall in which every cell leaves some bytes in the journal.
  std::string search(const std::string& engine, const fs::path& output) const {
    return "run --env " + hall / "small_cells.h5" + " --model " + hall / "model.ply" +
           " --trajectory " + hall / "trajectory.txt" +
           " --radius 0.1 --threads 2 --device cpu --engine " + engine + " -o " + quoted(output);
  }

  const Hall& hall = hall_of_small_cells();
};

void check_failed(const Outcome& outcome, const SmallDisk& disk) {
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 4);
  CHECK(outcome.out.empty());
  check_says(outcome.err, disk.path().string());
}

}  // namespace

TEST_CASE("a run on a disk that is full goes on once there is room") {
  if (!disks_can_be_made()) return;
  const Place place;
  const std::string engine = GENERATE("sweep", "grid", "kdtree");
  CAPTURE(engine);
  require_success(place.run(place.search(engine, place.folder / "expected.h5")));
  const std::string expected = bytes_of(place.folder / "expected.h5");
  bool done = false;
  int with_journal = 0, without_room_for_the_result = 0, names_missing = 0;
  for (std::uint64_t bytes = kPage; !done; bytes += bytes < 8 * kPage ? kPage : bytes / 2) {
    SmallDisk disk(bytes);
    const fs::path output = disk / "out.h5";
    CAPTURE(bytes);
    const Outcome outcome = place.run(place.search(engine, output));
    done = outcome.exit_code == 0;
    if (done) {
      CHECK(disk.files() == Names{"out.h5"});
      continue;
    }
    check_failed(outcome, disk);
    without_room_for_the_result += outcome.err.find("out.h5.journal") == std::string::npos;
    names_missing += outcome.err.find(" of which are missing: ") != std::string::npos;
    if (!disk.files().empty()) {
      REQUIRE(disk.files() == Names{"out.h5.journal"});
      with_journal += JournalReader(journal_of(output)).records() > 0;
      check_failed(place.run(place.search(engine, output) + " --resume"), disk);  // still full
    }
    disk.resize(kRoom);
    require_success(place.run(place.search(engine, output) + " --resume"));
    check_same(bytes_of(output), expected);
    CHECK(disk.files() == Names{"out.h5"});
  }
  CHECK(with_journal > 0);
  CHECK(without_room_for_the_result > 0);
  CHECK(names_missing > 0);
}

TEST_CASE("a conversion on a full disk goes on with room, and an export begins again") {
  if (!disks_can_be_made()) return;
  const Place place;
  require_success(place.run(place.search("sweep", place.folder / "made.h5")));
  const std::string made = quoted(place.folder / "made.h5");
  const std::vector<std::pair<std::string, std::string>> commands{
      {"convert " + place.hall / "environment.las", "out.h5"},
      {"export " + made, "out.las"},
      {"export " + made, "out.csv"},
      {"export " + made, "out.ply"}};
  for (const auto& [command, name] : commands) {
    const std::string to_expected = command + " -o " + quoted(place.folder / ("expected" + name));
    require_success(place.run(to_expected));
    const std::string expected = bytes_of(place.folder / ("expected" + name));
    int failed = 0;
    bool done = false;
    for (std::uint64_t bytes = kPage; !done; bytes *= 2) {
      SmallDisk disk(bytes);
      const std::string to_disk = command + " -o " + quoted(disk / name);
      CAPTURE(to_disk, bytes);
      const Outcome outcome = place.run(to_disk);
      done = outcome.exit_code == 0;
      if (done) continue;
      ++failed;
      check_failed(outcome, disk);
      const bool leaves = command.starts_with("convert") && !disk.files().empty();
      CHECK((leaves || disk.files().empty()));
      disk.resize(kRoom);
      require_success(place.run(to_disk + (leaves ? " --resume" : "")));
      CHECK(disk.files() == Names{name});
      check_same(bytes_of(disk / name), expected);
    }
    CHECK(failed > 2);
  }
}

TEST_CASE("a read-only disk: inputs are read from it, outputs are refused at once") {
  if (!disks_can_be_made()) return;
  const Place place;
  SmallDisk disk(kRoom);
  require_success(place.run(place.search("sweep", disk / "made.h5")));
  for (const char* name : {"environment.las", "model.ply", "trajectory.txt", "site.h5"}) {
    fs::copy_file(place.hall.path(name), disk / name);
  }
  {
    JournalWriter writer = JournalWriter::create(disk / "out.h5.journal", {{"radius", "1"}}, 1e9);
    JournalRecord record;
    record.put(std::uint8_t{2});  // points of a profile
    record.put_count(0);
    writer.append(record);
  }
  const Names before = disk.files();
  const std::string bytes = bytes_of(disk / "made.h5");
  const auto path = [&](const std::string& name) { return quoted(disk / name); };
  disk.make_read_only(kRoom);
  const std::string search = "run --env " + path("site.h5") + " --model " + path("model.ply") +
                             " --trajectory " + path("trajectory.txt") + " --radius 0.1 -o ";
  place.check({
      {"convert " + path("environment.las") + " -o " + quoted(place.folder / "a.h5"), 0},
      {search + quoted(place.folder / "b.h5"), 0},
      {"export " + path("made.h5") + " -o " + quoted(place.folder / "c.csv"), 0},
  });
  for (const std::string command : {"verify ", "info "}) {
    for (const std::string name : {"site.h5", "made.h5", "out.h5.journal"}) {
      check_outcome(place.run(command + path(name)), 0);
    }
  }
  for (const std::string options : {"", " --resume", " --force"}) {
    check_failed(place.run(search + path("out.h5") + options), disk);
  }
  check_failed(place.run(search + path("made.h5") + " --force"), disk);
  check_failed(place.run("convert " + path("environment.las") + " -o " + path("new.h5")), disk);
  check_failed(place.run("export " + path("made.h5") + " -o " + path("new.csv")), disk);
  CHECK(disk.files() == before);
  check_same(bytes_of(disk / "made.h5"), bytes);
}

TEST_CASE("check names the folder as the place for another disk") {
  if (!disks_can_be_made()) return;
  const Place place;
  const SmallDisk disk(40 * kPage);
  const Outcome full =
      place.run("check " + place.hall / "environment.las" + " --model " + place.hall / "model.ply" +
                " --trajectory " + place.hall / "trajectory.txt" + " --radius 0.1 -o " +
                quoted(disk / "site"));
  check_failed(full, disk);
  check_says(full.err, "give -o a folder on a disk with more");
}
