// read_vehicle: a vehicle's file and those that it names.
#include <numbers>

#include "clearway/clearway.hpp"
#include "io/paths/content_hash.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A folder with a path, a quarter of a circle of 20 m, and models of points, of a triangle and of
/// a solid.
struct Files {
  Files() {
    std::string own;
    for (int i = 0; i <= 150; ++i) {
      const double angle = std::numbers::pi / 300 * i, c = std::cos(angle), s = std::sin(angle);
      path.push_back({{c, -s, 0, s, c, 0, 0, 0, 1}, {20 * s, 20 - 20 * c, 0}});
      own += "1 0 0 " + std::to_string(i) + " 0 1 0 5 0 0 1 0\n";
    }
    put_bytes(folder / "own.txt", own);
    put_bytes(folder / "line.xyz", "0 -100 100\n0 0 100\n0 100 100\n");
    put_bytes(folder / "fin.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  }

  std::vector<Body> read(const std::string& bodies, const VehicleOptions& options = {},
                         std::vector<Message>* warnings = nullptr) const {
    put_bytes(folder / "v.json", "{\"bodies\": [" + bodies + "]}");
    return read_vehicle(folder / "v.json", path, options, warnings);
  }

  ScratchFolder folder;
  std::vector<Pose> path;
};

}  // namespace

TEST_CASE("a vehicle's file gives the bodies that follow gives") {
  const Files files;
  std::vector<Message> told, expected_told;
  const auto bodies = files.read(
      R"({"name": "body", "model": "line.xyz", "model_unit": "cm", "pivots": [5, "-500cm"]},
         {"name": "bogie", "model": "fin.off", "at": 5, "floor": "20cm"},
         {"name": "path", "model": "fin.off"},
         {"name": "crane", "model": "fin.off", "trajectory": "own.txt"})",
      {}, &told);
  REQUIRE(bodies.size() == 4);
  const Model fin = read_model(files.folder / "fin.off", {.as = ModelAs::kSurface});
  Body body = follow({"body", {{0, -1, 1}, {0, 0, 1}, {0, 1, 1}}, {}, {}}, files.path,
                     BodyPivots{5, -5}, &expected_told);
  Body bogie = follow({"bogie", fin, {}, {}}, files.path, BodyStation{5}, &expected_told);
  CHECK(hash_of_bodies({{bodies[1]}}) != hash_of_bodies({{bogie}}));
  bogie.floor = 0.2;
  CHECK(!bodies[0].floor);
  CHECK(bodies[0].path_pose.size() < files.path.size());
  CHECK(bodies[1].path_pose.size() < files.path.size());
  CHECK(hash_of_bodies({{bodies[0]}}) == hash_of_bodies({{body}}));
  CHECK(hash_of_bodies({{bodies[1]}}) == hash_of_bodies({{bogie}}));
  CHECK(bodies[2].poses == files.path);
  CHECK(bodies[3].poses[7].translation[0] == 7);
  CHECK(bodies[3].path_pose.back() == 150);
  REQUIRE(told.size() >= expected_told.size());
  check_says(told.front().text, "v.json ... body");
  std::vector<std::string> surfaces;  // the messages about a body's model name the body
  for (const Message& message : told) {
    if (message.text.find("searched as a surface") != std::string::npos) {
      surfaces.push_back(message.body);
    }
  }
  check_equal(surfaces, {"bogie", "path", "crane"});
}

TEST_CASE("options hold for all bodies, and threads change none") {
  const Files files;
  const std::string bodies = R"({"name": "a", "model": "line.xyz", "pivots": ["1m", -1]},
                                {"name": "b", "model": "fin.off", "at": "-2m"})";
  VehicleOptions options;
  options.threads = 1;
  const std::uint64_t hash = hash_of_bodies(files.read(bodies, options));
  options.threads = 3;
  CHECK(hash_of_bodies(files.read(bodies, options)) == hash);
  options.model.environment_unit = 0.5;  // "1m" is two of these, -1 is one
  CHECK(files.read(bodies, options)[1].path_pose.front() > files.read(bodies)[1].path_pose.front());
  options.model = {.as = ModelAs::kPoints, .spacing = 0.1};
  CHECK(files.read(bodies, options)[1].model.triangles.empty());
  CHECK(files.read(bodies, options)[1].model.vertices.size() > 20);
}

TEST_CASE("towed bodies of a file are those that follow gives, in any order") {
  const Files files;
  std::vector<Message> told;
  const auto bodies = files.read(
      R"({"name": "second", "model": "line.xyz",
          "towed": {"by": "trailer", "at": "-90cm", "pivots": [6, 0]}},
         {"name": "trailer", "model": "fin.off",
          "towed": {"by": "truck", "at": -0.6, "pivots": ["9.2m", 1.4]}},
         {"name": "truck", "model": "line.xyz", "pivots": [3, -1]},
         {"name": "crane", "model": "line.xyz", "trajectory": "own.txt"},
         {"name": "load", "model": "line.xyz", "towed": {"by": "crane", "at": 0, "pivots": [2, 0]}},
         {"name": "free", "model": "line.xyz", "towed": {"at": -1, "pivots": [4, 0]}})",
      {}, &told);
  std::vector<Body> given = bodies;
  for (Body& body : given) {
    if (body.name != "crane") body.poses.clear(), body.path_pose.clear();
  }
  const auto expected = follow(
      given, files.path,
      {BodyTowed{"trailer", -0.9, 6, 0}, BodyTowed{"truck", -0.6, 9.2, 1.4}, BodyPivots{3, -1},
       BodyOwnPoses{}, BodyTowed{"crane", 0, 2, 0}, BodyTowed{"", -1, 4, 0}});
  REQUIRE(bodies.size() == 6);
  CHECK(hash_of_bodies(bodies) == hash_of_bodies(expected));
  CHECK(bodies[0].path_pose == bodies[2].path_pose);
  CHECK(bodies[2].path_pose.size() < files.path.size());
  CHECK(bodies[4].path_pose == bodies[3].path_pose);
  const auto alone =
      files.read(R"({"name": "free", "model": "line.xyz", "towed": {"at": -1, "pivots": [4, 0]}})",
                 {.threads = 1});
  CHECK(hash_of_bodies(alone) == hash_of_bodies({{bodies[5]}}));
}

TEST_CASE("towed bodies are the same in feet") {
  Files files;
  const std::string body = R"({"name": "a", "model": "line.xyz",
                               "towed": {"at": "-1m", "pivots": ["4m", "0m"]}})";
  const auto metres = files.read(body);
  constexpr double kFoot = 0.3048;
  for (Pose& pose : files.path) {
    for (double& coordinate : pose.translation) coordinate /= kFoot;
  }
  VehicleOptions options;
  options.model.environment_unit = kFoot;
  const auto feet = files.read(body, options);
  REQUIRE(feet[0].poses.size() == metres[0].poses.size());
  for (std::size_t i = 0; i < feet[0].poses.size(); ++i) {
    check_near(kFoot * feet[0].poses[i].position(), metres[0].poses[i].position(), 1e-6);
  }
}

TEST_CASE("errors name the file and the key") {
  const Files files;
  const auto refused = [&](const std::string& body, const char* words,
                           const VehicleOptions& options = {}) {
    check_refused([&] { files.read(body, options); }, words);
  };
  const std::string none = R"({"name": "a", "model": "none.xyz"})";
  refused(R"({"name": "a", "model": "line.xyz", "pivots": [1, "x"]})",
          "v.json: bodies[0].pivots[1]: is \"x\", expected a length");
  refused(none, "v.json: bodies[0].model: ");
  CHECK_THROWS_AS(files.read(none), ResourceError);
  put_bytes(files.folder / "own.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  refused(R"({"name": "a", "model": "line.xyz", "trajectory": "own.txt"})",
          "bodies[0].trajectory: ... expected as many as the path: 151");
  VehicleOptions solid;
  solid.model.as = ModelAs::kSolid;
  refused(R"({"name": "a", "model": "line.xyz"})", "bodies[0].model: ", solid);
  CHECK_THROWS_AS(read_vehicle(files.folder / "no.json", files.path), ResourceError);
  CHECK_THROWS_AS(files.read(""), InputError);
}

TEST_CASE("a body whose station or pivots are far from the vehicle is warned of") {
  Files files;
  files.path.clear();
  for (int i = 0; i <= 400; ++i) files.path.push_back(translation({0.5 * i, 0, 0}));
  put_bytes(files.folder / "wagon.xyz", "-5 -1 0\n5 1 3\n");
  put_bytes(files.folder / "bogie.xyz", "-1.5 -1 0\n1.5 1 1\n");
  const auto body = [](const std::string& name, const std::string& model, const std::string& more) {
    return R"({"name": ")" + name + R"(", "model": ")" + model + R"(.xyz", )" + more + "}";
  };
  const auto check_codes = [&](const std::string& bodies, const char* codes) {
    CAPTURE(bodies);
    std::vector<Message> told;
    files.read(bodies, {}, &told);
    std::erase_if(told, [](const Message& m) { return m.severity == Message::Severity::kNote; });
    check_equal(codes_of(told), codes);
  };
  const std::string wagon = body("wagon", "wagon", R"("pivots": [4, -4])");
  check_codes(wagon, "");
  check_codes(wagon + "," + body("front", "bogie", R"("at": 4)"), "");
  check_codes(body("front", "bogie", R"("at": 10)") + "," + body("rear", "bogie", R"("at": -10)"),
              "");
  check_codes(body("wagon", "wagon", R"("at": -50)"), "body-far");
  check_codes(body("wagon", "wagon", R"("pivots": [-46, -54])"), "body-far");
  check_codes(wagon + "," + body("rear", "bogie", R"("at": -48)"), "body-far");
  // Wagons in a row are one vehicle: none counts as far from the path.
  check_codes(wagon + "," + body("b", "wagon", R"("at": -20)") + "," +
                  body("c", "wagon", R"("at": -40)") + "," + body("d", "wagon", R"("at": -60)"),
              "");
  const auto towed = [&](const std::string& at, const std::string& pivots) {
    return R"({"name": "truck", "model": "wagon.xyz"},)" +
           body("a", "wagon",
                R"("towed": {"by": "truck", "at": )" + at + R"(, "pivots": )" + pivots + "}");
  };
  check_codes(towed("-6", "[6, -4]"), "");
  check_codes(towed("-60", "[6, -4]"), "body-far");
  check_codes(towed("-6", "[60, 55]"), "body-far, body-far");
  // 150 of 200 m: most of the path is not searched, though it is only its end.
  check_codes(body("wagon", "wagon", R"("at": -150)"), "body-off-path, body-far");
}
