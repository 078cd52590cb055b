// Disks that fill or fail, calls that do less than asked, files that shrink: exit code 4, the file
// named, and nothing that looks finished.
#include <unistd.h>

#include <algorithm>

#include "support/catch.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

namespace fs = std::filesystem;

/// A folder of inputs from the hall, and of outputs of commands.
struct Site {
  Site() {
    fs::create_directory(folder / "files");
    for (const char* name : {"environment.las", "model.ply", "trajectory.txt", "site.h5"}) {
      restore(name);
    }
    const Outcome made = run_program(folder, search() + " --first-pose -o " + path("made.h5"));
    if (made.exit_code != 0) throw std::runtime_error("no result");
  }

  void restore(const char* name) const {
    fs::copy_file(hall.path(name), file(name), fs::copy_options::overwrite_existing);
  }
  fs::path file(const std::string& name) const { return folder / "files" / name; }
  std::string path(const std::string& name) const { return quoted(file(name)); }
  std::string search() const {
    return "run --env " + path("site.h5") + " --model " + path("model.ply") + " --trajectory " +
           path("trajectory.txt") + " --radius 0.1 --threads 2";
  }

  /// Runs the program while calls go wrong (faulty_calls.cpp); `went_wrong` tells whether one did.
  /// except: a file whose calls go right, for kind "shrink".
  Outcome run(const std::string& arguments, const char* kind, int call, bool& went_wrong,
              const std::string& except = "") const {
    const auto mark = folder / "mark";
    fs::remove(mark);
    ::setenv("LD_PRELOAD", FAULTY_CALLS, 1);
    ::setenv("FAULT_FOLDER", (folder / "files/").c_str(), 1);
    ::setenv("FAULT_KIND", kind, 1);
    ::setenv("FAULT_EXCEPT", except.c_str(), 1);
    ::setenv("FAULT_CALL", std::to_string(call).c_str(), 1);
    ::setenv("FAULT_MARK", mark.c_str(), 1);
    const Outcome outcome = run_program(folder, arguments);
    ::unsetenv("LD_PRELOAD");
    went_wrong = fs::exists(mark);
    return outcome;
  }

  const Hall& hall = Hall::small();
  ScratchFolder folder;
};

struct Command {
  std::string name, arguments, output;
  bool reads_again = false;  ///< reads a result again after an error, so that it may succeed
};

std::vector<Command> commands(const Site& site) {
  const auto to = [&](const std::string& name) { return " -o " + site.path(name); };
  return {
      {"convert",
       "convert " + site.path("environment.las") + " --force --cell-points 4096 --threads 2" +
           to("out.h5"),
       "out.h5"},
      {"convert text", "convert " + site.path("scan.xyz") + " --force --threads 2" + to("text.h5"),
       "text.h5"},
      {"sweep", site.search() + " --force --first-pose" + to("sweep.h5"), "sweep.h5"},
      {"kdtree", site.search() + " --force --engine kdtree" + to("kdtree.h5"), "kdtree.h5"},
      {"grid", site.search() + " --force --engine grid --device cpu" + to("grid.h5"), "grid.h5"},
      {"thin",
       "trajectory thin " + site.path("trajectory.txt") + " --model " + site.path("model.ply") +
           " --max-motion 0.01" + to("thin.txt"),
       "thin.txt"},
      {"export las", "export " + site.path("made.h5") + to("out.las"), "out.las", true},
      {"export csv", "export " + site.path("made.h5") + to("out.csv"), "out.csv", true}};
}

/// Writes a scan as text, so that readers of lines are among the commands.
void write_text(const Site& site) {
  std::string text;
  for (int i = 0; i < 4000; ++i) text += std::to_string(i % 50) + " " + std::to_string(i) + " 1\n";
  put_bytes(site.file("scan.xyz"), text);
}

/// The number of files in a folder without journals and what lies beside them, with which a stopped
/// run or conversion goes on.
std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::count_if(fs::directory_iterator(folder), {}, [](const fs::directory_entry& entry) {
        return !fs::exists(fs::path(entry.path()).replace_extension(".journal"));
      }));
}

}  // namespace

TEST_CASE("every call that fails in turn ends with exit code 4 and without an output") {
  const Site site;
  write_text(site);
  for (const Command& command : commands(site)) {
    require_success(run_program(site.folder, command.arguments));
    const std::string expected = bytes_of(site.file(command.output));
    fs::remove(site.file(command.output));
    const std::size_t files = files_in(site.folder / "files");
    int call = 1;
    for (;; ++call) {
      bool went_wrong = false;
      const Outcome outcome = site.run(command.arguments, "fail", call, went_wrong);
      if (!went_wrong) {
        check_outcome(outcome, 0);
        break;
      }
      INFO(command.name << ", call " << call << ": " << outcome.err);
      if (command.reads_again && outcome.exit_code == 0) {
        check_same(bytes_of(site.file(command.output)), expected);
        fs::remove(site.file(command.output));
        continue;
      }
      REQUIRE(outcome.exit_code == 4);
      check_says(outcome.err, (site.folder / "files").string());
      CHECK(outcome.out.empty());
      // A failed fsync of the folder is reported although the output already has its name.
      fs::remove(site.file(command.output));
      CHECK(files_in(site.folder / "files") == files);
    }
    INFO(command.name);
    CHECK(call > 4);
  }
}

TEST_CASE("a command that gets no threads says so, or does without them") {
  const Site site;
  write_text(site);
  std::string poses = path_along_x(40'000, 0.01);
  put_bytes(site.file("long.txt"), poses);
  put_bytes(site.file("vehicle.json"),
            R"({"bodies": [{"name": "a", "model": "model.ply", "pivots": [0.1, -0.1]}]})");
  const std::string question =
      " --trajectory " + site.path("trajectory.txt") + " --model " + site.path("model.ply");
  const std::string made = site.path("made.h5"), env = " --env " + site.path("site.h5");
  const std::string to_csv = " --force -o " + site.path("out.csv");
  std::vector<std::string> lines;
  for (const Command& command : commands(site)) lines.push_back(command.arguments + " --force");
  for (const std::string& line :
       {"conflicts " + made + question + to_csv,
        "stations " + made + " --trajectory " + site.path("trajectory.txt") + to_csv,
        "shift " + made + env + question + " --lateral -0.1,0.1" + to_csv,
        "report " + made + env + question + " --force -o " + site.path("out.html"),
        "run" + env + " --trajectory " + site.path("trajectory.txt") + " --vehicle " +
            site.path("vehicle.json") + " --radius 0.1 --force -o " + site.path("vehicle.h5"),
        "section find" + env + " --trajectory " + site.path("trajectory.txt") +
            " --x-range=-1,1 --window=-2,2,0,3 --force -o " + site.path("section.h5"),
        "trajectory follow " + site.path("trajectory.txt") + " --pivots 0.1,-0.1 --force -o " +
            site.path("out.txt"),
        "trajectory info " + site.path("long.txt"), "verify " + made,
        "compare " + made + " " + made, "info " + made, "verify " + site.path("site.h5")}) {
    lines.push_back(line);
  }
  std::size_t refused = 0;
  for (const std::string& line : lines) {
    // All threads fail, or the first one does. Where a later one fails, the check before has
    // passed, and oneTBB ends the process.
    for (const int call : {0, 1}) {
      bool went_wrong = false;
      const Outcome outcome = site.run(line, "thread", call, went_wrong);
      INFO(line << ", thread " << call << ": " << outcome.err);
      REQUIRE((outcome.exit_code == 0 || outcome.exit_code == 4));
      if (outcome.exit_code == 0) continue;
      ++refused;
      check_says(outcome.err, "threads cannot be started");
    }
  }
  CHECK(refused > lines.size() / 2);
}

TEST_CASE("short and interrupted calls change nothing") {
  const Site site;
  write_text(site);
  const std::string kind = GENERATE("short", "interrupt");
  for (const Command& command : commands(site)) {
    INFO(kind << ", " << command.name);
    require_success(run_program(site.folder, command.arguments));
    const std::string expected = bytes_of(site.file(command.output));
    fs::remove(site.file(command.output));
    bool went_wrong = false;
    const Outcome outcome = site.run(command.arguments, kind.c_str(), 0, went_wrong);
    INFO(outcome.err);
    CHECK(went_wrong);
    require_success(outcome);
    check_same(bytes_of(site.file(command.output)), expected);
  }
}

TEST_CASE("an input that shrinks while it is read is noticed") {
  const Site site;
  write_text(site);
  const std::string made = bytes_of(site.file("made.h5"));
  for (const Command& command : commands(site)) {
    require_success(run_program(site.folder, command.arguments));
    const std::string expected = bytes_of(site.file(command.output));
    fs::remove(site.file(command.output));
    int call = 1;
    for (bool went_wrong = true; went_wrong; ++call) {
      const Outcome outcome = site.run(command.arguments, "shrink", call, went_wrong,
                                       site.file(command.output).string());
      INFO(command.name << ", call " << call << ": " << outcome.err);
      const bool finished = outcome.exit_code == 0;  // what was cut off was read before
      CHECK(fs::exists(site.file(command.output)) == finished);
      if (finished) {
        check_same(bytes_of(site.file(command.output)), expected);
        fs::remove(site.file(command.output));
      } else {
        // Exit code 3 occurs where HDF5 no longer finds its metadata.
        CHECK((outcome.exit_code == 4 || outcome.exit_code == 3));
        check_says(outcome.err, (site.folder / "files").string());
      }
      for (const char* name : {"environment.las", "model.ply", "trajectory.txt", "site.h5"}) {
        site.restore(name);
      }
      write_text(site);
      put_bytes(site.file("made.h5"), made);
    }
    CHECK(call > 4);
  }
}
