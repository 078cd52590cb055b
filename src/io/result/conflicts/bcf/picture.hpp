#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// The camera of a picture. direction and up: of length 1, at right angles.
struct Camera {
  Vec3 place, direction, up;
  double field_of_view = 60;  ///< vertical field of view in degrees
};

using Colour = std::array<std::uint8_t, 3>;

/// A picture of points and lines as a camera sees them; at each pixel the nearest is shown.
class Picture {
 public:
  Picture(int width, int height, const Camera& camera);

  /// Draws a point as a square with sides of `size` pixels.
  void draw_point(const Vec3& at, const Colour& colour, int size);
  /// Draws a point as a square with sides of `size` pixels, in front of everything except other
  /// marks.
  void draw_mark(const Vec3& at, const Colour& colour, int size);
  void draw_line(const Vec3& from, const Vec3& to, const Colour& colour);

  /// The bytes of a PNG file. Source: W3C, PNG (second edition).
  std::string png() const;

 private:
  struct Seen {
    double x, y, depth;  ///< x, y: pixels from the upper left corner; depth: metres
  };
  bool see(const Vec3& at, Seen& seen) const;
  void draw_square(const Seen& seen, double depth, const Colour& colour, int size);
  void set(int x, int y, double depth, const Colour& colour);

  int width_, height_;
  Camera camera_;
  Vec3 right_;
  double scale_;  ///< size in pixels of a length that equals its depth
  std::vector<Colour> colours_;
  std::vector<float> depths_;
};

}  // namespace clearway
