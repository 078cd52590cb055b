// Warnings of a conversion, repeated by the commands that read its store.
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/store/convert/convert.hpp"
#include "io/store/store_reader.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

std::ptrdiff_t count_of(const std::vector<std::string>& codes, const std::string& code) {
  return std::count(codes.begin(), codes.end(), code);
}

/// A wall beside a straight path, in metres; some lines of the scan are no finite points.
struct Wall : Workplace {
  explicit Wall(int lost) {
    std::string points = "x[m],y[m],z[m]\n";
    for (int i = 0; i < 4000; ++i) {
      points += std::to_string(0.05 * (i % 200) + 0.000'137 * (i % 89)) + "," +
                std::to_string(i / 200 * 0.05 + 0.000'113 * (i % 97)) + "," +
                std::to_string(0.01 * (i % 7) + 0.000'127 * (i % 83)) + "\n";
    }
    for (int i = 0; i < lost; ++i) points += "nan,nan,nan\n";
    put("scan.csv", points);
    put("model.xyz", "0 0 0\n0.1 0 0\n");
    put("path.txt", "1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 1.1 0 1 0 0 0 0 1 0\n");
  }

  Outcome convert(const std::string& rest = "--force") const {
    return Workplace::run("convert --json scan.csv -o site.h5 " + rest);
  }
  Outcome run(const std::string& rest, const std::string& output = "out.h5") const {
    return Workplace::run(
        "run --force --radius 0.2 --first-pose --env site.h5 --model model.xyz "
        "--trajectory path.txt -o " +
        output + " " + rest);
  }
};

}  // namespace

TEST_CASE("run, info, report and merge repeat what the conversion warned of") {
  const Wall wall(3);
  REQUIRE(codes_in(json_of(wall.convert())["warnings"]) ==
          std::vector<std::string>{"non-finite-points"});
  const std::string code = "store-non-finite-points";
  const auto program = [&](const std::string& arguments) {
    return run_program(wall.folder, arguments);
  };
  const Outcome run = require_success(wall.run("--json"));
  CHECK(count_of(codes_in(json_of(run)["warnings"]), code) == 1);
  check_says(run.err, "3 points");
  const Outcome info = program("info --json site.h5");
  CHECK(count_of(codes_in(json_of(info)["warnings"]), code) == 1);
  check_says(program("info site.h5").out, code);
  check_outcome(program("verify site.h5"), 0);
  check_says(require_success(program("report out.h5 --env site.h5 --model model.xyz --trajectory "
                                     "path.txt --json -o page.html"))
                 .out,
             code);

  require_success(wall.run("--shard 1/2", "a.h5"));
  require_success(wall.run("--shard 2/2", "b.h5"));
  const std::string parts = "a.h5 b.h5";
  const Outcome merged = require_success(program("merge --json " + parts + " -o all.h5"));
  CHECK(count_of(codes_in(json_of(merged)["warnings"]), code) == 1);
}

TEST_CASE("a strict run counts its own warnings, not those of the store") {
  const Wall wall(3), sound(0);
  wall.convert();
  sound.convert();
  const Outcome without = sound.run("--strict"), with = wall.run("--strict");
  CAPTURE(without.err, with.err);
  CHECK(with.exit_code == without.exit_code);
  CHECK_THAT(with.err, !Contains("strict") || !Contains("(store-"));
}

TEST_CASE("a store that is there already tells its warnings again") {
  const Wall wall(3);
  wall.convert();
  const json report = json_of(require_success(wall.convert("--resume")));
  check_json(report, R"({"was_finished": true})");
  CHECK(codes_in(report["warnings"]) == std::vector<std::string>{"non-finite-points"});
  check_outcome(wall.convert("--resume --strict"), 3);
  const Wall sound(0);
  sound.convert();
  CHECK(StoreReader(sound.folder / "site.h5").metadata().warnings.empty());
  check_outcome(sound.convert("--resume --strict"), 0);
}

TEST_CASE("a store keeps few and short warnings") {
  std::vector<Message> many(99,
                            {Message::Severity::kWarning, "same-place", std::string(5000, 'x')});
  many.push_back({Message::Severity::kWarning, "cut-off", std::string(5000, 'x')});
  const std::vector<Message> kept = kept_warnings(many);
  REQUIRE(kept.size() == 64);
  CHECK(kept[0].code == "cut-off");  // which puts answers in doubt
  CHECK(kept[0].text.size() < 1010);
  CHECK(kept[63].code == "more-warnings");
  CHECK(kept[63].numbers[0].second == 37);
  CHECK(kept_warnings({}).empty());
}

TEST_CASE("zeros and points beyond the header's bounds are told of small files too") {
  const Workplace place;
  LasBytes las;
  las.scale = {0.001, 0.001, 0.001};
  las.offset = {1000, 2000, 0};
  const auto codes = [&](const std::vector<std::array<std::int32_t, 3>>& points) {
    las.points = points;
    std::string bytes = las.build();
    for (unsigned k = 0; k < 3; ++k) {  // bounds of 0 to 10 m from the offset
      LasBytes::put(bytes, 179 + 16 * k, las.offset[k] + 10);
      LasBytes::put(bytes, 187 + 16 * k, las.offset[k]);
    }
    place.put("a.las", bytes);
    const Outcome outcome = require_success(place.run("convert --json --force a.las -o a.h5"));
    return codes_in(json_of(outcome)["warnings"]);
  };
  std::vector<std::array<std::int32_t, 3>> points;
  for (std::int32_t i = 0; i < 20; ++i) points.push_back({487 * i + 3, 251 * i + 1, 97 * i});
  CHECK(codes(points).empty());
  auto half = points;
  half.insert(half.end(), 20, {0, 0, 0});
  CHECK(codes(half) == std::vector<std::string>{"same-place"});
  auto far = points;
  far.push_back({5'000, 40'000, 0});
  CHECK(codes(far) == std::vector<std::string>{"declared-bounds"});
  auto all_far = points;
  for (auto& point : all_far) point[1] += 40'000;
  CHECK(codes(all_far) == std::vector<std::string>{"outside-bounds"});
  auto near = points;
  near.push_back({5'000, 10'400, 0});
  CHECK(codes(near).empty());
}
