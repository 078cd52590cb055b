#include "io/store/convert/path_origins.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/files/mapped_file.hpp"
#include "io/files/xxh64.hpp"
#include "io/paths/trajectory_file.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/store/convert/near_path.hpp"

namespace clearway {
namespace {

constexpr double kWeek = 604800;
/// Adjusted standard GPS time is GPS time less this.
constexpr double kAdjustment = 1e9;
/// More points than one pulse can have. LAS counts up to 15 returns.
constexpr std::uint64_t kMoreThanAPulse = 15;

std::string seconds_text(double seconds) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3f", seconds);
  return text;
}

/// A whole number of seconds with its sign, such as "+604800".
std::string shift_text(double seconds) {
  char text[64];
  std::snprintf(text, sizeof text, "%+.0f", seconds);
  return text;
}

std::string range_text(double first, double last) {
  return "from " + seconds_text(first) + " to " + seconds_text(last) + " s";
}

/// A way to count seconds, as reports and as messages name it.
struct NamedClock {
  const char *key, *text;
};

constexpr NamedClock kClocks[] = {{"week-seconds", "seconds of the GPS week"},
                                  {"adjusted", "adjusted standard GPS time"},
                                  {"standard", "GPS time, seconds since 1980-01-06"}};

const NamedClock& clock_of(GpsTimes kind) { return kClocks[kind == GpsTimes::kAdjusted ? 1 : 0]; }

/// Reads a path. Matrices that scale or shear stay refused whatever the caller does, since a
/// scanner does not, so no error offers to accept them.
TrajectoryFile read_rigid_path(const std::filesystem::path& path, const TrajectoryOptions& how) {
  try {
    return read_trajectory_file(path, how);
  } catch (const InputError& error) {
    if (error.remedy() != Remedy::kAllowNonRigid) throw;
    throw InputError(error.what());
  }
}

/// The lever arm in the unit of the environment.
Vec3 lever_of(const ConvertOptions& options, double metres_per_unit) {
  return {options.lever_arm.x / metres_per_unit, options.lever_arm.y / metres_per_unit,
          options.lever_arm.z / metres_per_unit};
}

/// A difference between two ways to count seconds.
struct KnownShift {
  double seconds;
  const char* what;
};

constexpr KnownShift kKnownShifts[] = {
    {0, ""},
    {kAdjustment, "from adjusted standard GPS time to GPS time"},
    {-kAdjustment, "from GPS time to adjusted standard GPS time"},
    {-315964782, "from Unix time to GPS time, with the 18 leap seconds since 2017"},
    {315964782, "from GPS time to Unix time, with the 18 leap seconds since 2017"},
    {-315964782 - kAdjustment,
     "from Unix time to adjusted standard GPS time, with the 18 leap seconds since 2017"},
    {315964782 + kAdjustment,
     "from adjusted standard GPS time to Unix time, with the 18 leap seconds since 2017"},
    {18, "from UTC to GPS time, with the 18 leap seconds since 2017"},
    {-18, "from GPS time to UTC, with the 18 leap seconds since 2017"},
};

}  // namespace

PathOrigins::PathOrigins(const ConvertOptions& options, const EnvironmentSource& environment,
                         OriginTable& table, MessageLog& log)
    : environment_(environment),
      table_(table),
      name_(options.origins_path.string()),
      crs_wkt_(environment.crs_wkt()),
      unit_(environment.unit()),
      files_(environment.files().size()) {
  const TrajectoryOptions how = reading_of_paths(options, environment.crs().crs, unit_);
  const double metres = how.environment_unit;
  TrajectoryFile file = read_rigid_path(options.origins_path, how);
  const bool turns = !(options.lever_arm == Vec3{0, 0, 0});
  for (const Message& remark : file.remarks) {
    // Times that go back are refused below.
    if (remark.code == "time-order" || (!turns && is_about_rotation(remark))) continue;
    log.add(remark);
  }
  table_.rest_on("a path and the GPS times of the points");
  path_.emplace(file.poses, std::move(file.labels.time), lever_of(options, metres), name_);
  const std::uint64_t most_bytes = options.memory_bytes / 8;
  if (path_->bytes() > most_bytes) {
    throw ResourceError(name_ + ": its " + format_count(file.poses.size()) + " poses take " +
                            format_size(path_->bytes()) + "; they may take " +
                            format_size(most_bytes) + ", an eighth of the memory",
                        Remedy::kMoreMemory, 8 * static_cast<double>(path_->bytes()));
  }
  if (path_->first() >= 0 && path_->last() <= 2 * kWeek) {
    clock_ = kWeekSeconds;
  } else if (path_->last() < kAdjustment) {
    clock_ = kAdjusted;
  }
  const double spans = path_->last() - path_->first();
  if (has_week_seconds() && spans > kWeek) {
    refuse(name_, "its times span " + seconds_text(spans) +
                      " s, which is more than a week, so seconds of the GPS week do not say where "
                      "on the path a point was measured; expected the path of one recording");
  }
}

/// Whether the path or a file counts seconds of the GPS week.
bool PathOrigins::has_week_seconds() const {
  return clock_ == kWeekSeconds || std::ranges::count(environment_.infos(), GpsTimes::kWeekSeconds,
                                                      &CloudInfo::gps_times) > 0;
}

/// Whether a time of a file with this kind of times cannot be what the header says.
bool PathOrigins::contradicts(GpsTimes kind, double time) const {
  const bool within_week = time >= 0 && time <= kWeek;
  if (kind == GpsTimes::kWeekSeconds) return !within_week;
  // Adjusted time was within a week from 0 in September 2011.
  return within_week && clock_ == kWeekSeconds;
}

/// The seconds to add to the time of a point for the time on the path.
double PathOrigins::shift_for(GpsTimes kind, double time) const {
  if (contradicts(kind, time)) return 0;
  const double first = path_->first(), last = path_->last();
  // The time of a point is moved by whole weeks to within a week from the first pose, or to before
  // it where that is nearer to the path.
  const auto nearest = [&](double shift) {
    const double at = time + shift;
    return at > last && first - (at - kWeek) < at - last ? shift - kWeek : shift;
  };
  if (kind == GpsTimes::kWeekSeconds) {
    // The path may have counted on beyond the end of the week, or count from another epoch.
    const double epoch = clock_ == kAdjusted ? -kAdjustment : 0;
    return nearest(epoch + kWeek * std::ceil((first - epoch - time) / kWeek));
  }
  if (clock_ == kStandard) return kAdjustment;
  if (clock_ == kAdjusted) return 0;
  return nearest(kAdjustment - kWeek * std::floor((time + kAdjustment - first) / kWeek));
}

PathOrigins::OfBatch PathOrigins::origins_of(const QuantaBatch& batch) const {
  OfBatch out;
  out.points = batch.quanta.size();
  const GpsTimes kind = kind_of(batch.file);
  if (batch.times.empty()) {
    if (batch.counts.input_points > 0) out.runs.push_back({batch.first_source, std::nullopt});
    return out;
  }
  std::size_t step = 0;
  double added = std::numeric_limits<double>::quiet_NaN();
  if (batch.quanta.empty()) out.runs.push_back({batch.first_source, std::nullopt});
  for (std::size_t point = 0; point < batch.quanta.size(); ++point) {
    const std::size_t i = batch.offsets.empty() ? point : batch.offsets[point];
    const double time = batch.times[i];
    std::optional<OriginQuanta> origin;
    if (std::isfinite(time)) {
      ++out.with_time;
      out.contradicting += contradicts(kind, time) ? 1 : 0;
      out.first = std::min(out.first, time);
      out.last = std::max(out.last, time);
      const double shift = shift_for(kind, time);
      const TimedPath::Place place = path_->at(time + shift, step);
      ++out.places[static_cast<std::size_t>(place.where)];
      if (place.where == TimedPath::Where::kOnPath) {
        if (shift != added) out.shifts.insert(shift);
        added = shift;
        origin = quanta_of_origin(environment_.quantisation(), place.position, name_);
      }
    } else {
      ++out.not_finite;
    }
    if (out.runs.empty() || out.runs.back().origin != origin) {
      out.runs.push_back({batch.first_source + i, origin});
    }
  }
  return out;
}

void PathOrigins::Sums::add(const Sums& other) {
  points += other.points;
  with_time += other.with_time;
  not_finite += other.not_finite;
  contradicting += other.contradicting;
  for (std::size_t i = 0; i < places.size(); ++i) places[i] += other.places[i];
  first = std::min(first, other.first);
  last = std::max(last, other.last);
  shifts.insert(other.shifts.begin(), other.shifts.end());
}

void PathOrigins::add(const QuantaBatch& batch, const OfBatch& origins) {
  files_[batch.file].add(origins);
  for (const OfBatch::Run& run : origins.runs) {
    table_.add_quanta(run.first, run.origin, name_of(batch.file));
  }
}

/// The range of the points' times and what they are by the headers: "from 3.000 to 9.000 s
/// (adjusted standard GPS time, by the header)".
std::string PathOrigins::times_of_points() const {
  std::vector<std::string> texts;
  std::size_t all = 0;
  for (const GpsTimes kind : {GpsTimes::kWeekSeconds, GpsTimes::kAdjusted}) {
    Sums times;
    std::size_t files = 0;
    for (std::size_t i = 0; i < files_.size(); ++i) {
      if (kind_of(i) != kind || files_[i].with_time == 0) continue;
      ++files;
      times.add(files_[i]);
    }
    all += files;
    if (files == 0) continue;
    texts.push_back((files < all ? "and in others " : "") + range_text(times.first, times.last) +
                    " (" + clock_of(kind).text + ", by the header" + (files > 1 ? "s)" : ")"));
  }
  return texts.size() < 2 ? texts.front() : texts[0] + " " + texts[1];
}

/// What would make the ranges of times overlap, where a known difference of clocks does, or that
/// none is known.
std::string PathOrigins::advice(double first, double last) const {
  const double apart = (first + last) / 2 - (path_->first() + path_->last()) / 2;
  for (const bool by_weeks : {false, true}) {
    for (const KnownShift& known : kKnownShifts) {
      if (by_weeks && known.seconds != 0 && !has_week_seconds()) continue;
      const double more = by_weeks ? kWeek * std::round((apart - known.seconds) / kWeek) : 0;
      const double shift = known.seconds + more;
      const bool overlap = path_->first() + shift <= last && path_->last() + shift >= first;
      if (shift == 0 || !overlap) continue;
      std::string what = known.what;
      if (more != 0) {
        what += std::string(what.empty() ? "" : ", and ") +
                "by whole weeks, so the path may be that of another recording";
      }
      return "They would overlap if " + shift_text(shift) +
             " s were added to the times of the path: " + what +
             ". Nothing is added unless it is certain, so change the times of the path if it is "
             "meant so";
    }
  }
  return "No difference between clocks that Clearway knows makes them overlap; is it the path of "
         "another recording?";
}

void PathOrigins::refuse_same_times() const {
  for (std::size_t i = 0; i < files_.size(); ++i) {
    const Sums& file = files_[i];
    const std::uint64_t most = file.first == 0 ? 1 : kMoreThanAPulse;
    if (file.with_time <= most || file.first != file.last) continue;
    refuse(name_of(i),
           "all {} points have the GPS time {} s; expected the times at which they were measured, "
           "because the origins on the path follow from them",
           format_count(file.with_time), seconds_text(file.first));
  }
}

void PathOrigins::refuse_several_weeks() const {
  std::set<double> weeks = all_.shifts;
  for (const double shift : {-kWeek, 0.0, kWeek}) weeks.erase(shift);
  if (clock_ != kWeekSeconds || weeks.size() < 2) return;
  refuse(name_, "its times are seconds of the GPS week, and the points that match them are of " +
                    format_count(weeks.size()) + " weeks; expected the points of one recording");
}

/// A sentence about what was added to times of points.
std::string PathOrigins::shifts_text() const {
  if (all_.shifts == std::set<double>{0}) return "Both are compared as they are";
  std::string text;
  for (const double shift : all_.shifts) {
    text += (text.empty() ? "" : " or ") + shift_text(shift);
  }
  return "To compare both, " + text +
         " s are added to those of the points, which is exact by the definition of these times";
}

OriginsPathReport PathOrigins::finish(MessageLog& log) {
  for (const Sums& file : files_) all_.add(file);
  if (environment_.crs_wkt() != crs_wkt_ || environment_.unit() != unit_) {
    refuse(name_,
           "was read before the coordinate reference system of the points was known, because that "
           "comes after them in the stream; expected the scan as a file");
  }
  if (all_.with_time == 0) {
    refuse(name_, all_.not_finite > 0
                      ? "gives no point an origin: none of the inputs has a finite GPS time"
                      : "gives no point an origin: none of the inputs has GPS times, which LAS and "
                        "LAZ have in all point formats but 0 and 2");
  }
  refuse_same_times();
  const std::string times = "the GPS times of the points go " + times_of_points() +
                            ", those of the path " + range_text(path_->first(), path_->last()) +
                            " (taken for " + kClocks[clock_].text + "). ";
  if (all_.at(TimedPath::Where::kOnPath) == 0) {
    refuse(name_, "gives no point an origin: " + times + advice(all_.first, all_.last));
  }
  refuse_several_weeks();
  log.note(times + shifts_text());
  const OriginsPathReport found = report();
  warn(found, log);
  return found;
}

OriginsPathReport PathOrigins::report() const {
  OriginsPathReport out;
  std::set<GpsTimes> kinds;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    if (files_[i].with_time > 0) kinds.insert(kind_of(i));
    out.without_time += files_[i].points - files_[i].with_time;
  }
  out.point_clock = kinds.size() > 1 ? "mixed" : clock_of(*kinds.begin()).key;
  out.path_clock = kClocks[clock_].key;
  out.first_point = all_.first;
  out.last_point = all_.last;
  out.first_pose = path_->first();
  out.last_pose = path_->last();
  out.shifts.assign(all_.shifts.begin(), all_.shifts.end());
  out.before = all_.at(TimedPath::Where::kBefore);
  out.after = all_.at(TimedPath::Where::kAfter);
  out.in_gaps = all_.at(TimedPath::Where::kInGap);
  return out;
}

void PathOrigins::warn(const OriginsPathReport& found, MessageLog& log) const {
  std::uint64_t without = 0, files = 0;
  for (const Sums& file : files_) {
    if (file.points == 0 || file.with_time > 0) continue;
    ++files;
    without += file.points;
  }
  if (files > 0) {
    log.add(warning("no-gps-times", {{"files", files}, {"points", without}},
                    "{}{} no GPS times, so {} points have no origin", counted(files, "input"),
                    files == 1 ? " has" : " have", format_count(without)));
  }
  if (all_.not_finite > 0) {
    log.add(warning("gps-times-not-finite", {{"points", all_.not_finite}},
                    "{} a GPS time that is not finite, and so no origin",
                    counted(all_.not_finite, "point has", "points have")));
  }
  if (all_.contradicting > 0) {
    log.add(warning("gps-times-contradict", {{"points", all_.contradicting}},
                    "the GPS times of {} cannot be what the headers of their files say (bit 0 of "
                    "the global encoding: 0 for seconds of the GPS week, 1 for adjusted standard "
                    "GPS time). They are compared with the path as they are",
                    counted(all_.contradicting, "point")));
  }
  const std::uint64_t outside = found.before + found.after + found.in_gaps;
  if (outside == 0) return;
  log.add(warning(
      "origins-path-gap",
      {{"before", found.before},
       {"after", found.after},
       {"in_gaps", found.in_gaps},
       {"gaps", path_->gaps()},
       {"longest_gap", path_->longest_gap()}},
      "{} of {} points with a GPS time have no origin, because the path does not say where the "
      "scanner was: {} are from before its first pose, {} from after its last one, and {} from "
      "between poses more than {} s apart{}",
      format_count(outside), format_count(all_.with_time), format_count(found.before),
      format_count(found.after), format_count(found.in_gaps), format_brief(TimedPath::kLongestStep),
      path_->gaps() > 0 ? " (the path has " + counted(path_->gaps(), "such gap") +
                              ", the longest of " + format_brief(path_->longest_gap()) + " s)"
                        : ""));
}

}  // namespace clearway
