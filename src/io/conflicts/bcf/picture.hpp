#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// Where a picture is taken from. direction and up: of length 1, at right angles.
struct Camera {
  Vec3 place, direction, up;
  double field_of_view = 60;  ///< degrees, of the picture's height
};

using Colour = std::array<std::uint8_t, 3>;

/// Points and lines as a camera sees them: of several at a pixel the nearest.
class Picture {
 public:
  Picture(int width, int height, const Camera& camera);

  /// A square of `size` pixels.
  void draw_point(const Vec3& at, const Colour& colour, int size);
  /// The same in front of everything but other marks.
  void draw_mark(const Vec3& at, const Colour& colour, int size);
  void draw_line(const Vec3& from, const Vec3& to, const Colour& colour);

  /// The bytes of a PNG file. Source: W3C, PNG (second edition).
  std::string png() const;

 private:
  struct Seen {
    double x, y, depth;  ///< pixels from the upper left corner; metres
  };
  bool see(const Vec3& at, Seen& seen) const;
  void draw_square(const Seen& seen, double depth, const Colour& colour, int size);
  void set(int x, int y, double depth, const Colour& colour);

  int width_, height_;
  Camera camera_;
  Vec3 right_;
  double scale_;  ///< pixels of a length as long as its depth
  std::vector<Colour> colours_;
  std::vector<float> depths_;
};

}  // namespace clearway
