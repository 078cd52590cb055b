#pragma once

#include "io/model/sample_set.hpp"
#include "io/model/triangle_frame.hpp"

namespace clearway {

/// Samples that cover triangles: no place of a triangle given to cover() is farther than `spacing`
/// from a sample. The bounds are derived in docs/design/model.md, section "The cover".
class SurfaceCover {
 public:
  /// most: number of samples that may be added before cover() gives up.
  SurfaceCover(double spacing, std::uint64_t most);

  void add(const Vec3& sample) { samples_.add(sample); }
  /// Adds the samples that cover a triangle, whose corners are samples already. Returns false where
  /// `most` samples do not suffice.
  bool cover(const Vec3& a, const Vec3& b, const Vec3& c);
  /// Estimated number of samples for a triangle: about the number of nodes of its lattice; 0 where
  /// its corners suffice.
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
