// Journals of the program that are refused, damaged, torn or in use.
#include "support/catch.hpp"
#include "tools/cli/resume/slow_hall.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a run that is refused leaves no journal") {
  const Work work;
  check_refused(work.run("--memory 1K"), 4, "too little");
  CHECK(work.files().empty());
  check_refused(work.run("--between-poses"), 2, "--engine sweep");
  CHECK(work.files().empty());
}

TEST_CASE("what is no journal is left alone") {
  const Work work;
  put_bytes(work.journal, "a diary");
  for (const char* options : {"", "--resume", "--force"}) {
    check_refused(work.run(options), 2, "move it away");
  }
  check_same(bytes_of(work.journal), "a diary");
  std::filesystem::remove(work.journal);
  std::filesystem::create_symlink(work.folder / "elsewhere", work.journal);
  for (const char* options : {"", "--resume", "--force"}) {
    check_refused(work.run(options), 2, "move it away");
  }
  CHECK_FALSE(std::filesystem::exists(work.folder / "elsewhere"));
}

TEST_CASE("a flipped byte of a journal is detected or does no harm") {
  const Work work;
  work.start_and(SIGKILL);
  const std::string whole = bytes_of(work.journal).substr(0, 700);
  put_bytes(work.journal, whole);
  REQUIRE(run_program(work.folder, "verify " + quoted(work.journal)).exit_code <= 1);
  std::filesystem::remove(work.journal);
  require_success(work.run(""));
  const std::string expected = bytes_of(work.output);
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 8);
    put_bytes(work.journal, bytes);
    CAPTURE(at);
    const Outcome verified = run_program(work.folder, "verify " + quoted(work.journal));
    CHECK(verified.exit_code <= 1);
    if (at >= 16) CHECK_THAT(verified.out, Contains("record "));
    if (at % 13 != 0) continue;
    std::filesystem::remove(work.output);
    const Outcome outcome = work.run("--resume");
    if (outcome.exit_code != 2) CHECK(outcome.exit_code == (verified.exit_code == 0 ? 0 : 3));
    if (outcome.exit_code == 0) {
      check_same(bytes_of(work.output), expected);
    } else {
      CHECK((outcome.exit_code == 2 || outcome.exit_code == 3));
      CHECK_FALSE(std::filesystem::exists(work.output));
    }
  }
}

TEST_CASE("verify tells a torn tail, which resuming cuts off, from damage") {
  const Work work;
  work.start_and(SIGKILL, "--journal-interval 0");
  const std::string whole =
      bytes_of(work.journal).substr(0, JournalReader(work.journal).whole_bytes());
  const auto verify = [&](const std::string& bytes) {
    put_bytes(work.journal, bytes);
    return run_program(work.folder, "verify " + quoted(work.journal));
  };
  const Outcome sound = verify(whole);
  check_outcome(sound, 0);
  CHECK(sound.out == work.journal.string() + ": sound\n");
  check_outcome(verify(whole.substr(0, 5)), 0, kAnything, "it ends before its first record");
  check_outcome(verify(""), 0);

  std::string bytes = whole;
  bytes[100] = static_cast<char>(bytes[100] ^ 1);
  const Outcome damaged = verify(bytes);
  check_outcome(damaged, 1, kAnything, "record 0 at byte 16 is damaged ... : damaged\n");
  check_refused(work.run("--resume"), 3, "record 0 at byte 16 is damaged");

  const Outcome torn = verify(whole.substr(0, whole.size() - 3));
  check_outcome(torn, 0, kAnything, " is torn, with  ... --resume cuts that off ... : sound\n");
  check_outcome(work.run("--resume"), 0, " is torn, with  ... resumes with");
}

TEST_CASE("two runs of one output: the second is refused and leaves the first's journal alone") {
  const Work work;
  Process first(work.command(""), work.folder / "log.txt");
  work.wait_for_records(first, 5);
  for (const char* options : {"", "--resume", "--force"}) {
    check_refused(work.run(options), 4, "another process is writing it");
  }
  CHECK(first.wait() == 0);
  CHECK(work.files() == Names{"out.h5"});
}

TEST_CASE("options of the journal that make no sense are refused") {
  const Work work;
  for (const char* seconds : {"-1", "nan", "x", "4000"}) {
    check_refused(work.run(std::string("--journal-interval ") + seconds), 2, "--journal-interval");
  }
  check_outcome(work.run("--journal-interval 0"), 0);
}
