#include "stream/write/encode_rows.hpp"

#include <algorithm>
#include <vector>

#include "io/result/answer.hpp"

namespace clearway {
namespace {

/// Visits the rows in short pieces, so that their columns stay in a core's cache.
template <typename Row, typename Visit>
void for_each_strip(std::span<const Row> rows, Visit visit) {
  constexpr std::size_t kStrip = 1 << 12;
  for (std::size_t first = 0; first < rows.size(); first += kStrip) {
    visit(rows.subspan(first, std::min(kStrip, rows.size() - first)));
  }
}

template <typename Values, typename Row, typename ValueOf>
void set_column(std::vector<Values>& column, std::span<const Row> rows, ValueOf value_of) {
  column.resize(rows.size());
  std::ranges::transform(rows, column.begin(), value_of);
}

Vec3 xyz_of(const Quantisation& quantisation, const std::int32_t (&q)[3]) {
  return position(quantisation, q[0], q[1], q[2]);
}

}  // namespace

std::shared_ptr<WritePiece<Collisions>> encode_rows(const ResultWriter& writer,
                                                    const RowMeaning& meaning,
                                                    std::span<const CollisionRow> rows) {
  const Quantisation& quantisation = meaning.quantisation;
  const BodyNumbers numbers = meaning.numbers;
  auto out = std::make_shared<WritePiece<Collisions>>(writer.new_rows<Collisions>());
  Collisions columns;
  for_each_strip(rows, [&](std::span<const CollisionRow> strip) {
    set_column(columns.source, strip, [](const auto& row) { return row.source; });
    set_column(columns.xyz, strip, [&](const auto& row) { return xyz_of(quantisation, row.q); });
    if (meaning.header.first_pose) {
      set_column(columns.first_pose, strip,
                 [&](const auto& row) { return numbers.pose_of(row.first_pose); });
    }
    if (meaning.header.has_first_bodies()) {
      set_column(columns.body, strip,
                 [&](const auto& row) { return numbers.body_of(row.first_pose); });
    }
    if (meaning.header.last_pose) {
      set_column(columns.last_pose, strip, [](const auto& row) { return row.last_pose; });
    }
    out->rows.add(columns);
    summarise(columns, out->summary);
  });
  out->rows.seal();
  return out;
}

std::shared_ptr<WritePiece<Clearances>> encode_rows(const ResultWriter& writer,
                                                    const RowMeaning& meaning,
                                                    std::span<const ClearanceRow> rows) {
  const Quantisation& quantisation = meaning.quantisation;
  const BodyNumbers numbers = meaning.numbers;
  auto out = std::make_shared<WritePiece<Clearances>>(writer.new_rows<Clearances>());
  Clearances columns;
  for_each_strip(rows, [&](std::span<const ClearanceRow> strip) {
    set_column(columns.source, strip, [](const auto& row) { return row.source; });
    set_column(columns.xyz, strip, [&](const auto& row) { return xyz_of(quantisation, row.q); });
    set_column(columns.distance, strip, [](const auto& row) { return row.distance; });
    set_column(columns.pose, strip, [&](const auto& row) { return numbers.pose_of(row.pose); });
    if (!meaning.header.bodies.empty()) {
      set_column(columns.body, strip, [&](const auto& row) { return numbers.body_of(row.pose); });
    }
    out->rows.add(columns);
    summarise(columns, out->summary);
  });
  out->rows.seal();
  return out;
}

}  // namespace clearway
