#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/trajectory/corridor.hpp"
#include "core/util/progress.hpp"
#include "io/scans/point_reader.hpp"
#include "io/store/convert/convert.hpp"
#include "io/store/convert/input_agreement.hpp"
#include "io/store/convert/input_files.hpp"
#include "io/store/convert/quanta_batch.hpp"

namespace clearway {

/// What has to be read of all inputs before their points can be read in order.
struct FoundInputs {
  ReadableInputs readable;
  /// The scale and offset that were chosen; nullopt where the inputs have integers.
  std::optional<Quantisation> chosen;

  template <typename Values>
  void keep(Values& values) {
    values.add(readable, chosen);
  }
};

/// All inputs of a conversion as one sequence of points in one quantisation
/// (docs/design/conversion.md). Where inputs have integers, these are kept as read; files of the
/// same scale are shifted by whole quanta. Other coordinates are rounded to the nearest quantum:
/// that of files with integers if there are any, otherwise that of a chosen scale.
class EnvironmentSource {
 public:
  /// Reads the headers; it also reads all points once where files may be skipped, and once where a
  /// scale must be chosen. options: must outlive this object. found: what an earlier process found
  /// in these inputs, so that nothing but headers is read; or null. Throws InputError, UsageError
  /// and Interrupted.
  EnvironmentSource(const ConversionOptions& options, Progress& progress,
                    const FoundInputs* found = nullptr);
  ~EnvironmentSource();

  /// Leaves out the points that the corridor does not hold from the next rewind() on, and does not
  /// read pieces of which the file promises that they are all beyond. trust_bounds: the same for
  /// whole files by their declared boxes. corridor: must outlive this object.
  void keep_near(const Corridor& corridor, bool trust_bounds);
  /// For each of files(), whether keep_near() passes it over.
  const std::vector<bool>& passed_over() const { return passed_over_; }

  const Quantisation& quantisation() const { return quantisation_; }
  const std::string& crs_wkt() const { return crs_.wkt; }
  LengthUnit unit() const { return crs_.unit; }
  const CommonCrs& crs() const { return crs_; }
  /// The declarations of each of files(), with converted heights.
  std::span<const CloudInfo> infos() const { return infos_; }
  const std::vector<std::filesystem::path>& files() const {
    return inputs_.files();
  }  ///< "-" for a stream
  /// The files, and those with their poses.
  const std::vector<std::filesystem::path>& read_files() const { return inputs_.read_files(); }
  /// Number of points that the inputs declare, where all of them do.
  std::optional<std::uint64_t> declared_points() const { return declared_points_; }
  /// Notes and warnings on the inputs; complete once read() has returned false.
  std::vector<Message> remarks() const;

  /// For each file, whether its points are read in pieces.
  const std::vector<bool>& in_pieces() const { return in_pieces_; }

  /// Reads the next batch in input order; returns false at the end. It consists of three steps:
  /// next(), convert(), note().
  bool read(QuantaBatch& batch);
  /// Takes the next records in input order; returns false at the end.
  bool next(RecordBatch& records);
  /// Converts records to the store's integers, after reading them where they are a piece. Several
  /// threads may call it at once. with_bytes: whether the bytes of a piece are wanted too.
  void convert(RecordBatch& records, QuantaBatch& batch, bool with_bytes) const;
  /// Counts what was read. Called for all batches in input order.
  void note(const QuantaBatch& batch) { counts_.add(batch.counts); }
  void rewind();

  FoundInputs found() const;
  /// Keeps what is known once all batches were noted, or takes it after a rewind().
  template <typename Values>
  void keep(Values& values) {
    for (CloudInfo& info : infos_) values.add(info.remarks, info.origins, info.origins_rest_on);
    values.add(points_of_files_, counts_);
  }
  /// Reads no GPS times from the next rewind() on.
  void leave_out_times() { how_to_read_.with_times = false; }

  /// The place of a record in the inputs; known once read() has returned false.
  struct Place {
    std::size_t file;
    std::uint64_t point;  ///< number of the point in its file, from 0
  };
  Place place_of(std::uint64_t source) const;
  /// The place in the store of zeros in a file: its integers 0, or the position (0, 0, 0). Nullopt
  /// where the store cannot hold it.
  std::optional<std::array<std::int32_t, 3>> origin_of(std::size_t file) const;

  /// Throws InputError, which names the file, where a file has changed since before the reading
  /// began.
  void refuse_changed() const { inputs_.refuse_changed(); }

  /// What has been read since the last rewind().
  const ReadCounts& counts() const { return counts_; }
  /// Number of source indices that each of files() takes; complete once read() has returned false.
  const std::vector<std::uint64_t>& points_of_files() const { return points_of_files_; }

 private:
  void open_inputs();
  void find_crs();
  /// Bring heights as they were read to the unit of the plane.
  void convert_heights(CloudInfo& info) const;
  void convert_heights(Box& box) const;
  void convert_heights(PointBatch& batch) const;
  std::optional<Box> bounds_of(const PointReader& reader, std::size_t piece) const;
  void take_late_crs();
  void choose_offset_and_scale(Progress& progress);
  const std::shared_ptr<PointReader>& reader(std::size_t file);
  void read_piece(RecordBatch& records, PieceBytes* bytes) const;
  bool leaves_out(const PointBatch& batch, std::size_t point) const {
    return !options_.keep_withheld && batch.is_withheld(point);
  }
  void note_withheld(const RecordBatch& records, QuantaBatch& out) const;
  void append_kept(RecordBatch& records, QuantaBatch& out) const;
  void append_rounded(const RecordBatch& records, QuantaBatch& out) const;
  static void keep_classes(RecordBatch& records, QuantaBatch& out);
  void count_cut_off(QuantaBatch& out) const;
  bool is_far(const std::optional<Box>& bounds) const {
    return corridor_ != nullptr && bounds && !corridor_->may_hold(*bounds);
  }
  bool pass_over(RecordBatch& records);
  void append_unread(const RecordBatch& records, QuantaBatch& out) const;
  void check_bounds(const RecordBatch& records, const QuantaBatch& batch) const;
  void count_beyond(QuantaBatch& out) const;
  void drop_far(QuantaBatch& out) const;
  [[noreturn]] void refuse_beyond_quanta(std::size_t file) const;

  const ConversionOptions& options_;
  PointReadOptions how_to_read_;
  InputFiles inputs_;
  std::vector<CloudInfo> infos_;  // declarations of the files
  std::vector<bool> in_pieces_;
  Quantisation quantisation_{};
  // Shifts of the files' integers in quanta; empty where all are rounded anew.
  std::vector<std::array<std::int64_t, 3>> shifts_;
  CommonCrs crs_;
  const Corridor* corridor_ = nullptr;  ///< null where points are kept wherever they are
  std::vector<bool> passed_over_;
  // Edge of a cube of 1 m in the unit of the coordinates. It is that of the last rewind(), because
  // next() may change crs_ while other threads are in convert().
  double withheld_edge_ = 1;
  std::optional<std::uint64_t> declared_points_;

  std::shared_ptr<PointReader> stream_;   // standard input, spooled
  std::shared_ptr<PointReader> current_;  // the open file
  std::size_t open_file_ = 0;
  std::size_t file_ = 0;
  std::size_t piece_ = 0;  // next piece of the open file
  std::uint64_t file_points_ = 0;
  std::uint64_t next_source_ = 0;
  std::vector<std::uint64_t> points_of_files_;  // points of the files that were read to their end
  ReadCounts counts_;
  bool chose_scale_ = false;
};

}  // namespace clearway
