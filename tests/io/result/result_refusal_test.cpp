#include <hdf5.h>

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/stored_chunk.hpp"
#include "io/result/result.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Reads the colliding points. True where they and the header are as written; throws InputError
/// where damage is noticed.
bool reads_as(const std::filesystem::path& path, const ResultHeader& header,
              const Collisions& rows) {
  const ResultReader reader(path);
  return same_answer(reader.header(), header) && same_rows(read_rows(reader), rows);
}

/// Reads every table. True where they and the header are as written; throws InputError where damage
/// is noticed.
bool reads_tables(const std::filesystem::path& path, const ResultHeader& header,
                  const Collisions& rows, const Clearances& clearances,
                  const ProfileRows& profile) {
  if (!reads_as(path, header, rows)) return false;
  const ResultReader reader(path);
  Clearances near, no_more;
  ProfileRows along, no_poses;
  RowStream<Clearances> near_stream(reader);
  RowStream<ProfileRows> along_stream(reader);
  if (!near_stream.read(near) || near_stream.read(no_more)) return false;
  if (!along_stream.read(along) || along_stream.read(no_poses)) return false;
  return near.source == clearances.source && near.xyz == clearances.xyz &&
         near.distance == clearances.distance && near.pose == clearances.pose &&
         along.source == profile.source && along.distance == profile.distance &&
         along.chainage == profile.chainage && along.xyz.front() == profile.xyz.front();
}

void put_byte(const std::filesystem::path& path, std::size_t at, int byte) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(at));
  file.put(static_cast<char>(byte));
}

/// Opens a written result to change it behind the reader's back.
hdf5::Id open_to_change(const std::filesystem::path& path) {
  return {H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open"};
}

template <typename Number>
void replace_dataset(const std::filesystem::path& path, const std::string& name,
                     const std::vector<Number>& values, std::uint64_t columns) {
  const hdf5::Id file = open_to_change(path);
  REQUIRE(H5Ldelete(file.get(), name.c_str(), H5P_DEFAULT) >= 0);
  hdf5::write_dataset(file, name, std::span<const Number>(values), columns);
}

}  // namespace

TEST_CASE("what is not a result is refused") {
  const ScratchFolder folder;
  check_refused([&] { return ResultReader(folder / "missing.h5"); }, "No such file");
  put_bytes(folder / "empty.h5", "");
  check_refused([&] { return ResultReader(folder / "empty.h5"); }, "not an HDF5 file");
  put_bytes(folder / "text.h5", "x y z\n1 2 3\n");
  CHECK_THROWS_AS(ResultReader(folder / "text.h5"), InputError);
  { const hdf5::Id other = hdf5::create_file(folder / "other.h5"); }
  check_refused([&] { return ResultReader(folder / "other.h5"); },
                "other.h5 ... not a result of clearway run");
}

TEST_CASE("a result cut at any byte is refused") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(true);
  write_result(folder / "out.h5", header, sample_rows(header, 5));
  const std::string bytes = bytes_of(folder / "out.h5");
  for (std::size_t size = bytes.size() - 1; size < bytes.size(); --size) {
    std::filesystem::resize_file(folder / "out.h5", size);
    CHECK_THROWS_AS(reads_as(folder / "out.h5", header, {}), InputError);
  }
}

TEST_CASE("a flipped byte anywhere is noticed or changes nothing") {
  const LeaksOfHdf5 ignored;
  const ScratchFolder folder;
  ResultHeader header = sample_header(true);
  // The CRS may have several kilobytes, because such attributes must be as well guarded as short
  // ones.
  header.crs_wkt = GENERATE(std::string("EPSG"), std::string(6000, 'w'));
  header.poses = 6;
  header.clearance = header.profile = 0.5;
  const Collisions rows = sample_rows(header, 5);
  const Clearances near = sample_clearances(header, 7);
  const ProfileRows along = sample_profile(header);
  write_result(folder / "out.h5", header, rows, 1000, near, along);
  const std::string bytes = bytes_of(folder / "out.h5");
  // Beside a long CRS every byte of the rest is as it was with the short one.
  const std::size_t step = header.crs_wkt.size() > 100 ? 3 : 1;
  std::size_t noticed = 0;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    put_byte(folder / "out.h5", at, bytes[at] ^ (at % 2 == 0 ? 0xff : 1 << at / 2 % 8));
    INFO("byte " << at);
    bool same = false;
    try {
      same = reads_tables(folder / "out.h5", header, rows, near, along);
    } catch (const InputError&) {
      ++noticed;
      same = true;
    }
    CHECK(same);
    put_byte(folder / "out.h5", at, bytes[at]);
  }
  CHECK(noticed > bytes.size() / step / 2);
}

TEST_CASE("a chunk of zeros or with other values is noticed by whoever reads its column") {
  const LeaksOfHdf5 ignored;
  const ScratchFolder folder;
  const auto path = folder / "out.h5";
  ResultHeader header = sample_header(true);
  header.poses = 6;
  header.clearance = header.profile = 0.5;
  Collisions rows = sample_rows(header, 5);
  rows.last_pose.front() = 5;  // so that no two columns are equal
  const Clearances near = sample_clearances(header, 7);
  const ProfileRows along = sample_profile(header);
  write_result(path, header, rows, 1000, near, along);
  const std::string bytes = bytes_of(path);
  const auto text_of = []<typename... Values>(const std::vector<Values>&... columns) {
    std::string text;
    (text.append(reinterpret_cast<const char*>(columns.data()), columns.size() * sizeof(Values)),
     ...);
    return text;
  };
  using Read = std::function<std::string(const Result&)>;
  const std::vector<std::pair<std::string, Read>> columns{
      {text_of(rows.source), [&](const Result& r) { return text_of(r.source()); }},
      {text_of(rows.xyz), [&](const Result& r) { return text_of(r.xyz()); }},
      {text_of(rows.first_pose), [&](const Result& r) { return text_of(r.first_pose()); }},
      {text_of(rows.last_pose), [&](const Result& r) { return text_of(r.last_pose()); }},
      {text_of(near.distance), [&](const Result& r) { return text_of(r.clearance().distance); }},
      {text_of(near.xyz), [&](const Result& r) { return text_of(r.clearance().xyz); }},
      {text_of(along.distance), [&](const Result& r) { return text_of(r.profile().distance); }},
      {text_of(along.source), [&](const Result& r) { return text_of(r.profile().source); }},
      {text_of(along.xyz), [&](const Result& r) { return text_of(r.profile().xyz); }}};
  const Read all = [&](const Result& r) {
    const Collisions c = r.collisions();
    return text_of(c.source, c.xyz, c.first_pose, c.last_pose);
  };
  const std::string whole = all(Result(path));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto& [values, read] = columns[i];
    CAPTURE(i);
    CHECK(read(Result(path)) == values);
    // The chunk's values, and after them its checksum, which is 0 for zeros.
    const std::size_t at = bytes.find(values);
    REQUIRE(at != std::string::npos);
    for (const bool sealed : {false, true}) {
      std::string chunk(values.size(), '\0');
      if (sealed) {
        chunk = values;
        std::swap(chunk.front(), chunk[chunk.size() / 2]);
      }
      chunk.resize(chunk.size() + hdf5::kChecksumBytes);
      hdf5::seal_chunk(std::as_writable_bytes(std::span(chunk)));
      put_bytes(path, std::string(bytes).replace(at, chunk.size(), chunk));
      const bool differs = chunk.compare(0, values.size(), values) != 0;
      if (differs) CHECK_THROWS_AS(read(Result(path)), InputError);
      if (differs && i < 4) CHECK_THROWS_AS(all(Result(path)), InputError);
      if (i >= 4) CHECK(all(Result(path)) == whole);
    }
    put_bytes(path, bytes);
  }
}

TEST_CASE("datasets of another type or shape, or with impossible values, are refused") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(true);
  const Collisions rows = sample_rows(header, 3);
  const auto path = folder / "out.h5";
  write_result(path, header, rows);
  const auto refused = [&](const std::string& expectation) {
    CHECK_THROWS_AS(reads_as(path, header, rows), InputError);
    check_refused([&] { return reads_as(path, header, rows); },
                  std::string("out.h5 ... ") + expectation);
  };

  SECTION("type of source") {
    replace_dataset<std::uint32_t>(path, "/collisions/source", {1, 2, 3}, 0);
    refused("collisions/source");
  }
  SECTION("shape of xyz") {
    replace_dataset<double>(path, "/collisions/xyz", {1, 2, 3, 4, 5, 6}, 2);
    refused("collisions/xyz");
  }
  SECTION("rows of first_pose") {
    replace_dataset<std::uint32_t>(path, "/collisions/first_pose", {1, 2}, 0);
    refused("rows");
  }
  SECTION("no first_pose") {
    REQUIRE(H5Ldelete(open_to_change(path).get(), "/collisions/first_pose", H5P_DEFAULT) >= 0);
    refused("collisions/first_pose");
  }
  SECTION("no warnings") {
    REQUIRE(H5Ldelete(open_to_change(path).get(), "/warnings", H5P_DEFAULT) >= 0);
    refused("warnings");
  }
  SECTION("sources not ascending") {
    replace_dataset<std::uint64_t>(path, "/collisions/source", {1, 3, 3}, 0);
    refused("row 2");
  }
  SECTION("a source past the environment") {
    replace_dataset<std::uint64_t>(path, "/collisions/source", {1, 2, 5'000'000'000}, 0);
    refused("row 2");
  }
  SECTION("a coordinate that is not a number") {
    replace_dataset<double>(path, "/collisions/xyz", {1, 2, 3, 4, NAN, 6, 7, 8, 9}, 3);
    refused("row 1");
  }
  SECTION("a pose past the trajectory") {
    replace_dataset<std::uint32_t>(path, "/collisions/first_pose", {1, 2, 4'000'000'000}, 0);
    refused("row 2");
  }
  SECTION("another version") {
    {
      const hdf5::Id file = open_to_change(path);
      REQUIRE(H5Adelete(file.get(), "version") >= 0);
      const std::uint32_t version = 5;
      hdf5::write_attribute(file, "version", std::span<const std::uint32_t>(&version, 1));
    }
    refused("is a result of version 5");
  }
}

TEST_CASE("sources that do not ascend from one batch to the next are refused") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(false);
  Collisions rows = sample_rows(header, 65'537);
  write_result(folder / "out.h5", header, rows);
  rows.source.back() = rows.source[65'535];
  replace_dataset<std::uint64_t>(folder / "out.h5", "/collisions/source", rows.source, 0);
  const ResultReader reader(folder / "out.h5");
  check_refused([&] { return read_rows(reader); }, "row 65536");
}
