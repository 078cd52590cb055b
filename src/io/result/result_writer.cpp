#include <optional>
#include <stdexcept>

#include "clearway/error.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/result/result.hpp"
#include "io/result/result_header.hpp"
#include "io/result/result_names.hpp"
#include "io/result/result_table.hpp"
#include "io/system/file.hpp"

namespace clearway {
namespace {

namespace names = result_names;

using CollisionTable =
    ResultTable<std::uint64_t, Vec3, std::uint32_t, std::uint32_t, std::uint32_t>;

/// Number of columns in the collisions' hash. The last poses, which older releases did not write,
/// have a hash of their own.
constexpr std::size_t kHashedColumns = 4;
using ClearanceTable = ResultTable<std::uint64_t, Vec3, double, std::uint32_t, std::uint32_t>;
using ProfileTable = ResultTable<double, std::uint64_t, Vec3, double, double>;

CollisionTable::Names collision_columns(const ResultHeader& header) {
  return {names::kSource, names::kXyz, header.first_pose ? names::kFirstPose : nullptr,
          header.has_first_bodies() ? names::kBody : nullptr,
          header.last_pose ? names::kLastPose : nullptr};
}

ClearanceTable::Names clearance_columns(const ResultHeader& header) {
  return {names::kSource, names::kXyz, names::kDistance, names::kPose,
          header.bodies.empty() ? nullptr : names::kBody};
}

ResultFindings without_doubts(ResultFindings findings) {
  findings.doubts.clear();
  return findings;
}

}  // namespace

struct ResultWriter::State {
  State(const std::filesystem::path& path, const ResultHeader& header, std::uint64_t rows,
        std::uint64_t clearance_rows)
      : name(path.string()),
        is_empty(rows == 0),
        file(hdf5::create_file(path)),
        output(File::open_for_writing(path)),
        has_last_pose(header.last_pose),
        collisions(std::in_place, file, names::kGroup, collision_columns(header), rows) {
    if (header.clearance > 0) {
      clearances.emplace(file, names::kClearanceGroup, clearance_columns(header), clearance_rows);
    }
    if (header.profile > 0) {
      profile.emplace(
          file, names::kProfileGroup,
          ProfileTable::Names{names::kDistance, names::kSource, names::kXyz, names::kChainage,
                              header.part ? names::kSquared : nullptr},
          header.poses);
    }
    write_result_header(file, header);
    output.reserve_ahead(collisions->bytes() + (clearances ? clearances->bytes() : 0) +
                         (profile ? profile->bytes() : 0));
  }

  /// Starts the transfer of what has been written to the disk, while the rest is computed.
  void written() {
    constexpr std::uint64_t kAtOnce = std::uint64_t{32} << 20;
    const std::uint64_t end = output.size_bytes();
    if (end < synced + kAtOnce) return;
    output.begin_sync(synced, end - synced);
    synced = end;
  }

  /// Checks that a table has all of its promised rows and flushes it, before those of the next
  /// table are written.
  template <typename Table>
  void complete(std::optional<Table>& table) {
    if (!table) return;
    table->check_complete();
    hdf5::naming(name, [&] { table->flush(); });
  }

  std::string name;
  bool is_empty;  ///< whether nothing collides
  hdf5::Id file;
  File output;  ///< a second handle of the same file
  bool has_last_pose;
  std::uint64_t synced = 0;  ///< bytes of the file that are on their way to the disk
  std::optional<CollisionTable> collisions;
  std::optional<ClearanceTable> clearances;
  std::optional<ProfileTable> profile;
};

ResultWriter::ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
                           std::uint64_t collisions, std::uint64_t clearances)
    : state_(hdf5::naming(path.string(), [&] {
        return std::make_unique<State>(path, header, collisions, clearances);
      })) {}

ResultWriter::~ResultWriter() {
  const hdf5::QuietScope quiet;
  state_.reset();
}

void ResultWriter::append(std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
                          std::span<const std::uint32_t> first_pose,
                          std::span<const std::uint32_t> body,
                          std::span<const std::uint32_t> last_pose) {
  State& s = *state_;
  hdf5::naming(s.name, [&] { s.collisions->append(source, xyz, first_pose, body, last_pose); });
}

void ResultWriter::append_clearances(std::span<const std::uint64_t> source,
                                     std::span<const Vec3> xyz, std::span<const double> distance,
                                     std::span<const std::uint32_t> pose,
                                     std::span<const std::uint32_t> body) {
  State& s = *state_;
  if (!s.clearances) throw std::logic_error("ResultWriter: no clearances");
  s.complete(s.collisions);
  hdf5::naming(s.name, [&] { s.clearances->append(source, xyz, distance, pose, body); });
}

void ResultWriter::append_profile(std::span<const double> distance,
                                  std::span<const std::uint64_t> source, std::span<const Vec3> xyz,
                                  std::span<const double> chainage,
                                  std::span<const double> squared) {
  State& s = *state_;
  if (!s.profile) throw std::logic_error("ResultWriter: no profile");
  s.complete(s.collisions);
  s.complete(s.clearances);
  hdf5::naming(s.name, [&] { s.profile->append(distance, source, xyz, chainage, squared); });
}

EncodedCollisions ResultWriter::new_collisions() const { return state_->collisions->new_rows(); }

EncodedClearances ResultWriter::new_clearances() const {
  if (!state_->clearances) throw std::logic_error("ResultWriter: no clearances");
  return state_->clearances->new_rows();
}

void ResultWriter::hash(const EncodedCollisions& rows) { state_->collisions->hash(rows); }
void ResultWriter::hash(const EncodedClearances& rows) { state_->clearances->hash(rows); }

void ResultWriter::write(EncodedCollisions& rows) {
  hdf5::naming(state_->name, [&] { state_->collisions->write(rows); });
  state_->written();
}

void ResultWriter::write(EncodedClearances& rows) {
  State& s = *state_;
  s.complete(s.collisions);
  hdf5::naming(s.name, [&] { s.clearances->write(rows); });
  s.written();
}

void ResultWriter::finish(const ResultFindings& findings) {
  State& s = *state_;
  s.complete(s.collisions);
  s.complete(s.clearances);
  s.complete(s.profile);
  hdf5::naming(s.name, [&] {
    hdf5::write_number(s.file, names::kCollisionsHash, s.collisions->hash(kHashedColumns));
    if (s.has_last_pose) {
      hdf5::write_number(s.file, names::kLastPoseHash, s.collisions->hash_of_last());
    }
    if (s.clearances) hdf5::write_number(s.file, names::kClearanceHash, s.clearances->hash());
    if (s.profile) hdf5::write_number(s.file, names::kProfileHash, s.profile->hash());
    write_result_findings(s.file, s.is_empty ? findings : without_doubts(findings));
    hdf5::write_number(s.file, "complete", std::uint8_t{1});
    s.collisions->write_held();
    if (s.clearances) s.clearances->write_held();
    if (s.profile) s.profile->write_held();
    hdf5::check(H5Fflush(s.file.get(), H5F_SCOPE_LOCAL), "write the result");
    // After the flush, closing has nothing left to write and cannot fail for a full disk.
    s.profile.reset();
    s.clearances.reset();
    s.collisions.reset();
    s.file.close("close the result");
  });
}

}  // namespace clearway
