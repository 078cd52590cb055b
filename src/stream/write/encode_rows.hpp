#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/query/body_numbers.hpp"
#include "io/result/result.hpp"
#include "stream/write/write_rows.hpp"

namespace clearway {

struct CollisionRow {
  std::uint64_t source;
  std::int32_t q[3];
  std::uint32_t first_pose;  ///< as BodyNumbers
  std::uint32_t last_pose;
};

struct ClearanceRow {
  std::uint64_t source;
  double distance;
  std::int32_t q[3];
  std::uint32_t pose;  ///< as BodyNumbers
};

/// What encoding rows needs to know beside them.
struct RowMeaning {
  const Quantisation& quantisation;
  const ResultHeader& header;
  BodyNumbers numbers;
};

using CollisionPiece = WritePiece<EncodedCollisions>;
using ClearancePiece = WritePiece<EncodedClearances>;

/// Encodes rows that ascend by source, with the first of them at the smallest pose, where there are
/// first poses. Not for no rows.
std::shared_ptr<CollisionPiece> encode_rows(const ResultWriter& writer, const RowMeaning& meaning,
                                            std::span<const CollisionRow> rows);
/// The same, with the first of the least distance.
std::shared_ptr<ClearancePiece> encode_rows(const ResultWriter& writer, const RowMeaning& meaning,
                                            std::span<const ClearanceRow> rows);

}  // namespace clearway
