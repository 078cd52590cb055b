#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/files/file.hpp"
#include "io/scans/point_field.hpp"

namespace clearway {

/// Contents of a LAS file's header, which must be known before the first point is written.
struct LasHeader {
  Quantisation quantisation;
  std::uint64_t points = 0;
  QuantumBox bounds{};               ///< box of all points; ignored for 0 points
  std::string crs_wkt{};             ///< CRS; empty for none
  std::vector<PointField> fields{};  ///< become extra bytes, except a class
};

/// Writes LAS front to back, so that the output may be a pipe: version 1.2 with point format 0, or
/// 1.4 with point format 6 where the count exceeds 32 bits or where there is a CRS or extra bytes
/// (defined since 1.4). Equal contents give equal bytes, as no date is written. Output is buffered;
/// the caller owns the file.
class LasWriter {
 public:
  LasWriter(const File& file, const LasHeader& header);
  ~LasWriter();

  /// values: those of each field of the header. Throws std::logic_error where they do not fit.
  void write(std::span<const std::array<std::int32_t, 3>> quanta,
             std::span<const FieldValues> values = {});

  /// Flushes. Throws std::logic_error unless exactly header.points points were written.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
