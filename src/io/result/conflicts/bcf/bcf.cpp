#include "io/result/conflicts/bcf/bcf.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "clearway/error.hpp"
#include "core/geometry/predicate.hpp"
#include "core/query/body_numbers.hpp"
#include "io/files/deflate.hpp"
#include "io/files/file.hpp"
#include "io/result/conflicts/bcf/bcf_text.hpp"
#include "io/result/conflicts/bcf/picture.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/result.hpp"

namespace clearway {

namespace {

/// Writes a ZIP archive front to back. All members are dated 1980-01-01, the format's first day, so
/// equal contents give equal bytes with the same zlib. Up to 65,534 members and 4 GiB in all.
/// Throws ResourceError, and UsageError beyond these limits. Source: PKWARE, APPNOTE.TXT 6.3.10.
class ZipWriter {
 public:
  /// The caller owns the file.
  explicit ZipWriter(const File& file) : file_(file) {}

  /// Adds a member, compressed where that makes it smaller. name: ASCII.
  void add(const std::string& name, std::string_view bytes);
  /// Writes the directory. Called after the last member.
  void finish();

 private:
  void write(std::string_view bytes);

  const File& file_;
  std::uint64_t written_ = 0;
  std::uint32_t members_ = 0;
  std::string directory_;
};

constexpr std::uint32_t kMostMembers = 65'534;
constexpr std::uint64_t kMostBytes = 0xffff'fffe;
constexpr std::uint16_t kVersion = 20, kStored = 0, kDeflated = 8;
constexpr std::uint16_t kMidnight = 0, kFirstDay = (0 << 9) | (1 << 5) | 1;  // 1980-01-01

void put16(std::string& out, std::uint64_t value) {
  out += {static_cast<char>(value & 0xff), static_cast<char>(value >> 8 & 0xff)};
}

void put32(std::string& out, std::uint64_t value) {
  put16(out, value & 0xffff);
  put16(out, value >> 16 & 0xffff);
}

/// The fields that a member's own header and its entry in the directory share.
std::string description_of(std::string_view bytes, std::size_t packed, std::uint16_t method,
                           std::size_t name) {
  std::string out;
  put16(out, kVersion);
  put16(out, 0);  // flags
  put16(out, method);
  put16(out, kMidnight);
  put16(out, kFirstDay);
  put32(out, crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  put32(out, packed);
  put32(out, bytes.size());
  put16(out, name);
  put16(out, 0);  // extra field
  return out;
}

void ZipWriter::add(const std::string& name, std::string_view bytes) {
  std::string packed = deflated(bytes, DeflateForm::kRaw);
  const bool smaller = packed.size() < bytes.size();
  const std::string_view body = smaller ? packed : bytes;
  if (members_ == kMostMembers || written_ + directory_.size() + body.size() + 1024 > kMostBytes) {
    throw UsageError(file_.name() +
                     ": more than a ZIP archive holds; expected fewer conflicts, for example by "
                     "more points for the smallest one");
  }
  const std::string description =
      description_of(bytes, body.size(), smaller ? kDeflated : kStored, name.size());
  const std::uint64_t at = written_;
  std::string header;
  put32(header, 0x04034b50);
  write(header + description + name);
  write(body);
  put32(directory_, 0x02014b50);
  put16(directory_, kVersion);
  directory_ += description;
  put16(directory_, 0);  // comment
  put16(directory_, 0);  // disk
  put16(directory_, 0);  // internal attributes
  put32(directory_, 0);  // external attributes
  put32(directory_, at);
  directory_ += name;
  ++members_;
}

void ZipWriter::finish() {
  const std::uint64_t at = written_;
  write(directory_);
  std::string end;
  put32(end, 0x06054b50);
  put32(end, 0);  // disks
  put16(end, members_);
  put16(end, members_);
  put32(end, directory_.size());
  put32(end, at);
  put16(end, 0);  // comment
  write(end);
}

void ZipWriter::write(std::string_view bytes) {
  file_.write(std::as_bytes(std::span(bytes)));
  written_ += bytes.size();
}

constexpr int kWidth = 800, kHeight = 600;
constexpr Colour kColliding{200, 30, 30}, kModel{90, 110, 140}, kPath{40, 90, 200},
    kBoxEdge{120, 120, 120};
// Number of small groups that are shown instead of conflicts.
constexpr std::size_t kMostSmallTopics = 10;
constexpr double kLeastDistance = 6;  // least distance from camera to conflict, metres
// Least distance from camera to conflict, in diagonals of the conflict.
constexpr double kSizesAway = 1.6;
// Number of poses before and after the nearest one through which the path is drawn as a line.
constexpr std::size_t kPathPoses = 2000;

Vec3 unit(const Vec3& v, const Vec3& otherwise) {
  const double size = length(v);
  if (!(size > 0)) return otherwise;
  return {v.x / size, v.y / size, v.z / size};
}

/// A direction of the model's frame, turned into the environment's.
Vec3 turned(const Pose& pose, Axis axis) {
  const int column = static_cast<int>(axis) / 2;
  const double sign = static_cast<int>(axis) % 2 == 0 ? 1 : -1;
  const double* r = pose.rotation;
  return {sign * r[column], sign * r[3 + column], sign * r[6 + column]};
}

std::uint32_t place_on_path(const Conflict& conflict) {
  return conflict.nearest_pose.value_or(conflict.first_pose);
}

/// The pose from which a conflict is seen: that of its body where bodies are known.
const Pose& pose_of(const ConflictFile& file, const Conflict& conflict) {
  const std::uint32_t at = place_on_path(conflict);
  const std::span<const Body> bodies = file.options.bodies;
  const Pose* own =
      conflict.body && !bodies.empty() ? pose_at(bodies[*conflict.body], at) : nullptr;
  return own != nullptr ? *own : file.poses[at];
}

/// The camera of a conflict: behind and above, as seen by someone who follows the model.
Camera camera_of(const ConflictFile& file, const Conflict& conflict) {
  const Pose& pose = pose_of(file, conflict);
  const Vec3 ahead = unit(turned(pose, file.options.forward), {1, 0, 0});
  const Vec3 above = unit(turned(pose, file.options.up), {0, 0, 1});
  Camera out;
  out.direction = unit(ahead + -0.6 * above, ahead);
  const Vec3 right = unit(cross(out.direction, above), {0, 1, 0});
  out.up = cross(right, out.direction);
  const double diagonal = length(conflict.box.size());
  const double away = std::max(kLeastDistance / file.metres_per_unit(), kSizesAway * diagonal);
  out.place = conflict.centroid + -away * out.direction;
  return out;
}

void draw_path(Picture& picture, const ConflictFile& file, const Conflict& conflict) {
  const std::size_t at = place_on_path(conflict);
  const std::size_t first = at > kPathPoses ? at - kPathPoses : 0;
  const std::size_t last = std::min(file.poses.size(), at + kPathPoses + 1);
  for (std::size_t i = first + 1; i < last; ++i) {
    const double* a = file.poses[i - 1].translation;
    const double* b = file.poses[i].translation;
    picture.draw_line({a[0], a[1], a[2]}, {b[0], b[1], b[2]}, kPath);
  }
}

void draw_box(Picture& picture, const Box& box) {
  const Vec3 corners[] = {box.lo, box.hi};
  for (int axis = 0; axis < 3; ++axis) {
    for (int sides = 0; sides < 4; ++sides) {
      Vec3 from{}, to{};
      from[axis] = box.lo[axis];
      to[axis] = box.hi[axis];
      for (int other = 0; other < 2; ++other) {
        const int k = (axis + 1 + other) % 3;
        from[k] = to[k] = corners[sides >> other & 1][k];
      }
      picture.draw_line(from, to, kBoxEdge);
    }
  }
}

/// Draws the model, or every body that has a pose while the vehicle is at this pose of the path.
void draw_models(Picture& picture, const ConflictFile& file, const Conflict& conflict,
                 const std::vector<std::vector<Vec3>>& models) {
  const auto draw = [&picture](const std::vector<Vec3>& points, const Pose& pose) {
    for (const Vec3& m : points) picture.draw_point(transform(pose, m), kModel, 1);
  };
  const std::uint32_t at = place_on_path(conflict);
  const std::span<const Body> bodies = file.options.bodies;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const Pose* pose = bodies.empty() ? &file.poses[at] : pose_at(bodies[i], at);
    if (pose != nullptr) draw(models[i], *pose);
  }
}

std::string snapshot_of(const ConflictFile& file, const Conflict& conflict, const Camera& camera,
                        const std::vector<Vec3>& points,
                        const std::vector<std::vector<Vec3>>& models) {
  Picture picture(kWidth, kHeight, camera);
  draw_models(picture, file, conflict, models);
  draw_path(picture, file, conflict);
  draw_box(picture, conflict.box);
  for (const Vec3& p : points) picture.draw_mark(p, kColliding, 3);
  return picture.png();
}

}  // namespace

ConflictPoints conflict_points(const ResultReader& result, const Conflicts& conflicts,
                               const std::vector<std::uint32_t>& conflict_of) {
  constexpr std::size_t kMost = ConflictPictures::kMostPoints;
  ConflictPoints out(conflicts.listed.size());
  std::vector<std::uint64_t> seen(out.size());
  RowStream<Collisions> stream(result);
  std::size_t row = 0;
  for (Collisions rows; stream.read(rows);) {
    for (const Vec3& p : rows.xyz) {
      const std::uint32_t id = conflict_of[row++];
      if (id == 0) continue;
      const std::uint64_t points = conflicts.listed[id - 1].points;
      const std::uint64_t every = (points + kMost - 1) / kMost;
      if (seen[id - 1]++ % every == 0) out[id - 1].push_back(p);
    }
  }
  return out;
}

void write_bcf(const ConflictFile& file, const ConflictPictures& pictures, const File& output) {
  ZipWriter zip(output);
  zip.add("bcf.version", bcf_version());
  const auto add = [&](const Conflict& conflict, const std::vector<Vec3>& points) {
    const Camera camera = camera_of(file, conflict);
    const std::string folder = conflict_uuid(file, conflict, "topic") + "/";
    zip.add(folder + "markup.bcf", bcf_markup(file, conflict));
    zip.add(folder + "viewpoint.bcfv", bcf_viewpoint(file, conflict, camera));
    zip.add(folder + "snapshot.png", snapshot_of(file, conflict, camera, points, pictures.models));
  };
  for (std::size_t i = 0; i < file.conflicts.listed.size(); ++i) {
    add(file.conflicts.listed[i], pictures.points[i]);
  }
  std::vector<Conflict> small = small_groups_instead(file.conflicts);
  if (small.size() > kMostSmallTopics) small.resize(kMostSmallTopics);
  // The points of small groups are not kept individually, so the picture marks their boxes' corners
  // and centroids.
  for (const Conflict& group : small) add(group, {group.box.lo, group.centroid, group.box.hi});
  zip.finish();
}

}  // namespace clearway
