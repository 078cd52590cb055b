#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "clearway/error.hpp"
#include "io/convert/inputs/environment_source.hpp"
#include "io/convert/inputs/read_points.hpp"
#include "io/system/input_error.hpp"

// Conversion of records to the store's integers.

namespace clearway {

void EnvironmentSource::convert(RecordBatch& records, QuantaBatch& batch, bool with_bytes) const {
  if (records.reader) read_piece(records, with_bytes ? &batch.bytes : nullptr);
  batch.file = records.file;
  batch.first_source = records.first_source;
  batch.records = records.points.size();
  batch.quanta.clear();
  batch.offsets.clear();
  batch.classes.clear();
  batch.non_finite_points = batch.absent_points = 0;
  batch.largest_change = 0;
  if (shifts_.empty() || !infos_[records.file].quantisation) {
    append_rounded(records, batch);
  } else {
    append_kept(records, batch);
  }
  keep_classes(records, batch);
  records.points = {};
}

/// Keeps the classes of the points that were not dropped.
void EnvironmentSource::keep_classes(RecordBatch& records, QuantaBatch& out) {
  std::vector<std::uint8_t>& classes = records.points.classes;
  const auto is_set = [](std::uint8_t value) { return value != 0; };
  if (std::none_of(classes.begin(), classes.end(), is_set)) return;
  for (std::size_t i = 0; i < out.offsets.size(); ++i) classes[i] = classes[out.offsets[i]];
  classes.resize(out.quanta.size());
  out.classes = std::move(classes);
}

void EnvironmentSource::append_kept(RecordBatch& records, QuantaBatch& out) const {
  out.quanta = std::move(records.points.quanta);
  const std::size_t file = records.file;
  const Quantisation& own = *infos_[file].quantisation;
  if (own == quantisation_) return;
  for (auto& q : out.quanta) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double before = coordinate(own, axis, q[k]);
      const std::int64_t shifted = q[k] + shifts_[file][k];
      if (shifted < std::numeric_limits<std::int32_t>::min() ||
          shifted > std::numeric_limits<std::int32_t>::max()) {
        throw InputError(files()[file].string() + ": too far from " + files()[0].string() +
                             " for 32-bit integers of " + brief(own.scale[k]),
                         Remedy::kScale);
      }
      q[k] = static_cast<std::int32_t>(shifted);
      out.largest_change =
          std::max(out.largest_change, std::abs(coordinate(quantisation_, axis, q[k]) - before));
    }
  }
}

void EnvironmentSource::append_rounded(const RecordBatch& records, QuantaBatch& out) const {
  const PointBatch& batch = records.points;
  auto absent = batch.absent.begin();
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Vec3 p = point_of(batch, infos_[records.file], i);
    if (!is_finite(p)) {
      if (absent != batch.absent.end() && *absent == i) {
        ++out.absent_points;
        ++absent;
      } else {
        if (out.non_finite_points++ == 0) out.first_non_finite = records.first_source + i;
      }
      if (out.offsets.empty()) {
        for (std::uint32_t j = 0; j < out.quanta.size(); ++j) out.offsets.push_back(j);
        out.offsets.reserve(batch.size());
      }
      continue;
    }
    std::array<std::int32_t, 3> q;
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double quantum =
          std::nearbyint((p[axis] - quantisation_.offset[k]) / quantisation_.scale[k]);
      if (quantum < kLeastQuantum || quantum > kGreatestQuantum) {
        refuse_beyond_quanta(records.file);
      }
      q[k] = static_cast<std::int32_t>(quantum);
      out.largest_change =
          std::max(out.largest_change, std::abs(coordinate(quantisation_, axis, q[k]) - p[axis]));
    }
    out.quanta.push_back(q);
    // Points behind the first dropped one need an index of their own; without any dropped point,
    // offsets stays empty.
    if (out.quanta.size() <= i) out.offsets.push_back(static_cast<std::uint32_t>(i));
  }
}

void EnvironmentSource::refuse_beyond_quanta(std::size_t file) const {
  if (shifts_.empty()) refuse(files()[file].string(), "changed while it was read");
  refuse(files()[file].string(),
         "too far from the other files for 32-bit integers of " + brief(quantisation_.scale[0]),
         Remedy::kScale);
}

}  // namespace clearway
