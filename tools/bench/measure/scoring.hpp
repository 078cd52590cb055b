#pragma once

#include <filesystem>
#include <string>

#include "bench/measure/record.hpp"

/// What is said of a result.
namespace clearway::tool {

/// How its set differs from a reference's, about the same environment.
Json compared(const std::filesystem::path& result, const std::filesystem::path& reference);

/// How many points it decides wrongly, and how far from the boundary (misclassified.hpp).
Json judged(const std::filesystem::path& result, const std::filesystem::path& truth);

/// Notes which cases are wrong of engines that decide exactly.
class WrongCases {
 public:
  /// Looks at the findings of compared() or judged(), where the case has them.
  void look_at(const Json& of_case);
  /// Throws Error with the keys of the wrong ones.
  void refuse() const;

 private:
  std::string keys_;
};

/// How many points lie within 2^i ulps of the radius, i from 0.
Json near_boundary(const std::filesystem::path& truth);

}  // namespace clearway::tool
