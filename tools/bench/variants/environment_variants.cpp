#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "bench/measure/publish.hpp"
#include "bench/variants/variants.hpp"
#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/las/las_header.hpp"
#include "io/scans/las/las_reader.hpp"
#include "io/scans/las/las_writer.hpp"
#include "scene/random.hpp"

/// Bytes of the LAS header: ASPRS LAS 1.4 R15, section 2.4.
namespace clearway::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCountByte = 107;
constexpr std::size_t kOffsetByte = 155;
constexpr std::size_t kBoundsByte = 179;  // greatest and least x, then y, then z
constexpr std::size_t kLongCountByte = 247;
constexpr std::size_t kHeaderBytes14 = 375;

InputBuffer open_las(const fs::path& path) {
  return {File::open_for_reading(path), InputBuffer::Access::kSeek};
}

/// A LAS file read as bytes.
class RawLas {
 public:
  explicit RawLas(const fs::path& path) : input_(open_las(path)), header_(read_las_header(input_)) {
    input_.return_to({});
  }

  const std::string& name() const { return input_.name(); }
  const LasPublicHeader& header() const { return header_; }

  /// The next bytes, at most InputBuffer::kCapacity; valid until the next call.
  std::span<const std::byte> take(std::size_t bytes) {
    const auto taken = input_.take(bytes);
    if (taken.size() != bytes) refuse(name(), "became shorter while it was read");
    return taken;
  }

  void copy(std::uint64_t bytes, const File& out) {
    while (bytes > 0) {
      const auto piece = std::min<std::uint64_t>(bytes, InputBuffer::kCapacity);
      out.write(take(piece));
      bytes -= piece;
    }
  }

  void copy_rest(const File& out) { copy(*input_.size() - input_.position(), out); }

 private:
  InputBuffer input_;
  LasPublicHeader header_;
};

/// The public header block, to be changed and written.
class HeaderBytes {
 public:
  explicit HeaderBytes(RawLas& las) {
    const auto bytes = las.take(las.header().header_bytes);
    bytes_.assign(bytes.begin(), bytes.end());
  }

  template <typename Value>
  Value at(std::size_t byte) const {
    return load<Value>(bytes_.data() + byte);
  }

  template <typename Value>
  void put(std::size_t byte, Value value) {
    std::memcpy(bytes_.data() + byte, &value, sizeof value);
  }

  void write(const File& out) const { out.write(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// The sum of two numbers; throws UsageError unless a double holds it exactly. Source of the
/// rounding error: Knuth, The Art of Computer Programming 2, section 4.2.2 (TwoSum).
double exact_sum(double a, double b) {
  const double sum = a + b;
  const double from_b = sum - a;
  if (std::isfinite(sum) && (a - (sum - from_b)) + (b - from_b) == 0) return sum;
  throw UsageError("a shift of " + format_number(b) + " m: offset " + format_number(a) +
                   " plus that has to be a double, without rounding");
}

void shift_header(HeaderBytes& header, const Vec3& shift) {
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(shift[k]) || shift[k] != std::nearbyint(shift[k])) {
      throw UsageError("a shift of " + format_number(shift[k]) + " m; expected whole metres");
    }
    const std::size_t offset = kOffsetByte + 8 * k;
    header.put(offset, exact_sum(header.at<double>(offset), shift[k]));
    for (const std::size_t bound : {kBoundsByte + 16 * k, kBoundsByte + 16 * k + 8}) {
      header.put(bound, header.at<double>(bound) + shift[k]);
    }
  }
}

/// Sets the counts of all points and of first returns; those of later returns become 0.
void set_counts(HeaderBytes& header, const LasPublicHeader& before, std::uint64_t points) {
  if (header.at<std::uint32_t>(kCountByte) != 0) {
    header.put(kCountByte, static_cast<std::uint32_t>(points));
    header.put(kCountByte + 4, std::array<std::uint32_t, 5>{static_cast<std::uint32_t>(points)});
  }
  const bool version_14 = header.at<std::uint8_t>(25) == 4 && before.header_bytes >= kHeaderBytes14;
  if (!version_14) return;
  header.put(kLongCountByte, points);
  header.put(kLongCountByte + 8, std::array<std::uint64_t, 15>{points});
}

void copy_sample(RawLas& las, std::uint64_t wanted, const scene::Random& random, const File& out) {
  const std::size_t record_bytes = las.header().record_bytes;
  const std::uint64_t points = las.header().points;
  const std::uint64_t batch = InputBuffer::kCapacity / record_bytes;
  std::vector<std::byte> kept(InputBuffer::kCapacity);
  for (std::uint64_t i = 0; i < points;) {
    const std::size_t count = std::min(batch, points - i);
    const std::byte* record = las.take(count * record_bytes).data();
    std::byte* end = kept.data();
    for (const std::uint64_t last = i + count; i < last; ++i, record += record_bytes) {
      // Once all points that are left are wanted, each is taken, because unit() is below 1; once
      // none is wanted, none is taken.
      const bool take =
          random.unit(i) * static_cast<double>(points - i) < static_cast<double>(wanted);
      if (!take) continue;
      std::memcpy(end, record, record_bytes);
      end += record_bytes;
      --wanted;
    }
    out.write({kept.data(), end});
  }
}

QuantumBox box_of(PointReader& reader) {
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t kGreatest = std::numeric_limits<std::int32_t>::max();
  QuantumBox box{{kGreatest, kGreatest, kGreatest}, {kLeast, kLeast, kLeast}};
  for (PointBatch batch; reader.read(batch);) {
    for (const auto& q : batch.quanta) box = box.united({{q[0], q[1], q[2]}, {q[0], q[1], q[2]}});
  }
  reader.rewind();
  return box;
}

/// A box of integers, stretched about its centre and not rounded yet.
struct StretchedBox {
  StretchedBox(const QuantumBox& box, double factor) {
    for (int k = 0; k < 3; ++k) {
      const double centre = 0.5 * (static_cast<double>(box.lo[k]) + box.hi[k]);
      const double half = 0.5 * (static_cast<double>(box.hi[k]) - box.lo[k]);
      lo[k] = centre - factor * half;
      hi[k] = centre + factor * half;
    }
  }
  double lo[3], hi[3];
};

std::int32_t rounded(double quantum, int multiple) {
  return static_cast<std::int32_t>(std::llround(quantum / multiple));
}

QuantumBox rounded(const StretchedBox& box, int multiple) {
  QuantumBox out{};
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = rounded(box.lo[k], multiple);
    out.hi[k] = rounded(box.hi[k], multiple);
  }
  return out;
}

/// The least power of ten that makes the box's integers fit 32 bits.
int fitting_multiple(const StretchedBox& box) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max() - 1.0;  // 1 for rounding
  double reach = 0;
  for (int k = 0; k < 3; ++k) reach = std::max({reach, -box.lo[k], box.hi[k]});
  int multiple = 1;
  while (reach / multiple > kMost) multiple *= 10;
  return multiple;
}

void write_corners(const QuantumBox& box, LasWriter& writer) {
  std::array<std::array<std::int32_t, 3>, kStrayPoints> corners{};
  for (unsigned i = 0; i < corners.size(); ++i) {
    for (unsigned k = 0; k < 3; ++k) corners[i][k] = i >> k & 1 ? box.hi[k] : box.lo[k];
  }
  writer.write(corners);
}

}  // namespace

void shift_environment(const fs::path& las_in, const fs::path& las_out, const Vec3& shift) {
  RawLas las(las_in);
  HeaderBytes header(las);
  shift_header(header, shift);
  publish(las_in, las_out, [&](const File& out) {
    header.write(out);
    las.copy_rest(out);
  });
}

void sample_environment(const fs::path& las_in, const fs::path& las_out,
                        std::uint64_t points_wanted, std::uint64_t seed) {
  RawLas las(las_in);
  const LasPublicHeader& before = las.header();
  if (points_wanted > before.points) {
    throw UsageError(las.name() + ": " + std::to_string(points_wanted) + " points wanted of " +
                     std::to_string(before.points));
  }
  if (before.tail_count > 0) {
    refuse(las.name(), "has records behind its points; expected none, as clearway scene writes it");
  }
  HeaderBytes header(las);
  set_counts(header, before, points_wanted);
  publish(las_in, las_out, [&](const File& out) {
    header.write(out);
    las.copy(before.points_offset - before.header_bytes, out);
    copy_sample(las, points_wanted, scene::Random(seed, 0), out);
  });
}

int stretch_environment(const fs::path& las_in, const fs::path& las_out, double factor) {
  if (!(factor >= 1 && factor <= kGreatestStretch)) {
    throw UsageError("a stretch of " + format_number(factor) + "; expected 1 to " +
                     format_number(kGreatestStretch));
  }
  const auto reader = read_las(open_las(las_in));
  const CloudInfo& info = reader->info();
  if (info.declared_points == 0u) refuse(las_in.string(), "has no points; expected one at least");
  const QuantumBox box = box_of(*reader);
  const int multiple = fitting_multiple(StretchedBox(box, kGreatestStretch));
  const QuantumBox stretched = rounded(StretchedBox(box, factor), multiple);
  LasHeader header{.quantisation = *info.quantisation,
                   .points = *info.declared_points + kStrayPoints,
                   .bounds = stretched,
                   .crs_wkt = info.crs_wkt};
  for (double& scale : header.quantisation.scale) scale *= multiple;
  publish(las_in, las_out, [&](const File& out) {
    LasWriter writer(out, header);
    for (PointBatch batch; reader->read(batch); writer.write(batch.quanta)) {
      for (auto& q : batch.quanta) {
        for (std::int32_t& value : q) value = rounded(value, multiple);
      }
    }
    write_corners(stretched, writer);
    writer.finish();
  });
  return multiple;
}

}  // namespace clearway::bench
