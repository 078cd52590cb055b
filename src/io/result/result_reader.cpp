#include <optional>
#include <stdexcept>

#include "clearway/error.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/parallel_read.hpp"
#include "io/result/result.hpp"
#include "io/result/result_names.hpp"
#include "io/result/result_reader_state.hpp"
#include "io/result/row_checks.hpp"

namespace clearway {
namespace {

namespace names = result_names;

/// Calls `call` and turns a failure of HDF5 into an InputError: since the file could be opened, its
/// content must be damaged. Errors of system calls pass through.
template <typename Call>
auto as_input(const std::string& name, Call call) {
  const hdf5::QuietScope quiet;
  try {
    return call();
  } catch (const hdf5::Failure& error) {
    throw InputError(name + ": damaged: " + error.what());
  }
}

void check_range(std::uint64_t first, std::size_t count, std::uint64_t rows) {
  if (first > rows || count > rows - first) {
    throw std::logic_error("ResultReader: rows past the end");
  }
}

template <typename... Spans>
void check_lengths(std::size_t rows, const Spans&... spans) {
  if (((spans.size() != rows) || ...)) {
    throw std::logic_error("ResultReader: rows of unequal lengths");
  }
}

/// Whether many threads may read these rows, which they may where the rows begin and end with
/// chunks.
bool are_whole_chunks(std::uint64_t first, std::size_t count, std::uint64_t rows) {
  return first % kEncodedRows == 0 && (count % kEncodedRows == 0 || first + count == rows);
}

template <typename... Columns>
void add_to(std::span<Xxh64Stream> hashes, const Columns&... columns) {
  std::size_t i = 0;
  ((columns.empty() ? void() : hashes[i].update(std::as_bytes(columns)), ++i), ...);
}

}  // namespace

ResultReader::ResultReader(const std::filesystem::path& path, Parts parts) {
  state_ = as_input(path.string(), [&] { return std::make_unique<State>(path); });
  if (parts == Parts::kAccepted || !header().part) return;
  throw InputError(name() + ": is " + in_words(header().part->shard) +
                       " of a result, and says nothing of the rest",
                   Remedy::kMerge);
}

ResultReader::~ResultReader() {
  const hdf5::QuietScope quiet;
  state_.reset();
}
ResultReader::ResultReader(ResultReader&&) noexcept = default;
ResultReader& ResultReader::operator=(ResultReader&& other) noexcept {
  const hdf5::QuietScope quiet;
  state_ = std::move(other.state_);
  return *this;
}

const std::string& ResultReader::name() const { return state_->name; }
const ResultHeader& ResultReader::header() const { return state_->header; }
const ResultFindings& ResultReader::findings() const { return state_->findings; }
std::uint64_t ResultReader::collisions() const { return state_->source.rows(); }
std::uint64_t ResultReader::collisions_hash() const { return state_->collisions_hash; }
std::uint64_t ResultReader::clearances_hash() const { return state_->clearance_hash; }
std::uint64_t ResultReader::profile_hash() const { return state_->profile_hash; }

void ResultReader::read_collisions(std::uint64_t first, std::span<std::uint64_t> source,
                                   std::span<Vec3> xyz, std::span<std::uint32_t> first_pose,
                                   std::span<Xxh64Stream> hashes) const {
  const State& s = *state_;
  check_lengths(source.size(), xyz);
  check_lengths(s.first_pose ? source.size() : 0, first_pose);
  check_range(first, source.size(), collisions());
  ParallelRead read;
  const RowChecks checks = s.checks(names::kGroup, first);
  const bool there =
      are_whole_chunks(first, source.size(), collisions()) && as_input(s.name, [&] {
        return read.add(s.source, first, source, hashes[0],
                        checks.from_any_row(&RowChecks::sources)) &&
               read.add(s.xyz, first, xyz, hashes[1], checks.from_any_row(&RowChecks::points)) &&
               (!s.first_pose || read.add(*s.first_pose, first, first_pose, hashes[2],
                                          checks.for_poses(names::kFirstPose)));
      });
  if (there && read.run() && ascends_at_chunks(source, s.source.chunk_rows())) return;
  read_source(first, source);
  read_xyz(first, xyz);
  if (s.first_pose) read_first_pose(first, first_pose);
  add_to(hashes, source, xyz, first_pose);
}

void ResultReader::read_source(std::uint64_t first, std::span<std::uint64_t> out) const {
  check_range(first, out.size(), collisions());
  as_input(state_->name, [&] { state_->source.read(first, out); });
  state_->checks(names::kGroup, first).sources(out);
}

void ResultReader::read_xyz(std::uint64_t first, std::span<Vec3> out) const {
  check_range(first, out.size(), collisions());
  as_input(state_->name, [&] { state_->xyz.read(first, as_numbers(out)); });
  state_->checks(names::kGroup, first).points(out);
}

void ResultReader::read_first_pose(std::uint64_t first, std::span<std::uint32_t> out) const {
  check_range(first, out.size(), collisions());
  if (!state_->first_pose) throw std::logic_error("ResultReader: no first poses");
  as_input(state_->name, [&] { state_->first_pose->read(first, out); });
  state_->checks(names::kGroup, first).poses(names::kFirstPose, out);
}

void ResultReader::read_last_pose(std::uint64_t first, std::span<std::uint32_t> out) const {
  check_range(first, out.size(), collisions());
  if (!state_->last_pose) throw std::logic_error("ResultReader: no last poses");
  as_input(state_->name, [&] { state_->last_pose->read(first, out); });
  state_->checks(names::kGroup, first).poses(names::kLastPose, out);
}

std::uint64_t ResultReader::last_pose_hash() const { return state_->last_pose_hash; }

void ResultReader::read_first_body(std::uint64_t first, std::span<std::uint32_t> out) const {
  check_range(first, out.size(), collisions());
  if (!state_->body) throw std::logic_error("ResultReader: no bodies");
  as_input(state_->name, [&] { state_->body->read(first, out); });
  state_->checks(names::kGroup, first).bodies(out);
}

void ResultReader::read_clearance_body(std::uint64_t first, std::span<std::uint32_t> out) const {
  const auto& datasets = state_->clearance;
  if (!datasets || !datasets->body) throw std::logic_error("ResultReader: no bodies");
  check_range(first, out.size(), clearances());
  as_input(state_->name, [&] { datasets->body->read(first, out); });
  state_->checks(names::kClearanceGroup, first).bodies(out);
}

std::uint64_t ResultReader::clearances() const {
  return state_->clearance ? state_->clearance->source.rows() : 0;
}

void ResultReader::read_clearances(std::uint64_t first, std::span<std::uint64_t> source,
                                   std::span<Vec3> xyz, std::span<double> distance,
                                   std::span<std::uint32_t> pose) const {
  auto& datasets = state_->clearance;
  if (!datasets) throw std::logic_error("ResultReader: no clearances");
  check_lengths(source.size(), distance, pose);
  check_lengths(datasets->xyz ? source.size() : 0, xyz);
  check_range(first, source.size(), clearances());
  as_input(state_->name, [&] {
    datasets->source.read(first, source);
    if (datasets->xyz) datasets->xyz->read(first, as_numbers(xyz));
    datasets->distance.read(first, distance);
    datasets->pose.read(first, pose);
  });
  const RowChecks checks = state_->checks(names::kClearanceGroup, first);
  checks.sources(source);
  checks.points(xyz);
  checks.clearances(distance);
  checks.poses(names::kPose, pose);
}

void ResultReader::read_clearances(std::uint64_t first, std::span<std::uint64_t> source,
                                   std::span<Vec3> xyz, std::span<double> distance,
                                   std::span<std::uint32_t> pose,
                                   std::span<Xxh64Stream> hashes) const {
  const State& s = *state_;
  const auto& datasets = s.clearance;
  if (!datasets) throw std::logic_error("ResultReader: no clearances");
  check_lengths(source.size(), distance, pose);
  check_lengths(datasets->xyz ? source.size() : 0, xyz);
  check_range(first, source.size(), clearances());
  ParallelRead read;
  const RowChecks checks = s.checks(names::kClearanceGroup, first);
  const std::size_t next = datasets->xyz ? 1 : 0;
  const bool there =
      are_whole_chunks(first, source.size(), clearances()) && as_input(s.name, [&] {
        return read.add(datasets->source, first, source, hashes[0],
                        checks.from_any_row(&RowChecks::sources)) &&
               (!datasets->xyz || read.add(*datasets->xyz, first, xyz, hashes[next],
                                           checks.from_any_row(&RowChecks::points))) &&
               read.add(datasets->distance, first, distance, hashes[next + 1],
                        checks.from_any_row(&RowChecks::clearances)) &&
               read.add(datasets->pose, first, pose, hashes[next + 2],
                        checks.for_poses(names::kPose));
      });
  if (there && read.run() && ascends_at_chunks(source, datasets->source.chunk_rows())) return;
  read_clearances(first, source, xyz, distance, pose);
  if (datasets->xyz) {
    add_to(hashes, source, xyz, distance, pose);
  } else {
    add_to(hashes, source, distance, pose);
  }
}

std::uint64_t ResultReader::profile_rows() const {
  return state_->profile ? state_->profile->distance.rows() : 0;
}

void ResultReader::read_profile(std::uint64_t first, std::span<double> distance,
                                std::span<std::uint64_t> source, std::span<Vec3> xyz,
                                std::span<double> chainage) const {
  auto& datasets = state_->profile;
  if (!datasets) throw std::logic_error("ResultReader: no profile");
  check_lengths(distance.size(), source, xyz, chainage);
  check_range(first, distance.size(), profile_rows());
  as_input(state_->name, [&] {
    datasets->distance.read(first, distance);
    datasets->source.read(first, source);
    datasets->xyz.read(first, as_numbers(xyz));
    datasets->chainage.read(first, chainage);
  });
  const RowChecks checks = state_->checks(names::kProfileGroup, first);
  checks.profile(distance, source, xyz);
  checks.chainages(chainage);
}

void ResultReader::read_profile_squared(std::uint64_t first, std::span<double> out) const {
  const auto& datasets = state_->profile;
  if (!datasets || !datasets->squared) throw std::logic_error("ResultReader: no squares");
  check_range(first, out.size(), profile_rows());
  as_input(state_->name, [&] { datasets->squared->read(first, out); });
}

}  // namespace clearway
