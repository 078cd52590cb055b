#pragma once

namespace clearway {

/// An axis of a model's frame, with its sign.
enum class Axis { kPlusX, kMinusX, kPlusY, kMinusY, kPlusZ, kMinusZ };

/// The name of an axis with its sign, such as "+x".
inline const char* name_of(Axis axis) {
  switch (axis) {
    case Axis::kPlusX:
      return "+x";
    case Axis::kMinusX:
      return "-x";
    case Axis::kPlusY:
      return "+y";
    case Axis::kMinusY:
      return "-y";
    case Axis::kPlusZ:
      return "+z";
    case Axis::kMinusZ:
      return "-z";
  }
  return "";
}

/// Which axes of a model's frame point ahead and up.
struct ModelAxes {
  Axis forward = Axis::kPlusX, up = Axis::kPlusZ;

  /// Whether a model with these axes has to be turned to have x ahead, y to the left and z up.
  bool need_turn() const { return *this != ModelAxes{}; }
  friend bool operator==(const ModelAxes&, const ModelAxes&) = default;
};

}  // namespace clearway
