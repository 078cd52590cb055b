#include "tools/cli/support/hall.hpp"

#include <catch2/catch.hpp>
#include <stdexcept>

namespace clearway::test {

const Hall& Hall::get() {
  static const Hall hall("--points 30000 --model-points 300 --poses 150");
  return hall;
}

const Hall& Hall::small() {
  static const Hall hall("--points 12000 --model-points 200 --poses 100");
  return hall;
}

Hall::Hall(const std::string& size) {
  const Outcome made = run_program(folder_, "scene hall " + size + " -o " + *this / "");
  const Outcome converted =
      run_program(folder_, "convert " + *this / "environment.las" + " -o " + *this / "site.h5");
  if (made.exit_code != 0 || converted.exit_code != 0) throw std::runtime_error("no hall");
}

Outcome Work::run(const std::string& arguments, const std::filesystem::path& pipe) const {
  return run_program(folder, arguments, pipe);
}

Outcome Work::run_hall(const std::string& environment, const std::string& output,
                       const std::string& options) const {
  return run("run --env " + environment + " --model " + hall / "model.ply" + " --trajectory " +
             hall / "trajectory.txt" + " --radius 0.1 -o " + path(output) + " " + options);
}

void check_refused(const Outcome& outcome, int exit_code, const std::string& message) {
  CHECK(outcome.exit_code == exit_code);
  CHECK(outcome.out.empty());
  CHECK_THAT(outcome.err, Catch::Contains(message));
}

}  // namespace clearway::test
