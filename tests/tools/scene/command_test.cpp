#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/catch.hpp"

namespace fs = std::filesystem;

namespace {

/// A temporary folder that is removed when its owner ends.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "clearway-scene-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~Folder() { fs::remove_all(path_); }

  fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

/// The exit code of `clearway scene ARGUMENTS`, run by a shell.
int run_scene(const std::string& arguments) {
  const std::string command =
      std::string(CLEARWAY_PROGRAM) + " scene " + arguments + " 2>/dev/null";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

const std::string kSmall = " --points 30000 --model-points 100 --poses 10 ";

}  // namespace

TEST_CASE("scene writes four files, the same when piped") {
  const Folder folder;
  const std::string a = (folder / "a").string(), b = (folder / "b").string();
  REQUIRE(run_scene("tunnel -o " + a + kSmall) == 0);
  REQUIRE(run_scene("tunnel -o " + b + kSmall + "--environment - >" + b + ".las") == 0);
  CHECK(contents(a + "/environment.las").size() == 227 + 20 * 30000);
  CHECK(contents(a + "/environment.las") == contents(b + ".las"));
  for (const char* name : {"/model.ply", "/trajectory.txt", "/origins.csv"}) {
    CHECK_FALSE(contents(a + name).empty());
    CHECK(contents(a + name) == contents(b + name));
  }
  CHECK_FALSE(fs::exists(b + "/environment.las"));
}

TEST_CASE("scene overwrites nothing without --force") {
  const Folder folder;
  const std::string out = (folder / "a").string();
  REQUIRE(run_scene("hall -o " + out + kSmall) == 0);
  const std::string before = contents(out + "/environment.las");
  CHECK(run_scene("hall --seed 2 -o " + out + kSmall) == 2);
  CHECK(contents(out + "/environment.las") == before);
  CHECK(run_scene("hall --seed 2 --force -o " + out + kSmall) == 0);
  CHECK(contents(out + "/environment.las") != before);
}

TEST_CASE("scene leaves no file behind when writing fails") {
  const Folder folder;
  const std::string out = (folder / "a").string();
  CHECK(run_scene("hall -o " + out + kSmall + "--environment - >/dev/full") == 4);
  CHECK(fs::is_empty(out));
  CHECK(run_scene("hall -o /dev/null/folder" + kSmall) == 4);
}

TEST_CASE("scene refuses what it cannot make as wrong usage") {
  const Folder folder;
  const std::string out = " -o " + (folder / "a").string();
  CHECK(run_scene("cathedral" + out) == 2);
  CHECK(run_scene("hall" + out + " --points 0") == 2);
  CHECK(run_scene("hall" + out + " --points -5") == 2);
  CHECK(run_scene("hall" + out + " --environment file.las") == 2);
  CHECK(run_scene("hall") == 2);
  CHECK_FALSE(fs::exists(folder / "a"));
}
