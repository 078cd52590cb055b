#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/formats/length_unit.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// What a point cloud file says of itself before its points.
struct CloudInfo {
  std::optional<Quantisation> quantisation;      ///< where points are stored as integers
  std::optional<std::uint64_t> declared_points;  ///< where the format declares a count
  /// Of the points, where the format declares one for all of them. It is compared with them, and
  /// never trusted.
  std::optional<Box> declared_box;
  std::string crs_wkt;                     ///< as found; empty where there is none
  std::uint16_t crs_epsg = 0;              ///< of files that name it by a code alone; 0: none
  LengthUnit unit = LengthUnit::kUnknown;  ///< of the horizontal coordinates
  bool any_foot = false;         ///< the unit is a "ft", which does not say which foot it is
  std::string unit_trouble;      ///< why they cannot be taken as they are; empty where they can
  std::string unit_doubt;        ///< what contradicts the unit; empty where nothing does
  std::uint64_t faces = 0;       ///< of a mesh, which are not read
  double model_spacing = 0;      ///< as Query::model_spacing, where clearway model wrote the file
  bool text_table = false;       ///< whose columns can be chosen
  std::vector<Message> remarks;  ///< on the whole file; complete once read() has returned false
};

/// Consecutive points of a file, in its order: integers where the file has a quantisation,
/// otherwise positions; the other vector is empty.
struct PointBatch {
  std::vector<std::array<std::int32_t, 3>> quanta;
  std::vector<Vec3> positions;
  /// Indices into positions, ascending, of records without a point (a beam without a return). Their
  /// positions are NaN. They keep their number in the file, and are no error.
  std::vector<std::uint32_t> absent;
  /// A class a point, as ASPRS numbers them. Empty where the format has none.
  std::vector<std::uint8_t> classes;

  std::size_t size() const { return quanta.size() + positions.size(); }
};

/// The bytes of a file that a piece of its points was read from.
struct PieceBytes {
  std::uint64_t first = 0;  ///< position in the file
  std::size_t count = 0;
  std::unique_ptr<std::byte[]> bytes;

  std::span<std::byte> span() const { return {bytes.get(), count}; }
};

/// Reads the points of one file, front to back, in constant memory. Non-finite positions are
/// delivered as they are; the caller counts them. Malformed input throws InputError with file, line
/// or byte, and what was expected; nothing is skipped silently.
class PointReader {
 public:
  static constexpr std::size_t kBatchPoints = 1 << 16;

  virtual ~PointReader() = default;
  virtual const CloudInfo& info() const = 0;
  /// Fills `batch` with up to kBatchPoints points; false, and an empty batch, at the end.
  virtual bool read(PointBatch& batch) = 0;
  /// Pieces of the file's points, which read_piece() reads in any order; 0 where only read() can.
  /// In their order they are all points, and their bytes follow each other.
  virtual std::size_t pieces() const { return 0; }
  virtual std::uint64_t points_of_piece(std::size_t /*piece*/) const { return 0; }
  /// Several threads at once, while nobody calls read(). bytes: receives those of the piece, or
  /// null. Throws as read() does.
  virtual void read_piece(std::size_t /*piece*/, PointBatch& /*batch*/, PieceBytes* /*bytes*/) {}
  virtual bool can_rewind() const { return true; }
  /// Back to the first point. Throws ResourceError where the input cannot seek.
  virtual void rewind() = 0;
  /// The line of each of `points`, which are ascending numbers from 0; empty where the format has
  /// no lines. Reads the file from its first point on, and leaves the reader anywhere.
  virtual std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> /*points*/) {
    return {};
  }
};

/// How a text is read whose columns its own lines do not tell, or tell wrongly.
struct PointReadOptions {
  /// Of x, y and z: numbers counted from 1, or names of the header. Empty: as the text says, and
  /// what looks like something else than points is refused. Other formats are not concerned.
  std::vector<std::string> columns = {};
  bool may_choose = false;  ///< refusals advise to choose the columns
};

/// Opens a file by its content, where the content tells, and by the ending of its name otherwise:
/// LAS 1.0-1.4, LAZ, E57, PLY, PCD, PTX, PTS, XYZ text and scans of 3DTK. What is no regular file
/// is read as by open_las_stream, with the system's folder for temporary files. Unknown formats
/// throw InputError with advice.
std::unique_ptr<PointReader> open_point_file(const std::filesystem::path& path,
                                             const PointReadOptions& options = {});

/// Reads LAS or LAZ from a stream that cannot seek, for example standard input. Of LAS, a CRS that
/// only a record behind the points holds (1.4) is in info() once read() has returned false; points
/// beyond the header's count are read too, and a warning is among the remarks. LAZ goes into a file
/// without a name in `temporary_folder` first, and can be read again.
std::unique_ptr<PointReader> open_las_stream(File stream,
                                             const std::filesystem::path& temporary_folder);

/// The point files of a list of inputs in the order that counts: the inputs as given, a folder's
/// files in byte order of their names (not recursive; hidden files, and files whose ending is not
/// that of a point format alone, such as .md, .txt and .csv, are left out). remarks: receives what
/// was left out of folders, or null. Throws ResourceError for a missing input, InputError for a
/// folder without any point file.
std::vector<std::filesystem::path> list_point_files(
    const std::vector<std::filesystem::path>& inputs, std::vector<Message>* remarks = nullptr);

/// The files, and behind them those that hold their poses (3DTK): all that a conversion reads.
std::vector<std::filesystem::path> with_pose_files(std::vector<std::filesystem::path> files);

}  // namespace clearway
