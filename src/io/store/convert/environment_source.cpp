#include "io/store/convert/environment_source.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/scans/declared_box.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/store/convert/coordinate_range.hpp"
#include "io/store/convert/file_boxes.hpp"
#include "io/store/convert/read_points.hpp"
#include "io/store/convert/spooled_reader.hpp"
#include "io/store/convert/withheld_cubes.hpp"

namespace clearway {
namespace {

/// Calls `read`. Where one of several files is refused, the error says that it can be skipped.
template <typename Read>
auto reading_one_of(std::size_t files, Read read) {
  try {
    return read();
  } catch (const InputError& error) {
    const Remedy remedy = error.remedy();
    const bool can_be_skipped = remedy == Remedy::kNone || remedy == Remedy::kStandardInput;
    if (files < 2 || !can_be_skipped) throw;
    throw InputError(error.what(), Remedy::kSkipUnreadable);
  }
}

}  // namespace

EnvironmentSource::EnvironmentSource(const ConversionOptions& options, Progress& progress,
                                     const FoundInputs* found)
    : options_(options),
      how_to_read_{options.columns, true, !options.origins_path.empty()},
      inputs_(options, how_to_read_, progress, found != nullptr ? &found->readable : nullptr) {
  open_inputs();
  find_crs();
  withheld_edge_ = metre_cube_edge(crs_.unit);
  for (CloudInfo& info : infos_) convert_heights(info);
  if (auto kept = common_quanta(files(), infos_, options_.scale)) {
    quantisation_ = kept->quantisation;
    shifts_ = std::move(kept->shifts);
    return;
  }
  chose_scale_ = true;
  if (found != nullptr && found->chosen) {
    quantisation_ = *found->chosen;
    return;
  }
  choose_offset_and_scale(progress);
}

FoundInputs EnvironmentSource::found() const {
  return {inputs_.readable(), chose_scale_ ? std::optional(quantisation_) : std::nullopt};
}

EnvironmentSource::~EnvironmentSource() = default;

void EnvironmentSource::open_inputs() {
  if (inputs_.are_a_stream()) {
    const std::filesystem::path folder = folder_of(options_.output);
    auto stream =
        open_las_stream(File::adopt(::dup(STDIN_FILENO), "standard input"), folder, how_to_read_);
    if (!stream->can_rewind()) stream = spool(std::move(stream), folder);
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
  crs_ = common_crs(files(), infos_, options_);
  for (std::size_t i = 0; i < files().size(); ++i) {
    if (infos_[i].faces == 0) continue;
    crs_.warnings.push_back(warning("mesh-faces", files()[i].string() + ": its " +
                                                      std::to_string(infos_[i].faces) +
                                                      " faces are not read, its vertices are"));
  }
}

void EnvironmentSource::convert_heights(CloudInfo& info) const {
  const double factor = crs_.height_factor;
  if (info.quantisation) {
    info.quantisation->scale[2] *= factor;
    info.quantisation->offset[2] *= factor;
  }
  if (info.declared_box) convert_heights(*info.declared_box);
  for (OriginRun& run : info.origins) {
    if (run.origin) run.origin->z *= factor;
  }
}

void EnvironmentSource::convert_heights(Box& box) const {
  box.lo.z *= crs_.height_factor;
  box.hi.z *= crs_.height_factor;
}

void EnvironmentSource::convert_heights(PointBatch& batch) const {
  if (crs_.height_factor == 1) return;
  for (Vec3& position : batch.positions) position.z *= crs_.height_factor;
}

std::optional<Box> EnvironmentSource::bounds_of(const PointReader& reader,
                                                std::size_t piece) const {
  std::optional<Box> bounds = reader.bounds_of_piece(piece);
  if (bounds) convert_heights(*bounds);
  return bounds;
}

std::vector<Message> EnvironmentSource::remarks() const {
  std::vector<Message> all = crs_.warnings;
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
      if (is_finite(p) && !leaves_out(records.points, i)) range.add(p, file_, first + i);
    }
    progress.advance(count);
  }
  progress.end();
  rewind();
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
  counts_ = {};
  withheld_edge_ = metre_cube_edge(crs_.unit);
  points_of_files_.clear();
  if (stream_) stream_->rewind();
  current_.reset();
}

bool EnvironmentSource::next(RecordBatch& records) {
  for (; file_ < files().size(); ++file_, piece_ = 0, file_points_ = 0) {
    records.unread = 0;
    if (file_ < passed_over_.size() && passed_over_[file_]) {
      if (pass_over(records)) return true;
      points_of_files_.push_back(file_points_);
      continue;
    }
    const std::shared_ptr<PointReader>& from = reader(file_);
    std::uint64_t count = 0;
    if (piece_ < from->pieces()) {
      records.reader = from;
      records.piece = piece_++;
      count = from->points_of_piece(records.piece);
      const std::optional<Box> bounds = bounds_of(*from, records.piece);
      if (is_far(bounds)) {
        records.unread = count;
        records.unread_bytes = from->place_of_piece(records.piece).count;
        records.bounds = *bounds;
      }
    } else if (from->pieces() == 0 &&
               reading_one_of(files().size(), [&] { return from->read(records.points); })) {
      convert_heights(records.points);
      records.reader.reset();
      count = records.points.size();
    } else {
      CloudInfo found = from->info();
      convert_heights(found);
      infos_[file_].remarks = std::move(found.remarks);
      infos_[file_].origins = std::move(found.origins);
      infos_[file_].origins_rest_on = std::move(found.origins_rest_on);
      points_of_files_.push_back(file_points_);
      continue;
    }
    records.file = file_;
    records.first_source = next_source_;
    file_points_ += count;
    next_source_ += count;
    return true;
  }
  if (stream_) take_late_crs();
  return false;
}

/// Takes all records of a file that is passed over. Returns false where that was done.
bool EnvironmentSource::pass_over(RecordBatch& records) {
  const CloudInfo& info = infos_[file_];
  if (file_points_ > 0 || *info.declared_points == 0) return false;
  records.reader.reset();
  records.file = file_;
  records.first_source = next_source_;
  records.unread = *info.declared_points;
  records.unread_bytes = std::filesystem::file_size(files()[file_]);
  records.bounds = *info.declared_box;
  file_points_ += records.unread;
  next_source_ += records.unread;
  return true;
}

/// Takes the CRS of a stream, which may follow its points.
void EnvironmentSource::take_late_crs() {
  const StatedCrs& late = stream_->info();
  if (static_cast<const StatedCrs&>(infos_[0]) == late) return;
  infos_[0].set(late);
  const double factor = crs_.height_factor;
  find_crs();
  if (crs_.height_factor == factor) return;
  refuse(files()[0].string(),
         "its unit comes after its points, whose heights were converted for another one; expected "
         "the scan as a file");
}

void EnvironmentSource::read_piece(RecordBatch& records, PieceBytes* bytes) const {
  reading_one_of(files().size(), [&] {
    records.reader->read_piece(records.piece, records.points, bytes);
    return true;
  });
  convert_heights(records.points);
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
    const double quantum = quantum_of(quantisation_, static_cast<int>(k), origin);
    if (!(quantum >= kLeastQuantum && quantum <= kGreatestQuantum)) return std::nullopt;
    out[k] = static_cast<std::int32_t>(quantum);
  }
  return out;
}

}  // namespace clearway

// Conversion of records to the store's integers.

namespace clearway {
namespace {

/// Leaves out the points i of a batch for which `keeps(i)` does not hold. Called in order.
template <typename Keeps>
void keep_points(QuantaBatch& out, Keeps keeps) {
  std::vector<std::uint32_t> offsets;
  for (std::size_t i = 0; i < out.quanta.size(); ++i) {
    if (!keeps(i)) continue;
    out.quanta[offsets.size()] = out.quanta[i];
    offsets.push_back(out.offsets.empty() ? static_cast<std::uint32_t>(i) : out.offsets[i]);
  }
  if (offsets.size() == out.quanta.size()) return;
  out.quanta.resize(offsets.size());
  out.offsets = std::move(offsets);
}

}  // namespace

void EnvironmentSource::convert(RecordBatch& records, QuantaBatch& batch, bool with_bytes) const {
  batch = {};
  batch.file = records.file;
  batch.first_source = records.first_source;
  if (records.unread > 0) {
    if (records.reader) batch.bytes = records.reader->place_of_piece(records.piece);
    return append_unread(records, batch);
  }
  if (records.reader) read_piece(records, with_bytes ? &batch.bytes : nullptr);
  batch.counts.input_points = records.points.size();
  note_withheld(records, batch);
  if (shifts_.empty() || !infos_[records.file].quantisation) {
    append_rounded(records, batch);
  } else {
    append_kept(records, batch);
  }
  batch.whole = FileBox::of(batch.quanta);
  count_beyond(batch);
  if (corridor_ != nullptr) {
    check_bounds(records, batch);
    drop_far(batch);
  }
  keep_classes(records, batch);
  count_cut_off(batch);
  batch.times = std::move(records.points.times);
  batch.turn = records.points.turn;
  records.points = {};
}

void EnvironmentSource::keep_near(const Corridor& corridor, bool trust_bounds) {
  corridor_ = &corridor;
  Box path{corridor.path().front(), corridor.path().front()};
  for (const Vec3& p : corridor.path()) path.extend(p);
  for (const CloudInfo& info : infos_) {
    std::optional<Box> bounds = info.declared_box;
    for (int k = 0; bounds && k < 3; ++k) {
      if (bounds->lo[k] != 0 || bounds->hi[k] != 0) continue;
      bounds->lo[k] = path.lo[k];  // nobody filled in this axis, so that it says nothing
      bounds->hi[k] = path.hi[k];
    }
    passed_over_.push_back(trust_bounds && !stream_ && info.quantisation && info.declared_points &&
                           is_far(bounds));
  }
}

/// Counts records that are not read.
void EnvironmentSource::append_unread(const RecordBatch& records, QuantaBatch& out) const {
  out.counts = {.input_points = records.unread,
                .far_points = records.unread,
                .unread_points = records.unread,
                .unread_bytes = records.unread_bytes};
  out.whole = {.points = records.unread};
  for (int k = 0; k < 3; ++k) {
    out.whole.lo[k] = nearest_int32(quantum_of(quantisation_, k, records.bounds.lo[k]));
    out.whole.hi[k] = nearest_int32(quantum_of(quantisation_, k, records.bounds.hi[k]));
  }
  const std::optional<Box> reach = reach_of(infos_[out.file].declared_box);
  if (reach && !reach->meets(records.bounds)) out.whole.beyond = records.unread;
}

/// Counts the points out of reach of the box that their file declares.
void EnvironmentSource::count_beyond(QuantaBatch& out) const {
  const std::optional<Box> reach = reach_of(infos_[out.file].declared_box);
  if (!reach || out.whole.points == 0) return;
  const Box box = box_of(out.whole, quantisation_);
  if (reach->contains(box.lo) && reach->contains(box.hi)) return;
  for (const auto& q : out.quanta) {
    if (!reach->contains(position(quantisation_, q[0], q[1], q[2]))) ++out.whole.beyond;
  }
}

/// Throws InputError where points that were read lie beyond the bounds that the file promises of
/// them, so that those of other pieces cannot be believed either.
void EnvironmentSource::check_bounds(const RecordBatch& records, const QuantaBatch& batch) const {
  if (!records.reader || batch.whole.points == 0) return;
  const std::optional<Box> bounds = bounds_of(*records.reader, records.piece);
  if (!bounds) return;
  for (int k = 0; k < 3; ++k) {
    const double step = 2 * quantisation_.scale[k];
    if (coordinate(quantisation_, k, batch.whole.lo[k]) >= bounds->lo[k] - step &&
        coordinate(quantisation_, k, batch.whole.hi[k]) <= bounds->hi[k] + step) {
      continue;
    }
    refuse(files()[records.file].string(),
           "points lie outside of the cube that its hierarchy names for them, so that it does not "
           "tell which points are near a path; expected a hierarchy that is right. Write the file "
           "again");
  }
}

/// Leaves out the points that are too far from the path.
void EnvironmentSource::drop_far(QuantaBatch& out) const {
  const std::size_t count = out.quanta.size();
  CorridorWalk walk(*corridor_);
  keep_points(out, [&](std::size_t i) {
    const auto& q = out.quanta[i];
    return walk.holds(position(quantisation_, q[0], q[1], q[2]));
  });
  out.counts.far_points = count - out.quanta.size();
}

/// Keeps the classes of the points that were not left out, where one of these has a class.
void EnvironmentSource::keep_classes(RecordBatch& records, QuantaBatch& out) {
  std::vector<std::uint8_t>& classes = records.points.classes;
  if (classes.empty()) return;
  for (std::size_t i = 0; i < out.offsets.size(); ++i) classes[i] = classes[out.offsets[i]];
  classes.resize(out.quanta.size());
  const auto is_set = [](std::uint8_t value) { return value != 0; };
  if (std::ranges::any_of(classes, is_set)) out.classes = std::move(classes);
}

/// Counts the points that are at the ends of their file's integers.
void EnvironmentSource::count_cut_off(QuantaBatch& out) const {
  const std::optional<Quantisation>& own = infos_[out.file].quantisation;
  if (!own) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto count = [&](std::int64_t end) -> std::uint64_t {
      const int axis = static_cast<int>(k);
      const double at = coordinate(*own, axis, static_cast<std::int32_t>(end));
      const double quantum = shifts_.empty() ? quantum_of(quantisation_, axis, at)
                                             : static_cast<double>(end + shifts_[out.file][k]);
      if (out.whole.lo[k] != quantum && out.whole.hi[k] != quantum) return 0;
      return static_cast<std::uint64_t>(
          std::ranges::count_if(out.quanta, [&](const auto& q) { return q[k] == quantum; }));
    };
    out.whole.cut_off.lowest[k] = count(CutOff::kLowest);
    out.whole.cut_off.greatest[k] = count(CutOff::kGreatest);
  }
}

namespace {

MetreCube cube_of(const Vec3& p, double edge) {
  MetreCube cube{};
  for (int k = 0; k < 3; ++k) {
    cube[static_cast<std::size_t>(k)] = nearest_int32(std::floor(p[k] / edge));
  }
  return cube;
}

}  // namespace

/// Counts the records that are withheld, and finds their cubes where they are left out.
void EnvironmentSource::note_withheld(const RecordBatch& records, QuantaBatch& out) const {
  const PointBatch& batch = records.points;
  for (std::size_t i = 0; i < batch.flags.size(); ++i) {
    if (!batch.is_withheld(i)) continue;
    if (out.counts.withheld_points++ == 0) out.counts.first_withheld = records.first_source + i;
    if (options_.keep_withheld) continue;
    const MetreCube cube = cube_of(point_of(batch, infos_[records.file], i), withheld_edge_);
    // Neighbours in a file mostly share a cube.
    if (out.withheld_cubes.empty() || out.withheld_cubes.back() != cube) {
      out.withheld_cubes.push_back(cube);
    }
  }
  keep_once(out.withheld_cubes);
}

void EnvironmentSource::append_kept(RecordBatch& records, QuantaBatch& out) const {
  out.quanta = std::move(records.points.quanta);
  if (!options_.keep_withheld && out.counts.withheld_points > 0) {
    keep_points(out, [&](std::size_t i) { return !records.points.is_withheld(i); });
  }
  const std::size_t file = records.file;
  const Quantisation& own = *infos_[file].quantisation;
  if (own == quantisation_) return;
  for (auto& q : out.quanta) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double before = coordinate(own, axis, q[k]);
      const std::int64_t shifted = q[k] + shifts_[file][k];
      if (!std::in_range<std::int32_t>(shifted)) {
        throw InputError(files()[file].string() + ": too far from " + files()[0].string() +
                             " for 32-bit integers of " + format_digits(own.scale[k], 9),
                         Remedy::kScale);
      }
      q[k] = static_cast<std::int32_t>(shifted);
      out.counts.largest_change = std::max(
          out.counts.largest_change, std::abs(coordinate(quantisation_, axis, q[k]) - before));
    }
  }
}

void EnvironmentSource::append_rounded(const RecordBatch& records, QuantaBatch& out) const {
  const PointBatch& batch = records.points;
  std::vector<std::size_t> dropped;
  out.quanta.resize(batch.size());
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Vec3 p = point_of(batch, infos_[records.file], i);
    const bool withheld = leaves_out(batch, i);
    if (withheld || !is_finite(p)) {
      dropped.push_back(i);
      if (withheld) continue;  // counted already
      if (std::ranges::binary_search(batch.absent, i)) {
        ++out.counts.absent_points;
      } else if (out.counts.non_finite_points++ == 0) {
        out.counts.first_non_finite = records.first_source + i;
      }
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const double quantum = quantum_of(quantisation_, k, p[k]);
      if (quantum < kLeastQuantum || quantum > kGreatestQuantum) {
        refuse_beyond_quanta(records.file);
      }
      const auto q = static_cast<std::int32_t>(quantum);
      out.quanta[i][static_cast<std::size_t>(k)] = q;
      out.counts.largest_change =
          std::max(out.counts.largest_change, std::abs(coordinate(quantisation_, k, q) - p[k]));
    }
  }
  if (dropped.empty()) return;
  auto next = dropped.begin();
  keep_points(out, [&](std::size_t i) {
    const bool is_dropped = next != dropped.end() && *next == i;
    if (is_dropped) ++next;
    return !is_dropped;
  });
}

void EnvironmentSource::refuse_beyond_quanta(std::size_t file) const {
  if (shifts_.empty()) refuse(files()[file].string(), "changed while it was read");
  refuse(files()[file].string(), Remedy::kScale,
         "too far from the other files for 32-bit integers of {}",
         format_digits(quantisation_.scale[0], 9));
}

bool EnvironmentPass::next(PassingBatch& batch) {
  if (failed) return false;
  try {
    throw_if_stopped(progress);
    const auto running = clocks.measure(Stage::kRead);
    if (!environment.next(batch.records)) return false;
  } catch (...) {
    batch.error = std::current_exception();
    failed = true;
  }
  return true;
}

void EnvironmentPass::read(PassingBatch& batch) const {
  const auto running = clocks.measure(Stage::kRead);
  environment.convert(batch.records, batch.quanta, files != nullptr);
}

void EnvironmentPass::hash_file(PassingBatch& batch) const {
  if (files == nullptr || batch.error) return;
  const auto running = clocks.measure(Stage::kHash);
  const PieceBytes bytes = std::exchange(batch.quanta.bytes, {});
  if (bytes.count > 0) files->add(batch.quanta.file, bytes);
}

void EnvironmentPass::note(const PassingBatch& batch) const {
  if (batch.error) std::rethrow_exception(batch.error);
  environment.note(batch.quanta);
}

}  // namespace clearway
