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
  std::uint32_t first_pose;  ///< encoded as BodyNumbers does
  std::uint32_t last_pose;
};

struct ClearanceRow {
  std::uint64_t source;
  double distance;
  std::int32_t q[3];
  std::uint32_t pose;  ///< encoded as BodyNumbers does
};

/// What the encoding has to know besides the rows.
struct RowMeaning {
  const Quantisation& quantisation;
  const ResultHeader& header;
  BodyNumbers numbers;
};

/// Encodes and summarises rows that ascend by source index.
std::shared_ptr<WritePiece<Collisions>> encode_rows(const ResultWriter& writer,
                                                    const RowMeaning& meaning,
                                                    std::span<const CollisionRow> rows);
std::shared_ptr<WritePiece<Clearances>> encode_rows(const ResultWriter& writer,
                                                    const RowMeaning& meaning,
                                                    std::span<const ClearanceRow> rows);

}  // namespace clearway
