#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "io/convert/inputs/input_agreement.hpp"
#include "io/convert/inputs/input_files.hpp"
#include "io/convert/quanta_batch.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

struct EnvironmentOptions {
  std::optional<double> scale{};       ///< metres; wanted on all axes
  FileUnit unit{};                     ///< of inputs that name none
  bool ignore_crs = false;             ///< accept degrees and inputs of different units
  bool skip_unreadable = false;        ///< leave out files that cannot be read to their end
  std::vector<std::string> columns{};  ///< of texts, see PointReadOptions
  std::filesystem::path temporary_folder = ".";
};

/// All inputs of a conversion as one sequence of points in one quantisation
/// (docs/design/conversion.md): integers are kept as read where the inputs have them; files of the
/// same scale are rebased by whole quanta; everything else is rounded to the nearest quantum, of
/// those files where there are any, otherwise of a chosen scale.
class EnvironmentSource {
 public:
  /// inputs: files and folders, or "-" alone for LAS on standard input. Reads headers, all points
  /// once where files may be skipped, and once where a scale has to be chosen. Throws InputError,
  /// UsageError and Interrupted.
  EnvironmentSource(const std::vector<std::filesystem::path>& inputs,
                    const EnvironmentOptions& options, Progress& progress);
  ~EnvironmentSource();

  const Quantisation& quantisation() const { return quantisation_; }
  const std::string& crs_wkt() const { return crs_.wkt; }
  LengthUnit unit() const { return crs_.unit; }
  /// What each of files() says of itself.
  std::span<const CloudInfo> infos() const { return infos_; }
  const std::vector<std::filesystem::path>& files() const {
    return inputs_.files();
  }  ///< "-": stream
  /// The files, and those that hold their poses.
  const std::vector<std::filesystem::path>& read_files() const { return inputs_.read_files(); }
  /// Points that the inputs declare, where all do.
  std::optional<std::uint64_t> declared_points() const { return declared_points_; }
  /// Notes and warnings on the inputs; complete once read() has returned false.
  std::vector<Message> remarks() const;

  /// Whether the points of a file are read in pieces.
  const std::vector<bool>& in_pieces() const { return in_pieces_; }

  /// The next batch in input order; false at the end. Three steps: next(), convert(), note().
  bool read(QuantaBatch& batch);
  /// The next records in input order; false at the end.
  bool next(RecordBatch& records);
  /// Reads them where they are a piece, and makes them the store's integers. Several threads at
  /// once. with_bytes: what a piece was read from is wanted too.
  void convert(RecordBatch& records, QuantaBatch& batch, bool with_bytes) const;
  /// In input order: counts what was read.
  void note(const QuantaBatch& batch);
  void rewind();

  /// A record of an input; known once read() has returned false.
  struct Place {
    std::size_t file;
    std::uint64_t point;  ///< from 0, in the file
  };
  Place place_of(std::uint64_t source) const;
  /// What zeros in a file are in the store: its integers 0, or the position (0, 0, 0). None where
  /// the store cannot hold that.
  std::optional<std::array<std::int32_t, 3>> origin_of(std::size_t file) const;

  /// Throws InputError, naming it, where a file is not as it was before the first of it was read.
  void refuse_changed() const { inputs_.refuse_changed(); }

  // Of what has been read since the last rewind:
  std::uint64_t input_points() const { return input_points_; }
  std::uint64_t non_finite_points() const { return non_finite_points_; }
  /// The source index of the first of them.
  std::uint64_t first_non_finite() const { return first_non_finite_; }
  /// Of each of files(), source indices; complete once read() has returned false.
  const std::vector<std::uint64_t>& points_of_files() const { return points_of_files_; }
  /// Records of the files that hold no point, by their format's rules.
  std::uint64_t absent_points() const { return absent_points_; }
  /// Largest |stored - read| of any coordinate, metres.
  double largest_change() const { return largest_change_; }

 private:
  void open_inputs();
  void find_crs();
  void choose_offset_and_scale(Progress& progress);
  const std::shared_ptr<PointReader>& reader(std::size_t file);
  void read_piece(RecordBatch& records, PieceBytes* bytes) const;
  void append_kept(RecordBatch& records, QuantaBatch& out) const;
  void append_rounded(const RecordBatch& records, QuantaBatch& out) const;
  static void keep_classes(RecordBatch& records, QuantaBatch& out);
  [[noreturn]] void refuse_beyond_quanta(std::size_t file) const;

  EnvironmentOptions options_;
  PointReadOptions how_to_read_;
  InputFiles inputs_;
  std::vector<CloudInfo> infos_;  // of the files
  std::vector<bool> in_pieces_;
  Quantisation quantisation_{};
  std::vector<std::array<std::int64_t, 3>> shifts_;  // of the files' integers; empty: rounded anew
  CommonCrs crs_;
  std::vector<Message> range_warnings_;  // of the coordinates as they are
  std::optional<std::uint64_t> declared_points_;

  std::shared_ptr<PointReader> stream_;   // standard input, spooled
  std::shared_ptr<PointReader> current_;  // the open file
  std::size_t open_file_ = 0;
  std::size_t file_ = 0;
  std::size_t piece_ = 0;  // of that file
  std::uint64_t file_points_ = 0;
  std::uint64_t next_source_ = 0;
  std::vector<std::uint64_t> points_of_files_;  // of those that were read to their end
  std::uint64_t input_points_ = 0;
  std::uint64_t non_finite_points_ = 0;
  std::uint64_t first_non_finite_ = 0;
  std::uint64_t absent_points_ = 0;
  double largest_change_ = 0;
};

}  // namespace clearway
