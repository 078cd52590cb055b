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
  bool between_poses = true;  ///< whether it answers such questions
};

std::span<const Engine> engines();

/// From now on engines() are these.
void test_only(std::vector<Engine> engines);

/// Runs every engine on the points, packed in several ways, as a set and with first poses, at
/// poses and between them, and checks the answers against brute force; likewise clearances below
/// and above the radius, where an engine has them. Returns the number of points that collide at a
/// pose.
std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Question& question);

/// Only between poses, in one packing. Returns every point's first pose, or HitSet::kNever.
std::vector<std::uint32_t> check_between_poses(std::span<const Quantum> points,
                                               const Quantisation& quantisation, Question question);

/// The same as check_engines above for one way of packing them.
std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Question& question, const MemoryCloudOptions& packing);

/// The clearances that the question asks for. Returns how many there are.
std::uint64_t check_clearances(std::span<const Quantum> points, const Quantisation& quantisation,
                               const Question& question);

}  // namespace clearway
