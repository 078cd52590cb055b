#include "io/convert/environment_source.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/shorten_notes.hpp"
#include "io/convert/spooled_reader.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

constexpr double kLeastQuantum = std::numeric_limits<std::int32_t>::min();
constexpr double kGreatestQuantum = std::numeric_limits<std::int32_t>::max();
constexpr double kScales[] = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1e0, 1e1, 1e2, 1e3};

bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Vec3 point_of(const PointBatch& batch, const CloudInfo& info, std::size_t i) {
  if (!info.quantisation) return batch.positions[i];
  const auto& q = batch.quanta[i];
  return position(*info.quantisation, q[0], q[1], q[2]);
}

/// The finest power of ten >= 1e-6 at which `length` fits int32; the coarsest where none does.
double fitting_scale(double length) {
  const auto fits = [length](double scale) { return length / scale <= kGreatestQuantum; };
  const auto* found = std::find_if(std::begin(kScales), std::end(kScales), fits);
  return found == std::end(kScales) ? *std::prev(found) : *found;
}

/// A pipe can be read only once.
void refuse_pipe(const std::filesystem::path& file) {
  if (std::filesystem::is_regular_file(file)) return;
  throw InputError(file.string() +
                   ": is a pipe or device, expected a file; LAS can be piped to standard input: "
                   "clearway convert -");
}

}  // namespace

EnvironmentSource::EnvironmentSource(const std::vector<std::filesystem::path>& inputs,
                                     const EnvironmentOptions& options)
    : options_(options) {
  const bool streams = std::find(inputs.begin(), inputs.end(), "-") != inputs.end();
  if (streams && inputs.size() > 1) {
    throw UsageError("standard input (-) cannot be combined with other inputs");
  }
  if (options.scale && !(*options.scale > 0 && std::isfinite(*options.scale))) {
    throw UsageError("a scale of " + brief(*options.scale) + ": expected a positive length");
  }
  if (streams) {
    files_ = read_files_ = {"-"};
    stream_ = spool(open_las_stream(File::adopt(::dup(STDIN_FILENO), "standard input")),
                    options.temporary_folder);
  } else {
    files_ = list_point_files(inputs, &folder_remarks_);
    std::for_each(files_.begin(), files_.end(), refuse_pipe);
    read_files_ = with_pose_files(files_);
    std::transform(read_files_.begin(), read_files_.end(), std::back_inserter(states_), state_of);
  }
  open_inputs();
  find_crs();
  if (auto kept = common_quanta(files_, infos_, options_.scale)) {
    quantisation_ = kept->quantisation;
    shifts_ = std::move(kept->shifts);
    return;
  }
  choose_offset_and_scale();
}

EnvironmentSource::~EnvironmentSource() = default;

void EnvironmentSource::open_inputs() {
  declared_points_ = 0;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    const CloudInfo& info = infos_.emplace_back(reader(i).info());
    if (declared_points_ && info.declared_points) {
      *declared_points_ += *info.declared_points;
    } else {
      declared_points_.reset();
    }
  }
}

void EnvironmentSource::find_crs() {
  crs_ = common_crs(files_, infos_, options_.ignore_crs);
  for (std::size_t i = 0; i < files_.size(); ++i) {
    if (infos_[i].faces == 0) continue;
    crs_.warnings.push_back({Message::Severity::kWarning, "mesh-faces",
                             files_[i].string() + ": its " + std::to_string(infos_[i].faces) +
                                 " faces are not read, its vertices are"});
  }
}

std::vector<Message> EnvironmentSource::remarks() const {
  std::vector<Message> all = crs_.warnings;
  all.insert(all.end(), folder_remarks_.begin(), folder_remarks_.end());
  if (!shifts_.empty()) {
    const auto mixture = remark_on_mixture(files_, infos_, quantisation_);
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

void EnvironmentSource::choose_offset_and_scale() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 lo{kInfinity, kInfinity, kInfinity};
  Vec3 hi{-kInfinity, -kInfinity, -kInfinity};
  while (next_batch(raw_)) {
    for (std::size_t i = 0; i < raw_.size(); ++i) {
      const Vec3 p = point_of(raw_, infos_[file_], i);
      if (!is_finite(p)) continue;
      for (int k = 0; k < 3; ++k) {
        lo[k] = std::min(lo[k], p[k]);
        hi[k] = std::max(hi[k], p[k]);
      }
    }
  }
  rewind();
  for (int k = 0; k < 3; ++k) {
    const bool any = lo[k] <= hi[k];
    const double offset = any ? std::floor(lo[k]) : 0;
    const double fitting = fitting_scale(any ? hi[k] - offset : 0);
    quantisation_.offset[k] = offset;
    quantisation_.scale[k] = options_.scale.value_or(fitting);
    if (any && (hi[k] - offset) / quantisation_.scale[k] > kGreatestQuantum) {
      const bool fits = (hi[k] - offset) / fitting <= kGreatestQuantum;
      throw InputError("coordinates from " + brief(lo[k]) + " to " + brief(hi[k]) +
                           " do not fit 32-bit integers at a scale of " +
                           brief(quantisation_.scale[k]),
                       Remedy::kScale, fits ? fitting : 0);
    }
  }
}

PointReader& EnvironmentSource::reader(std::size_t file) {
  if (stream_) return *stream_;
  if (!current_ || open_file_ != file) {
    current_ = open_point_file(files_[file]);
    open_file_ = file;
  }
  return *current_;
}

void EnvironmentSource::rewind() {
  file_ = 0;
  file_points_ = 0;
  input_points_ = non_finite_points_ = absent_points_ = 0;
  largest_change_ = 0;
  if (stream_) stream_->rewind();
  current_.reset();
}

void EnvironmentSource::refuse_changed() const {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (state_of(read_files_[i]) == states_[i]) continue;
    refuse(read_files_[i].string(),
           "changed during its conversion, expected the same file in every pass over it");
  }
}

bool EnvironmentSource::next_batch(PointBatch& batch) {
  for (; file_ < files_.size(); ++file_, file_points_ = 0) {
    if (!reader(file_).read(batch)) {
      infos_[file_].remarks = reader(file_).info().remarks;
      continue;
    }
    file_points_ += batch.size();
    return true;
  }
  if (stream_ &&
      (infos_[0].crs_wkt != stream_->info().crs_wkt || infos_[0].unit != stream_->info().unit)) {
    infos_[0] = stream_->info();  // a CRS may follow the points
    find_crs();
  }
  return false;
}

bool EnvironmentSource::read(QuantaBatch& batch) {
  batch.quanta.clear();
  batch.offsets.clear();
  if (!next_batch(raw_)) return false;
  batch.first_source = input_points_;
  if (shifts_.empty() || !infos_[file_].quantisation) {
    append_rounded(raw_, batch);
  } else {
    append_kept(raw_, batch);
  }
  input_points_ += raw_.size();
  return true;
}

void EnvironmentSource::append_kept(const PointBatch& batch, QuantaBatch& out) {
  out.quanta = batch.quanta;
  const Quantisation& own = *infos_[file_].quantisation;
  if (own == quantisation_) return;
  for (auto& q : out.quanta) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double before = coordinate(own, axis, q[k]);
      const std::int64_t shifted = q[k] + shifts_[file_][k];
      if (shifted < std::numeric_limits<std::int32_t>::min() ||
          shifted > std::numeric_limits<std::int32_t>::max()) {
        throw InputError(files_[file_].string() + ": too far from " + files_[0].string() +
                             " for 32-bit integers of " + brief(own.scale[k]),
                         Remedy::kScale);
      }
      q[k] = static_cast<std::int32_t>(shifted);
      largest_change_ =
          std::max(largest_change_, std::abs(coordinate(quantisation_, axis, q[k]) - before));
    }
  }
}

void EnvironmentSource::append_rounded(const PointBatch& batch, QuantaBatch& out) {
  auto absent = batch.absent.begin();
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Vec3 p = point_of(batch, infos_[file_], i);
    if (!is_finite(p)) {
      if (absent != batch.absent.end() && *absent == i) {
        ++absent_points_;
        ++absent;
      } else {
        drop_non_finite(file_points_ - batch.size() + i);
      }
      if (out.offsets.empty()) {
        for (std::uint32_t j = 0; j < out.quanta.size(); ++j) out.offsets.push_back(j);
        out.offsets.reserve(batch.size());
      }
      continue;
    }
    std::array<std::int32_t, 3> q;
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double quantum =
          std::nearbyint((p[axis] - quantisation_.offset[k]) / quantisation_.scale[k]);
      if (quantum < kLeastQuantum || quantum > kGreatestQuantum) {
        refuse_beyond_quanta();
      }
      q[k] = static_cast<std::int32_t>(quantum);
      largest_change_ =
          std::max(largest_change_, std::abs(coordinate(quantisation_, axis, q[k]) - p[axis]));
    }
    out.quanta.push_back(q);
    // Identity until the first dropped point, also where that is the batch's very first one.
    if (out.quanta.size() <= i) out.offsets.push_back(static_cast<std::uint32_t>(i));
  }
}

void EnvironmentSource::refuse_beyond_quanta() const {
  if (shifts_.empty()) refuse(files_[file_].string(), "changed while it was read");
  refuse(files_[file_].string(),
         "too far from the other files for 32-bit integers of " + brief(quantisation_.scale[0]),
         Remedy::kScale);
}

void EnvironmentSource::drop_non_finite(std::uint64_t point) {
  ++non_finite_points_;
  if (options_.strict) {
    throw InputError(files_[file_].string() + ": point " + std::to_string(point) +
                     " is not finite, expected finite coordinates in a strict conversion");
  }
}

}  // namespace clearway
