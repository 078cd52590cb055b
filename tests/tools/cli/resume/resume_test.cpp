// --resume and --force of the program, also after signals.
#include <signal.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <nlohmann/json.hpp>

#include "tools/cli/resume/slow_hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
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
    CHECK_THAT(process.log(), Contains("interrupted") && Contains("--resume"));
    CHECK(work.files() == Names{"out.h5.journal"});
    CHECK(JournalReader(work.journal).torn().empty());
    std::filesystem::remove(work.journal);
  }
  work.start_and(SIGTERM);
  const Outcome resumed = work.run("--resume --json");
  REQUIRE(resumed.exit_code == 0);
  CHECK_THAT(resumed.err, Contains("resumes with") && Contains("cells finished"));
  const json report = json::parse(resumed.out);
  CHECK(report["pages"].get<int>() + report["resumed_cells"].get<int>() > 0);
  CHECK(report["resumed_cells"].get<int>() >= 20);
  CHECK(work.files() == Names{"out.h5"});
  const std::string bytes = bytes_of(work.output);
  REQUIRE(work.run("--force").exit_code == 0);
  CHECK((bytes_of(work.output) == bytes));
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
  CHECK_THAT(process.log(), Contains("before the work in flight was finished"));
  CHECK(work.run("--resume").exit_code == 0);
}

TEST_CASE("an unfinished journal is neither used nor dropped unasked") {
  const Work work;
  work.start_and(SIGKILL);
  const std::string found = bytes_of(work.journal);
  check_refused(work.run(""), 2, "--resume continues it, --force starts again");
  check_refused(work.run(""), 2, "an unfinished run with engine grid on cpu, radius 0.1");
  check_refused(work.run("--resume --force"), 2, "--force");
  check_refused(work.run("--resume", "0.2"), 2, "its radius is 0.1, expected 0.2");
  check_refused(work.run("--resume", "0.1", "kdtree"), 2, "its engine is grid, expected kdtree");
  check_refused(work.run("--resume --between-poses", "0.1", "sweep"), 2, "between_poses is no");
  check_refused(work.run_with("model.ply", "1 2 3\n"), 2, "its model is ");
  check_refused(work.run_with("trajectory.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"), 2,
                "its trajectory is ");
  CHECK((bytes_of(work.journal) == found));

  const Outcome info = run_program(work.folder, "info --json " + quoted(work.journal));
  REQUIRE(info.exit_code == 0);
  CHECK(json::parse(info.out)["kind"] == "journal");
  CHECK(json::parse(info.out)["finished_cells"] >= 19);
  CHECK(json::parse(info.out)["radius"] == "0.1");

  const Outcome forced = work.run("--force");
  CHECK(forced.exit_code == 0);
  CHECK_THAT(forced.err, Contains("journal of an unfinished run removed"));
  CHECK(work.files() == Names{"out.h5"});
}

TEST_CASE("a run with other threads and memory resumes") {
  const Work work;
  work.start_and(SIGKILL, "--threads 1");
  const Outcome resumed = work.run("--resume --threads 3 --memory 1G");
  CHECK(resumed.exit_code == 0);
  CHECK_THAT(resumed.err, Contains("resumes with"));
}

TEST_CASE("resuming without a journal starts afresh and says so") {
  const Work work;
  const Outcome outcome = work.run("--resume");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, Contains("no journal to resume, starts from the beginning"));
  put_bytes(work.journal, "CLWYJ");
  CHECK_THAT(work.run("--force").err, Contains("removed, starts from the beginning"));
  std::filesystem::remove(work.output);
  put_bytes(work.journal, "CLWYJ");
  CHECK_THAT(work.run("").err, Contains("nothing in it yet"));
  CHECK(work.files() == Names{"out.h5"});
}

TEST_CASE("a resumed run leaves a result alone that answers its query, and no other") {
  const Work work;
  const Outcome first = work.run("--json");
  REQUIRE(first.exit_code == 0);
  const std::string bytes = bytes_of(work.output);
  const Outcome again = work.run("--resume --json", "0.1", "sweep");
  CHECK(again.exit_code == 0);
  CHECK_THAT(again.err, Contains("is the finished result of this query already"));
  const json found = json::parse(first.out), kept = json::parse(again.out);
  for (const char* same : {"environment_points", "colliding_points", "cells_total"}) {
    CHECK(kept[same] == found[same]);
  }
  CHECK(kept["engine"].is_null());
  put_bytes(work.journal, "CLWYJ");  // a journal with nothing in it yet
  CHECK(work.run("--resume").exit_code == 0);
  CHECK(work.files() == Names{"out.h5"});
  CHECK(kept["cells_read"] == 0);
  CHECK(kept["seconds"].size() == found["seconds"].size());
  const std::string radii =
      "exists already, and answers another question than this run: radius: 0.1 m in the file, "
      "0.2 m here; --force ";
  check_refused(work.run("--resume", "0.2"), 2, radii + "instead of --resume overwrites it");
  check_refused(work.run("", "0.2"), 2, radii + "overwrites it, or give another name");
  check_refused(work.run("--shard 1/2"), 2, "part: the whole result in the file, part 1 of 2 here");
  check_refused(work.run(""), 2,
                "exists already, and answers the same question; --resume repeats that answer");
  CHECK((bytes_of(work.output) == bytes));

  std::string damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  put_bytes(work.output, damaged);
  check_refused(work.run("--resume"), 2, "exists already, and is ");
}

TEST_CASE("an existing result stays until a resumed run replaces it, and only where asked for") {
  const Work work;
  REQUIRE(work.run("", "0.05").exit_code == 0);
  const std::string old = bytes_of(work.output);
  work.start_and(SIGKILL, "--force");
  CHECK((bytes_of(work.output) == old));
  CHECK(work.run("--resume").exit_code == 0);
  const std::string done = bytes_of(work.output);
  CHECK((done != old));
  CHECK(work.files() == Names{"out.h5"});

  std::filesystem::remove(work.output);
  work.start_and(SIGKILL);
  put_bytes(work.output, "of somebody else");
  check_refused(work.run("--resume"), 2, "exists already, and is no complete result");
  CHECK(bytes_of(work.output) == "of somebody else");
  // As if killed after the result got its name and before its journal was removed.
  put_bytes(work.output, done);
  const Outcome outcome = work.run("--resume");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, Contains("is the finished result of this query already"));
  CHECK(work.files() == Names{"out.h5"});
}

TEST_CASE("an unfinished run over an existing result is reported, and kept until one replaces it") {
  const Work work;
  REQUIRE(work.run("", "0.05").exit_code == 0);
  work.start_and(SIGKILL, "--force");
  const std::string found = bytes_of(work.journal);
  check_refused(work.run(""), 2, "an unfinished run with engine grid on cpu");
  std::string mistyped = work.command("--force");
  mistyped.replace(mistyped.find("model.ply"), 9, "modle.ply");
  check_refused(run_program(work.folder, mistyped), 4, "modle.ply");
  CHECK((bytes_of(work.journal) == found));
  CHECK(work.run("--resume").exit_code == 0);
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
  CHECK(bytes_of(work.journal) == of_another);
}

TEST_CASE("an automatic choice of the device goes on where it was") {
  const Work work;
  work.start_and(SIGKILL);
  std::string command = work.command("--resume --device-memory 1G");
  command.replace(command.find("--device cpu"), 12, "--device auto");
  const Outcome resumed = run_program(work.folder, command);
  CHECK(resumed.exit_code == 0);
  CHECK_THAT(resumed.err, Contains("resumes with") && Contains("on the CPU"));
}

TEST_CASE("poses that were divided otherwise are counted once") {
  const Work work;
  Process process(work.command("--threads 1", "0.1", "kdtree"), work.folder / "log.txt");
  work.wait_for_records(process, 3);
  process.send(SIGKILL);
  process.wait();
  for (const char* threads : {"3", "2"}) {
    const Outcome resumed =
        work.run(std::string("--resume --json --threads ") + threads, "0.1", "kdtree");
    if (resumed.exit_code != 0 || !json::parse(resumed.out).contains("resumed_poses")) continue;
    CHECK(json::parse(resumed.out)["resumed_poses"] <= 3000);
  }
}
