// What a process of the program may find at its start: standard descriptors, limits, and files that
// are not what their names say.
#include <sys/stat.h>

#include <fstream>
#include <string_view>

#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Hall {
  Hall() {
    require_success(run("scene hall --points 5000 --model-points 200 --poses 50 -o " + path("")));
    require_success(run("convert " + path("environment.las") + " -o " + path("site.h5")));
    require_success(run(query() + "-o " + path("expected.h5")));
    expected = bytes_of(folder / "expected.h5");
  }

  Outcome run(const std::string& arguments) const { return run_program(folder, arguments); }
  std::string path(const std::string& name) const { return quoted(folder / name); }
  std::string query(const std::string& store = "site.h5") const {
    return "run --env " + path(store) + " --model " + path("model.ply") + " --trajectory " +
           path("trajectory.txt") + " --radius 0.1 ";
  }
  /// The exit code of the program in a shell that sets its surroundings; "{}" stands for the
  /// program.
  int shell(std::string command) const {
    command.replace(command.find("{}"), 2, std::string("'") + CLEARWAY_PROGRAM + "'");
    const int status =
        std::system(("exec 2>'" + (folder / "stderr.txt").string() + "'; " + command).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string messages() const { return bytes_of(folder / "stderr.txt"); }

  ScratchFolder folder;
  std::string expected;
};

}  // namespace

TEST_CASE("closed standard descriptors do not become an output's") {
  const Hall hall;
  const auto out = hall.folder / "out.h5";
  for (const std::string closed : {"<&- 2>&-", "<&- >&- 2>&-", ">&- 2>&-", "2>&-"}) {
    CAPTURE(closed);
    const bool prints = std::string_view(closed).find(">&- ") == std::string_view::npos;
    for (const std::string engine : {"kdtree", "sweep"}) {
      CHECK(hall.shell("{} " + hall.query() + "--device cpu --force --engine " + engine + " -o " +
                       quoted(out) + " " + closed) == (prints ? 0 : 4));
      check_same(bytes_of(out), hall.expected);
      std::filesystem::remove(out);
    }
    const std::string scene = quoted(hall.folder / "again");
    CHECK(hall.shell("{} scene hall --points 5000 --model-points 200 --poses 50 --force -o " +
                     scene + " " + closed) == 0);
    for (const char* file : {"model.ply", "trajectory.txt", "environment.las"}) {
      check_same(bytes_of(hall.folder / "again" / file), bytes_of(hall.folder / file));
    }
  }
}

TEST_CASE("a small stack is enough") {
  const Hall hall;
  std::ofstream(hall.folder / "car.off") << "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                                            "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  for (const std::string model : {"model.ply", "car.off"}) {
    CAPTURE(model);
    CHECK(hall.shell("ulimit -s 192; {} check " + hall.path("environment.las") + " --model " +
                     hall.path(model) + " --trajectory " + hall.path("trajectory.txt") +
                     " --radius 0.1 -o " + hall.path(model + ".d") + " >/dev/null") == 0);
  }
}

TEST_CASE("what cannot be printed is an error, and the output is whole") {
  const Hall hall;
  const auto out = hall.folder / "out.h5";
  for (const std::string nowhere : {">&-", ">/dev/full", "| true"}) {
    CAPTURE(nowhere);
    hall.shell("({} " + hall.query() + "--force --json -o " + quoted(out) + "; echo $? >" +
               hall.path("code.txt") + ") " + nowhere);
    check_same(bytes_of(hall.folder / "code.txt"), "4\n");
    check_says(hall.messages(), "standard output: cannot write");
    check_same(bytes_of(out), hall.expected);
  }
  put_bytes(hall.folder / "campaign.json",
            R"({"name": "a", "environments": {"h": "site.h5"}, "vehicles": {"m": "model.ply"},)"
            R"("routes": {"r": "trajectory.txt"}, "radii": [0.1]})");
  require_success(hall.run(hall.query() + "--first-pose -o " + hall.path("first.h5")));
  const std::string made = hall.path("first.h5"), site = hall.path("site.h5");
  const std::string path = hall.path("trajectory.txt"), model = hall.path("model.ply");
  const std::string campaign = hall.path("campaign");
  REQUIRE(hall.shell("{} campaign plan " + hall.path("campaign.json") + " -o " + campaign) == 0);
  for (const std::string& line :
       {std::string("--version"),
        std::string("--help"),
        std::string("run --help"),
        std::string("campaign run --help"),
        "info " + site,
        "info --json " + site,
        "info " + made,
        "info " + path,
        "info " + model,
        "verify " + site,
        "verify --json " + made,
        "compare " + made + " " + made,
        "compare --json " + made + " " + made,
        "model " + model,
        "model --json " + model,
        "trajectory info " + path,
        "trajectory info --json " + path,
        "conflicts " + made + " --trajectory " + path,
        "conflicts --json " + made + " --trajectory " + path,
        "stations " + made + " --trajectory " + path,
        hall.query() + "--force -o " + hall.path("out.h5"),
        "campaign status " + campaign,
        "campaign status --json " + campaign,
        "campaign status --missing " + campaign,
        "campaign plan " + hall.path("campaign.json") + " -o " + campaign}) {
    CAPTURE(line);
    CHECK(hall.shell("{} " + line + " >/dev/full") == 4);
    check_says(hall.messages(), "standard output: cannot write");
  }
  CHECK(hall.shell("{} scene hall --environment - --points 500 --model-points 20 --poses 5 -o " +
                   quoted(hall.folder / "piped") + " >&-") == 4);
  CHECK_FALSE(std::filesystem::exists(hall.folder / "piped/model.ply"));
}

TEST_CASE("a pipe instead of a store, a result or a journal is refused at once") {
  const Hall hall;
  REQUIRE(::mkfifo((hall.folder / "pipe").c_str(), 0600) == 0);
  const std::string pipe = hall.path("pipe");
  for (const std::string& arguments :
       {"verify " + pipe, "info " + pipe, "export " + pipe + " -o " + hall.path("x.csv"),
        "compare " + pipe + " " + hall.path("expected.h5"),
        hall.query("pipe") + "-o " + hall.path("x.h5")}) {
    CAPTURE(arguments);
    check_outcome(hall.run(arguments), 4, "pipe: is a directory, pipe or device");
  }
}

TEST_CASE("a file with another name in the place of a temporary file or journal is left alone") {
  const Hall hall;
  for (const char* place : {"out.h5.partial", "out.h5.journal"}) {
    CAPTURE(place);
    put_bytes(hall.folder / "kept.txt", "");
    std::filesystem::create_hard_link(hall.folder / "kept.txt", hall.folder / place);
    for (const std::string options : {"", "--force ", "--resume "}) {
      check_outcome(hall.run(hall.query() + options + "-o " + hall.path("out.h5")), 2,
                    "move it away");
    }
    CHECK(std::filesystem::exists(hall.folder / place));
    CHECK(std::filesystem::is_empty(hall.folder / "kept.txt"));
    std::filesystem::remove(hall.folder / place);
  }
}

#ifndef CLEARWAY_SANITIZED  // a sanitizer needs more address space
TEST_CASE("more threads than there may be are refused") {
  const Hall hall;
  for (const std::string engine : {"kdtree", "sweep"}) {
    CAPTURE(engine);
    CHECK(hall.shell("ulimit -v 3000000; {} " + hall.query() +
                     "--device cpu --threads 1024 --memory 8G --engine " + engine + " -o " +
                     hall.path("out.h5")) == 4);
    check_says(hall.messages(), "1024 threads cannot be started");
    CHECK_FALSE(std::filesystem::exists(hall.folder / "out.h5.partial"));
  }
}
#endif
