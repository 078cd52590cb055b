#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "clearway/error.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/hdf5/stored_chunk.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/result.hpp"
#include "io/result/result_names.hpp"
#include "io/result/result_reader_state.hpp"
#include "io/result/row_checks.hpp"
#include "io/system/xxh64.hpp"

namespace clearway {
namespace {

/// Reads rows of several columns together. The thread that calls HDF5 reads their chunks, and many
/// threads then check, decode and hash these. run() tells only whether all is well; to find out
/// what is wrong, the caller reads the rows again one after the other, so that messages are always
/// the same.
class ParallelRead {
 public:
  /// Reads the chunks of rows from `first`, which begins a chunk, as many as `out` has. check(first
  /// row, values) throws InputError for rows that are wrong and is thread safe. Returns false where
  /// the chunks cannot be read.
  template <typename Number, typename Value, typename Check>
  bool add(const hdf5::Rows<Number>& dataset, std::uint64_t first, std::span<Value> out,
           Xxh64Stream& hash, Check check) {
    Chunks& chunks = chunks_.emplace_back();
    if (!dataset.read_chunks(first, out.size(), chunks)) return false;
    const std::uint64_t rows = dataset.chunk_rows();
    columns_.emplace_back([&chunks, out, &hash] {
      std::size_t left = out.size_bytes();
      for (const std::vector<std::byte>& chunk : chunks) {
        const std::size_t used = std::min(left, chunk.size() - hdf5::kChecksumBytes);
        hash.update(std::span(chunk).first(used));
        left -= used;
      }
    });
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      const std::size_t from = i * rows;
      const std::span<Value> part = out.subspan(from, std::min(rows, out.size() - from));
      pieces_.emplace_back([&chunk = chunks[i], part, check, row = first + from] {
        if (!hdf5::is_sealed(chunk)) return false;
        std::memcpy(part.data(), chunk.data(), part.size_bytes());
        return passes(check, row, std::span<const Value>(part));
      });
    }
    return true;
  }

  /// Whether all rows are intact and pass their checks. If so, the rows and the hashes are
  /// complete.
  bool run() const;

 private:
  using Chunks = std::vector<std::vector<std::byte>>;

  template <typename Check, typename Value>
  static bool passes(const Check& check, std::uint64_t row, std::span<const Value> values) {
    try {
      check(row, values);
    } catch (const InputError&) {
      return false;
    }
    return true;
  }

  std::deque<Chunks> chunks_;  // a deque, because the tasks keep references to its elements
  std::vector<std::function<bool()>> pieces_;
  // Tasks that hash one column each, run once all pieces are intact.
  std::vector<std::function<void()>> columns_;
};

template <typename Visit>
void for_each_index(std::size_t count, Visit visit) {
  const ParallelScope scope;
  const auto piece = piece_of(scope, visit);
  scope.begin();
  tbb::parallel_for(std::size_t{0}, count, piece);
}

bool ParallelRead::run() const {
  std::atomic<bool> well = true;
  for_each_index(pieces_.size(), [&](std::size_t i) {
    if (!pieces_[i]()) well = false;
  });
  if (!well) return false;
  for_each_index(columns_.size(), [&](std::size_t i) { columns_[i](); });
  return true;
}

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
