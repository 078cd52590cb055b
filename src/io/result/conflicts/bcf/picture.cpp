#include "io/result/conflicts/bcf/picture.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "io/files/deflate.hpp"

namespace clearway {
namespace {

constexpr Colour kBackground{255, 255, 255};
constexpr double kNearest = 0.01;  // least distance in front of the camera, in metres

double along(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

void put_big_endian(std::string& out, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(value >> shift & 0xff);
}

void put_chunk(std::string& out, const std::string& kind, const std::string& data) {
  put_big_endian(out, static_cast<std::uint32_t>(data.size()));
  const std::string checked = kind + data;
  out += checked;
  put_big_endian(out, static_cast<std::uint32_t>(crc32_z(
                          0, reinterpret_cast<const Bytef*>(checked.data()), checked.size())));
}

}  // namespace

Picture::Picture(int width, int height, const Camera& camera)
    : width_(width),
      height_(height),
      camera_(camera),
      right_{camera.direction.y * camera.up.z - camera.direction.z * camera.up.y,
             camera.direction.z * camera.up.x - camera.direction.x * camera.up.z,
             camera.direction.x * camera.up.y - camera.direction.y * camera.up.x},
      scale_(height / 2.0 / std::tan(camera.field_of_view / 2 * std::numbers::pi / 180)),
      colours_(static_cast<std::size_t>(width) * height, kBackground),
      depths_(colours_.size(), std::numeric_limits<float>::infinity()) {}

bool Picture::see(const Vec3& at, Seen& seen) const {
  const Vec3 from{at.x - camera_.place.x, at.y - camera_.place.y, at.z - camera_.place.z};
  seen.depth = along(from, camera_.direction);
  if (!(seen.depth > kNearest)) return false;
  seen.x = width_ / 2.0 + scale_ * along(from, right_) / seen.depth;
  seen.y = height_ / 2.0 - scale_ * along(from, camera_.up) / seen.depth;
  return std::abs(seen.x) < 1e6 && std::abs(seen.y) < 1e6;
}

void Picture::set(int x, int y, double depth, const Colour& colour) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  const std::size_t pixel = static_cast<std::size_t>(y) * width_ + x;
  if (!(depth < depths_[pixel])) return;
  depths_[pixel] = static_cast<float>(depth);
  colours_[pixel] = colour;
}

void Picture::draw_point(const Vec3& at, const Colour& colour, int size) {
  Seen seen{};
  if (see(at, seen)) draw_square(seen, seen.depth, colour, size);
}

void Picture::draw_mark(const Vec3& at, const Colour& colour, int size) {
  Seen seen{};
  if (see(at, seen)) draw_square(seen, 0, colour, size);
}

void Picture::draw_square(const Seen& seen, double depth, const Colour& colour, int size) {
  const int left = static_cast<int>(std::floor(seen.x)) - size / 2;
  const int top = static_cast<int>(std::floor(seen.y)) - size / 2;
  for (int y = top; y < top + size; ++y) {
    for (int x = left; x < left + size; ++x) set(x, y, depth, colour);
  }
}

void Picture::draw_line(const Vec3& from, const Vec3& to, const Colour& colour) {
  Seen a{}, b{};
  if (!see(from, a) || !see(to, b)) return;
  const double longest = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
  const int steps = static_cast<int>(std::clamp(longest, 1.0, 4.0 * (width_ + height_)));
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    set(static_cast<int>(std::floor(a.x + t * (b.x - a.x))),
        static_cast<int>(std::floor(a.y + t * (b.y - a.y))), a.depth + t * (b.depth - a.depth),
        colour);
  }
}

std::string Picture::png() const {
  std::string header;
  put_big_endian(header, static_cast<std::uint32_t>(width_));
  put_big_endian(header, static_cast<std::uint32_t>(height_));
  header += {8, 2, 0, 0, 0};  // bits, RGB, deflate, filters, not interlaced
  std::string lines;
  lines.reserve(colours_.size() * 3 + static_cast<std::size_t>(height_));
  for (int y = 0; y < height_; ++y) {
    lines += '\0';  // no filter
    for (int x = 0; x < width_; ++x) {
      for (const std::uint8_t part : colours_[static_cast<std::size_t>(y) * width_ + x]) {
        lines += static_cast<char>(part);
      }
    }
  }
  std::string out = "\x89PNG\r\n\x1a\n";
  put_chunk(out, "IHDR", header);
  put_chunk(out, "IDAT", deflated(lines, DeflateForm::kZlib));
  put_chunk(out, "IEND", "");
  return out;
}

}  // namespace clearway
