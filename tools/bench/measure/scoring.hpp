#pragma once

#include <filesystem>
#include <string>

#include "bench/measure/record.hpp"
#include "clearway/error.hpp"

/// Judgements of results for the records of experiments.
namespace clearway::bench {

/// Whether two files have the same bytes.
bool same_bytes(const std::filesystem::path& a, const std::filesystem::path& b);

/// How the colliding points of a result differ from a reference's in the same environment.
Json compared(const std::filesystem::path& result, const std::filesystem::path& reference);

/// How many points a result decides wrongly, and how far from the boundary they lie
/// (misclassified.hpp).
Json judged(const std::filesystem::path& result, const std::filesystem::path& truth);

/// Thrown where results that must be equal are not.
class ResultsDiffer : public Error {
 public:
  using Error::Error;
};

/// Collects the cases that an exact engine decided wrongly.
class WrongCases {
 public:
  /// Checks the findings of compared() or judged(), where the case has them.
  void look_at(const Json& of_case);
  /// Throws ResultsDiffer with the keys of the wrong cases, if there are any.
  void refuse() const;

 private:
  std::string keys_;
};

/// How many points lie within 2^i ulps of the radius, i from 0.
Json near_boundary(const std::filesystem::path& truth);

}  // namespace clearway::bench
