#include <cmath>
#include <numbers>
#include <string>

#include "bench/measure/publish.hpp"
#include "bench/variants/variants.hpp"
#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "core/geometry/point_box.hpp"
#include "io/files/text_writer.hpp"

namespace clearway::bench {
namespace {

/// The mesh of a superellipsoid with n meridians and n + 1 steps from pole to pole.
class BodyMesh {
 public:
  BodyMesh(const Box& box, std::uint64_t n) : box_(box), n_(n) {}

  void write(const File& file) const {
    TextWriter out(file);
    out << "OFF\n" << top() + 2 << " " << 2 * n_ * n_ << " 0\n";
    write_corners(out);
    write_faces(out);
    out.flush();
  }

 private:
  std::uint64_t top() const { return n_ * n_; }
  std::uint64_t bottom() const { return top() + 1; }

  /// Writes the corners row by row, then both poles.
  void write_corners(TextWriter& out) const {
    const auto n = static_cast<double>(n_);
    for (std::uint64_t row = 1; row <= n_; ++row) {
      const double polar = std::numbers::pi * static_cast<double>(row) / (n + 1);
      for (std::uint64_t i = 0; i < n_; ++i) {
        const double turn = 2 * std::numbers::pi * static_cast<double>(i) / n;
        const double around = root(std::sin(polar));
        write_corner(out, {around * root(std::cos(turn)), around * root(std::sin(turn)),
                           root(std::cos(polar))});
      }
    }
    write_corner(out, {0, 0, 1});
    write_corner(out, {0, 0, -1});
  }

  void write_faces(TextWriter& out) const {
    const auto face = [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
      out << "3 " << a << " " << b << " " << c << "\n";
    };
    for (std::uint64_t i = 0; i < n_; ++i) {
      const std::uint64_t next = (i + 1) % n_;
      face(top(), i, next);
      for (std::uint64_t upper = 0, lower = n_; lower < top(); upper = lower, lower += n_) {
        face(upper + i, lower + i, lower + next);
        face(upper + i, lower + next, upper + next);
      }
      face(bottom(), top() - n_ + next, top() - n_ + i);
    }
  }

  void write_corner(TextWriter& out, const Vec3& unit) const {
    for (int k = 0; k < 3; ++k) {
      const double half = (box_.hi[k] - box_.lo[k]) / 2;
      out << box_.lo[k] + half * (1 + unit[k]) << (k < 2 ? " " : "\n");
    }
  }

  /// The square root with the sign of x. Squares of sine and cosine add up to 1, so fourth powers
  /// of their roots do.
  static double root(double x) { return std::copysign(std::sqrt(std::abs(x)), x); }

  Box box_;
  std::uint64_t n_;
};

}  // namespace

void write_body(const std::filesystem::path& in, const std::filesystem::path& out,
                std::uint64_t triangles) {
  const auto n = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(triangles) / 2));
  if (n < 3) {
    throw UsageError("a body of " + std::to_string(triangles) + " triangles; expected at least 18");
  }
  const BodyMesh mesh(box_of(read_model_points(in)), n);
  publish(in, out, [&](const File& file) { mesh.write(file); });
}

}  // namespace clearway::bench
