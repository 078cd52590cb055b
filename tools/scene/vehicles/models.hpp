#pragma once

#include "scene/vehicles/mesh.hpp"

/// The models: x forward, y left, z up, metres.
namespace clearway::scene {

/// The bare body of a car, hollow, with its window, door and wheel openings, floor and cross
/// members. The origin lies under its middle, at the height of the floor's lowest parts.
struct CarBodySize {
  double length, width, height;
};
Mesh car_body(const CarBodySize& size);

/// An underground front loader, 9.6 m with its bucket. Origin on the ground, amid its length.
Mesh front_loader();

/// A railway wagon over its bogies, 25 m. Origin amid its length, at the height of the rails' tops.
Mesh train_wagon();

}  // namespace clearway::scene
