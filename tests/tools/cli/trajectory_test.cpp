#include "clearway/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/trajectory/trajectory_summary.hpp"
#include "io/paths/trajectory_file.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kModel{{-1, -2, 0}, {3, 2, 1}};

/// A folder with model.xyz, whose box is kModel, and path.txt.
struct PathFiles : Workplace {
  PathFiles() {
    put("model.xyz", "-1 -2 0.5\n3 1 0\n0 2 1\n");
    Random random(51);
    for (int i = 0; i < 30; ++i) {
      poses.push_back(rotation(random_direction(random), uniform(random, 0, 1),
                               {5e5 + i, uniform(random, 0, 1), 0}));
    }
    poses.insert(poses.begin() + 10, 5, poses[10]);
    NoProgress progress;
    write_trajectory(poses, File::create(folder / "path.txt"), progress);
  }

  Outcome run(const std::string& what, const std::string& in, const std::string& out,
              const std::string& more) const {
    return run_program(
        folder, "trajectory " + what + " " + in + " -o " + out + " --model model.xyz " + more);
  }
  std::vector<Pose> read(const std::string& name) const {
    return read_trajectory(folder / name, {.allow_non_rigid = true});
  }

  std::vector<Pose> poses;
};

bool has_in_order(const std::vector<Pose>& all, const std::vector<Pose>& some) {
  auto at = all.begin();
  for (const Pose& pose : some) {
    at = std::find(at, all.end(), pose);
    if (at == all.end()) return false;
    ++at;
  }
  return true;
}

}  // namespace

TEST_CASE("trajectory resample bounds the motion of the poses as read back") {
  const PathFiles files;
  const Outcome outcome =
      require_success(files.run("resample", "path.txt", "out.txt", "--max-motion 0.05 --json"));
  const auto out = files.read("out.txt");
  CHECK(largest_motion(kModel, out) <= 0.05);
  CHECK(has_in_order(out, files.poses));
  const auto json = json_of(outcome);
  CHECK(json["poses_in"] == files.poses.size());
  CHECK(json["poses_out"] == out.size());
  check_json(json, R"({"max_motion": 0.05})");
  CHECK(json["largest_motion_before"] == largest_motion(kModel, files.poses));
  CHECK(json["largest_motion_after"] == largest_motion(kModel, out));
}

TEST_CASE("trajectory thin keeps some of the poses, and what it wrote can be resampled") {
  const PathFiles files;
  const Outcome outcome =
      require_success(files.run("thin", "path.txt", "thin.txt", "--max-motion 3 --json"));
  const auto kept = files.read("thin.txt");
  CHECK(kept.size() < files.poses.size());
  CHECK(kept.front() == files.poses.front());
  CHECK(has_in_order(files.poses, kept));
  CHECK(json_of(outcome)["poses_out"] == kept.size());
  check_says(outcome.err, std::to_string(kept.size()) + " poses, from 35");
  require_success(files.run("resample", "thin.txt", "again.txt", "--max-motion 0.1"));
  const auto again = files.read("again.txt");
  CHECK(has_in_order(again, kept));
  CHECK(largest_motion(kModel, again) <= 0.1);
}

TEST_CASE("trajectory reads the formats that run reads") {
  const PathFiles files;
  files.put("tum.txt", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 1 0\n");
  files.put("euroc.csv", "0,0,0,0,1,0,0,0\n1,1,0,0,0,0,0,1\n");
  require_success(files.run("resample", "tum.txt", "a.txt", "--max-motion 0.1"));
  require_success(
      files.run("resample", "euroc.csv", "b.txt", "--max-motion 0.1 --trajectory-format euroc"));
  CHECK(files.read("a.txt").size() > 30);
  CHECK(files.read("a.txt") == files.read("b.txt"));
  check_says(files.bytes("a.txt"),
             "# made by clearway trajectory resample of tum.txt: 2 given poses "
             "among ");
}

TEST_CASE("trajectory overwrites neither outputs nor inputs") {
  const PathFiles files;
  const std::string what = GENERATE("resample", "thin");
  files.put("out.txt", "mine");
  check_outcome(files.run(what, "path.txt", "out.txt", "--max-motion 1"), 2, "--force");
  check_same(files.bytes("out.txt"), "mine");
  check_outcome(files.run(what, "path.txt", "out.txt", "--max-motion 1 --force"), 0);
  CHECK(files.bytes("out.txt") != "mine");
  for (const std::string input : {"path.txt", "model.xyz"}) {
    const std::string before = files.bytes(input);
    check_outcome(files.run(what, "path.txt", input, "--max-motion 1 --force"), 2);
    check_same(files.bytes(input), before);
  }
  check_outcome(files.run(what, "path.txt", "no/folder.txt", "--max-motion 1"), 4);
}

TEST_CASE("trajectory refuses what it cannot use and leaves no output") {
  const PathFiles files;
  const std::string what = GENERATE("resample", "thin");
  for (const std::string bad : {"0", "-1", "nan", "inf", "far"}) {
    check_outcome(files.run(what, "path.txt", "out.txt", "--max-motion " + bad), 2);
  }
  check_outcome(files.run(what, "path.txt", "out.txt", ""), 2);
  check_outcome(files.run(what, "missing.txt", "out.txt", "--max-motion 1"), 4);
  files.put("scaled.txt", "2 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  const Outcome scaled = files.run(what, "scaled.txt", "out.txt", "--max-motion 1");
  check_outcome(scaled, 3, "line 1 ... --allow-non-rigid");
  CHECK_FALSE(files.has("out.txt"));
  CHECK_FALSE(files.has("out.txt.partial"));
  check_outcome(files.run(what, "scaled.txt", "out.txt", "--max-motion 1 --allow-non-rigid"), 0);
}

TEST_CASE("trajectory resample refuses a jump that takes too many poses") {
  const PathFiles files;
  files.put("jump.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 9e6 0 1 0 0 0 0 1 0\n");
  check_outcome(files.run("resample", "jump.txt", "out.txt", "--max-motion 0.01"), 2,
                "poses 0 and 1 ... expected 0.909 or more");
  CHECK_FALSE(files.has("out.txt"));
}

TEST_CASE("trajectory resample names poses that mirror the model by turns") {
  const PathFiles files;
  files.put("mirror.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n-1 0 0 0 0 1 0 0 0 0 1 0\n");
  check_outcome(
      files.run("resample", "mirror.txt", "out.txt", "--max-motion 0.1 --allow-non-rigid"), 3,
      "mirror.txt: poses 0 and 1 ... mirrors");
}

TEST_CASE("resample, thin and follow warn of poses that are missing, as their output hides it") {
  const PathFiles files;
  std::string gap, turn;
  for (int i = 0; i < 60; ++i) {
    gap += pose_at(i < 30 ? i * 0.5 : 10 + i * 0.5);
    turn += (i < 30 ? "1 0 0 " : "0 -1 0 ") + std::to_string(i * 0.5) +
            (i < 30 ? " 0 1 0 0 0 0 1 0\n" : " 1 0 0 0 0 0 1 0\n");
  }
  files.put("gap.txt", gap);
  files.put("turn.txt", turn);
  files.put("even.txt", gap.substr(0, gap.size() / 2));
  for (const std::string what : {"resample", "thin"}) {
    for (const std::string in : {"gap.txt", "turn.txt"}) {
      const Outcome outcome = files.run(what, in, "out.txt", "--max-motion 0.6 --force");
      check_outcome(outcome, 0, "the step from pose 29 to 30 is");
      check_says(outcome.err, what == "thin" ? "does not show it" : "are a guess");
    }
    const Outcome even = files.run(what, "even.txt", "out.txt", "--max-motion 0.6 --force");
    CHECK(even.err.find("the step from") == std::string::npos);
  }
  const auto follow = [&](const std::string& in) {
    return run_program(files.folder, "trajectory follow " + in + " --at 1 --force -o out.txt");
  };
  check_says(follow("gap.txt").err, "the step from pose 29 to 30 is 10.5 m long");
  CHECK(follow("even.txt").err.find("the step from") == std::string::npos);
}

TEST_CASE("an empty trajectory stays one, with a warning") {
  const PathFiles files;
  const std::string what = GENERATE("resample", "thin");
  files.put("empty.txt", "");
  const Outcome outcome = files.run(what, "empty.txt", "out.txt", "--max-motion 1 --json");
  check_outcome(outcome, 0, "no poses");
  CHECK(files.bytes("out.txt").empty());
  check_json(json_of(outcome), R"({"poses_out": 0})");
}

TEST_CASE("resample takes the meaning of ft from the store") {
  const PathFiles files;
  files.put("scan.xyz", "0 0 0\n100 100 0\n");
  require_success(run_program(files.folder, "convert --unit us-ft scan.xyz -o s.h5"));
  const std::string feet = "--trajectory-unit ft --max-motion 0.5";
  require_success(files.run("resample", "path.txt", "feet.txt", feet + " --env s.h5"));
  // The file is in the store's own foot, so its positions stay as they are, and the new one says
  // ft.
  const TrajectoryOptions in_feet{.allow_non_rigid = true,
                                  .environment_unit = kMetresPerUsSurveyFoot};
  CHECK(has_in_order(read_trajectory(files.folder / "feet.txt", in_feet), files.poses));
  check_says(run_program(files.folder, "convert --unit us-ft --resume scan.xyz -o s.h5").err,
             "is the store of these inputs already, with coordinates in ");
  check_refused(run_program(files.folder, "convert --resume scan.xyz -o s.h5"), 2,
                "its unit is 0.3048006096012192 m, expected none");
}

TEST_CASE("resample and thin keep stations, and put those of new poses between them") {
  const PathFiles files;
  std::vector<double> stations;
  for (std::size_t i = 0; i < files.poses.size(); ++i) {
    stations.push_back(700 - 3 * static_cast<double>(i));
  }
  NoProgress progress;
  write_trajectory_table(files.poses, {.station = stations}, {.unit = FileUnit::exactly(1)},
                         File::create(files.folder / "line.csv"), progress);
  const std::string given = "--trajectory-format csv --allow-non-rigid ";
  const auto read = [&](const std::string& name, std::vector<double>& found) {
    PoseLabels labels;
    const auto poses =
        read_trajectory(files.folder / name, {TrajectoryFormat::kCsv, true}, nullptr, &labels);
    found = labels.station;
    REQUIRE(found.size() == poses.size());
    return poses;
  };
  const Outcome dense =
      require_success(files.run("resample", "line.csv", "dense.csv", given + "--max-motion 0.5"));
  std::vector<double> found;
  const std::vector<Pose> more = read("dense.csv", found);
  REQUIRE(more.size() > 2 * files.poses.size());
  CHECK(has_in_order(more, files.poses));
  std::vector<double> way{0};
  for (std::size_t i = 1; i < more.size(); ++i) {
    const double* a = more[i - 1].translation;
    const double* b = more[i].translation;
    way.push_back(way.back() + std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]));
  }
  std::size_t last = 0, next = 1;  // of the given poses, the last one met
  for (std::size_t i = 1, from = 0; i < more.size(); ++i) {
    if (next < files.poses.size() && more[i] == files.poses[next]) {
      CHECK(found[i] == stations[next]);
      for (std::size_t k = from + 1; k < i; ++k) {
        const double part = (way[k] - way[from]) / (way[i] - way[from]);
        CHECK(found[k] == Approx(stations[last] + part * (stations[next] - stations[last])));
      }
      from = i;
      last = next++;
    }
  }
  CHECK(next == files.poses.size());

  const Outcome thin =
      require_success(files.run("thin", "line.csv", "thin.csv", given + "--max-motion 3"));
  const std::vector<Pose> fewer = read("thin.csv", found);
  REQUIRE(fewer.size() < files.poses.size());
  for (std::size_t i = 0; i < fewer.size(); ++i) {
    const auto at = std::find(files.poses.begin(), files.poses.end(), fewer[i]);
    CHECK(found[i] == stations[static_cast<std::size_t>(at - files.poses.begin())]);
  }
}

TEST_CASE("trajectory smooth says what it does, and keeps to it as read back") {
  const PathFiles files;
  std::string noisy, table = "x,y,z,qx,qy,qz,qw,station,time\n", jump;
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    const std::string y = std::to_string(0.2 * std::sin(0.05 * i) + uniform(random, -0.004, 0.004));
    const std::string x = std::to_string(0.05 * i + (i > 150 ? 2 : 0));
    noisy += "1 0 0 " + std::to_string(0.05 * i) + " 0 1 0 " + y + " 0 0 1 0\n";
    jump += "1 0 0 " + x + " 0 1 0 " + y + " 0 0 1 0\n";
    table += std::to_string(0.05 * i) + "," + y + ",0,0,0,0,1," + std::to_string(100 + i) + "," +
             std::to_string(i) + "\n";
  }
  files.put("noisy.txt", noisy);
  files.put("jump.txt", jump);
  files.put("noisy.csv", table);
  const auto report =
      json_of(require_success(files.run("smooth", "noisy.txt", "out.txt", "--within 0.02 --json")));
  const auto out = files.read("out.txt");
  CHECK(report["poses_out"] == out.size());
  check_json(report, R"({"poses_in": 200, "within": 0.02, "step": 0.1})");
  CHECK(report["largest_deviation"] <= 0.02);
  CHECK(report["largest_step"] == largest_motion(kModel, out));
  CHECK(largest_motion(kModel, out) <= 0.1);
  const double error = report["error_model"], between = report["error_model_between_poses"];
  const double deviation = report["largest_deviation"], step = report["largest_step"];
  CHECK((error >= deviation + step / 2 && error < deviation + step / 2 + 1e-4));
  CHECK((between >= deviation && between < deviation + 1e-4));

  require_success(files.run("smooth", "noisy.csv", "out.csv", "--within 0.02"));
  check_says(files.bytes("out.csv"), "station");
  check_outcome(files.run("smooth", "noisy.txt", "out.txt", "--within 0.02"), 2, "--force");
  check_outcome(files.run("smooth", "noisy.txt", "noisy.txt", "--within 0.02 --force"), 2);
  check_outcome(files.run("smooth", "noisy.txt", "new.txt", ""), 2, "--within");
  check_outcome(files.run("smooth", "noisy.txt", "new.txt", "--within 0"), 2);
  check_outcome(files.run("smooth", "jump.txt", "new.txt", "--within 0.02"), 3,
                "jump.txt: jumps by ... from pose 150 to pose 151");
  check_outcome(run_program(files.folder, "trajectory smooth path.txt -o new.txt --within 0.1"), 2,
                "expected the model");
  require_success(run_program(files.folder, "trajectory smooth noisy.txt -o new.txt --within 2cm"));
}
