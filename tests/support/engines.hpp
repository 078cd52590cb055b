#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/hit_set.hpp"
#include "core/question.hpp"
#include "support/memory_cloud.hpp"

namespace clearway {

/// An engine under test. Every one runs through the same cases, against brute force.
struct Engine {
  std::string name;
  HitSet (*run)(const PackedCloud& cloud, const Question& question, int threads);
};

std::span<const Engine> engines();

/// Runs every engine on the points, packed in several ways, as a set and with first poses, and
/// checks the answers against brute force. Returns the number of colliding points.
std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Question& question);

/// The same for one way of packing them.
std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Question& question, const MemoryCloudOptions& packing);

}  // namespace clearway
