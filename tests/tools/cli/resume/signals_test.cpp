// Commands that are asked to stop, or killed, while they write.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

#include "support/catch.hpp"
#include "tools/cli/support/process.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using std::chrono::steady_clock;

namespace {

using Names = std::vector<std::string>;

/// A folder with a folder for outputs alone.
struct Place {
  Names files() const {
    Names names;
    for (const auto& entry : std::filesystem::directory_iterator(output.parent_path())) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  ScratchFolder folder;
  std::filesystem::path output =
      (std::filesystem::create_directory(folder / "out"), folder / "out" / "out.h5");
};

/// Asks the command to stop, later each time, until that happens while it works, and checks what it
/// leaves then.
void check_stopped(const Place& place, const std::string& command,
                   const std::function<void()>& check_left) {
  bool stopped = false;
  for (int delay = 20; delay < 2000 && !stopped; delay += 20) {
    Process process(command, place.folder / "log.txt");
    std::this_thread::sleep_for(std::chrono::milliseconds(delay));
    process.send(SIGTERM);
    const int code = process.wait();
    if (code == -SIGTERM) continue;  // the signal came before the handlers were installed
    stopped = code == 5;
    REQUIRE((stopped || code == 0));
    if (stopped) {
      check_says(process.log(), "interrupted ... the same command");
      check_left();
    }
    for (const std::string& file : place.files()) {
      std::filesystem::remove(place.output.parent_path() / file);
    }
  }
  CHECK(stopped);
}

}  // namespace

TEST_CASE("a conversion that is asked to stop leaves what it has finished, and goes on with it") {
  const Place place;
  const std::string hall = quoted(place.folder / "hall");
  require_success(run_program(place.folder, "scene hall --points 500000 -o " + hall));
  const std::string command = "convert " + quoted(place.folder / "hall/environment.las") +
                              " --cell-points 500 -o " + quoted(place.output) + " --resume";
  const std::string store = quoted(place.folder / "site.h5");
  require_success(run_program(
      place.folder, "convert " + quoted(place.folder / "hall/environment.las") + " -o " + store));
  check_stopped(place, command, [&] {
    for (const std::string& file : place.files()) check_says(file, "out.h5.");
    if (!place.files().empty()) {
      check_outcome(
          run_program(place.folder, "run --force --env " + store + " --model " + hall +
                                        "/model.ply --trajectory " + hall +
                                        "/trajectory.txt --radius 0.1 -o " + quoted(place.output)),
          2, "is the journal of an unfinished conversion");
    }
    require_success(run_program(place.folder, command));
    CHECK(place.files() == Names{"out.h5"});
  });
  check_outcome(run_program(place.folder, command), 0);
}

TEST_CASE("a scene that is asked to stop leaves nothing behind") {
  const Place place;
  check_stopped(place, "scene hall --points 3000000 -o " + quoted(place.output.parent_path()),
                [&] { CHECK(place.files().empty()); });
}

TEST_CASE("an export that is asked to stop, or killed, leaves nothing that looks finished") {
  const Place place;
  const std::size_t rows = 600'000;
  ResultHeader header = sample_header(true);
  header.environment_points = std::uint64_t{1} << 33;
  write_result(place.folder / "large.h5", header, sample_rows(header, rows));
  const std::filesystem::path csv = place.output.string() + ".csv";
  const std::string command = "export " + quoted(place.folder / "large.h5") + " -o " + quoted(csv);
  for (const int signal : {SIGTERM, SIGINT, SIGKILL}) {
    CAPTURE(signal);
    bool stopped = false;
    for (int delay = 10; delay < 2000 && !stopped; delay += 10) {
      Process process(command, place.folder / "log.txt");
      std::this_thread::sleep_for(std::chrono::milliseconds(delay));
      process.send(signal);
      const int code = process.wait();
      const Names files = place.files();
      if (code == 0) {
        CHECK(files == Names{"out.h5.csv"});
        std::filesystem::remove(csv);
      } else if (signal == SIGKILL) {
        REQUIRE(code == -SIGKILL);
        stopped = !files.empty();
        if (stopped) CHECK(files == Names{"out.h5.csv.partial"});
      } else if (code != -signal) {  // the handlers were installed already
        REQUIRE(code == 5);
        stopped = true;
        CHECK(files.empty());
        check_says(process.log(), "interrupted ... starts it again");
      }
    }
    CHECK(stopped);
  }
  check_outcome(run_program(place.folder, command), 0);
  CHECK(place.files() == Names{"out.h5.csv"});
}

TEST_CASE("what does not come to an end is given up within 5 seconds") {
  const Place place;
  const auto pipe = place.folder / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const int writer = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);  // never writes
  REQUIRE(writer >= 0);
  Process process("convert - -o " + quoted(place.output) + " <" + quoted(pipe),
                  place.folder / "log.txt");
  while (place.files().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // until the handlers are installed
  const auto begin = steady_clock::now();
  process.send(SIGTERM);
  CHECK(process.wait() == 5);
  CHECK(steady_clock::now() - begin < std::chrono::seconds(5));
  check_says(process.log(), "interrupted before");
  CHECK(place.files() == Names{"out.h5.partial"});
  ::close(writer);
}
