// `clearway run --shard` and `clearway merge` as a user sees them.
#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A wall beside a path along x, one point of which is near the path.
struct Street : Workplace {
  Street() {
    std::string wall;
    for (int i = 0; i < 2000; ++i) wall += std::to_string(i * 0.005) + " 1 0\n";
    put("wall.xyz", wall + "7 0.25 0\n");
    put("car.xyz", "0 0 0\n0.01 0 0\n-0.01 0 0\n0 0.01 0\n0 -0.01 0\n");
    put("path.txt", path_along_x(101, 0.1));
    require_success(run("convert wall.xyz -o site.h5 --cell-points 64"));
  }

  Outcome search(const std::string& arguments) const {
    return run("run --env site.h5 --model car.xyz --trajectory path.txt --threads 2 " + arguments);
  }
  void make_parts(const std::string& arguments) const {
    for (const std::string part : {"1", "2"}) {
      require_success(
          search(std::string("--shard ") + part + "/2 -o part" + part + ".h5 " + arguments));
    }
  }
};

}  // namespace

TEST_CASE("the verdict of a part is never clear") {
  const Street street;
  const Outcome part = street.search("--shard 1/2 --radius 0.1 -o part1.h5");
  check_outcome(part, 0, kAnything,
                "part 1 of 2: no point of this part is closer than 0.1 m ... clearway merge gives "
                "the answer of all parts");
  check_lacks(part.out, "clear:");
  check_says(part.err, "part 1 of 2: 0 of 2,001 environment points collide");
  const Outcome as_json = street.search("--shard 2/2 --radius 0.1 -o part2.h5 --json");
  const json report = json_of(as_json);
  check_json(report, R"({"verdict": "unknown", "shard": "2/2"})");
  CHECK(report["shard_share"].is_number());
  check_says(street.search("--shard 2/2 --radius 0.1 -o part2.h5 --resume").out,
             "part 2 of 2: no point of this part");

  check_outcome(street.run("merge part1.h5 part2.h5 -o out.h5 --fail-on-collision"), 0, kAnything,
                "clear with warnings: no environment point is closer than 0.1 m ... ; see the 3 "
                "warnings above");
}

TEST_CASE("whether a point collides is asked of all parts") {
  const Street street;
  check_outcome(street.search("--shard 1/2 --radius 0.1 -o part1.h5 --fail-on-collision"), 2,
                "clearway merge --fail-on-collision");
  CHECK(!std::filesystem::exists(street.folder / "part1.h5"));
}

TEST_CASE("a merge has the warnings of its runs") {
  const Street street;
  const std::string query = "--radius 0.006 ";
  const Outcome whole = street.search(query + "-o whole.h5 --json");
  const json run = json_of(whole);
  REQUIRE(!run["warnings"].empty());
  street.make_parts(query);
  const Outcome merged = street.run("merge part2.h5 part1.h5 -o out.h5 --json");
  INFO(merged.err);
  const json merge = json_of(merged);
  REQUIRE(merge["warnings"].size() == run["warnings"].size());
  for (std::size_t i = 0; i < run["warnings"].size(); ++i) {
    json expected = run["warnings"][i];
    check_says(merged.err, expected["message"].get<std::string>() + " (in all parts)");
    expected["parts"] = 2;
    CHECK(merge["warnings"][i] == expected);
  }
  const std::string caveat = "; see the ";
  check_says(whole.err, caveat);
  check_says(street.run("merge part2.h5 part1.h5 -o out.h5 --resume").out,
             "clear with warnings:  ... " + caveat);
  check_same(street.bytes("out.h5"), street.bytes("whole.h5"));

  const Outcome strict = street.run("merge part1.h5 part2.h5 -o strict.h5 --strict");
  check_outcome(strict, 3, "strict:  ... no output was written");
  CHECK(!std::filesystem::exists(street.folder / "strict.h5"));
}

TEST_CASE("a merge may open as many files as it has parts") {
  const Street street;
  std::string parts;
  for (int number = 1; number <= 30; ++number) {
    const std::string part = "part" + std::to_string(number) + ".h5";
    require_success(street.search("--radius 0.5 --shard " + std::to_string(number) + "/30 -o " +
                                  part + " --device cpu"));
    parts += part + " ";
  }
  const auto merge_with = [&](const std::string& limit, const std::string& output) {
    const std::string command =
        "'" CLEARWAY_PROGRAM "' merge " + parts + "-o " + output + " --threads 1";
    return run_program_at("env", street.folder,
                          "-C " + quoted(street.folder / "") + " bash -c \"ulimit " + limit +
                              "; exec " + command + "\"");
  };
  check_outcome(merge_with("-Sn 24", "raised.h5"), 0);
  check_outcome(merge_with("-n 24", "refused.h5"), 4,
                "to merge 30 parts needs ... this process may open 24 ... ulimit -n");
}

TEST_CASE("a merge names the unit of the scan as its runs do") {
  const Street street;
  street.put("feet.xyz", "x [ft] y [ft] z [ft]\n0 1 0\n7 0.25 0\n9 1 0\n");
  street.succeed("convert feet.xyz -o site.h5 --force");
  const Outcome run = street.search("--radius 0.5 -o whole.h5");
  INFO(run.err);
  check_says(run.out, "closer than 0.5 ft");
  street.make_parts("--radius 0.5");
  check_says(street.run("merge part1.h5 part2.h5 -o out.h5").out, "closer than 0.5 ft");
  check_says(street.run("merge part1.h5 part2.h5 -o out.h5 --resume").out, "closer than 0.5 ft");
}

TEST_CASE("a merge answers as a run does") {
  const Street street;
  street.make_parts("--radius 0.5 --first-pose --profile 2");
  const Outcome whole = street.search("--radius 0.5 --first-pose --profile 2 -o whole.h5 --json");
  const Outcome merged = street.run("merge part2.h5 part1.h5 -o out.h5 --json --fail-on-collision");
  check_outcome(merged, 1);
  check_same(street.bytes("out.h5"), street.bytes("whole.h5"));
  const json run = json_of(whole), merge = json_of(merged);
  for (const char* key : {"verdict", "shard", "colliding_points", "poses", "model_points",
                          "environment_points", "profile_poses", "radius"}) {
    CAPTURE(key);
    CHECK(run[key] == merge[key]);
  }
  CHECK(run["first_place"]["source"] == merge["first_place"]["source"]);
  check_json(merge, R"({"first_place": {"chainage": null}, "parts": 2})");
}

TEST_CASE("only merge and info and verify take a part") {
  const Street street;
  street.make_parts("--radius 0.5 --first-pose --profile 2");
  check_says(street.run("info part1.h5").out, "part of a result ... 1/2");
  check_outcome(street.run("verify part1.h5"), 0);
  for (const char* command :
       {"export part1.h5 -o out.csv", "compare part1.h5 part2.h5",
        "conflicts part1.h5 --trajectory path.txt -o out.csv",
        "report part1.h5 --env site.h5 --model car.xyz --trajectory path.txt -o out.html"}) {
    CAPTURE(command);
    check_outcome(
        street.run(command), 3,
        "part1.h5: is part 1 of 2 of a result ... clearway merge makes the result of all parts");
  }
}

TEST_CASE("what is no shard is refused") {
  const Street street;
  for (const char* shard :
       {"0/2", "3/2", "1/0", "1", "1/", "/2", "a/b", "1/1001", "-1/2", "1/2/3"}) {
    CAPTURE(shard);
    check_outcome(street.search(std::string("--radius 0.1 -o x.h5 --shard=") + shard), 2,
                  "--shard ... for example 1/16 to 16/16");
  }
}

TEST_CASE("the journal of a shard is its own") {
  const Street street;
  street.make_parts("--radius 0.5");
  check_outcome(street.search("--radius 0.5 --shard 2/2 -o part1.h5 --resume"), 2,
                "part1.h5: is part 1 of 2, and part 2 of 2 is asked for");
  const Outcome whole = street.search("--radius 0.5 -o part1.h5 --resume");
  check_outcome(
      whole, 2,
      "part1.h5: is part 1 of 2, and the whole result is asked for ... --shard ... --force");
  const Outcome missing = street.run("merge part1.h5 nothing.h5 -o out.h5");
  CHECK(missing.exit_code > 2);
  check_says(missing.err, "nothing.h5");
  check_outcome(street.run("merge part1.h5 -o out.h5"), 3);
}
