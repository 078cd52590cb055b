#include <chrono>
#include <cstring>
#include <functional>

#include "io/files/xxh64.hpp"
#include "io/store/convert/count.hpp"
#include "io/store/convert/distribute.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

namespace fs = std::filesystem;

/// Two scans, and a file of the second one's size with other points in the same place.
struct Scans : Conversion {
  Scans() {
    add_las("a.las", points);
    add_las("b.las", points);
    auto others = points;
    std::swap(others.front(), others.back());
    write_las(other, others);
    // The file's time is set back, so that a change is seen however coarse the file system's clock
    // is.
    fs::last_write_time(second, fs::last_write_time(second) - std::chrono::hours(1));
  }

  std::string refusal_of_change(const std::string& stage, const std::function<void()>& change) {
    WatchedStage progress(stage, change);
    try {
      convert_scans(options, progress);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  fs::path second = folder / "b.las", other = folder / "other.las";
  std::vector<Quantum> points = cube_cloud(1000, -50, 50, 1);
};

}  // namespace

TEST_CASE("an input that changes before its last pass is refused by name") {
  Scans scans;
  const std::string stage = GENERATE("count", "distribute");
  std::function<void()> change;
  SECTION("another file has its name") {
    change = [&scans] { fs::rename(scans.other, scans.second); };
  }
  SECTION("other points are written to it") {
    change = [&scans] { put_bytes(scans.second, bytes_of(scans.other)); };
  }
  SECTION("all but its points changes") {
    change = [&scans] {
      std::string bytes = bytes_of(scans.second);
      bytes[58] ^= 1;  // a byte of the generating software's name
      put_bytes(scans.second, bytes);
    };
  }
  SECTION("its points are the same, their scale is not") {
    change = [&scans] {
      write_las(scans.second, scans.points, {{0.01, 0.01, 0.01}, {100, -200, 0}});
    };
  }
  check_says(scans.refusal_of_change(stage, change), "b.las: changed");
  CHECK_FALSE(fs::exists(scans.options.output));
  CHECK_FALSE(fs::exists(scans.folder / "a.h5.partial"));
}

TEST_CASE("points are distributed only where they are those that were counted") {
  Scans scans;
  NoProgress progress;
  EnvironmentSource environment(scans.options, progress);
  const Lattice lattice;
  PlaceSample sample;
  FileBoxes boxes;
  PlaceCounter places({});
  StageClocks clocks;
  FileHashes hashes(environment.files(), {false, false});
  CountedEnvironment counted =
      count_environment(environment, lattice, sample, boxes, hashes, 1, clocks, progress);
  const SplitTree tree(counted.bins, lattice, environment.quantisation().scale);
  const auto distribute_again = [&] {
    std::vector<File> files;
    files.push_back(File::create_temporary(scans.folder.folder()));
    Distribution distribution(tree, std::move(files));
    distribute(environment, counted, lattice, tree, places, distribution, 2, clocks, progress);
    return distribution.take(0).span().size();
  };
  check_equal(distribute_again(), 2000);
  std::string classed = bytes_of(scans.second);
  std::uint32_t points_offset = 0;
  std::memcpy(&points_offset, classed.data() + 96, sizeof points_offset);
  classed[points_offset + 15] = 2;
  const std::string before = bytes_of(scans.second);
  put_bytes(scans.second, classed);
  CHECK_THROWS_AS(distribute_again(), InputError);
  put_bytes(scans.second, before);
  put_bytes(scans.second, bytes_of(scans.other));
  CHECK_THROWS_AS(distribute_again(), InputError);
}

TEST_CASE("an input may change once its points are distributed") {
  Scans scans;
  const std::string before = bytes_of(scans.second);
  check_equal(scans.refusal_of_change("partition", [&] { fs::rename(scans.other, scans.second); }),
              "");
  const StoreReader store(scans.options.output);
  CHECK(points_by_source(store).back() == scans.points.back());
  CHECK(store.metadata().sources[1].xxh64 == xxh64(std::as_bytes(std::span(before))));
}
