#pragma once

#include "scene/vehicles/mesh.hpp"

/// The models of the scenes: x forward, y left, z up, metres.
namespace clearway::scene {

/// The bare body of a car, hollow, with its window, door and wheel openings, floor and cross
/// members. The origin lies under its middle, at the height of the floor's lowest parts.
struct CarBodySize {
  double length, width, height;
};
Mesh car_body(const CarBodySize& size);

/// An underground front loader, 9.6 m long with its bucket. Its origin lies on the ground, amid its
/// length.
Mesh front_loader();

/// The body of a railway wagon above its bogies, 25 m long. Its origin lies amid its length, at the
/// height of the rails' tops.
Mesh train_wagon();

/// A lorry with a high load, 12 m long, 2.9 m wide and 4 m high, without its wheels. Its origin
/// lies on the ground, amid its length.
Mesh lorry();

}  // namespace clearway::scene
