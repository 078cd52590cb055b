#include "io/convert/inputs/environment_source.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/shorten_notes.hpp"
#include "io/convert/checks/choose_scale.hpp"
#include "io/convert/checks/lost_digits.hpp"
#include "io/convert/inputs/read_points.hpp"
#include "io/convert/inputs/spooled_reader.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

const EnvironmentOptions& checked(const EnvironmentOptions& options) {
  if (options.scale && !(*options.scale > 0 && std::isfinite(*options.scale))) {
    throw UsageError("a scale of " + brief(*options.scale) + ": expected a positive length");
  }
  return options;
}

/// Calls `read`. Where one of several files is refused, the error says that it can be skipped.
template <typename Read>
auto reading_one_of(std::size_t files, Read read) {
  try {
    return read();
  } catch (const InputError& error) {
    const Remedy remedy = error.remedy();
    const bool can_be_skipped = remedy == Remedy::kNone || remedy == Remedy::kStandardInput ||
                                remedy == Remedy::kSampleMesh;
    if (files < 2 || !can_be_skipped) throw;
    throw InputError(error.what(), Remedy::kSkipUnreadable);
  }
}

}  // namespace

EnvironmentSource::EnvironmentSource(const std::vector<std::filesystem::path>& inputs,
                                     const EnvironmentOptions& options, Progress& progress)
    : options_(checked(options)),
      how_to_read_{options.columns, true},
      inputs_(inputs, options.skip_unreadable, how_to_read_, progress) {
  open_inputs();
  find_crs();
  if (auto kept = common_quanta(files(), infos_, options_.scale)) {
    quantisation_ = kept->quantisation;
    shifts_ = std::move(kept->shifts);
    return;
  }
  choose_offset_and_scale(progress);
}

EnvironmentSource::~EnvironmentSource() = default;

void EnvironmentSource::open_inputs() {
  if (inputs_.are_a_stream()) {
    auto stream = open_las_stream(File::adopt(::dup(STDIN_FILENO), "standard input"),
                                  options_.temporary_folder);
    if (!stream->can_rewind()) stream = spool(std::move(stream), options_.temporary_folder);
    stream_ = std::move(stream);
  }
  declared_points_ = 0;
  for (std::size_t i = 0; i < files().size(); ++i) {
    const CloudInfo& info = infos_.emplace_back(reader(i)->info());
    in_pieces_.push_back(!stream_ && reader(i)->pieces() > 0);
    if (declared_points_ && info.declared_points) {
      *declared_points_ += *info.declared_points;
    } else {
      declared_points_.reset();
    }
  }
  const auto is_text = [](const CloudInfo& info) { return info.text_table; };
  if (!options_.columns.empty() && std::none_of(infos_.begin(), infos_.end(), is_text)) {
    throw UsageError("columns are chosen, but no input is a text; expected one at least");
  }
}

void EnvironmentSource::find_crs() {
  crs_ = common_crs(files(), infos_, options_.unit, options_.ignore_crs);
  for (std::size_t i = 0; i < files().size(); ++i) {
    if (infos_[i].faces == 0) continue;
    crs_.warnings.push_back({Message::Severity::kWarning, "mesh-faces",
                             files()[i].string() + ": its " + std::to_string(infos_[i].faces) +
                                 " faces are not read, its vertices are"});
  }
}

std::vector<Message> EnvironmentSource::remarks() const {
  std::vector<Message> all = crs_.warnings;
  all.insert(all.end(), range_warnings_.begin(), range_warnings_.end());
  const std::vector<Message> of_files = inputs_.remarks();
  all.insert(all.end(), of_files.begin(), of_files.end());
  if (!shifts_.empty()) {
    const auto mixture = remark_on_mixture(files(), infos_, quantisation_);
    if (mixture) all.push_back(*mixture);
  }
  std::vector<Message> own;
  for (const CloudInfo& info : infos_) {
    own.insert(own.end(), info.remarks.begin(), info.remarks.end());
  }
  shorten_notes(own);
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

void EnvironmentSource::choose_offset_and_scale(Progress& progress) {
  CoordinateRange range;
  progress.begin("range", declared_points_.value_or(0), "points");
  RecordBatch records;
  while (next(records)) {
    throw_if_stopped(progress);
    if (records.reader) read_piece(records, nullptr);
    const std::size_t count = records.points.size();
    const std::uint64_t first = file_points_ - count;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 p = point_of(records.points, infos_[file_], i);
      if (is_finite(p)) range.add(p, file_, first + i);
    }
    progress.advance(count);
  }
  progress.end();
  rewind();
  range_warnings_ = warn_of_lost_digits(range.samples());
  quantisation_ = choose_scale(range, options_.scale, files(), how_to_read_);
}

const std::shared_ptr<PointReader>& EnvironmentSource::reader(std::size_t file) {
  if (stream_) return stream_;
  if (!current_ || open_file_ != file) {
    current_ = reading_one_of(files().size(),
                              [&] { return open_point_file(files()[file], how_to_read_); });
    open_file_ = file;
  }
  return current_;
}

void EnvironmentSource::rewind() {
  file_ = piece_ = 0;
  file_points_ = next_source_ = 0;
  input_points_ = non_finite_points_ = absent_points_ = 0;
  largest_change_ = 0;
  points_of_files_.clear();
  if (stream_) stream_->rewind();
  current_.reset();
}

bool EnvironmentSource::next(RecordBatch& records) {
  for (; file_ < files().size(); ++file_, piece_ = 0, file_points_ = 0) {
    const std::shared_ptr<PointReader>& from = reader(file_);
    std::uint64_t count = 0;
    if (piece_ < from->pieces()) {
      records.reader = from;
      records.piece = piece_++;
      count = from->points_of_piece(records.piece);
    } else if (from->pieces() == 0 &&
               reading_one_of(files().size(), [&] { return from->read(records.points); })) {
      records.reader.reset();
      count = records.points.size();
    } else {
      infos_[file_].remarks = from->info().remarks;
      points_of_files_.push_back(file_points_);
      continue;
    }
    records.file = file_;
    records.first_source = next_source_;
    file_points_ += count;
    next_source_ += count;
    return true;
  }
  if (stream_ &&
      (infos_[0].crs_wkt != stream_->info().crs_wkt || infos_[0].unit != stream_->info().unit)) {
    infos_[0].crs_wkt = stream_->info().crs_wkt;  // the CRS may follow the points
    infos_[0].unit = stream_->info().unit;
    infos_[0].unit_trouble = stream_->info().unit_trouble;
    find_crs();
  }
  return false;
}

void EnvironmentSource::read_piece(RecordBatch& records, PieceBytes* bytes) const {
  reading_one_of(files().size(), [&] {
    records.reader->read_piece(records.piece, records.points, bytes);
    return true;
  });
}

void EnvironmentSource::note(const QuantaBatch& batch) {
  if (non_finite_points_ == 0) first_non_finite_ = batch.first_non_finite;
  input_points_ += batch.records;
  non_finite_points_ += batch.non_finite_points;
  absent_points_ += batch.absent_points;
  largest_change_ = std::max(largest_change_, batch.largest_change);
}

bool EnvironmentSource::read(QuantaBatch& batch) {
  RecordBatch records;
  batch.quanta.clear();
  if (!next(records)) return false;
  convert(records, batch, false);
  note(batch);
  return true;
}

EnvironmentSource::Place EnvironmentSource::place_of(std::uint64_t source) const {
  Place place{0, source};
  while (place.file + 1 < points_of_files_.size() && place.point >= points_of_files_[place.file]) {
    place.point -= points_of_files_[place.file++];
  }
  return place;
}

std::optional<std::array<std::int32_t, 3>> EnvironmentSource::origin_of(std::size_t file) const {
  const auto& own = infos_[file].quantisation;
  std::array<std::int32_t, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double origin = own ? own->offset[k] : 0;
    const double quantum =
        std::nearbyint((origin - quantisation_.offset[k]) / quantisation_.scale[k]);
    if (!(quantum >= kLeastQuantum && quantum <= kGreatestQuantum)) return std::nullopt;
    out[k] = static_cast<std::int32_t>(quantum);
  }
  return out;
}

}  // namespace clearway
