#pragma once

#include <vector>

#include "clearway/query.hpp"

namespace clearway {

/// One query for each body, with the body's model at its own poses and its floor. Copies models and
/// poses.
inline std::vector<Query> body_queries(const Query& query) {
  std::vector<Query> out;
  out.reserve(query.bodies.size());
  for (const Body& body : query.bodies) {
    Query& one = out.emplace_back(body.model, body.poses, query);
    if (body.floor) one.floor = body.floor;
  }
  return out;
}

}  // namespace clearway
