#include <hdf5.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "clearway/error.hpp"
#include "io/files/hdf5.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

ResultHeader header_of_3() {
  ResultHeader header = sample_header(false);
  header.poses = 3;
  header.profile = 0.5;
  return header;
}

/// Replaces an attribute behind the reader's back.
template <typename Write>
void replace(const std::filesystem::path& path, const char* name, Write write) {
  const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
  REQUIRE(H5Adelete(file.get(), name) >= 0);
  write(file);
}

}  // namespace

TEST_CASE("results of other versions are refused") {
  const ScratchFolder folder;
  write_result(folder / "a.h5", header_of_3(), {}, 1000, {}, sample_profile(header_of_3()));
  const auto version = GENERATE(as<std::uint32_t>(), 0, 5, 7, 0xffffffff);
  replace(folder / "a.h5", "version",
          [&](const hdf5::Id& file) { hdf5::write_number(file, "version", version); });
  CHECK_THROWS_WITH(ResultReader(folder / "a.h5"),
                    Contains("is a result of version " + std::to_string(version) +
                             " of another release; run it again"));
}

TEST_CASE("malformed attributes of a profile and a model box are refused") {
  const ScratchFolder folder;
  write_result(folder / "a.h5", header_of_3(), {}, 1000, {}, sample_profile(header_of_3()));
  std::string expected;
  SECTION("a negative length") {
    replace(folder / "a.h5", "profile",
            [](const hdf5::Id& file) { hdf5::write_number(file, "profile", -0.5); });
    expected = "'profile'";
  }
  SECTION("no number") {
    replace(folder / "a.h5", "profile",
            [](const hdf5::Id& file) { hdf5::write_number(file, "profile", std::nan("")); });
    expected = "'profile'";
  }
  SECTION("more poses than rows") {
    replace(folder / "a.h5", "poses",
            [](const hdf5::Id& file) { hdf5::write_number(file, "poses", std::uint64_t{4}); });
    expected = "one for each of 4 poses";
  }
  SECTION("a box from high to low") {
    replace(folder / "a.h5", "model_box", [](const hdf5::Id& file) {
      hdf5::write_attribute<double>(file, "model_box", std::vector<double>{0, 0, 1, 0, 0, 0}, 3);
    });
    expected = "'model_box'";
  }
  SECTION("a box of five numbers") {
    replace(folder / "a.h5", "model_box", [](const hdf5::Id& file) {
      hdf5::write_attribute<double>(file, "model_box", std::vector<double>{0, 0, 1, 0, 0});
    });
    expected = "model_box";
  }
  CHECK_THROWS_WITH(ResultReader(folder / "a.h5"), Contains(expected));
}
