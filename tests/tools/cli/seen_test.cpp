#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "clearway/result.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Ray {
  double from[3], to[3];
};

/// A car of points that drives along x from 8 m to 15 m, towards a wall at 20 m that a scanner at
/// the origin has scanned through the space where the car drives.
struct Road : Workplace {
  /// origin: where the road's coordinates have their origin.
  explicit Road(const std::array<double, 3>& origin = {}) : at(origin) {
    std::string car, path;
    for (int i = 0; i <= 10; ++i) {
      for (int j = 0; j <= 6; ++j) {
        for (const double x : {-0.3, 0.0, 0.3}) {
          car += line(x, -0.5 + 0.1 * i, -0.3 + 0.1 * j);
        }
      }
    }
    for (int i = 0; i <= 70; ++i) {
      path += pose_at(at[0] + 8 + 0.1 * i, at[1], at[2]);
    }
    put("car.xyz", car);
    put("path.txt", path);
    put("wagon.json", R"({"bodies": [{"name": "car", "model": "car.xyz"}]})");
  }

  static std::string line(double x, double y, double z) {
    return std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  }

  /// The beams to the wall. A board at 5 m, from y = 0 to 0.3, stops those behind it.
  static std::vector<Ray> beams(bool board) {
    std::vector<Ray> out;
    for (int i = -60; i <= 60; ++i) {
      for (int j = -40; j <= 40; ++j) {
        const double y = 0.05 * i + 0.013, z = 0.05 * j + 0.011;
        const bool stopped = board && y / 4 >= 0 && y / 4 < 0.3;
        const double part = stopped ? 0.25 : 1;
        out.push_back({{0, 0, 0}, {20 * part, y * part, z * part}});
      }
    }
    return out;
  }

  /// Beams from the side, across the road to a wall at y = 6.
  static std::vector<Ray> from_the_side() {
    std::vector<Ray> out;
    for (int k = 0; k <= 8; ++k) {
      for (int i = -50; i <= 50; ++i) {
        for (int j = -40; j <= 40; ++j) {
          out.push_back({{7.5 + k, -6, 0.0}, {7.5 + k + 0.04 * i, 6, 0.02 * j + 0.011}});
        }
      }
    }
    return out;
  }

  /// Converts the beams' points, with their origins.
  void scan(const std::vector<Ray>& rays) const {
    std::string points, origins = "first,x,y,z\n";
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray& ray = rays[i];
      points += line(at[0] + ray.to[0], at[1] + ray.to[1], at[2] + ray.to[2]);
      if (i > 0 && std::equal(ray.from, ray.from + 3, rays[i - 1].from)) continue;
      origins += std::to_string(i);
      for (std::size_t k = 0; k < 3; ++k) origins += "," + std::to_string(at[k] + ray.from[k]);
      origins += "\n";
    }
    put("scan.xyz", points);
    put("origins.csv", origins);
    require_success(
        Workplace::run("convert scan.xyz --origins origins.csv -o site.h5 --scale 0.001 "
                       "--cell-points 2000 --force"));
  }

  Outcome run(const std::string& options, const std::string& out = "out.h5",
              const std::string& moves = "--model ") const {
    const std::string file = moves == "--model " ? "car.xyz" : "wagon.json";
    return Workplace::run("run --env site.h5 " + moves + file +
                          " --trajectory path.txt --radius 0.1 --force -o " + out + " " + options);
  }

  nlohmann::json answer(const std::string& options, const std::string& out = "out.h5",
                        const std::string& moves = "--model ") const {
    return json_of(require_success(run(options + " --json", out, moves)));
  }

  std::array<double, 3> at;
};

std::vector<Ray> with(std::vector<Ray> rays, const std::vector<Ray>& more) {
  rays.insert(rays.end(), more.begin(), more.end());
  return rays;
}

}  // namespace

TEST_CASE("a path through space that beams crossed is clear, and a hidden place is undecided") {
  const Road road;
  road.scan(Road::beams(false));
  const auto open = road.answer("--seen");
  check_json(open, R"({"verdict": "clear", "seen": {"unseen": 0}})");
  CHECK(open["seen"]["swept"] > 500);
  CHECK(road.answer("")["seen"].is_null());

  // Behind the board nobody knows what stands.
  road.scan(Road::beams(true));
  CHECK(road.answer("")["verdict"] == "clear");
  check_outcome(road.run("--seen --fail-on-collision"), 6, kAnything,
                "undecided (not-scanned) ... of 7.0 m");
  const auto hidden = road.answer("--seen");
  check_json(hidden, R"({"verdict": "undecided", "seen": {"listed_groups": 1}})");
  CHECK(hidden["reasons"] == nlohmann::json::array({"not-scanned"}));
  CHECK(hidden["seen"]["not_scanned_length"].get<double>() > 3);
  CHECK(hidden["seen"]["swept"] == open["seen"]["swept"]);
  CHECK(hidden["seen"]["seen"].get<int>() + hidden["seen"]["unseen"].get<int>() ==
        hidden["seen"]["swept"].get<int>());
  check_outcome(run_program(road.folder, "verify out.h5"), 0);
}

TEST_CASE("a floor leaves out the cubes whose middle is below it") {
  const Road road;
  road.scan(Road::beams(true));
  // On a level path the height of a middle in the car's frame is its z; cubes are 0.2 m.
  const auto cubes_from = [&](const std::string& options, double height) {
    require_success(road.run(options));
    const double offset =
        json_of(run_program(road.folder, "info out.h5 --json"))["offset"][2].get<double>();
    std::set<std::array<std::int32_t, 3>> out;
    for (const auto& cube : Result(road.folder / "out.h5").unseen().cube) {
      if (0.2 * cube[2] + 0.1 + offset >= height) out.insert(cube);
    }
    return out;
  };
  const std::string seen = "--seen --seen-min 1 ";
  const auto above = cubes_from(seen, 0.05);
  CHECK(above.size() < cubes_from(seen, -10).size());
  CHECK(cubes_from(seen + "--floor 0.05", -10) == above);
  // With an error budget the floor of near points counts, which is lower.
  const std::string budget = seen + "--error-scan 0.03 --sigmas 2 ";
  const double lower = road.answer(budget)["margins"]["clear"];
  CHECK(lower > 0.05);
  CHECK(cubes_from(budget + "--floor 0.05", -10) == cubes_from(budget, 0.05 - lower));
}

TEST_CASE("poses closer than a cube do not make the length that was not scanned shorter") {
  const Road road;
  road.scan(Road::beams(true));
  const double coarse = road.answer("--seen")["seen"]["not_scanned_length"];
  road.put("path.txt", path_along_x(701, 0.01, 8));
  const double fine = road.answer("--seen")["seen"]["not_scanned_length"];
  CHECK(coarse > 6);
  CHECK(fine == Approx(coarse).margin(0.2));
}

TEST_CASE(
    "cubes that are too large for the distance are warned of, and none that is swept is no "
    "answer") {
  const Road road;
  road.scan(Road::beams(false));
  const auto codes_of = [](const nlohmann::json& answer) {
    std::vector<std::string> codes;
    for (const auto& warning : answer["warnings"]) {
      const std::string code = warning["code"];
      if (code == "large-cubes" || code == "nothing-swept") codes.push_back(code);
    }
    return codes;
  };
  CHECK(codes_of(road.answer("--seen --seen-cube 0.2")).empty());
  CHECK(codes_of(road.answer("--seen --seen-cube 0.3")) == std::vector<std::string>{"large-cubes"});
  CHECK(codes_of(road.answer("--seen --seen-cube 0.3 --error-scan 0.02")).empty());
  const auto none = road.answer("--seen --seen-cube 40");
  check_json(none, R"({"seen": {"swept": 0}, "verdict": "undecided"})");
  CHECK(none["reasons"] == nlohmann::json::array({"question-in-doubt"}));
  CHECK(codes_of(none) == std::vector<std::string>{"large-cubes", "nothing-swept"});
  check_json(json_of(run_program(road.folder, "info out.h5 --json")),
             R"({"verdict": "undecided"})");
}

TEST_CASE("a second scan shows that a hidden place is free, or what stands in it") {
  const Road road;
  road.scan(with(Road::beams(true), Road::from_the_side()));
  CHECK(road.answer("--seen")["verdict"] == "clear");
  std::vector<Ray> post;
  for (int i = 0; i < 20; ++i) post.push_back({{11, -6, 0}, {11, 0.2, -0.2 + 0.02 * i}});
  road.scan(with(Road::beams(true), post));
  const auto found = road.answer("--seen");
  check_json(found, R"({"verdict": "conflict"})");
  CHECK(found["seen"]["listed_groups"] > 0);
  check_says(road.run("--seen").out, "1 of the places that were not scanned is behind a conflict");
}

TEST_CASE("fewer beams see less, and their order does not matter") {
  const Road road;
  std::vector<Ray> rays = with(Road::beams(true), Road::from_the_side());
  road.scan(rays);
  const auto all = road.answer("--seen --seen-cube 0.1");
  std::reverse(rays.begin(), rays.end());
  road.scan(rays);
  CHECK(road.answer("--seen --seen-cube 0.1")["seen"] == all["seen"]);
  std::mt19937 random(5);
  std::uint64_t before = all["seen"]["unseen"];
  for (int i = 0; i < 3; ++i) {
    std::erase_if(rays, [&](const Ray&) { return random() % 3 == 0; });
    road.scan(rays);
    const std::uint64_t unseen = road.answer("--seen --seen-cube 0.1")["seen"]["unseen"];
    CHECK(unseen >= before);
    before = unseen;
  }
  CHECK(before > 0);
}

TEST_CASE(
    "deleting beams only adds unseen cubes, and coordinates of a map projection change none") {
  const Road road;
  const auto unseen = [&] {
    road.answer("--seen --seen-cube 0.1");
    const auto cubes = Result(road.folder / "out.h5").unseen().cube;
    return std::set(cubes.begin(), cubes.end());
  };
  std::vector<Ray> rays = Road::beams(true);
  road.scan(rays);
  const auto all = unseen();
  CHECK(all.size() > 100);
  std::mt19937 random(9);
  std::erase_if(rays, [&](const Ray&) { return random() % 2 == 0; });
  road.scan(rays);
  const auto fewer = unseen();
  CHECK(fewer.size() > all.size());
  CHECK(std::ranges::includes(fewer, all));

  const Road far({450'000, 5'400'000, 100});
  far.scan(rays);
  auto here = road.answer("--seen --seen-cube 0.1")["seen"];
  auto there = far.answer("--seen --seen-cube 0.1")["seen"];
  CHECK(here["unseen"] == fewer.size());
  check_near(there, "/not_scanned_length", here["not_scanned_length"].get<double>());
  here.erase("not_scanned_length");
  there.erase("not_scanned_length");
  CHECK(there == here);
}

TEST_CASE("seen space has the same bytes with any threads, and from shards") {
  const Road road;
  road.scan(Road::beams(true));
  const auto same = [&](const std::string& name) {
    return road.bytes(name) == road.bytes("out.h5");
  };
  const std::string ask = "--seen --seen-cube 0.1 --first-pose";
  const auto whole = road.answer(ask);
  REQUIRE(whole["seen"]["unseen"] > 0);
  require_success(road.run(ask + " --threads 1", "alone.h5"));
  CHECK(same("alone.h5"));
  std::string parts;
  for (const std::string number : {"1", "2", "3"}) {
    const auto part = road.answer(ask + " --shard " + number + "/3", "part" + number + ".h5");
    check_json(part, R"({"verdict": "unknown"})");
    parts += " part" + number + ".h5";
  }
  const Outcome merged =
      require_success(run_program(road.folder, "merge" + parts + " -o merged.h5"));
  CHECK(same("merged.h5"));
  // The merge has no path, so it cannot say how long that is.
  check_says(merged.out, "undecided (not-scanned) ... ; not scanned on 7.0 m of the path: no beam");
}

TEST_CASE("a place that only the last pose reaches is not said to be 0 m long") {
  const Road road;
  road.scan(Road::beams(true));
  const auto drive = [&](const std::vector<double>& lateral) {
    std::string text;
    for (const double y : lateral) text += "1 0 0 16 0 1 0 " + std::to_string(y) + " 0 0 1 0\n";
    road.put("path.txt", text);
  };
  drive({-1.2});
  REQUIRE(road.answer("--seen")["verdict"] == "clear");
  drive({-1.2, 0.3});  // into what the board hides
  const auto last = road.answer("--seen");
  check_json(last, R"({"verdict": "undecided", "seen": {"not_scanned_length": 0}})");
  CHECK(last["seen"]["listed_groups"] > 0);
  check_says(road.run("--seen").out, "; not scanned on less than 0.1 of 1.5 m: no beam");
  drive({0.3});
  check_says(road.run("--seen").out, "undecided (not-scanned) ... ; not scanned: no beam");
}

TEST_CASE("merging what was not scanned takes no more memory than it may") {
  const Road road;
  road.scan({{{0, 0, 0}, {1, 0, 0}}});
  std::string parts;
  for (const std::string number : {"1", "2"}) {
    const std::string part = "part" + number + ".h5";
    require_success(road.run("--seen --seen-cube 0.02 --shard " + number + "/2", part));
    parts += " " + part;
  }
  const auto merge = [&](const std::string& memory) {
    return run_program(road.folder,
                       "merge" + parts + " --force --memory " + memory + " -o merged.h5");
  };
  check_outcome(merge("40M"), 4, "to merge 2 parts needs");
  check_outcome(merge("1G"), 0);
}

TEST_CASE("a vehicle of one body sweeps what its model sweeps") {
  const Road road;
  road.scan(Road::beams(true));
  const auto model = road.answer("--seen");
  const auto vehicle = road.answer("--seen", "vehicle.h5", "--vehicle ");
  CHECK(vehicle["seen"] == model["seen"]);
  check_json(vehicle, R"({"verdict": "undecided"})");
}

TEST_CASE("with an error budget a cube counts as swept farther from the model") {
  const Road road;
  road.scan(Road::beams(false));
  const auto plain = road.answer("--seen --seen-cube 0.1");
  const auto budget = road.answer("--seen --seen-cube 0.1 --error-pose 0.05");
  CHECK(budget["seen"]["swept"] > plain["seen"]["swept"]);
}

TEST_CASE("groups of few unseen cubes are counted, and do not make a verdict undecided") {
  const Road road;
  road.scan(Road::beams(true));
  const Outcome outcome = road.run("--seen --seen-min 100000 --json");
  const auto facts = json_of(outcome);
  check_json(facts, R"({"verdict": "clear", "seen": {"groups": 1, "listed_groups": 0}})");
  CHECK(facts["warnings"].dump().find("small-unseen") != std::string::npos);
}

TEST_CASE("what makes no sense of seen space is refused by name") {
  const Road road;
  road.scan(Road::beams(true));
  const auto refusal = [&](const std::string& options) {
    const Outcome outcome = road.run(options);
    check_outcome(outcome, 2);
    return outcome.err;
  };
  check_says(refusal("--seen-cube 0.1"), "seen space");
  check_says(refusal("--seen --seen-cube 0.003"), "at least 0.004");
  check_says(refusal("--seen --seen-cube 1e7"), "2^29");
  require_success(run_program(road.folder, "convert scan.xyz -o site.h5 --scale 0.001 --force"));
  check_says(refusal("--seen"), "where its scanner stood");
}
