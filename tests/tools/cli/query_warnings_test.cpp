// Questions that may be misread, as users ask them. With --strict the program refuses to search.
#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "clearway/model.hpp"
#include "core/geometry/angle.hpp"
#include "io/scans/point_reader.hpp"
#include "support/catch.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/asked.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Keeps every n-th value.
template <typename Value>
void thin(std::vector<Value>& values, std::size_t n) {
  std::vector<Value> few;
  for (std::size_t i = 0; i < values.size(); i += n) few.push_back(values[i]);
  values = few;
}

using Change = std::function<Vec3(const Vec3&)>;

Change times(double factor) {
  return [=](const Vec3& p) { return Vec3{factor * p.x, factor * p.y, factor * p.z}; };
}

Change plus(double x, double y, double z) {
  return [=](const Vec3& p) { return Vec3{p.x + x, p.y + y, p.z + z}; };
}

/// Checks that a question causes a warning, and the words of what is said. Returns all codes.
std::string check_warned(const Asked& asked, std::string_view code, std::string_view words,
                         const Caller& caller = Caller::current()) {
  const Outcome outcome = asked.ask();
  const std::string codes = codes_of(outcome);
  check_says(codes, code, caller);
  check_says(outcome.err, words, caller);
  return codes;
}

void check_path(const Change& change, std::string_view code, std::string_view words,
                const Caller& caller = Caller::current()) {
  Asked asked;
  asked.move_path(change);
  check_warned(asked, code, words, caller);
}

void check_model(const Change& change, std::string_view code, std::string_view words,
                 const Caller& caller = Caller::current()) {
  Asked asked;
  asked.move_model(change);
  check_warned(asked, code, words, caller);
}

/// Checks that rotations that were misread have this diagnosis alone: that of reading the
/// trajectory, or that of the query.
void check_turned(const std::function<void(double*)>& change, std::string_view code,
                  std::string_view words, const Caller& caller = Caller::current()) {
  Asked asked;
  asked.turn(change);
  const std::string codes = check_warned(asked, code, words, caller);
  int diagnoses = 0;
  for (const char* one : {"rotation-missing", "rotation-too-small", "poses-inverse",
                          "turns-against-path", "upside-down", "rotations", "tilted"}) {
    diagnoses += codes.find(one) != std::string::npos;
  }
  check_equal(diagnoses, 1, caller);
}

void transpose(double* r) {
  std::swap(r[1], r[3]);
  std::swap(r[2], r[6]);
  std::swap(r[5], r[7]);
}

}  // namespace

TEST_CASE("nothing is warned of where nothing is wrong") {
  CHECK(codes_of(Asked().ask()).empty());
  for (const auto& [kind, sizes, codes] : std::vector<std::array<std::string, 3>>{
           {"plant", "--points 300000 --model-points 20000 --poses 16000", ""},
           {"mine", "--points 200000 --model-points 40000 --poses 12000", ""},
           {"tunnel", "--points 200000 --poses 19392", "model-spacing"}}) {
    CAPTURE(kind);
    const Scene scene(kind, sizes);
    Asked asked;
    asked.model = scene.model;
    asked.poses = scene.poses;
    CHECK(codes_of(asked.ask(quoted(scene.folder / "site.h5"))) == codes);
  }
}

TEST_CASE("a path in another unit or frame is warned of, with the remedy") {
  check_path(times(1000), "out-of-reach", "divided by 1000");
  check_path(times(100), "out-of-reach", "divided by 100");
  check_path(times(1 / 0.3048), "leaves-scan", "multiplied by 0.3048");
  check_path(times(0.001), "tiny-path", "kilometres");
  check_path([](const Vec3& p) { return Vec3{p.y, p.x, p.z}; }, "leaves-scan", "x and y swapped");
  check_path([](const Vec3& p) { return Vec3{p.x, -p.z, p.y}; }, "leaves-scan", kAnything);
  check_path(plus(691'000, 5'336'000, 520), "out-of-reach", "A shift of the path by about");
  check_path(plus(0, 0, 47), "out-of-reach", "above what was scanned");
  check_path(plus(0, 0, 12), "floats", "count from the ellipsoid");
}

TEST_CASE("inverted poses are warned of") {
  Asked asked;
  for (Pose& pose : asked.poses) {
    Pose inverse{};
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) {
        inverse.rotation[3 * k + j] = pose.rotation[3 * j + k];
        inverse.translation[k] -= pose.rotation[3 * j + k] * pose.translation[j];
      }
    }
    pose = inverse;
  }
  check_warned(asked, "leaves-scan", "every pose inverted");
}

TEST_CASE("a path whose rotations were misread is warned of") {
  check_turned(transpose, "turns-against-path", "column by column");
  const auto without_turning = [](double* r) {
    for (int k = 0; k < 9; ++k) r[k] = k % 4 == 0 ? 1 : 0;
  };
  check_turned(without_turning, "rotation-missing", "rotations may be missing");
  const auto z_down = [](double* r) {
    for (const int k : {1, 2, 4, 5, 7, 8}) r[k] = -r[k];
  };
  check_turned(z_down, "upside-down", "points down");
  const auto heads_35_degrees_left = [](double* r) {
    const double c = std::cos(35 * kDegree), s = std::sin(35 * kDegree);
    for (double* row = r; row != r + 9; row += 3) {
      const double forward = row[0], left = row[1];
      row[0] = c * forward + s * left;
      row[1] = c * left - s * forward;
    }
  };
  check_turned(heads_35_degrees_left, "rotations", "zero direction of the angles");
  const auto x_right_y_down_z_forward = [](double* r) {
    for (double* row = r; row != r + 9; row += 3) {
      const double forward = row[0], left = row[1], up = row[2];
      row[0] = -left, row[1] = -up, row[2] = forward;
    }
  };
  check_turned(x_right_y_down_z_forward, "tilted", "a camera's");
}

namespace {

/// Turns the model about its x axis.
void roll(double* r, double degrees) {
  const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
  for (double* row = r; row != r + 9; row += 3) {
    const double left = row[1], up = row[2];
    row[1] = c * left + s * up;
    row[2] = c * up - s * left;
  }
}

}  // namespace

TEST_CASE("a model that leans along its whole path is warned of") {
  for (const double degrees : {5.0, 8.0, -5.0}) {
    CAPTURE(degrees);
    Asked asked;
    asked.turn([&](double* r) { roll(r, degrees); });
    const std::string side = degrees > 0 ? "right" : "left";
    check_warned(asked, "leans", "to the " + side + " by ... degrees, also where it does not turn");
  }
  Asked road;  // a road that banks
  road.turn([](double* r) { roll(r, 4); });
  CHECK(codes_of(road.ask()).empty());
  Asked changing;
  double i = 0;
  changing.turn([&](double* r) { roll(r, 6 * std::sin(i++ / 200)); });
  check_lacks(codes_of(changing.ask()), "leans");
}

TEST_CASE("a model that leans inwards in a curve, as on rails, is not warned of") {
  const auto codes = [](double degrees) {
    Asked asked;
    asked.poses.clear();
    for (int k = 0; k < 1000; ++k) {
      const double angle = 0.0015 * k;  // to the left
      Pose pose{
          {std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1},
          {20 * std::sin(angle), 20 - 20 * std::cos(angle), 0}};
      roll(pose.rotation, degrees);
      asked.poses.push_back(pose);
    }
    return codes_of(asked.ask());
  };
  check_says(codes(6), "leans");
  check_lacks(codes(-6), "leans");
}

TEST_CASE("a model in another unit or frame is warned of") {
  check_model(times(1000), "model-unit", "In millimetres it would be");
  check_model(times(100), "model-unit", ", in centimetres ");
  check_model(times(1 / 0.0254), "model-unit", ", in inches ");
  check_model(times(0.001), "model-unit", "check its unit");
  check_model(plus(691'000, 5'336'000, 0), "model-origin", "from the origin of their frame");
  check_model([](const Vec3& p) { return Vec3{-p.y, p.x, p.z}; }, "sideways", "drives sideways");
}

TEST_CASE("the scan itself as the model is warned of") {
  Asked asked;
  asked.model = read_model_points(Scene::hall().folder / "environment.las");
  check_says(codes_of(asked.ask()), "model-is-environment");
}

TEST_CASE("a radius in another unit, and gaps that let things through, are warned of") {
  const auto codes = [](const std::function<void(Asked&)>& change) {
    Asked asked;
    change(asked);
    return codes_of(asked.ask());
  };
  CHECK(codes([](Asked& asked) { asked.radius = "100"; }) == "radius-size");
  check_says(codes([](Asked& asked) { asked.radius = "0.0005"; }), "fine-radius");
  check_says(codes([](Asked& asked) { asked.radius = "0.00005"; }), "coarse-digits");
  check_says(codes([](Asked& asked) { thin(asked.model, 200); }), "model-spacing");
  const auto sparse = [](Asked& asked) { thin(asked.poses, 20); };
  CHECK(codes(sparse) == "large-steps");
  CHECK(codes([&](Asked& asked) {
          sparse(asked);
          asked.options = "--between-poses";
        }).empty());
}

namespace {

/// The poses without those from `first` on and before `last`.
std::vector<Pose> without(std::vector<Pose> poses, std::ptrdiff_t first, std::ptrdiff_t last) {
  poses.erase(poses.begin() + first, poses.begin() + last);
  return poses;
}

/// The lines of standard error that name a step.
std::string said_of_steps(const Outcome& outcome) {
  std::istringstream lines(outcome.err);
  std::string found;
  for (std::string line; std::getline(lines, line);) {
    if (line.find(" step") != std::string::npos) found += line + "\n";
  }
  return found;
}

}  // namespace

TEST_CASE("missing poses are warned of, once, at poses and between them") {
  Asked asked;
  asked.poses = without(asked.poses, 600, 1000);
  const std::string code = codes_of(asked.ask());
  CHECK(code == "trajectory-jump");
  check_says(asked.ask().err, "from pose 599 to 600 ... Nothing is searched");
  asked.options = "--between-poses";
  const Outcome between = asked.ask();
  CHECK(codes_of(between) == "large-steps");
  check_says(said_of_steps(between),
             "at 1 of 1,599 steps ... after pose 599 ... so poses may be missing there");
}

TEST_CASE("poses that are missing on a straight path are warned of between poses too") {
  Asked asked;
  const Pose start = asked.poses[0];
  asked.poses.clear();
  for (int i = 0; i < 100; ++i) {
    Pose pose = start;
    for (int k = 0; k < 3; ++k) {
      pose.translation[k] += (i < 50 ? 0.05 : 0.1) * i * start.rotation[3 * k];
    }
    asked.poses.push_back(pose);
  }
  asked.options = "--between-poses";
  check_says(codes_of(asked.ask()), "trajectory-jump");
  check_says(said_of_steps(asked.ask()),
             "the step from pose 49 to 50 is 2.55 m long, 34 times ... searched on the straight "
             "way there");
}

TEST_CASE("steps that are as long as the radius, to the rounding of sums, are not warned of") {
  Asked asked;
  Pose pose = asked.poses[0];
  asked.poses.clear();
  for (int i = 0; i < 100; ++i) {
    asked.poses.push_back(pose);
    for (int k = 0; k < 3; ++k) pose.translation[k] += 0.1 * pose.rotation[3 * k];
  }
  check_lacks(codes_of(asked.ask()), "large-steps");
  asked.radius = "0.0999";
  check_says(codes_of(asked.ask()), "large-steps");
}

TEST_CASE("a turn in one step is warned of, at poses and between them") {
  Asked asked;
  // The model stays in its place while its heading jumps.
  for (std::size_t i = 1200; i < asked.poses.size(); ++i) {
    double* r = asked.poses[i].rotation;
    for (int row = 0; row < 3; ++row) {
      const double x = r[3 * row], y = r[3 * row + 1];
      r[3 * row] = y;
      r[3 * row + 1] = -x;
    }
  }
  for (const std::string options : {"", "--between-poses"}) {
    asked.options = options;
    const Outcome outcome = asked.ask();
    check_says(codes_of(outcome), "large-steps");
    check_says(said_of_steps(outcome), "at 1 of 1,999 steps ... after pose 1199");
  }
}

TEST_CASE("between poses the curve's chord is judged by the radius") {
  Asked asked;
  asked.poses.clear();
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.025 * i;
    Pose pose{{std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1},
              {20 * std::sin(angle), 20 - 20 * std::cos(angle), 0}};
    asked.poses.push_back(pose);
  }
  asked.options = "--between-poses";
  asked.radius = "0.001";
  const Outcome fine = asked.ask();
  check_says(codes_of(fine), "large-steps");
  check_says(said_of_steps(fine),
             "at 99 of 99 steps ... up to 0.00 ... goes on by 0.5 m and turns by 1.43 degrees");
  asked.radius = "0.01";
  check_says(said_of_steps(asked.ask()), "a tenth of the radius");
  asked.radius = "0.1";
  CHECK(said_of_steps(asked.ask()).empty());
}

TEST_CASE("a scan that does not cover the whole path is warned of") {
  const ScratchFolder folder;
  const auto reader = open_point_file(Scene::hall().folder / "environment.las");
  const Quantisation quantisation = *reader->info().quantisation;
  std::vector<Quantum> kept;
  for (PointBatch batch; reader->read(batch);) {
    for (const Quantum& q : batch.quanta) {
      const double x = coordinate(quantisation, 0, q[0]);
      if (x < 20 || x > 60) kept.push_back(q);
    }
  }
  write_las(folder / "gap.las", kept, quantisation);
  require_success(run_program(
      folder, "convert " + quoted(folder / "gap.las") + " -o " + quoted(folder / "gap.h5")));
  const Outcome outcome = Asked().ask(quoted(folder / "gap.h5"));
  CHECK(codes_of(outcome) == "leaves-scan");
  check_says(outcome.err,
             " m of the 80 m of the path, between pose  ... there the result says nothing");
}

TEST_CASE("warnings are in the JSON, and the last line names them") {
  const Scene& hall = Scene::hall();
  const ScratchFolder folder;
  const auto run = [&](const std::string& radius) {
    return run_program(folder, "run --json --force --env " + quoted(hall.folder / "site.h5") +
                                   " --model " + quoted(hall.folder / "model.ply") +
                                   " --trajectory " + quoted(hall.folder / "trajectory.txt") +
                                   " --radius " + radius + " -o " + quoted(folder / "out.h5"));
  };
  const Outcome silent = run("10cm");
  CHECK((json_of(silent)["warnings"].empty() && silent.err.find("warning") == std::string::npos));
  check_says(silent.err, "info: model 4.5 x 1.9 x 1.5 m, path 80 m long");
  const Outcome doubtful = run("0.5mm");
  const auto warnings = json_of(doubtful)["warnings"];
  const auto fine = std::ranges::find_if(
      warnings, [](const auto& warning) { return warning["code"] == "fine-radius"; });
  REQUIRE(fine != warnings.end());
  CHECK((*fine)["numbers"]["radius"] == 0.0005);
  CHECK((*fine)["message"].get<std::string>().starts_with("the radius is 0.0005 m"));
  const std::string last = doubtful.err.substr(doubtful.err.rfind("info: "));
  check_says(last, "; see the ... warnings above");
}

TEST_CASE("a path in single precision or with too few digits at large coordinates is warned of") {
  // 150 km from the origin, where such numbers are 16 mm apart.
  const auto shifted = [](const Vec3& p) { return Vec3{p.x + 150'000, p.y + 160'000, p.z}; };
  const auto single = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  const auto whole = [](double v, double step) { return std::round(v / step) * step; };
  const ScratchFolder folder;
  const std::string store = Scene::hall().moved_store(folder, shifted);
  const auto check = [&](const Change& change, const char* radius, const std::string& code,
                         const Caller& caller = Caller::current()) {
    Asked asked;
    asked.radius = radius;
    asked.move_path([&](const Vec3& p) { return change(shifted(p)); });
    // A rounded path has other doubtful steps too.
    check_says(codes_of(asked.ask(store)), code, caller);
  };
  const auto singles = [&](const Vec3& p) { return Vec3{single(p.x), single(p.y), single(p.z)}; };
  const auto rounded = [&](double step) {
    return [=](const Vec3& p) { return Vec3{whole(p.x, step), whole(p.y, step), p.z}; };
  };
  check(singles, "0.1", "single-precision");
  check(singles, "0.5", "");
  check(plus(0, 0, 0), "0.1", "");
  check(rounded(0.01), "0.1", "");
  check(rounded(1), "0.1", "lost-digits");
  check([&](const Vec3& p) { return Vec3{whole(p.x, 1), p.y, p.z}; }, "0.1", "lost-digits");
}

TEST_CASE("error budgets that are hardly meant so are warned of") {
  for (const auto& [options, code] : std::vector<std::array<const char*, 2>>{
           {"--error-pose 1cm --sigmas 0.003", "few-sigmas"},
           {"--error-angle 0.0005deg", "small-error-angle"},
           {"--error-pose 1cm --sigmas 1 --error-angle 0.02deg", ""},
           {"--error-model 1cm --sigmas 0.5", ""},
           {"--error-pose 1cm --error-angle 0", ""}}) {
    CAPTURE(options);
    Asked asked;
    asked.options = std::string("--first-pose ") + options;
    CHECK(codes_of(asked.ask()) == code);
  }
}
