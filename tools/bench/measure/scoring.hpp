#pragma once

#include <filesystem>
#include <string>

#include "bench/measure/record.hpp"
#include "clearway/error.hpp"

/// What is said of a result.
namespace clearway::bench {

/// Whether two files have the same bytes.
bool same_bytes(const std::filesystem::path& a, const std::filesystem::path& b);

/// How its set differs from a reference's, about the same environment.
Json compared(const std::filesystem::path& result, const std::filesystem::path& reference);

/// How many points it decides wrongly, and how far from the boundary (misclassified.hpp).
Json judged(const std::filesystem::path& result, const std::filesystem::path& truth);

/// Results that must be equal are not.
class ResultsDiffer : public Error {
 public:
  using Error::Error;
};

/// Notes which cases are wrong of engines that decide exactly.
class WrongCases {
 public:
  /// Looks at the findings of compared() or judged(), where the case has them.
  void look_at(const Json& of_case);
  /// Throws ResultsDiffer with the keys of the wrong ones.
  void refuse() const;

 private:
  std::string keys_;
};

/// How many points lie within 2^i ulps of the radius, i from 0.
Json near_boundary(const std::filesystem::path& truth);

}  // namespace clearway::bench
