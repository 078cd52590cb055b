#include "bench/measure/work_folder.hpp"

#include <fstream>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare_json.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using namespace clearway::bench;

namespace {

const Json kProgram{{"version", "1.2.3"}, {"commit", "0123456789ab"}, {"build", "Release"}};

Json with(const char* name, const char* value) {
  Json program = kProgram;
  program[name] = value;
  return program;
}

}  // namespace

TEST_CASE("a new work folder is of the program that makes it, and of no other") {
  const ScratchFolder scratch;
  const WorkFolder work(scratch / "work");
  CHECK_FALSE(work.note_program(kProgram));
  std::ofstream(work.path() / "hall-small.h5") << "store";
  std::filesystem::create_directories(work.answers());
  CHECK_FALSE(work.note_program(kProgram));
  for (const auto& [name, value] :
       {std::pair{"version", "1.2.4"}, {"commit", "ba9876543210"}, {"build", "Debug"}}) {
    CHECK_THROWS_AS(work.note_program(with(name, value)), UsageError);
    CHECK_THROWS_WITH(
        work.note_program(with(name, value)),
        Contains("made by clearway version 1.2.3 commit 0123456789ab build Release") &&
            Contains(value) && Contains("another --work or remove the folder"));
  }
}

TEST_CASE("scenes and stores of an unknown program are used with a remark, its answers are not") {
  const ScratchFolder scratch;
  const WorkFolder work(scratch / "work");
  std::filesystem::create_directories(work.path() / "hall-small");
  const auto remark = work.note_program(kProgram);
  REQUIRE(remark);
  check_says(*remark, "unknown program");
  CHECK_FALSE(work.note_program(kProgram));
  std::filesystem::create_directories(work.answers());
  std::filesystem::remove(work.path() / "made-by.json");
  CHECK_THROWS_WITH(work.note_program(kProgram), Contains("made by an unknown program"));
  std::ofstream(work.path() / "made-by.json") << "{";
  CHECK_THROWS_WITH(work.note_program(kProgram), Contains("made by an unknown program"));
}

TEST_CASE("a program whose source may have changed is told so where it goes on") {
  for (const char* commit : {"0123456789ab-dirty", "unknown"}) {
    const ScratchFolder scratch;
    const WorkFolder work(scratch / "work");
    const Json program = with("commit", commit);
    CHECK(may_have_changed(program));
    CHECK_FALSE(work.note_program(program));
    const auto remark = work.note_program(program);
    REQUIRE(remark);
    check_says(*remark, std::string(commit) + " ... remove the folder if the source");
  }
  CHECK_FALSE(may_have_changed(kProgram));
}
