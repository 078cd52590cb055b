#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "io/scans/point_reader.hpp"
#include "support/scratch_folder.hpp"

namespace clearway::test {

struct ReadCloud {
  CloudInfo info;  ///< what the reader tells after the last point
  std::vector<std::array<std::int32_t, 3>> quanta;
  std::vector<Vec3> positions;
  std::vector<std::uint64_t> absent;  ///< numbers of the records without a point
  std::vector<std::uint8_t> classes, flags;

  std::size_t size() const { return quanta.size() + positions.size(); }
  /// The point as coordinates.
  Vec3 at(std::size_t index) const;
};

ReadCloud read_all(PointReader& reader);

ReadCloud read_all(const std::filesystem::path& path);

/// Reads the file as a LAS stream.
ReadCloud read_stream(const std::filesystem::path& path);

/// The message with which reading the file is refused; empty where it is read.
std::string refusal_of(const std::filesystem::path& path);

/// The message with which reading the file as a LAS stream is refused; empty where it is read.
std::string stream_refusal_of(const std::filesystem::path& path);

/// The message with which a file of that name is refused, which has to hold its path; empty where
/// it is read.
std::string refusal_of_file(const std::string& name, std::string_view bytes);

/// The bytes with a number of `size` bytes put in place of others, the lowest first.
std::string edited(std::string bytes, std::size_t at, unsigned size, std::uint64_t value);

}  // namespace clearway::test
