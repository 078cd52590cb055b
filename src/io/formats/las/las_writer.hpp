#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/geometry/quantisation.hpp"
#include "core/geometry/quantum_box.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// What a LAS file's header has to say before the first point is written.
struct LasHeader {
  Quantisation quantisation;
  std::uint64_t points = 0;
  QuantumBox bounds{};      ///< holds every point; ignored for 0 points
  std::string crs_wkt{};    ///< empty: none
  bool first_pose = false;  ///< adds the extra-bytes field "first_pose", uint32
};

/// Writes LAS front to back, so that the output may be a pipe: version 1.2 with point format 0, or
/// 1.4 with point format 6 where the count exceeds 32 bits, there is a CRS or there are first poses
/// (extra bytes are defined since 1.4). Equal contents give equal bytes: no date is written.
/// Buffered; the file stays the caller's.
class LasWriter {
 public:
  LasWriter(const File& file, const LasHeader& header);
  ~LasWriter();

  /// first_pose: as many as quanta where the header has it, empty otherwise.
  void write(std::span<const std::array<std::int32_t, 3>> quanta,
             std::span<const std::uint32_t> first_pose = {});

  /// Flushes. Throws std::logic_error unless exactly header.points points were written.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
