// Results that are damaged, or hold what no run can have found.
#include <cmath>
#include <fstream>
#include <functional>

#include "io/files/fletcher32.hpp"
#include "io/result/sample_result.hpp"
#include "support/catch.hpp"
#include "support/change_header.hpp"
#include "support/compare.hpp"
#include "support/leaks_of_hdf5.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Writes the sample, changes its file, and checks that it is refused with these words, at once or
/// by whoever reads or verifies it.
void check_refused_file(const SampleResult& sample, const std::string& words,
                        const std::function<void(const std::filesystem::path&)>& change) {
  sample.write();
  change(sample.path());
  const auto verify = [&] {
    if (const std::string fault = sample.fault(); !fault.empty()) throw InputError(fault);
  };
  check_refused<InputError>(verify, sample.path().string() + " ... " + words);
}

}  // namespace

TEST_CASE("what is not a result is refused") {
  const ScratchFolder folder;
  put_bytes(folder / "empty.h5", "");
  put_bytes(folder / "text.h5", "x y z\n1 2 3\n");
  hdf5::create_file(folder / "other.h5");
  for (const auto& [name, words] :
       {std::pair("missing.h5", "No such file"),
        {"empty.h5", "not an HDF5 file"},
        {"text.h5", "text.h5"},
        {"other.h5", "other.h5 ... is not a result; expected a file of clearway run"}}) {
    check_refused([&, file = name] { return ResultReader(folder / file); }, words);
  }
}

TEST_CASE("a result cut at any byte is refused") {
  const SampleResult sample(sample_header(true), 5);
  sample.write();
  for (std::size_t size = std::filesystem::file_size(sample.path()); size-- > 0;) {
    std::filesystem::resize_file(sample.path(), size);
    CHECK_THROWS_AS(sample.is_read(), InputError);
  }
}

TEST_CASE("a flipped byte of a result, or a stretch of zeros, is noticed or changes nothing") {
  const LeaksOfHdf5 ignored;
  ResultHeader header = full_header(6);
  // The CRS may have several kilobytes, because such attributes must be as well guarded as short
  // ones.
  header.crs_wkt = GENERATE(std::string("EPSG"), std::string(6000, 'w'));
  const SampleResult sample(header, 7);
  sample.write();
  const std::string bytes = bytes_of(sample.path());
  // Beside a long CRS every byte of the rest is as it was with the short one.
  const std::size_t step = header.crs_wkt.size() > 100 ? 3 : 1;
  std::size_t noticed = 0;
  const auto check = [&](std::size_t at, const std::string& changed) {
    {
      std::fstream file(sample.path(), std::ios::binary | std::ios::in | std::ios::out);
      file.seekp(static_cast<std::streamoff>(at)).write(changed.data(), std::ssize(changed));
    }
    try {
      if (!sample.is_read()) FAIL_CHECK("a change at byte " << at << " is not noticed");
    } catch (const InputError&) {
      ++noticed;
    }
    put_bytes(sample.path(), bytes);
  };
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    check(at, {static_cast<char>(bytes[at] ^ (at % 2 == 0 ? 0xff : 1 << at / 2 % 8))});
  }
  CHECK(noticed > bytes.size() / step / 2);
  for (std::size_t at = 0; step == 1 && at < bytes.size(); at += 16) {
    check(at, std::string(std::min<std::size_t>(1400, bytes.size() - at), '\0'));
  }
}

TEST_CASE("a chunk of zeros or with other values is noticed by whoever reads its column") {
  const LeaksOfHdf5 ignored;
  SampleResult sample(full_header(6), 7);
  sample.rows.last_pose.front() = 5, sample.near.pose.front() = 3;  // so that no columns are equal
  sample.write();
  const auto path = sample.path();
  const std::string bytes = bytes_of(path);
  const auto check = [&]<typename Rows>(const Rows& rows) {
    for_each_column<Rows>([&](const auto& column) {
      const auto& column_values = rows.*column.values;
      if (column_values.empty()) return;
      CAPTURE(column.dataset);
      const std::string values(reinterpret_cast<const char*>(column_values.data()),
                               column_values.size() * sizeof column_values[0]);
      // The chunk's values, and after them its checksum, which is 0 for zeros.
      const std::size_t at = bytes.find(values);
      REQUIRE(at != std::string::npos);
      for (const bool sealed : {false, true}) {
        std::string chunk(values.size(), '\0');
        if (sealed) {
          chunk = values;
          std::swap(chunk.front(), chunk[chunk.size() / 2]);
        }
        if (chunk == values) continue;
        const std::uint32_t checksum = fletcher32(std::as_bytes(std::span(chunk)));
        chunk.append(reinterpret_cast<const char*>(&checksum), sizeof checksum);
        put_bytes(path, std::string(bytes).replace(at, chunk.size(), chunk));
        const ResultReader reader(path);
        CHECK_THROWS_AS(reader.all<Rows>(), InputError);
        using Value = typename std::decay_t<decltype(column)>::Value;
        if constexpr (std::is_same_v<Rows, Collisions> && !std::is_same_v<Value, double> &&
                      !std::is_same_v<Value, std::uint8_t>) {
          CHECK_THROWS_AS(reader.column(column.values), InputError);
        }
      }
      put_bytes(path, bytes);
    });
  };
  check(sample.rows);
  check(sample.near);
  check(sample.profile);
}

TEST_CASE("a result whose datasets or attributes are not those of a run is refused by name") {
  using Path = std::filesystem::path;
  const SampleResult plain(sample_header(true), 3), vehicle(full_header(3), 3);
  const auto with = [&](const char* name, const auto& values) {
    return [=](const Path& path) { change_column(path, name, values); };
  };
  const auto fact = [](const char* name, const Json& value) {
    return
        [=](const Path& path) { change_header(path, [&](Json& header) { header[name] = value; }); };
  };
  const auto without = [](const char* name) {
    return
        [=](const Path& path) { change_header(path, [&](Json& header) { header.erase(name); }); };
  };
  using Indices = std::vector<std::uint32_t>;
  using Sources = std::vector<std::uint64_t>;
  using Numbers = std::vector<double>;
  check_refused_file(plain, "'collisions/source': expected numbers of the type",
                     [](const Path& path) {
                       remove_link(path, "collisions/source");
                       const hdf5::Id file = open_to_change(path);
                       hdf5::check(H5Lmove(file.get(), "collisions/first_pose", file.get(),
                                           "collisions/source", H5P_DEFAULT, H5P_DEFAULT),
                                   "move");
                     });
  check_refused_file(plain, "rows", with("collisions/first_pose", Indices{1, 2}));
  check_refused_file(plain, "collisions/first_pose",
                     [](const Path& path) { remove_link(path, "collisions/first_pose"); });
  for (const char* name : {"warnings", "poses", "radius", "scale"}) {
    check_refused_file(plain, std::string("header: '") + name, without(name));
  }
  for (const char* name : {"columns", "chunk_hashes"}) {
    check_refused_file(plain, "its chunk hashes are damaged", without(name));
  }
  check_refused_file(plain, "row 2", with("collisions/source", Sources{1, 3, 3}));
  check_refused_file(plain, "row 2", with("collisions/source", Sources{1, 2, 5'000'000'000}));
  check_refused_file(plain, "row 1", with("collisions/xyz", Numbers{1, 2, 3, 4, NAN, 6, 7, 8, 9}));
  check_refused_file(plain, "row 2", with("collisions/first_pose", Indices{1, 2, 4'000'000'000}));
  for (const std::uint32_t version : {0u, 6u, 8u, 0xffffffffu}) {
    check_refused_file(
        plain,
        "is a result of version " + std::to_string(version) + " of another release; run it again",
        [&](const Path& path) {
          replace_attribute(path, "version", [&](const hdf5::Id& file) {
            hdf5::write_number(file, "version", version);
          });
        });
  }
  for (const char* name : {"collisions/body", "clearance/body"}) {
    check_refused_file(vehicle, "body, row 1: expected one of the bodies",
                       with(name, Indices{0, 3, 2}));
  }
  check_refused_file(vehicle, "'bodies'", fact("bodies", {"a", "", "b"}));
  check_refused_file(vehicle, "'bodies': expected a list", fact("bodies", "a"));
  check_refused_file(vehicle, "row 2: expected one of the bodies", fact("bodies", {"a", "b"}));
  check_refused_file(vehicle, "'profile'", fact("profile", -0.5));
  check_refused_file(vehicle, "'profile': expected a number", fact("profile", std::nan("")));
  check_refused_file(vehicle, "'seen_min': expected a whole number", fact("seen_min", 1ULL << 32));
  check_refused_file(vehicle, "'poses': expected a whole number", fact("poses", -1));
  check_refused_file(vehicle, "'between_poses': expected true", fact("between_poses", 1));
  check_refused_file(vehicle, "'model_axes'", fact("model_axes", "+x,-x"));
  check_refused_file(vehicle, "'scale': expected 3 values", fact("scale", {1.0, 1.0}));
  check_refused_file(vehicle, "'crs_wkt': expected a text", fact("crs_wkt", 4326));
  check_refused_file(vehicle, "one for each of 4 poses", fact("poses", 4));
  const auto box = [&](const Json& lo) {
    return fact("model_box", {{"lo", lo}, {"hi", {0.0, 0.0, 0.0}}});
  };
  check_refused_file(vehicle, "'model_box'", box({0.0, 0.0, 1.0}));
  check_refused_file(vehicle, "'model_box.lo': expected 3 values", box({0.0, 0.0}));
  check_refused_file(vehicle, "'model_box.lo': expected a number", box({0.0, 0.0, nullptr}));
  SampleResult floor(full_header(3), 3);
  floor.header.floor = 0.2;
  check_refused_file(floor, "'body_floors' is missing; run it again", [](const Path&) {});
  // Sources that do not ascend from one batch to the next.
  const SampleResult large(sample_header(false), 65'537);
  Sources sources = large.rows.source;
  sources.back() = sources[65'535];
  check_refused_file(large, "row 65536", with("collisions/source", sources));
}

TEST_CASE("rows that no run can have found are faults, wherever they are") {
  ResultHeader header = full_header(70'000);
  header.bodies.clear();
  const SampleResult sound(header, 70'000);
  const auto at = GENERATE(as<std::size_t>(), 0, 65'536, 69'998);
  const auto check = [&](const std::string& dataset,
                         const std::function<void(Clearances&, ProfileRows&)>& change) {
    SampleResult sample(header, 0);
    sample.near = sound.near;
    sample.profile = sound.profile;
    change(sample.near, sample.profile);
    const auto chainage = std::exchange(sample.profile.chainage, sound.profile.chainage);
    sample.write();
    change_column(sample.path(), "profile/chainage", chainage);
    check_says(sample.fault(), dataset + ", row ");
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::string distance = "/clearance/distance", gap = "/profile/distance";
  check(distance, [&](auto& near, auto&) { near.distance[at] = std::nextafter(0.5, 1); });
  check(distance, [&](auto& near, auto&) { near.distance[at] = -1e-9; });
  check(distance, [&](auto& near, auto&) { near.distance[at] = NAN; });
  check("/clearance/xyz", [&](auto& near, auto&) { near.xyz[at].y = NAN; });
  check("/clearance/pose", [&](auto& near, auto&) { near.pose[at] = 70'000; });
  check("/clearance/source",
        [&](auto& near, auto&) { near.source.back() = header.environment_points; });
  check(gap, [&](auto&, auto& along) { along.distance[at] = std::nextafter(0.75, 1); });
  check(gap, [&](auto&, auto& along) { along.distance[at] = -1e-9; });
  check(gap, [&](auto&, auto& along) { along.distance[at] = NAN; });
  check(gap, [&](auto&, auto& along) { along.distance[at] = kInfinity; });
  check(gap, [&](auto&, auto& along) {
    along.source[at] = Profile::kNoPoint, along.xyz[at] = {NAN, NAN, NAN};
  });
  check("/profile/source",
        [&](auto&, auto& along) { along.source[at] = header.environment_points; });
  check("/profile/xyz", [&](auto&, auto& along) { along.xyz[at].z = NAN; });
  check("/profile/xyz", [&](auto&, auto& along) { along.xyz[at - at % 5 + 4].x = 1; });
  check("/profile/chainage", [&](auto&, auto& along) {
    along.chainage[at] = at == 0 ? -1 : along.chainage[at - 1] - 0.5;
  });
  check("/profile/chainage", [&](auto&, auto& along) { along.chainage[at] = NAN; });
  check("/profile/chainage", [](auto&, auto& along) { along.chainage[0] = 1e-9; });
}
