#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/files/file.hpp"
#include "io/scans/stated_crs.hpp"

namespace clearway {

/// The place of the scanner that saw the records of a file from number `first` on; nullopt where
/// the file does not give it for them.
struct OriginRun {
  std::uint64_t first = 0;
  std::optional<Vec3> origin;
};

/// What the GPS times of a file count, as its header says.
enum class GpsTimes {
  kNone,         ///< the file has no GPS times
  kWeekSeconds,  ///< seconds since the beginning of the GPS week
  kAdjusted,     ///< adjusted standard GPS time: seconds since 1980-01-06, less 10^9
};

/// What a point cloud file declares before its points.
struct CloudInfo : StatedCrs {
  std::optional<Quantisation> quantisation;      ///< where points are stored as integers
  std::optional<std::uint64_t> declared_points;  ///< where the format declares a count
  /// Box of all points, where the format declares one and the writer filled it in. It is compared
  /// with the points, and trusted only for ConvertOptions::trust_bounds.
  std::optional<Box> declared_box;
  std::uint64_t faces = 0;  ///< number of faces in a mesh; they are not read
  /// See Query::model_spacing; known where `clearway model` wrote the file.
  double model_spacing = 0;
  bool text_table = false;  ///< whether the file is a text table, whose columns can be chosen
  /// Where the scanners stood, the first run from record 0 on, in ascending order; complete once
  /// read() has returned false. Empty where the file gives it for no record.
  std::vector<OriginRun> origins;
  /// What `origins` rest on, such as "poses of E57".
  std::string origins_rest_on;
  GpsTimes gps_times = GpsTimes::kNone;
  /// The day on which the file was made, such as "2024-05-31"; empty where it does not say.
  std::string date = {};
  /// Remarks on the whole file; complete once read() has returned false.
  std::vector<Message> remarks;

  void set(StatedCrs stated) { static_cast<StatedCrs&>(*this) = std::move(stated); }
};

/// Bits of PointBatch::flags. Source: LAS 1.4 R15 (ASPRS), "Classification Flags".
struct PointFlags {
  static constexpr std::uint8_t kSynthetic = 1;  ///< made by something other than a scan
  static constexpr std::uint8_t kKeyPoint = 2;
  static constexpr std::uint8_t kWithheld = 4;  ///< deleted, though its record is still there
  static constexpr std::uint8_t kOverlap = 8;   ///< in the overlap of two swaths
};

/// Consecutive points of a file, in its order: integers where the file has a quantisation,
/// otherwise positions. The other of the two vectors is empty.
struct PointBatch {
  std::vector<std::array<std::int32_t, 3>> quanta;
  std::vector<Vec3> positions;
  /// Indices into `positions`, ascending, of records without a point (a beam without a return).
  /// Their positions are NaN. They keep their number in the file and are not errors.
  std::vector<std::uint32_t> absent;
  /// The class of each point, as ASPRS numbers them. Empty where the format has no classes.
  std::vector<std::uint8_t> classes;
  /// The flags of each point, bits of PointFlags. Empty where the file has no flags.
  std::vector<std::uint8_t> flags = {};
  /// The GPS time of each point. Empty unless PointReadOptions::with_times asks for them and the
  /// file has them.
  std::vector<double> times = {};
  /// The pose that the reader has applied to all of the positions, where it turned them.
  std::optional<Pose> turn = {};

  std::size_t size() const { return quanta.size() + positions.size(); }
  /// Removes all points and keeps the memory.
  void clear() {
    quanta.clear();
    positions.clear();
    absent.clear();
    classes.clear();
    flags.clear();
    times.clear();
    turn.reset();
  }
  bool is_withheld(std::size_t point) const {
    return !flags.empty() && (flags[point] & PointFlags::kWithheld) != 0;
  }
};

/// The pose, where it turns points and does not shift them alone.
inline std::optional<Pose> turn_of(const Pose& pose) {
  for (std::size_t i = 0; i < 9; ++i) {
    if (pose.rotation[i] != (i % 4 == 0 ? 1 : 0)) return pose;
  }
  return std::nullopt;
}

/// The bytes of a file from which a piece of its points was read, or would have been.
struct PieceBytes {
  std::uint64_t first = 0;  ///< position in the file
  std::size_t count = 0;
  std::unique_ptr<std::byte[]> bytes;  ///< null where they were not read

  std::span<std::byte> span() const { return {bytes.get(), count}; }
};

/// Reads the points of one file, front to back, in constant memory. Non-finite positions are
/// delivered as they are, and the caller counts them. Malformed input throws InputError with file,
/// line or byte, and what was expected; nothing is skipped silently.
class PointReader {
 public:
  static constexpr std::size_t kBatchPoints = 1 << 16;

  virtual ~PointReader() = default;
  virtual const CloudInfo& info() const = 0;
  /// Fills `batch` with up to kBatchPoints points. At the end it returns false and an empty batch.
  virtual bool read(PointBatch& batch) = 0;
  /// Number of pieces of the file's points, which read_piece() reads in any order; 0 where only
  /// read() works. All pieces in their order are all points, and their bytes are contiguous.
  virtual std::size_t pieces() const { return 0; }
  virtual std::uint64_t points_of_piece(std::size_t /*piece*/) const { return 0; }
  /// Reads one piece. Several threads may call it at once, while nobody calls read(). bytes:
  /// receives the bytes of the piece, or is null. Throws as read() does.
  virtual void read_piece(std::size_t /*piece*/, PointBatch& /*batch*/, PieceBytes* /*bytes*/) {}
  /// A box that the file promises to hold the points of a piece, as the hierarchy of COPC does;
  /// nullopt where it promises none.
  virtual std::optional<Box> bounds_of_piece(std::size_t /*piece*/) const { return std::nullopt; }
  /// Where the bytes of a piece are, without the bytes.
  virtual PieceBytes place_of_piece(std::size_t /*piece*/) const { return {}; }
  virtual bool can_rewind() const { return true; }
  /// Goes back to the first point. Throws ResourceError where the input cannot seek.
  virtual void rewind() = 0;
  /// The line number of each of `points`, which are ascending numbers counted from 0; empty where
  /// the format has no lines. Reads the file from its first point and leaves the reader at any
  /// position.
  virtual std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> /*points*/) {
    return {};
  }
};

/// How to read a text file that does not name its columns, or names them wrongly.
struct PointReadOptions {
  /// The columns of x, y and z: numbers counted from 1, or names in the header. If empty, the text
  /// decides, and one that looks like something other than points is refused. Ignored for other
  /// formats.
  std::vector<std::string> columns = {};
  bool may_choose = false;  ///< whether messages advise the user to choose the columns
  bool with_times = false;  ///< whether GPS times are read too, where a file has them
};

/// Opens a file. Its content decides the format, or the ending of its name where the content does
/// not say: LAS 1.0-1.4, LAZ, E57, PLY, PCD, PTX, PTS, XYZ text and scans of 3DTK. A path that is
/// not a regular file is read as by open_las_stream(), with the system's folder for temporary
/// files. Unknown formats throw InputError with advice.
std::unique_ptr<PointReader> open_point_file(const std::filesystem::path& path,
                                             const PointReadOptions& options = {});

/// Reads LAS or LAZ from a stream that cannot seek, for example standard input. In LAS 1.4, a CRS
/// that only a record after the points holds appears in info() once read() has returned false.
/// Points beyond the header's count are read too, with a warning among the remarks. LAZ is first
/// copied into a nameless file in `temporary_folder`, and can be read again.
std::unique_ptr<PointReader> open_las_stream(File stream,
                                             const std::filesystem::path& temporary_folder,
                                             const PointReadOptions& options = {});

/// The point files of a list of inputs in the order in which their points are numbered: inputs as
/// given, and the files of a folder in byte order of their names. Folders are not searched
/// recursively; their hidden files are left out, and so are files whose ending does not belong to a
/// point format alone, such as .md, .txt and .csv. remarks: receives what was left out of folders,
/// or is null. Throws ResourceError for a missing input and InputError for a folder without any
/// point file.
std::vector<std::filesystem::path> list_point_files(
    const std::vector<std::filesystem::path>& inputs, std::vector<Message>* remarks = nullptr);

/// The files, followed by the files that hold their poses (3DTK): everything that a conversion
/// reads.
std::vector<std::filesystem::path> with_pose_files(std::vector<std::filesystem::path> files);

/// The files that are read where an input names one file or a folder of poses: the file, with that
/// of its pose for a scan of 3DTK, or the files of poses in the folder, by their names.
std::vector<std::filesystem::path> files_behind(const std::filesystem::path& input);

}  // namespace clearway
