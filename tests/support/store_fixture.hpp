#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/store/convert/convert.hpp"
#include "io/store/store_reader.hpp"
#include "support/scratch_folder.hpp"

/// Scans made for a test, their conversion, and what the store then holds.
namespace clearway::test {

using Quantum = std::array<std::int32_t, 3>;

inline const Quantisation kMillimetres{{0.001, 0.001, 0.001}, {100, -200, 0}};

void write_las(const std::filesystem::path& path, std::span<const Quantum> points,
               const Quantisation& quantisation = kMillimetres);

void write_ply(const std::filesystem::path& path, std::span<const Vec3> points);

ConversionOptions conversion_of(std::vector<std::filesystem::path> inputs,
                                const std::filesystem::path& output,
                                std::uint32_t cell_points = 64);

ConversionReport convert_quietly(const ConversionOptions& options);

/// The message with which the conversion is refused; empty where it succeeds.
template <typename Refusal = Error>
std::string conversion_refusal(const ConversionOptions& options) {
  try {
    convert_quietly(options);
  } catch (const Refusal& error) {
    return error.what();
  }
  return {};
}

/// The classes of a store's points, by source index.
std::vector<std::uint8_t> classes_by_source(const StoreReader& store);

struct StoredPoint {
  std::uint64_t source;
  Quantum q;
  friend bool operator==(const StoredPoint&, const StoredPoint&) = default;
};

/// The points of cells first .. first + count - 1 in the store's order.
std::vector<StoredPoint> points_of_cells(const StoreReader& store, std::uint32_t first,
                                         std::uint32_t count);

std::vector<StoredPoint> stored_points(const StoreReader& store);

/// The store's points in source order. Throws where a source index is missing, out of range or
/// there twice.
std::vector<Quantum> points_by_source(const StoreReader& store);

std::vector<std::string> faults_of(const StoreReader& store);

}  // namespace clearway::test
