#include "tools/cli/support/hall.hpp"

#include <stdexcept>

#include "support/catch.hpp"

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

Work::Work(const Hall& of) : hall(of) {
  std::filesystem::create_directory_symlink(hall.path(""), folder / "hall");
}

Outcome Work::run_hall(const std::string& environment, const std::string& output,
                       const std::string& options) const {
  return run("run --env " + environment +
             " --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.1 -o " + output +
             " " + options);
}

}  // namespace clearway::test
