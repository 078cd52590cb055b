// `clearway run --shard` and `clearway merge` as a user sees them.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A wall beside a path along x, one point of which is near the path.
struct Street {
  Street() {
    std::string wall;
    for (int i = 0; i < 2000; ++i) wall += std::to_string(i * 0.005) + " 1 0\n";
    put_bytes(folder / "wall.xyz", wall + "7 0.25 0\n");
    put_bytes(folder / "car.xyz", "0 0 0\n0.01 0 0\n-0.01 0 0\n0 0.01 0\n0 -0.01 0\n");
    std::string path;
    for (int i = 0; i <= 100; ++i)
      path += "1 0 0 " + std::to_string(i * 0.1) + " 0 1 0 0 0 0 1 0\n";
    put_bytes(folder / "path.txt", path);
    REQUIRE(program("convert wall.xyz -o site.h5 --cell-points 64").exit_code == 0);
  }

  Outcome program(const std::string& arguments) const {
    return run_program_at("env", folder,
                          "-C " + quoted(folder / "") + " '" CLEARWAY_PROGRAM "' " + arguments);
  }
  Outcome run(const std::string& arguments) const {
    return program("run --env site.h5 --model car.xyz --trajectory path.txt --threads 2 " +
                   arguments);
  }
  void make_parts(const std::string& arguments) const {
    for (const char* part : {"1", "2"}) {
      REQUIRE(run(std::string("--shard ") + part + "/2 -o part" + part + ".h5 " + arguments)
                  .exit_code == 0);
    }
  }

  ScratchFolder folder;
};

}  // namespace

TEST_CASE("the verdict of a part is never clear") {
  const Street street;
  const Outcome part = street.run("--shard 1/2 --radius 0.1 -o part1.h5");
  INFO(part.err);
  CHECK(part.exit_code == 0);
  CHECK_THAT(part.out, Contains("part 1 of 2: no point of this part is closer than 0.1 m") &&
                           Contains("clearway merge gives the answer of all parts"));
  CHECK_THAT(part.out, !Contains("clear:"));
  CHECK_THAT(part.err, Contains("part 1 of 2: 0 of 2,001 environment points collide"));
  const Outcome as_json = street.run("--shard 2/2 --radius 0.1 -o part2.h5 --json");
  const json report = json::parse(as_json.out);
  CHECK(report["verdict"] == "unknown");
  CHECK(report["shard"] == "2/2");
  CHECK(report["shard_share"].is_number());
  const Outcome again = street.run("--shard 2/2 --radius 0.1 -o part2.h5 --resume");
  CHECK_THAT(again.out, Contains("part 2 of 2: no point of this part"));

  const Outcome all = street.program("merge part1.h5 part2.h5 -o out.h5 --fail-on-collision");
  INFO(all.err);
  CHECK(all.exit_code == 0);
  CHECK_THAT(all.out, Contains("clear: no environment point is closer than 0.1 m") &&
                          Contains(", but see the 3 warnings above"));
}

TEST_CASE("whether a point collides is asked of all parts") {
  const Street street;
  const Outcome part = street.run("--shard 1/2 --radius 0.1 -o part1.h5 --fail-on-collision");
  CHECK(part.exit_code == 2);
  CHECK_THAT(part.err, Contains("clearway merge --fail-on-collision"));
  CHECK(!std::filesystem::exists(street.folder / "part1.h5"));
}

TEST_CASE("a merge has the warnings of its runs") {
  const Street street;
  const std::string query = "--radius 0.001 ";
  const Outcome whole = street.run(query + "-o whole.h5 --json");
  const json run = json::parse(whole.out);
  REQUIRE(!run["warnings"].empty());
  street.make_parts(query);
  const Outcome merged = street.program("merge part2.h5 part1.h5 -o out.h5 --json");
  INFO(merged.err);
  const json merge = json::parse(merged.out);
  REQUIRE(merge["warnings"].size() == run["warnings"].size());
  for (std::size_t i = 0; i < run["warnings"].size(); ++i) {
    json expected = run["warnings"][i];
    CHECK_THAT(merged.err, Contains(expected["message"].get<std::string>() + " (in all parts)"));
    expected["parts"] = 2;
    CHECK(merge["warnings"][i] == expected);
  }
  const std::string doubt = ", but see the ";
  CHECK_THAT(whole.err, Contains(doubt));
  const Outcome again = street.program("merge part2.h5 part1.h5 -o out.h5 --resume");
  CHECK_THAT(again.out, Contains("clear: ") && Contains(doubt));
  CHECK(bytes_of(street.folder / "out.h5") == bytes_of(street.folder / "whole.h5"));

  const Outcome strict = street.program("merge part1.h5 part2.h5 -o strict.h5 --strict");
  CHECK(strict.exit_code == 3);
  CHECK_THAT(strict.err, Contains("strict: ") && Contains("no output was written"));
  CHECK(!std::filesystem::exists(street.folder / "strict.h5"));
}

TEST_CASE("a merge may open as many files as it has parts") {
  const Street street;
  std::string parts;
  for (int number = 1; number <= 30; ++number) {
    const std::string part = "part" + std::to_string(number) + ".h5";
    REQUIRE(street
                .run("--radius 0.5 --shard " + std::to_string(number) + "/30 -o " + part +
                     " --device cpu")
                .exit_code == 0);
    parts += part + " ";
  }
  const auto merge_with = [&](const std::string& limit, const std::string& output) {
    const std::string command =
        "'" CLEARWAY_PROGRAM "' merge " + parts + "-o " + output + " --threads 1";
    return run_program_at("env", street.folder,
                          "-C " + quoted(street.folder / "") + " bash -c \"ulimit " + limit +
                              "; exec " + command + "\"");
  };
  const Outcome raised = merge_with("-Sn 24", "raised.h5");
  INFO(raised.err);
  CHECK(raised.exit_code == 0);
  const Outcome refused = merge_with("-n 24", "refused.h5");
  CHECK(refused.exit_code == 4);
  CHECK_THAT(refused.err, Contains("to merge 30 parts needs") &&
                              Contains("this process may open 24") && Contains("ulimit -n"));
}

TEST_CASE("a merge names the unit of the scan as its runs do") {
  const Street street;
  put_bytes(street.folder / "feet.xyz", "x [ft] y [ft] z [ft]\n0 1 0\n7 0.25 0\n9 1 0\n");
  REQUIRE(street.program("convert feet.xyz -o site.h5 --force").exit_code == 0);
  const Outcome run = street.run("--radius 0.5 -o whole.h5");
  INFO(run.err);
  CHECK_THAT(run.out, Contains("closer than 0.5 ft"));
  street.make_parts("--radius 0.5");
  CHECK_THAT(street.program("merge part1.h5 part2.h5 -o out.h5").out,
             Contains("closer than 0.5 ft"));
  CHECK_THAT(street.program("merge part1.h5 part2.h5 -o out.h5 --resume").out,
             Contains("closer than 0.5 ft"));
}

TEST_CASE("a merge answers as a run does") {
  const Street street;
  street.make_parts("--radius 0.5 --first-pose --profile 2");
  const Outcome whole = street.run("--radius 0.5 --first-pose --profile 2 -o whole.h5 --json");
  const Outcome merged =
      street.program("merge part2.h5 part1.h5 -o out.h5 --json --fail-on-collision");
  INFO(merged.err);
  CHECK(merged.exit_code == 1);
  CHECK(bytes_of(street.folder / "out.h5") == bytes_of(street.folder / "whole.h5"));
  const json run = json::parse(whole.out), merge = json::parse(merged.out);
  for (const char* key : {"verdict", "shard", "colliding_points", "poses", "model_points",
                          "environment_points", "profile_poses", "radius"}) {
    CAPTURE(key);
    CHECK(run[key] == merge[key]);
  }
  CHECK(run["first_place"]["source"] == merge["first_place"]["source"]);
  CHECK(merge["first_place"]["chainage"].is_null());
  CHECK(merge["parts"] == 2);
}

TEST_CASE("only merge and info and verify take a part") {
  const Street street;
  street.make_parts("--radius 0.5 --first-pose --profile 2");
  CHECK_THAT(street.program("info part1.h5").out, Contains("part of a result") && Contains("1/2"));
  CHECK(street.program("verify part1.h5").exit_code == 0);
  for (const char* command :
       {"export part1.h5 -o out.csv", "compare part1.h5 part2.h5",
        "conflicts part1.h5 --trajectory path.txt -o out.csv",
        "report part1.h5 --env site.h5 --model car.xyz --trajectory path.txt -o out.html"}) {
    CAPTURE(command);
    const Outcome refused = street.program(command);
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("part1.h5: is part 1 of 2 of a result") &&
                                Contains("clearway merge makes the result of all parts"));
  }
}

TEST_CASE("what is no shard is refused") {
  const Street street;
  for (const char* shard :
       {"0/2", "3/2", "1/0", "1", "1/", "/2", "a/b", "1/1001", "-1/2", "1/2/3"}) {
    CAPTURE(shard);
    const Outcome refused = street.run(std::string("--radius 0.1 -o x.h5 --shard=") + shard);
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains("--shard") && Contains("for example 1/16 to 16/16"));
  }
}

TEST_CASE("the journal of a shard is its own") {
  const Street street;
  street.make_parts("--radius 0.5");
  const Outcome other = street.run("--radius 0.5 --shard 2/2 -o part1.h5 --resume");
  CHECK(other.exit_code == 2);
  CHECK_THAT(other.err, Contains("part1.h5: is part 1 of 2, and part 2 of 2 is asked for"));
  const Outcome whole = street.run("--radius 0.5 -o part1.h5 --resume");
  CHECK(whole.exit_code == 2);
  CHECK_THAT(whole.err, Contains("part1.h5: is part 1 of 2, and the whole result is asked for") &&
                            Contains("--shard") && Contains("--force"));
  const Outcome missing = street.program("merge part1.h5 nothing.h5 -o out.h5");
  CHECK(missing.exit_code > 2);
  CHECK_THAT(missing.err, Contains("nothing.h5"));
  CHECK(street.program("merge part1.h5 -o out.h5").exit_code == 3);
}
