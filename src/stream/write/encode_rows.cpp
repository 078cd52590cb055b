#include "stream/write/encode_rows.hpp"

#include <algorithm>
#include <vector>

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

/// The row of least rank. Of several it is the one with the smallest source index, because rows
/// ascend by it.
template <typename Row, typename RankOf>
const Row& least_row(std::span<const Row> rows, RankOf rank_of) {
  return *std::ranges::min_element(rows, {}, rank_of);
}

/// The columns of a strip of rows.
struct Strip {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<double> distance;
  std::vector<std::uint32_t> pose, body, last_pose;
};

}  // namespace

std::shared_ptr<CollisionPiece> encode_rows(const ResultWriter& writer, const RowMeaning& meaning,
                                            std::span<const CollisionRow> rows) {
  const Quantisation& quantisation = meaning.quantisation;
  const BodyNumbers numbers = meaning.numbers;
  const bool first_pose = meaning.header.first_pose;
  const auto pose_of = [&](const auto& row) { return numbers.pose_of(row.first_pose); };
  const auto body_of = [&](const auto& row) { return numbers.body_of(row.first_pose); };
  auto out = std::make_shared<CollisionPiece>(writer.new_collisions());
  Strip columns;
  for_each_strip(rows, [&](std::span<const CollisionRow> strip) {
    set_column(columns.source, strip, [](const auto& row) { return row.source; });
    set_column(columns.xyz, strip, [&](const auto& row) { return xyz_of(quantisation, row.q); });
    if (first_pose) set_column(columns.pose, strip, pose_of);
    if (meaning.header.has_first_bodies()) set_column(columns.body, strip, body_of);
    if (meaning.header.last_pose) {
      set_column(columns.last_pose, strip, [](const auto& row) { return row.last_pose; });
    }
    out->rows.add(columns.source, columns.xyz, columns.pose, columns.body, columns.last_pose);
  });
  out->rows.seal();
  if (first_pose) {
    const CollisionRow& first = least_row(rows, pose_of);
    out->place = {first.source, pose_of(first), xyz_of(quantisation, first.q), 0, body_of(first)};
  }
  return out;
}

std::shared_ptr<ClearancePiece> encode_rows(const ResultWriter& writer, const RowMeaning& meaning,
                                            std::span<const ClearanceRow> rows) {
  const Quantisation& quantisation = meaning.quantisation;
  const BodyNumbers numbers = meaning.numbers;
  const auto pose_of = [&](const auto& row) { return numbers.pose_of(row.pose); };
  const auto body_of = [&](const auto& row) { return numbers.body_of(row.pose); };
  auto out = std::make_shared<ClearancePiece>(writer.new_clearances());
  Strip columns;
  for_each_strip(rows, [&](std::span<const ClearanceRow> strip) {
    set_column(columns.source, strip, [](const auto& row) { return row.source; });
    set_column(columns.xyz, strip, [&](const auto& row) { return xyz_of(quantisation, row.q); });
    set_column(columns.distance, strip, [](const auto& row) { return row.distance; });
    for (const double distance : columns.distance) out->inside += distance < 0;
    set_column(columns.pose, strip, pose_of);
    if (!meaning.header.bodies.empty()) set_column(columns.body, strip, body_of);
    out->rows.add(columns.source, columns.xyz, columns.distance, columns.pose, columns.body);
  });
  out->rows.seal();
  const ClearanceRow& least = least_row(rows, &ClearanceRow::distance);
  out->place = {least.source, pose_of(least), xyz_of(quantisation, least.q), least.distance,
                body_of(least)};
  return out;
}

}  // namespace clearway
