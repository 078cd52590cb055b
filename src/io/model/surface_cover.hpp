#pragma once

#include "io/model/sample_set.hpp"
#include "io/model/triangle_frame.hpp"

namespace clearway {

/// Samples that cover triangles: no place of a triangle given to cover() is farther than `spacing`
/// from a sample. docs/design/model.md, section "The cover", has the bounds named here.
class SurfaceCover {
 public:
  /// most: samples that may be added before it gives up.
  SurfaceCover(double spacing, std::uint64_t most);

  void add(const Vec3& sample) { samples_.add(sample); }
  /// The corners are samples already. False where `most` samples do not do.
  bool cover(const Vec3& a, const Vec3& b, const Vec3& c);
  /// About as many samples as the lattice of the triangle has nodes; 0 where its corners do.
  double estimate(const Vec3& a, const Vec3& b, const Vec3& c) const;

  SampleSet& samples() { return samples_; }

 private:
  struct Lattice;

  bool corners_cover(const TriangleFrame& triangle) const;
  bool cover_node(const TriangleFrame& triangle, const FlatPolygon& region, const FlatPlace& node);
  bool covered(const TriangleFrame& triangle, const FlatPolygon& region, int splits) const;

  double spacing_, reach_;
  std::uint64_t most_;
  SampleSet samples_;
};

}  // namespace clearway
