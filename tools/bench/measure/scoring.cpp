#include "bench/measure/scoring.hpp"

#include <cstring>

#include "bench/measure/misclassified.hpp"
#include "io/files/mapped_file.hpp"
#include "io/result/check_results.hpp"

namespace clearway::bench {

bool same_bytes(const std::filesystem::path& a, const std::filesystem::path& b) {
  const MappedFile one(a), other(b);
  return one.bytes().size() == other.bytes().size() &&
         std::memcmp(one.bytes().data(), other.bytes().data(), one.bytes().size()) == 0;
}

Json compared(const std::filesystem::path& result, const std::filesystem::path& reference) {
  const Comparison found = compare_results(ResultReader(result), ResultReader(reference), 0);
  return {{"common", found.common},
          {"only_here", found.only_in_a},
          {"only_in_reference", found.only_in_b},
          {"equal", found.equal()}};
}

Json judged(const std::filesystem::path& result, const std::filesystem::path& truth) {
  const Misclassified wrong = misclassified(ResultReader(truth), ResultReader(result));
  const std::uint64_t count = wrong.false_hits + wrong.misses;
  return {{"false_hits", wrong.false_hits},
          {"misses", wrong.misses},
          {"share", static_cast<double>(count) /
                        static_cast<double>(std::max<std::uint64_t>(wrong.environment_points, 1))},
          {"beyond", wrong.beyond},
          {"largest_distance", wrong.largest_distance},
          {"histogram", wrong.histogram}};
}

void WrongCases::look_at(const Json& of_case) {
  const Json found = of_case.value("findings", Json::object());
  const bool right = found.value("equal", true) && found.value("false_hits", 0) == 0 &&
                     found.value("misses", 0) == 0;
  if (!right) keys_ += (keys_.empty() ? "" : ", ") + of_case["key"].get<std::string>();
}

void WrongCases::refuse() const {
  if (!keys_.empty()) throw ResultsDiffer("engines that decide exactly are wrong: " + keys_);
}

Json near_boundary(const std::filesystem::path& truth) {
  const ResultReader reader(truth);
  return {{"environment_points", reader.header().environment_points},
          {"within_ulps", points_near_boundary(reader, reader.header().radius)}};
}

}  // namespace clearway::bench
