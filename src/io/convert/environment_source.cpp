#include "io/convert/environment_source.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "io/convert/spooled_reader.hpp"
#include "io/store_metadata.hpp"

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

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
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
    throw UsageError("--scale " + number(*options.scale) + ": expected a positive length");
  }
  if (streams) {
    files_ = {"-"};
    stream_ = spool(open_las_stream(File::adopt(::dup(STDIN_FILENO), "standard input")),
                    options.temporary_folder);
  } else {
    files_ = list_point_files(inputs);
    std::for_each(files_.begin(), files_.end(), refuse_pipe);
  }
  open_inputs();
  check_crs();
  choose_quantisation();
}

EnvironmentSource::~EnvironmentSource() = default;

void EnvironmentSource::open_inputs() {
  declared_points_ = 0;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    inputs_.push_back({.info = reader(i).info()});
    const CloudInfo& info = inputs_.back().info;
    if (declared_points_ && info.declared_points) {
      *declared_points_ += *info.declared_points;
    } else {
      declared_points_.reset();
    }
  }
}

void EnvironmentSource::check_crs() {
  remarks_.clear();
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const CloudInfo& info = inputs_[i].info;
    const std::string name = files_[i].string();
    if (info.unit == LengthUnit::kDegree && !options_.ignore_crs) {
      throw InputError(name +
                       ": its coordinate reference system is in degrees, expected lengths; " +
                       "project the scan first (for example with PDAL), or use --ignore-crs");
    }
    if (i == 0) {
      unit_ = info.unit;
      crs_wkt_ = info.crs_wkt;
      continue;
    }
    if (info.unit != unit_ && !options_.ignore_crs) {
      throw InputError(name + ": its unit of length is " + to_string(info.unit) + ", expected " +
                       to_string(unit_) + " as in " + files_[0].string() + " (or --ignore-crs)");
    }
    if (info.crs_wkt != crs_wkt_) {
      remarks_.push_back(name + ": another coordinate reference system than " + files_[0].string() +
                         "; the first one's is kept");
    }
  }
  if (unit_ == LengthUnit::kFoot || unit_ == LengthUnit::kUsSurveyFoot) {
    remarks_.push_back("the coordinates are in feet (" + to_string(unit_) +
                       "): radius, model and trajectory must be in feet too");
  }
}

void EnvironmentSource::choose_quantisation() {
  if (!try_keeping_integers()) choose_offset_and_scale();
}

bool EnvironmentSource::try_keeping_integers() {
  const auto scale_of = [](const Quantisation& q) {
    return std::array<double, 3>{q.scale[0], q.scale[1], q.scale[2]};
  };
  if (inputs_.empty() || !inputs_[0].info.quantisation) return false;
  quantisation_ = *inputs_[0].info.quantisation;
  const auto scale = scale_of(quantisation_);
  if (options_.scale && scale != std::array{*options_.scale, *options_.scale, *options_.scale}) {
    return false;
  }
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    Input& input = inputs_[i];
    const bool same = input.info.quantisation && scale_of(*input.info.quantisation) == scale;
    bool whole = same;
    for (std::size_t k = 0; k < 3 && same; ++k) {
      const double shift =
          (input.info.quantisation->offset[k] - quantisation_.offset[k]) / scale[k];
      const double rounded = std::nearbyint(shift);
      // A millionth of a quantum is the noise of offsets written in decimal.
      whole = whole && std::abs(shift - rounded) <= 1e-6 && std::abs(rounded) < 0x1p53;
      input.shift[k] = whole ? static_cast<std::int64_t>(rounded) : 0;
    }
    if (!whole) {
      if (options_.scale) return false;
      if (!input.info.quantisation) return false;  // refused with the right words
      throw InputError(files_[i].string() + ": its scale or offset does not agree with that of " +
                       files_[0].string() + "; --scale sets one for all, for example --scale " +
                       number(scale[0]));
    }
    input.kept = true;
  }
  return true;
}

void EnvironmentSource::choose_offset_and_scale() {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    inputs_[i].kept = false;
    const bool mixed =
        inputs_[i].info.quantisation.has_value() != inputs_[0].info.quantisation.has_value();
    if (mixed && !options_.scale) {
      const bool integers = inputs_[0].info.quantisation.has_value();
      throw InputError(files_[i].string() + ": its coordinates are " +
                       (integers ? "floating-point numbers" : "integers times a scale") +
                       ", expected " + (integers ? "integers" : "floating-point numbers") +
                       " as in " + files_[0].string() +
                       ". Does it belong to the environment (a model does not)? If so, --scale " +
                       "METRES rounds all of them to one scale");
    }
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 lo{kInfinity, kInfinity, kInfinity};
  Vec3 hi{-kInfinity, -kInfinity, -kInfinity};
  while (next_batch(raw_)) {
    for (std::size_t i = 0; i < raw_.size(); ++i) {
      const Vec3 p = point_of(raw_, inputs_[file_].info, i);
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
      throw InputError("coordinates from " + number(lo[k]) + " to " + number(hi[k]) +
                       " do not fit 32-bit integers at --scale " + number(quantisation_.scale[k]) +
                       "; --scale " + number(fitting) + " fits");
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
  input_points_ = non_finite_points_ = 0;
  largest_change_ = 0;
  if (stream_) stream_->rewind();
  current_.reset();
}

bool EnvironmentSource::next_batch(PointBatch& batch) {
  for (; file_ < files_.size(); ++file_, file_points_ = 0) {
    if (!reader(file_).read(batch)) continue;
    file_points_ += batch.size();
    return true;
  }
  if (stream_ && (inputs_[0].info.crs_wkt != stream_->info().crs_wkt ||
                  inputs_[0].info.unit != stream_->info().unit)) {
    inputs_[0].info = stream_->info();  // a CRS may follow the points
    check_crs();
  }
  return false;
}

bool EnvironmentSource::read(QuantaBatch& batch) {
  batch.quanta.clear();
  batch.offsets.clear();
  if (!next_batch(raw_)) return false;
  batch.first_source = input_points_;
  const Input& input = inputs_[file_];
  if (input.kept) {
    append_kept(raw_, input, batch);
  } else {
    append_rounded(raw_, input, batch);
  }
  input_points_ += raw_.size();
  return true;
}

void EnvironmentSource::append_kept(const PointBatch& batch, const Input& input, QuantaBatch& out) {
  out.quanta = batch.quanta;
  const Quantisation& own = *input.info.quantisation;
  if (own == quantisation_) return;
  for (auto& q : out.quanta) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double before = coordinate(own, axis, q[k]);
      const std::int64_t shifted = q[k] + input.shift[k];
      if (shifted < std::numeric_limits<std::int32_t>::min() ||
          shifted > std::numeric_limits<std::int32_t>::max()) {
        throw InputError(files_[file_].string() + ": too far from " + files_[0].string() +
                         " for 32-bit integers of " + number(own.scale[k]) +
                         "; a coarser --scale fits");
      }
      q[k] = static_cast<std::int32_t>(shifted);
      largest_change_ =
          std::max(largest_change_, std::abs(coordinate(quantisation_, axis, q[k]) - before));
    }
  }
}

void EnvironmentSource::append_rounded(const PointBatch& batch, const Input& input,
                                       QuantaBatch& out) {
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Vec3 p = point_of(batch, input.info, i);
    if (!is_finite(p)) {
      drop_non_finite(file_points_ - batch.size() + i);
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
        throw InputError(files_[file_].string() + ": changed while it was read");
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

void EnvironmentSource::drop_non_finite(std::uint64_t point) {
  ++non_finite_points_;
  if (options_.strict) {
    throw InputError(files_[file_].string() + ": point " + std::to_string(point) +
                     " is not finite, expected finite coordinates (--strict)");
  }
}

}  // namespace clearway
