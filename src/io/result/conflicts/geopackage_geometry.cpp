#include "io/result/conflicts/geopackage_geometry.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/geometry/point_box.hpp"

namespace clearway {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint32_t kWithHeights = 1000;  // added to the number of a shape that has heights

class Bytes {
 public:
  template <typename Number>
  void add(Number number) {
    const std::size_t end = out_.size();
    out_.resize(end + sizeof number);
    std::memcpy(out_.data() + end, &number, sizeof number);
  }
  std::vector<std::byte> take() { return std::move(out_); }

 private:
  std::vector<std::byte> out_;
};

void add_header(Bytes& out, GeoShape shape, std::span<const Vec3> points, std::int32_t srs) {
  constexpr std::uint8_t kLittleEndian = 1, kBoxInXY = 1 << 1;
  const bool has_box = shape != GeoShape::kPoint;
  for (const char c : {'G', 'P', '\0'}) out.add(c);
  out.add(static_cast<std::uint8_t>(kLittleEndian | (has_box ? kBoxInXY : 0)));
  out.add(srs);
  if (!has_box) return;
  const Box box = box_of(points);
  for (const double side : {box.lo.x, box.hi.x, box.lo.y, box.hi.y}) out.add(side);
}

}  // namespace

std::vector<std::byte> geometry_bytes(GeoShape shape, std::span<const Vec3> points,
                                      std::int32_t srs) {
  Bytes out;
  add_header(out, shape, points, srs);
  out.add(std::uint8_t{1});  // little-endian
  out.add(static_cast<std::uint32_t>(shape) + kWithHeights);
  if (shape == GeoShape::kPolygon) out.add(std::uint32_t{1});  // one ring
  if (shape != GeoShape::kPoint) out.add(static_cast<std::uint32_t>(points.size()));
  for (const Vec3& p : points) {
    for (int k = 0; k < 3; ++k) out.add(p[k]);
  }
  return out.take();
}

}  // namespace clearway
