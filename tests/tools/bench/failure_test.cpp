#include "bench/measure/failure.hpp"

#include "support/catch.hpp"

using namespace clearway::bench;
using clearway::Remedy;

namespace {

constexpr Refusal kAll[] = {Refusal::kNone, Refusal::kMemory, Refusal::kNonRigidPoses};

ProgramRun failed(int exit_code, const std::string& log) {
  ProgramRun run;
  run.exit_code = exit_code;
  run.log = log;
  return run;
}

}  // namespace

TEST_CASE("a case may end with the refusal that is expected of it, and no other") {
  const std::string run =
      "error: 1 B of memory is too little: this search needs 28.6 MiB beside the mapped store; "
      "--memory 29941972 is enough\n";
  const std::string device =
      "error: 28.3 MiB of device memory is too little: this search needs 28.6 MiB on each device; "
      "--device-memory 29941972 is enough\n";
  const std::string conversion =
      "warning: first\nerror: 1 B of memory is too little; give more with --memory\n";
  const std::string rigid =
      "error: t.txt: line 1: determinant 1.1; expected a rigid motion: singular values within "
      "1e-04 of 1 and a positive determinant; --allow-non-rigid accepts any invertible matrix\n";
  CHECK(amount_in(run, Remedy::kMoreMemory) == 29941972U);
  CHECK_FALSE(amount_in(run, Remedy::kMoreDeviceMemory));
  CHECK(amount_in(device, Remedy::kMoreDeviceMemory) == 29941972U);
  CHECK_FALSE(amount_in(conversion, Remedy::kMoreMemory));
  for (const std::string& memory : {run, device, conversion}) {
    CAPTURE(memory);
    CHECK(is_finding(failed(4, memory), Refusal::kMemory));
    CHECK_FALSE(is_finding(failed(3, memory), Refusal::kMemory));
    CHECK_FALSE(is_finding(failed(4, memory), Refusal::kNonRigidPoses));
    CHECK_FALSE(is_finding(failed(4, memory), Refusal::kNone));
  }
  CHECK(is_finding(failed(3, rigid), Refusal::kNonRigidPoses));
  CHECK_FALSE(is_finding(failed(4, rigid), Refusal::kNonRigidPoses));
  CHECK_FALSE(is_finding(failed(3, rigid), Refusal::kMemory));
}

TEST_CASE("what the machine or another program causes is no finding") {
  const std::string reasons[] = {
      "error: r.h5.partial: another process is writing it; wait for it, or choose another output",
      "error: r.h5: cannot write: No space left on device",
      "error: out of memory; a smaller --memory or fewer --threads may help",
      "error: CUDA failed at a.cu:1: out of memory; nvidia-smi lists what else uses the GPU: take "
      "less --device-memory, or --device cpu",
      ""};
  for (const std::string& log : reasons) {
    CAPTURE(log);
    for (const int exit_code : {2, 3, 4}) {
      for (const Refusal one : kAll) CHECK_FALSE(is_finding(failed(exit_code, log), one));
    }
  }
}

TEST_CASE("every case may be stopped by the limit, which is kept with it") {
  ProgramRun late = failed(5, "error: interrupted\n");
  late.timed_out = true;
  late.wall_seconds = 61.7;
  for (const Refusal one : kAll) CHECK(is_finding(late, one));
  const Json kept = failure_of(late, 60);
  CHECK(kept == Json{{"after_seconds", 61.7}, {"limit", 60.0}});
  CHECK(reason_of(kept) == "stopped after 62 s");
}

TEST_CASE("the reason of a failure is the last line of its log") {
  CHECK(reason_of(failure_of(failed(4, "warning: a\nerror: b\n"), 60)) == "error: b (exit code 4)");
}
