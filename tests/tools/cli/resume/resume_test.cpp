// --resume and --force of the program, also after signals.
#include <signal.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "tools/cli/resume/slow_hall.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;
using std::chrono::steady_clock;

TEST_CASE("a run that is asked to stop says how to resume, and resumes") {
  const Work work;
  for (const int signal : {SIGTERM, SIGINT}) {
    CAPTURE(signal);
    Process process(work.command(""), work.folder / "log.txt");
    work.wait_for_records(process, 20);
    const auto begin = steady_clock::now();
    process.send(signal);
    CHECK(process.wait() == 5);
    CHECK(steady_clock::now() - begin < std::chrono::seconds(5));
    check_says(process.log(), "interrupted ... --resume");
    CHECK(work.files() == Names{"out.h5.journal"});
    CHECK(JournalReader(work.journal).torn().empty());
    std::filesystem::remove(work.journal);
  }
  work.start_and(SIGTERM);
  const Outcome resumed = require_success(work.run("--resume --json"));
  check_says(resumed.err, "resumes with ... cells finished");
  const json report = json_of(resumed);
  CHECK(report["pages"].get<int>() + report["resumed_cells"].get<int>() > 0);
  CHECK(report["resumed_cells"].get<int>() >= 20);
  CHECK(work.files() == Names{"out.h5"});
  const std::string bytes = bytes_of(work.output);
  require_success(work.run("--force"));
  check_same(bytes_of(work.output), bytes);
}

TEST_CASE("a second signal ends a run at once") {
  const Work work;
  Process process(work.command(""), work.folder / "log.txt");
  work.wait_for_records(process, 20);
  process.send(SIGSTOP);  // both signals are pending when it continues
  process.send(SIGTERM);
  process.send(SIGINT);
  process.send(SIGCONT);
  CHECK(process.wait() == 5);
  check_says(process.log(), "before the work in flight was finished");
  check_outcome(work.run("--resume"), 0);
}

TEST_CASE("an unfinished journal is neither used nor dropped unasked") {
  const Work work;
  work.start_and(SIGKILL);
  const std::string found = bytes_of(work.journal);
  check_cases([&](const std::string& more) { return work.run(more); },
              {
                  {"", 2, "--resume continues it, --force starts again"},
                  {"", 2, "an unfinished run with engine grid on cpu, radius 0.1"},
                  {"--resume --force", 2, "--force"},
              });
  check_refused(work.run("--resume", "0.2"), 2, "its radius is 0.1, expected 0.2");
  check_refused(work.run("--resume", "0.1", "kdtree"), 2, "its engine is grid, expected kdtree");
  check_refused(work.run("--resume --between-poses", "0.1", "sweep"), 2, "between_poses is no");
  check_refused(work.run_with("model.ply", "1 2 3\n"), 2, "its model is ");
  check_refused(work.run_with("trajectory.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"), 2,
                "its trajectory is ");
  check_same(bytes_of(work.journal), found);

  const Outcome info =
      require_success(run_program(work.folder, "info --json " + quoted(work.journal)));
  check_json(json_of(info), R"({"kind": "journal", "radius": "0.1"})");
  CHECK(json_of(info)["finished_cells"] >= 19);
  CHECK(json_of(info)["answered_cells"]["hits"] == json_of(info)["finished_cells"]);

  check_outcome(work.run("--force"), 0, "journal of an unfinished run removed");
  CHECK(work.files() == Names{"out.h5"});
}

TEST_CASE("a run with other threads and memory resumes") {
  const Work work;
  work.start_and(SIGKILL, "--threads 1");
  check_outcome(work.run("--resume --threads 3 --memory 1G"), 0, "resumes with");
}

TEST_CASE("resuming without a journal starts afresh and says so") {
  const Work work;
  check_outcome(work.run("--resume"), 0, "no journal to resume, starts from the beginning");
  put_bytes(work.journal, "CLWYJ");
  check_says(work.run("--force").err, "removed, starts from the beginning");
  std::filesystem::remove(work.output);
  put_bytes(work.journal, "CLWYJ");
  check_says(work.run("").err, "nothing in it yet");
  CHECK(work.files() == Names{"out.h5"});
}

TEST_CASE("a resumed run leaves a result alone that answers its query, and no other") {
  const Work work;
  const Outcome first = require_success(work.run("--json"));
  const std::string bytes = bytes_of(work.output);
  const Outcome again = work.run("--resume --json", "0.1", "sweep");
  check_outcome(again, 0, "is the finished result of this query already");
  const json found = json_of(first), kept = json_of(again);
  for (const char* same : {"environment_points", "colliding_points", "cells_total"}) {
    CHECK(kept[same] == found[same]);
  }
  check_json(kept, R"({"engine": null})");
  put_bytes(work.journal, "CLWYJ");  // a journal with nothing in it yet
  check_outcome(work.run("--resume"), 0);
  CHECK(work.files() == Names{"out.h5"});
  check_json(kept, R"({"cells_read": 0})");
  CHECK(kept["seconds"].size() == found["seconds"].size());
  const std::string radii =
      "exists already, and answers another question than this run: radius: 0.1 m in the file, 0.2 "
      "m here; --force ";
  check_refused(work.run("--resume", "0.2"), 2, radii + "instead of --resume overwrites it");
  check_refused(work.run("", "0.2"), 2, radii + "overwrites it, or give another name");
  check_refused(work.run("--shard 1/2"), 2, "part: the whole result in the file, part 1 of 2 here");
  check_refused(work.run(""), 2,
                "exists already, and answers the same question; --resume repeats that answer");
  check_same(bytes_of(work.output), bytes);

  std::string damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  put_bytes(work.output, damaged);
  check_refused(work.run("--resume"), 2, "exists already, and is ");
}

TEST_CASE("an existing result stays until a resumed run replaces it, and only where asked for") {
  const Work work;
  require_success(work.run("", "0.05"));
  const std::string old = bytes_of(work.output);
  work.start_and(SIGKILL, "--force");
  check_same(bytes_of(work.output), old);
  check_outcome(work.run("--resume"), 0);
  const std::string done = bytes_of(work.output);
  CHECK((done != old));
  CHECK(work.files() == Names{"out.h5"});

  std::filesystem::remove(work.output);
  work.start_and(SIGKILL);
  put_bytes(work.output, "of somebody else");
  check_refused(work.run("--resume"), 2, "exists already, and is no complete result");
  check_same(bytes_of(work.output), "of somebody else");
  // As if killed after the result got its name and before its journal was removed.
  put_bytes(work.output, done);
  check_outcome(work.run("--resume"), 0, "is the finished result of this query already");
  CHECK(work.files() == Names{"out.h5"});
}

TEST_CASE("an unfinished run over an existing result is reported, and kept until one replaces it") {
  const Work work;
  require_success(work.run("", "0.05"));
  work.start_and(SIGKILL, "--force");
  const std::string found = bytes_of(work.journal);
  check_refused(work.run(""), 2, "an unfinished run with engine grid on cpu");
  std::string mistyped = work.command("--force");
  mistyped.replace(mistyped.find("model.ply"), 9, "modle.ply");
  check_refused(run_program(work.folder, mistyped), 4, "modle.ply");
  check_same(bytes_of(work.journal), found);
  check_outcome(work.run("--resume"), 0);
}

TEST_CASE("a run does not remove the journal of the next one") {
  const Work work;
  work.start_and(SIGKILL);
  Process finishing(work.command("--resume"), work.folder / "log.txt");
  work.wait_for_records(finishing, JournalReader(work.journal).records() + 5);
  const std::string of_another = "CLWYJRNL of another run";
  std::filesystem::remove(work.journal);
  put_bytes(work.journal, of_another);
  CHECK(finishing.wait() == 0);
  check_same(bytes_of(work.journal), of_another);
}

TEST_CASE("an automatic choice of the device goes on where it was") {
  const Work work;
  work.start_and(SIGKILL);
  std::string command = work.command("--resume --device-memory 1G");
  command.replace(command.find("--device cpu"), 12, "--device auto");
  check_outcome(run_program(work.folder, command), 0, "resumes with ... on the CPU");
}
