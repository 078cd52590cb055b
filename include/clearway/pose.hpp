#pragma once

namespace clearway {

/// m' = rotation * m + translation, as read: the rotation is not re-orthonormalised.
/// rotation: 3 x 3, row-major, unitless; translation: metres.
struct Pose {
  double rotation[9];
  double translation[3];
  friend bool operator==(const Pose&, const Pose&) = default;
};

}  // namespace clearway
