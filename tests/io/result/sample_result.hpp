#pragma once

#include <optional>

#include "io/result/check_results.hpp"
#include "support/result_fixture.hpp"

namespace clearway::test {

/// A header that asks for every table and column of this room's tests.
inline ResultHeader full_header(std::uint64_t poses) {
  ResultHeader header = sample_header(true);
  header.poses = poses;
  header.clearance = 0.5;
  header.profile = 0.75;
  header.bodies = {"front bogie", "body", "back"};
  header.ignore_classes = {2, 7};
  header.ignore_boxes = {{{-1, -2, -3}, {4, 5, 6}}, {{0, 0, 0}, {1, 1, 1}}};
  header.ignored = {1234, {1000, 200}, {0, 34}};
  header.classes_hash = 0x123456789abcdef0;
  return header;
}

/// A result with the tables that its header asks for.
struct SampleTables {
  SampleTables(const ResultHeader& asked, std::size_t count) : header(asked) {
    rows = sample_rows(header, count);
    for (std::uint32_t i = 0; header.has_first_bodies() && i < count; ++i) {
      rows.body.push_back(i * 7 % 3);
    }
    if (header.clearance > 0) near = sample_clearances(header, count);
    for (std::uint32_t i = 0; i < near.size(); ++i) {
      if (!header.bodies.empty()) near.body.push_back(i * 5 % 3);
      if (header.has_classes()) near.point_class.push_back(static_cast<std::uint8_t>(i * 11));
    }
    if (header.profile > 0) profile = sample_profile(header);
    if (header.has_classes()) profile.point_class.assign(profile.size(), 6);
  }

  void write(const std::filesystem::path& path, std::size_t step = 1000) const {
    write_result(path, header, rows, step, near, profile);
  }

  ResultHeader header;
  Collisions rows;
  Clearances near;
  ProfileRows profile;
};

/// The same with a folder for its file.
struct SampleResult : SampleTables {
  using SampleTables::SampleTables;

  std::filesystem::path path(const std::string& name = "out.h5") const { return folder / name; }
  void write(const std::string& name = "out.h5", std::size_t step = 1000) const {
    SampleTables::write(path(name), step);
  }
  /// Whether the file is read as it was written. Throws InputError where damage is noticed.
  bool is_read(const std::string& name = "out.h5") const {
    const ResultReader reader(path(name));
    return same_answer(reader.header(), header) && same_table(read_rows(reader), rows) &&
           same_table(read_rows<Clearances>(reader), near) &&
           same_table(read_rows<ProfileRows>(reader), profile);
  }
  /// The first fault of the file; empty where it has none.
  std::string fault(const std::string& name = "out.h5") const {
    NoProgress progress;
    return verify_result(ResultReader(path(name)), progress).value_or("");
  }

  ScratchFolder folder;
};

}  // namespace clearway::test
