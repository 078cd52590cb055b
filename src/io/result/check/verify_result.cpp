#include "io/result/check/verify_result.hpp"

#include <span>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "io/formats/requantize.hpp"
#include "io/result/result.hpp"

namespace clearway {
namespace {

void check_points(const ResultReader& result, std::span<const std::uint64_t> source,
                  std::span<const Vec3> xyz) {
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    if (source[i] == Profile::kNoPoint) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (!quantum_at(result.header().quantisation, axis, xyz[i][axis])) {
        throw InputError(result.name() + ": a coordinate of source point " +
                         std::to_string(source[i]) + " is not on the environment's scale");
      }
    }
  }
}

template <typename Rows>
void check_table(const ResultReader& result, Progress& progress) {
  RowStream<Rows> stream(result);
  for (Rows rows; stream.read(rows);) {
    check_points(result, rows.source, rows.xyz);
    progress.advance(rows.size());
  }
}

}  // namespace

std::optional<std::string> verify_result(const ResultReader& result, Progress& progress) {
  progress.begin("verify", result.collisions() + result.clearances() + result.profile_rows(),
                 "rows");
  std::optional<std::string> fault;
  try {
    check_table<Collisions>(result, progress);
    check_table<Clearances>(result, progress);
    check_table<ProfileRows>(result, progress);
  } catch (const InputError& error) {
    fault = error.what();
  }
  progress.end();
  return fault;
}

bool is_intact_result(const std::filesystem::path& file, const ResultHeader& header,
                      Progress& progress) {
  try {
    const ResultReader result(file, Parts::kAccepted);
    ResultHeader found = result.header();
    found.last_pose =
        header.last_pose;  // Older releases wrote no last poses, but answered the same question.
    return found == header && !verify_result(result, progress);
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace clearway
