#include "io/result/verify_result.hpp"

#include "clearway/error.hpp"
#include "io/formats/requantize.hpp"
#include "io/result/result_rows.hpp"

namespace clearway {
namespace {

void check_rows(const ResultReader& result, const ResultRows& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!quantum_at(result.header().quantisation, axis, rows.xyz[i][axis])) {
        throw InputError(result.name() + ": a coordinate of source point " +
                         std::to_string(rows.source[i]) + " is not on the environment's scale");
      }
    }
  }
}

}  // namespace

std::optional<std::string> verify_result(const ResultReader& result, Progress& progress) {
  ResultRowStream stream(result);
  ResultRows rows;
  progress.begin("verify", result.collisions() + result.clearances(), "points");
  std::optional<std::string> fault;
  try {
    while (stream.read(rows)) {
      check_rows(result, rows);
      progress.advance(rows.size());
    }
    ClearanceRowStream clearances(result);
    for (ClearanceRows read; clearances.read(read);) progress.advance(read.size());
  } catch (const InputError& error) {
    fault = error.what();
  }
  progress.end();
  return fault;
}

}  // namespace clearway
