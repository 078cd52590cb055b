#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "clearway/convert.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/timed_path.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/convert/origin_table.hpp"
#include "io/store/convert/quanta_batch.hpp"

namespace clearway {

/// The origins of a conversion by the points' GPS times and the path of the scanner.
class PathOrigins {
 public:
  /// What was found for some points.
  struct Sums {
    std::uint64_t points = 0, with_time = 0;  ///< all, and those with a finite time
    std::uint64_t not_finite = 0;
    std::uint64_t contradicting = 0;        ///< times that cannot be what the header says
    std::array<std::uint64_t, 4> places{};  ///< points by TimedPath::Where
    double first = std::numeric_limits<double>::infinity();  ///< least time, as in the file
    double last = -std::numeric_limits<double>::infinity();
    std::set<double> shifts{};  ///< seconds that were added to the times of points with an origin

    std::uint64_t at(TimedPath::Where where) const {
      return places[static_cast<std::size_t>(where)];
    }
    void add(const Sums& other);
  };

  /// The origins of a batch's records, by runs.
  struct OfBatch : Sums {
    struct Run {
      std::uint64_t first;  ///< source index
      std::optional<OriginQuanta> origin;
    };
    std::vector<Run> runs{};
  };

  /// Reads the path of options.origins_path, for points of this environment, whose headers have
  /// been read and which outlives this object. table: receives the origins, and outlives this
  /// object too. log: receives notes and warnings on the path. Throws InputError, UsageError, and
  /// ResourceError where the path takes more than an eighth of the memory.
  PathOrigins(const ConvertOptions& options, const EnvironmentSource& environment,
              OriginTable& table, MessageLog& log);

  /// Several threads may call it at once.
  OfBatch origins_of(const QuantaBatch& batch) const;
  /// Adds the origins of a batch. Called for all batches in input order.
  void add(const QuantaBatch& batch, const OfBatch& origins);
  /// Called after the last batch: says how times were understood, warns of points without an
  /// origin, and throws InputError where no point has one, or where the times cannot be right.
  OriginsPathReport finish(MessageLog& log);

 private:
  /// What the times of the path count, by their numbers.
  enum Clock : std::size_t { kWeekSeconds, kAdjusted, kStandard };

  GpsTimes kind_of(std::size_t file) const { return environment_.infos()[file].gps_times; }
  std::string name_of(std::size_t file) const { return environment_.files()[file].string(); }
  bool has_week_seconds() const;
  bool contradicts(GpsTimes kind, double time) const;
  double shift_for(GpsTimes kind, double time) const;
  std::string times_of_points() const;
  std::string shifts_text() const;
  std::string advice(double first, double last) const;
  void refuse_same_times() const;
  void refuse_several_weeks() const;
  OriginsPathReport report() const;
  void warn(const OriginsPathReport& found, MessageLog& log) const;

  const EnvironmentSource& environment_;
  OriginTable& table_;
  std::string name_;
  std::string crs_wkt_;
  LengthUnit unit_;
  std::optional<TimedPath> path_;
  Clock clock_ = kStandard;
  std::vector<Sums> files_;  ///< of each file
  Sums all_;                 ///< known in finish()
};

}  // namespace clearway
